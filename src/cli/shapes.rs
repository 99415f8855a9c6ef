//! Inputs that are no files: `box:10,10,2`, `cylinder:3,20`, `text:No 42`.

use std::path::{Path, PathBuf};

use trisect::io::{Contents, Format};
use trisect::{Error, Mesh, primitives};

use super::chosen::Chosen;
use super::fault::Fault;

/// Around a full turn, unless the input says otherwise.
const SEGMENTS: u32 = 64;

/// How an input `text:...` is set.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Setting {
    pub(crate) font: Option<PathBuf>,
    pub(crate) size: Option<f64>,
    pub(crate) depth: Option<f64>,
    pub(crate) justify: Option<Justify>,
}

/// To which side lines of text are flush.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Justify {
    /// Lines begin at x = 0
    Left,
    /// The middle of every line is at x = 0
    Center,
    /// Lines end at x = 0
    Right,
}

impl Setting {
    /// This, and for what it does not say what another one does.
    pub(crate) fn or(self, other: &Self) -> Self {
        Self {
            font: self.font.or_else(|| other.font.clone()),
            size: self.size.or(other.size),
            depth: self.depth.or(other.depth),
            justify: self.justify.or(other.justify),
        }
    }

    /// Whether anything is said.
    pub(crate) fn is_some(&self) -> bool {
        *self != Self::default()
    }
}

/// The kind of shape that a name means, and what follows the colon; nothing for names of files.
pub(crate) fn named(path: &Path) -> Option<(&str, &str)> {
    let (kind, rest) = path.to_str()?.split_once(':')?;
    let is_kind = ["box", "sphere", "cylinder", "cone", "torus", "text"].contains(&kind);
    (is_kind && !path.exists()).then_some((kind, rest))
}

/// The mesh of a shape.
pub(crate) fn made(path: &Path, setting: &Setting) -> Result<Chosen, Fault> {
    let (kind, rest) = named(path).ok_or_else(|| Fault::internal("not a shape"))?;
    let mesh = match kind {
        "text" => text(rest, setting)?,
        _ => solid(kind, rest).map_err(|what| Fault::usage(format!("{}: {what}", path.display())))?,
    };
    Ok(Chosen {
        name: None,
        mesh,
        // Whatever has z upwards.
        format: Format::Stl,
        warnings: Vec::new(),
        contents: Contents::default(),
    })
}

/// Round shapes stand in the middle of the origin, as those of model files do.
fn solid(kind: &str, rest: &str) -> Result<Mesh, String> {
    let numbers: Vec<f64> = rest
        .split([',', ' '])
        .filter(|word| !word.is_empty())
        .map(|word| word.parse().map_err(|_| format!("'{word}' is not a number")))
        .collect::<Result<_, _>>()?;
    let segments = |given: Option<&f64>| match given {
        None => Ok(SEGMENTS),
        Some(&count) if count.fract() == 0.0 && (3.0..=65536.0).contains(&count) => Ok(count as u32),
        Some(count) => Err(format!("segments around are a number from 3 to 65536, not {count}")),
    };
    let told = |error: Error| error.to_string().replace("invalid argument: ", "");
    match (kind, &*numbers) {
        ("box", &[size]) => cuboid([size; 3]).map_err(told),
        ("box", &[x, y, z]) => cuboid([x, y, z]).map_err(told),
        ("sphere", &[radius, ref rest @ ..]) if rest.len() <= 1 => {
            let around = segments(rest.first())?;
            primitives::uv_sphere(radius, around, (around / 2).max(2)).map_err(told)
        }
        ("cylinder", &[radius, height, ref rest @ ..]) if rest.len() <= 1 => {
            let mesh = primitives::cylinder(radius, height, segments(rest.first())?).map_err(told)?;
            Ok(mesh.translated([0.0, 0.0, -height / 2.0]))
        }
        ("cone", &[radius, height, ref rest @ ..]) if rest.len() <= 1 => {
            let mesh = primitives::cone(radius, height, segments(rest.first())?).map_err(told)?;
            Ok(mesh.translated([0.0, 0.0, -height / 2.0]))
        }
        ("torus", &[large, small, ref rest @ ..]) if rest.len() <= 1 => {
            let around = segments(rest.first())?;
            primitives::torus(large, small, around, (around / 2).max(3)).map_err(told)
        }
        _ => Err("expected box:X,Y,Z, sphere:R, cylinder:R,HEIGHT, cone:R,HEIGHT or torus:R,r (round ones with how many \
                  segments around as a further number), or text:TEXT"
            .into()),
    }
}

fn cuboid(size: [f64; 3]) -> Result<Mesh, Error> {
    primitives::cuboid(size.map(|x| -x / 2.0), size.map(|x| x / 2.0))
}

#[cfg(feature = "text")]
fn text(text: &str, setting: &Setting) -> Result<Mesh, Fault> {
    use trisect::making::{Font, Lettering, TextAlign};

    let Some(font) = &setting.font else {
        return Err(Fault::usage(
            "text needs a font: --font FILE.ttf (or .otf, .ttc; systems have theirs in /usr/share/fonts, /Library/Fonts or \
             C:\\Windows\\Fonts)",
        ));
    };
    let align = match setting.justify {
        None | Some(Justify::Left) => TextAlign::Left,
        Some(Justify::Center) => TextAlign::Center,
        Some(Justify::Right) => TextAlign::Right,
    };
    let lettering = Lettering::new(setting.size.unwrap_or(10.0), setting.depth.unwrap_or(1.0)).align(align);
    // Shells have no easy way to write the end of a line.
    let lines = text.replace("\\n", "\n");
    Ok(lettering.mesh(&lines, &Font::load(font)?)?)
}

#[cfg(not(feature = "text"))]
fn text(_: &str, _: &Setting) -> Result<Mesh, Fault> {
    Err(Fault::usage("this build of the program has no text (feature `text`)"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_are_in_the_middle_of_the_origin() {
        for text in ["box:2", "box:2,4,6", "sphere:3", "cylinder:1,2", "cone:1,2,7", "torus:3,1,24"] {
            let made = made(text.as_ref(), &Setting::default()).unwrap().mesh;
            let middle = made.bounds().unwrap().center();
            assert!(text.starts_with("cone") || middle.iter().all(|x| x.abs() < 1e-12), "{text}: {middle:?}");
            assert!(trisect::Solid::try_from(made).unwrap().is_manifold(), "{text}");
        }
        for bad in ["box:", "box:1,2", "box:-1", "sphere:x", "cylinder:1", "cylinder:1,2,2", "torus:1,2"] {
            assert!(made(bad.as_ref(), &Setting::default()).is_err(), "{bad}");
        }
        assert!(named("C:box.stl".as_ref()).is_none() && named("box".as_ref()).is_none());
        assert!(made("text:A".as_ref(), &Setting::default()).unwrap_err().message.contains("--font"));
    }
}
