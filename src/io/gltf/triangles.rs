//! The triangles of a primitive.

use gltf_json::mesh::{TRIANGLE_STRIP, TRIANGLES};

use super::primitive::Builder;

impl Builder<'_> {
    /// Adds the triangles that indices make in a mode, the first vertex being `first` of the mesh. With `merged`, the indices
    /// of the same corners on a closed surface, those make the triangles, and `corners` gets the ones of the primitive.
    #[expect(clippy::too_many_arguments, reason = "a primitive has so many sides")]
    pub(super) fn triangles(
        &mut self,
        mode: u32,
        indices: &[u32],
        first: u32,
        mirrored: bool,
        merged: Option<&[u32]>,
        corners: &mut Vec<[u32; 3]>,
        pointer: &str,
    ) {
        let mut dropped = 0;
        let turned = |[a, b, c]: [u32; 3]| if mirrored { [a, c, b] } else { [a, b, c] };
        if let Some(merged) = merged {
            let own = indices.as_chunks::<3>().0;
            for (own, &closed) in own.iter().zip(merged.as_chunks::<3>().0) {
                let [a, b, c] = closed.map(|corner| corner + first);
                if a == b || b == c || c == a {
                    dropped += 1;
                } else {
                    self.mesh.triangles.push(turned([a, b, c]));
                    corners.push(turned(*own));
                }
            }
            self.notes.add("triangle with a repeated corner dropped", dropped);
            return;
        }
        let mut push = |corners: [u32; 3]| {
            let [a, b, c] = corners.map(|corner| corner + first);
            if a == b || b == c || c == a {
                dropped += 1;
            } else {
                self.mesh.triangles.push(turned([a, b, c]));
            }
        };
        match mode {
            TRIANGLES => {
                let (whole, rest) = indices.as_chunks::<3>();
                whole.iter().for_each(|&corners| push(corners));
                if !rest.is_empty() {
                    self.notes
                        .say(format!("{pointer}: {} indices after the last triangle ignored", rest.len()));
                }
            }
            TRIANGLE_STRIP => {
                for (i, window) in indices.windows(3).enumerate() {
                    let [a, b, c] = [window[0], window[1], window[2]];
                    push(if i % 2 == 0 { [a, b, c] } else { [a, c, b] });
                }
                // Triangles without area link the parts of a strip.
                dropped = 0;
            }
            _ => {
                for pair in indices.get(1..).unwrap_or_default().windows(2) {
                    push([indices[0], pair[0], pair[1]]);
                }
            }
        }
        self.notes.add("triangle with a repeated corner dropped", dropped);
    }
}
