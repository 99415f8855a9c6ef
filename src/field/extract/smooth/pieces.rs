//! The surface in pieces, which are worked over each for itself: what goes wrong in one is put right, or left as it was, in that one alone.
//!
//! The vertices where pieces meet stay with their triangles, so that every piece fits its neighbours whatever is made of them. The next
//! time the surface is divided elsewhere.

use glam::DVec3;

use super::care::{self, Care, Fault};
use super::features::frozen_at;
use super::net::{Kind, Net, Vertex};
use super::stirred::{Stirred, Task};
use crate::Mesh;

/// Times that halves are taken at another part than the middle: once along each axis of a body.
const OFF_CENTRE: usize = 3;

/// A closed surface between times that it is worked over.
pub(super) struct Surface {
    /// Triangles, and what their vertices are; these have the places where they are to go.
    net: Net,
    /// Where the vertices are.
    places: Vec<DVec3>,
}

impl Surface {
    /// The surface of a mesh whose vertices are those of `net`.
    pub(super) fn new(net: Net, mesh: &Mesh) -> Self {
        Self { net, places: mesh.positions.iter().map(|&place| DVec3::from_array(place)).collect() }
    }

    /// As a mesh, with the numbers of its triangles.
    pub(super) fn mesh(&self) -> Mesh {
        let triangles = self.net.present().map(|(_, corners)| corners).collect();
        Mesh::new(self.places.iter().map(DVec3::to_array).collect(), triangles)
    }

    /// The triangles in pieces of at most `most` that lie together, the first few times divided at `part` of their number.
    pub(super) fn divided(&self, most: usize, part: f64) -> Vec<Vec<u32>> {
        let middle = |corners: [u32; 3]| corners.map(|k| self.places[k as usize]).iter().sum::<DVec3>() / 3.0;
        let middles: Vec<DVec3> = self.net.present().map(|(_, corners)| middle(corners)).collect();
        let mut pieces = Vec::new();
        let mut groups = vec![((0..middles.len() as u32).collect::<Vec<u32>>(), 0)];
        while let Some((mut group, depth)) = groups.pop() {
            if group.len() <= most.max(1) {
                group.sort_unstable();
                pieces.push(group);
                continue;
            }
            let of = |triangle: u32| middles[triangle as usize];
            let low = group.iter().map(|&triangle| of(triangle)).fold(DVec3::INFINITY, DVec3::min);
            let high = group.iter().map(|&triangle| of(triangle)).fold(DVec3::NEG_INFINITY, DVec3::max);
            let axis = (high - low).max_position();
            let part = if depth < OFF_CENTRE { part } else { 0.5 };
            let at = ((group.len() as f64 * part) as usize).clamp(1, group.len() - 1);
            let order = |x: &u32, y: &u32| of(*x)[axis].total_cmp(&of(*y)[axis]).then(x.cmp(y));
            group.select_nth_unstable_by(at, order);
            let upper = group.split_off(at);
            groups.extend([(upper, depth + 1), (group, depth + 1)]);
        }
        pieces
    }
}

/// A piece of a surface, and what has been learnt about it.
pub(super) struct Piece {
    /// The numbers of its vertices in the surface, in ascending order.
    numbers: Vec<u32>,
    /// Triangles, by positions in `numbers`, and which way the surface faces there.
    triangles: Vec<[u32; 3]>,
    sides: Vec<DVec3>,
    /// What to be careful with. Vertices that other pieces have, too, are frozen.
    care: Vec<Care>,
    /// Times that it was worked over.
    pub(super) times: usize,
}

/// What is made of a piece: its first vertices are those of the piece.
pub(super) struct Patch {
    vertices: Vec<Vertex>,
    triangles: Vec<[u32; 3]>,
    sides: Vec<DVec3>,
    /// Where there may be something to do yet.
    stirred: Stirred,
}

