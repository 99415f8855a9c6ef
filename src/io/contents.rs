//! What a file holds besides its mesh.

/// What a file holds that a [`Mesh`](crate::Mesh) has no place for. Nothing of it is in files written from the mesh.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Contents {
    /// The names of animations, or their numbers.
    pub animations: Vec<String>,
    /// How many cameras there are.
    pub cameras: usize,
    /// How many lights there are.
    pub lights: usize,
    /// How many meshes have a skeleton; they are read in the pose in which they are bound to it.
    pub skinned: usize,
    /// How many meshes have morph targets; they are read in the shape that their weights show.
    pub morphed: usize,
    /// How many nodes, scenes and the like have extras: what programs say of them for themselves.
    pub extras: usize,
    /// How many material variants there are; materials are the usual ones.
    pub variants: usize,
    /// How many pieces of metadata a package has.
    pub metadata: usize,
    /// How many files a package has besides its models: pictures of them, settings of slicers.
    pub attachments: usize,
}

impl Contents {
    /// Whether there is nothing but the mesh.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// What is lost where the mesh alone is written, one sentence each.
    #[must_use]
    pub fn not_kept(&self) -> Vec<String> {
        let mut sentences = Vec::new();
        if !self.animations.is_empty() {
            const SHOWN: usize = 8;
            let names: Vec<&str> = self.animations.iter().take(SHOWN).map(String::as_str).collect();
            let more = if self.animations.len() > SHOWN { ", ..." } else { "" };
            let names = format!("{}{more}", names.join(", "));
            sentences.push(format!("{} not kept: {names}", counted(self.animations.len(), "animation")));
        }
        if self.skinned > 0 {
            let meshes = counted(self.skinned, "skinned mesh");
            sentences.push(format!("{meshes} taken in the bind pose, the skeleton is not kept"));
        }
        if self.morphed > 0 {
            let meshes = counted(self.morphed, "mesh");
            sentences.push(format!(
                "{meshes} with morph targets taken in the shape of the weights, the targets are not kept"
            ));
        }
        for (count, what) in [
            (self.cameras, "camera"),
            (self.lights, "light"),
            (self.variants, "material variant"),
            (self.metadata, "metadata entry"),
            (self.attachments, "further file of the package"),
        ] {
            if count > 0 {
                sentences.push(format!("{} not kept", counted(count, what)));
            }
        }
        if self.extras > 0 {
            let whose = if self.extras == 1 {
                "1 node or scene"
            } else {
                &format!("{} nodes and scenes", self.extras)
            };
            sentences.push(format!("extras of {whose} not kept"));
        }
        sentences
    }
}

fn counted(count: usize, what: &str) -> String {
    match (count, what) {
        (1, _) => format!("1 {what}"),
        (_, "metadata entry") => format!("{count} metadata entries"),
        (_, "further file of the package") => format!("{count} further files of the package"),
        (_, what) if what.ends_with("sh") => format!("{count} {what}es"),
        (_, what) => format!("{count} {what}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_lost_is_counted() {
        assert!(Contents::default().is_empty() && Contents::default().not_kept().is_empty());
        let contents = Contents {
            animations: (0..9).map(|i| format!("walk{i}")).collect(),
            cameras: 1,
            skinned: 2,
            extras: 1,
            variants: 2,
            ..Contents::default()
        };
        let said = contents.not_kept();
        assert!(
            said[0].starts_with("9 animations not kept: walk0, walk1") && said[0].ends_with("walk7, ...")
        );
        assert!(said[1].starts_with("2 skinned meshes") && said[2] == "1 camera not kept");
        assert_eq!(said[3..], ["2 material variants not kept", "extras of 1 node or scene not kept"]);
    }
}