impl Piece {
    pub(super) fn new(surface: &Surface, triangles: &[u32]) -> Self {
        let net = &surface.net;
        let corners = || triangles.iter().map(|&triangle| net.corners(triangle));
        let mut uses: Vec<u32> = corners().flatten().collect();
        uses.sort_unstable();
        let (mut numbers, mut care) = (Vec::new(), Vec::new());
        for of_one in uses.chunk_by(|x, y| x == y) {
            let whole = of_one.len() == net.star(of_one[0]).len();
            numbers.push(of_one[0]);
            care.push(if whole { Care::None } else { Care::Frozen });
        }
        let local = |number: u32| numbers.partition_point(|&other| other < number) as u32;
        let own = corners().map(|corners| corners.map(local)).collect();
        let sides = triangles.iter().map(|&triangle| net.side(triangle)).collect();
        Self { numbers, triangles: own, sides, care, times: 0 }
    }

    /// The piece to be worked over.
    pub(super) fn net(&self, surface: &Surface) -> Net {
        let vertex = |(&number, care): (&u32, &Care)| {
            let known = surface.net.vertex(number);
            match care {
                Care::None => known.clone(),
                Care::Calm => Vertex { calm: true, ..known.clone() },
                Care::Frozen => frozen_at(surface.places[number as usize]),
            }
        };
        let vertices = self.numbers.iter().zip(&self.care).map(vertex).collect();
        let mut net = Net::new(vertices, self.triangles.clone(), self.sides.clone());
        net.stirred = Stirred::of(&surface.net.stirred, &self.numbers);
        net
    }

    /// Takes more care around the faults, the farther the more often it was worked over; leaves all as it was after `most` times.
    pub(super) fn take_care(&mut self, surface: &Surface, faults: &[Fault], most: usize) {
        if self.times >= most {
            self.care.fill(Care::Frozen);
            return;
        }
        let places: Vec<DVec3> = self.numbers.iter().map(|&number| surface.places[number as usize]).collect();
        care::take_care(&places, faults, f64::from(1u32 << self.times.min(8)) / 2.0, &mut self.care);
    }

    /// Whether nothing of it may change.
    pub(super) fn is_left(&self) -> bool {
        self.care.iter().all(|care| *care == Care::Frozen)
    }
}

impl Patch {
    pub(super) fn of(net: &Net) -> Self {
        let (triangles, sides) = net.present().map(|(number, corners)| (corners, net.side(number))).unzip();
        Self { vertices: net.vertices.clone(), triangles, sides, stirred: net.stirred.clone() }
    }

    /// Its triangles that were worked over since they were checked, by the places of their corners; of those of which a corner stays, and
    /// that are still the same triangles, where they were before, too.
    pub(super) fn changed(
        &self,
        piece: &Piece,
        surface: &Surface,
    ) -> impl Iterator<Item = ([DVec3; 3], Option<[DVec3; 3]>)> {
        let is_new = |corners: &&[u32; 3]| {
            is_changed(corners, &self.vertices)
                && corners.iter().any(|&corner| self.stirred.for_task(corner, Task::Check))
        };
        self.triangles.iter().filter(is_new).map(|corners| {
            let stays = self.stays(corners);
            let before = || corners.map(|corner| surface.places[piece.numbers[corner as usize] as usize]);
            (corners.map(|corner| self.vertices[corner as usize].place), stays.then(before))
        })
    }

    /// Notes that what is [`Patch::changed`] was looked at. Next to vertices that stay all is looked at again, when these are within a piece.
    pub(super) fn checked(&mut self) {
        self.stirred.settle_all(Task::Check);
        for corners in &self.triangles {
            if self.stays(corners) {
                corners.iter().for_each(|&corner| self.stirred.stir(corner));
            }
        }
    }

    fn stays(&self, corners: &[u32; 3]) -> bool {
        corners.iter().any(|&corner| self.vertices[corner as usize].kind == Kind::Frozen)
    }
}

fn is_changed(corners: &[u32; 3], vertices: &[Vertex]) -> bool {
    corners.iter().any(|&corner| vertices[corner as usize].kind != Kind::Frozen)
}

/// The surface put together of what was made of its pieces; for every triangle the piece it is of, and whether that was worked over there.
pub(super) fn joined<'p>(
    surface: &Surface,
    pieces: &[Piece],
    patches: impl Iterator<Item = &'p Patch>,
) -> (Surface, Vec<(u32, bool)>) {
    const NONE: u32 = u32::MAX;
    let mut numbers = vec![NONE; surface.places.len()];
    let (mut vertices, mut places, mut stirred) = (Vec::new(), Vec::new(), Stirred::default());
    let (mut triangles, mut sides, mut origins) = (Vec::new(), Vec::new(), Vec::new());
    for (index, (piece, patch)) in (0u32..).zip(pieces.iter().zip(patches)) {
        let mut own = vec![NONE; patch.vertices.len()];
        for &corners in &patch.triangles {
            for corner in corners {
                let vertex = &patch.vertices[corner as usize];
                let known = piece.numbers.get(corner as usize).filter(|_| vertex.kind == Kind::Frozen);
                let number = match known {
                    // Vertices that stayed keep what is known of them.
                    Some(&known) => &mut numbers[known as usize],
                    None => &mut own[corner as usize],
                };
                if *number == NONE {
                    *number = places.len() as u32;
                    let (place, vertex) = match known {
                        Some(&known) => (surface.places[known as usize], surface.net.vertex(known)),
                        None => (vertex.place, vertex),
                    };
                    places.push(place);
                    vertices.push(Vertex { calm: false, ..vertex.clone() });
                    stirred.push(Some((&patch.stirred, corner)));
                }
                own[corner as usize] = *number;
            }
            triangles.push(corners.map(|corner| own[corner as usize]));
            origins.push((index, is_changed(&corners, &patch.vertices)));
        }
        sides.extend(&patch.sides);
    }
    let mut net = Net::new(vertices, triangles, sides);
    net.stirred = stirred;
    (Surface { net, places }, origins)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ball, to be blown up by half.
    fn surface() -> Surface {
        let mesh = crate::primitives::uv_sphere(1.0, 32, 16).expect("a sphere");
        let vertex = |p: &[f64; 3]| Vertex::free(DVec3::from_array(*p) * 1.5, DVec3::from_array(*p));
        let vertices = mesh.positions.iter().map(vertex).collect();
        let sides = mesh.triangles.iter().map(|t| DVec3::from_array(mesh.positions[t[0] as usize])).collect();
        Surface::new(Net::new(vertices, mesh.triangles.clone(), sides), &mesh)
    }

    #[test]
    fn pieces_that_are_left_give_the_surface_back() {
        let surface = surface();
        let groups = surface.divided(100, 0.3);
        assert!(groups.len() > 5 && groups.iter().all(|group| (1..=100).contains(&group.len())));
        let mut pieces: Vec<Piece> = groups.iter().map(|group| Piece::new(&surface, group)).collect();
        pieces.iter_mut().for_each(|piece| piece.take_care(&surface, &[], 0));
        let patches: Vec<Patch> = pieces.iter().map(|piece| Patch::of(&piece.net(&surface))).collect();
        let (same, origins) = joined(&surface, &pieces, patches.iter());
        assert!(origins.iter().all(|(_, changed)| !changed));
        let [before, after] = [surface.mesh(), same.mesh()].map(|mesh| {
            let place = |k: u32| mesh.positions[k as usize].map(f64::to_bits);
            let mut all: Vec<_> = mesh.triangles.iter().map(|t| t.map(place)).collect();
            all.sort_unstable();
            (all, mesh.positions.len())
        });
        assert_eq!(before, after);
    }

    #[test]
    fn vertices_within_pieces_go_where_they_belong_and_seams_stay() {
        let surface = surface();
        let groups = surface.divided(100, 0.3);
        let pieces: Vec<Piece> = groups.iter().map(|group| Piece::new(&surface, group)).collect();
        let patches: Vec<Patch> = pieces.iter().map(|piece| Patch::of(&piece.net(&surface))).collect();
        let (moved, _) = joined(&surface, &pieces, patches.iter());
        assert_eq!(moved.places.len(), surface.places.len());
        let far = moved.places.iter().filter(|place| place.length() > 1.4).count();
        assert!(far > 0 && far < moved.places.len());
        // As one piece there are no seams.
        let all = [Piece::new(&surface, &surface.divided(usize::MAX, 0.3)[0])];
        let (moved, _) = joined(&surface, &all, [Patch::of(&all[0].net(&surface))].iter());
        assert!(moved.places.iter().all(|place| place.length() > 1.4));
    }
}
