//! Pieces of a surface that are height fields: seen along an axis, each of their points is seen once. No two of their triangles meet
//! but in the corners and edges that they share, however many they are, so that none of their pairs need be looked for.
//!
//! Where all triangles of a piece are seen from the front, a point of the picture plane is covered by as many of them as the boundary
//! of the piece winds around it. So the piece is a height field if its boundary winds once around a region
//! ([`winds_once`]), which takes the square root of its size to see (the "contour condition" of Volino and Magnenat-Thalmann 1994;
//! dropping a coordinate rounds nothing, so that it is exact here, and needs neither a connected piece nor one without holes). All
//! tests are strict: what they say holds after the smallest of moves too.
//!
//! Pieces are branches of the tree of boxes. The corners around which all triangles belong to one piece are *inner* ones, and an edge
//! with an inner end is no part of a boundary; for the others edges are cancelled against each other.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

use crate::Mesh;
use crate::control::Limit;
use crate::exact::{Projection, facing};
use crate::parallel::{Runner, build};
use crate::polygon::winds_once;
use crate::spatial::{BoxTree, Branch, Branches};

/// The fewest triangles of a piece: with fewer the boundary is most of it.
const LEAST: usize = 48;
/// Triangles from which pieces are looked for: below, there are few pairs anyway.
const WORTHWHILE: usize = 1024;
/// Triangles that one thread looks at before the limits are checked.
const AT_ONCE: usize = 1 << 14;
/// The label of a vertex that nothing is known of yet.
const NONE: u32 = u32::MAX;
/// The label of a vertex with triangles of several pieces, or of none.
const RIM: u32 = u32::MAX - 1;

/// The height fields among the branches of a tree of triangles.
pub(super) struct HeightFields {
    /// Branches without pairs in them.
    pub(super) branches: Branches,
    /// For each vertex whether all its triangles belong to one height field.
    pub(super) inner: Vec<bool>,
    /// The triangles that have other vertices too.
    pub(super) rim: Vec<u32>,
    /// By place in the tree whether the triangle is among these.
    pub(super) is_rim: Vec<bool>,
}

impl HeightFields {
    /// None.
    pub(super) fn none(mesh: &Mesh, tree: &BoxTree) -> Self {
        Self {
            branches: Branches::none(tree),
            inner: vec![false; mesh.positions.len()],
            rim: (0..mesh.triangles.len() as u32).collect(),
            is_rim: vec![true; tree.items().len()],
        }
    }

    /// Of a closed mesh; the tree has some of its triangles, `others` are the rest. O(n), where few pieces look like height fields
    /// and are none.
    ///
    /// # Errors
    /// Only limits.
    pub(super) fn new(
        mesh: &Mesh,
        tree: &BoxTree,
        others: &[u32],
        runner: Runner<'_>,
    ) -> Result<Self, Limit> {
        if tree.items().len() < WORTHWHILE {
            return Ok(Self::none(mesh, tree));
        }
        // 1. What may be one: triangles that are seen from the front along one axis.
        let masks = build(mesh.triangles.len(), AT_ONCE, |first, run: &mut [u8]| {
            let triangles = mesh.triangles[first..].iter();
            run.iter_mut().zip(triangles).for_each(|(mask, triangle)| {
                *mask = facing(&triangle.map(|v| &mesh.positions[v as usize]));
            });
        });
        let found = tree.branches_alike(LEAST, |item| masks[item as usize]);
        drop(masks);
        if found.is_empty() {
            return Ok(Self::none(mesh, tree));
        }
        // 2. Round by round: those that are none are looked at part by part.
        let labels = std::iter::repeat_with(|| AtomicU32::new(NONE)).take(mesh.positions.len()).collect();
        let search = Search { mesh, tree, labels };
        let (mut branches, mut rim, mut is_field) = (Branches::none(tree), Vec::new(), Vec::new());
        let (mut pieces, mut others_left) = (pieces(tree, &found), others);
        while !pieces.is_empty() {
            let first = is_field.len() as u32;
            search.label(&pieces, std::mem::take(&mut others_left), first, runner)?;
            let labelled = (first..).zip(pieces).collect();
            let round = runner.each(labelled, |(label, piece)| (search.check(&piece, label), piece))?;
            pieces = Vec::new();
            for (found, piece) in round {
                is_field.push(matches!(found, Found::Field(_)));
                match found {
                    Found::Field(places) => {
                        piece.branch.into_iter().for_each(|(branch, _)| branches.insert(branch));
                        rim.extend(places);
                    }
                    Found::Parts(parts) => pieces.extend(parts),
                    Found::Nothing => rim.extend(piece.range.start as u32..piece.range.end as u32),
                }
            }
        }
        // 3. What was found.
        let mut is_rim = vec![false; tree.items().len()];
        rim.iter().for_each(|&place| is_rim[place as usize] = true);
        let of_tree = rim.iter().map(|&place| tree.items()[place as usize]);
        let rim = of_tree.chain(others.iter().copied()).collect();
        let is_inner = |label: AtomicU32| is_field.get(label.into_inner() as usize) == Some(&true);
        Ok(Self { branches, inner: search.labels.into_iter().map(is_inner).collect(), rim, is_rim })
    }
}

/// Consecutive items of the tree.
struct Piece {
    range: Range<usize>,
    /// What they are, if they may be a height field, and the ends of the axes from which all of them are seen from the front.
    branch: Option<(Branch, u8)>,
    /// The label of its vertices so far: that of the piece it is a part of.
    before: u32,
}

impl Piece {
    fn of_branch(branch: Branch, mask: u8, before: u32, tree: &BoxTree) -> Self {
        let range = branch.range(tree);
        Self { branch: (range.len() >= LEAST).then_some((branch, mask)), range, before }
    }
}

/// All items: the given branches, and what is between them.
fn pieces(tree: &BoxTree, found: &[(Branch, u8)]) -> Vec<Piece> {
    let (mut pieces, mut end) = (Vec::with_capacity(2 * found.len() + 1), 0);
    let between = |range| Piece { range, branch: None, before: NONE };
    for &(branch, mask) in found {
        let piece = Piece::of_branch(branch, mask, NONE, tree);
        pieces.push(between(end..piece.range.start));
        end = piece.range.end;
        pieces.push(piece);
    }
    pieces.push(between(end..tree.items().len()));
    pieces.retain(|piece| !piece.range.is_empty());
    pieces
}

/// What a piece turns out to be.
enum Found {
    /// A height field, with the places of those of its triangles that have vertices with triangles of others too.
    Field(Vec<u32>),
    /// None; but its parts may be.
    Parts(Vec<Piece>),
    Nothing,
}

struct Search<'a> {
    mesh: &'a Mesh,
    tree: &'a BoxTree,
    /// For each vertex the piece that all its triangles belong to; `RIM` if there is none.
    labels: Vec<AtomicU32>,
}

impl Search<'_> {
    /// Labels vertices that only triangles of one piece have, given the label of the first piece.
    fn label(&self, pieces: &[Piece], others: &[u32], first: u32, runner: Runner<'_>) -> Result<(), Limit> {
        let mut runs: Vec<(&[u32], u32, u32)> = others.chunks(AT_ONCE).map(|run| (run, RIM, RIM)).collect();
        for (label, piece) in (first..).zip(pieces) {
            let own = if piece.branch.is_some() { label } else { RIM };
            let triangles = &self.tree.items()[piece.range.clone()];
            runs.extend(triangles.chunks(AT_ONCE).map(|run| (run, piece.before, own)));
        }
        runner.each(runs, |(triangles, before, own)| {
            let order = Ordering::Relaxed;
            for vertex in triangles.iter().flat_map(|&triangle| self.mesh.triangles[triangle as usize]) {
                let label = &self.labels[vertex as usize];
                // (What comes out does not depend on who comes first.)
                let seen = label.load(order);
                let is_own = seen == own
                    || (seen == before && label.compare_exchange(before, own, order, order).is_ok())
                    || label.load(order) == own;
                if !is_own {
                    label.store(RIM, order);
                }
            }
        })?;
        Ok(())
    }

    fn check(&self, piece: &Piece, label: u32) -> Found {
        let Some((branch, mask)) = piece.branch else { return Found::Nothing };
        // 1. The sides of its triangles without inner vertices are all that may bound it.
        let (mut rim, mut sides) = (Vec::new(), Vec::new());
        for place in piece.range.clone() {
            let corners = self.corners(place);
            let is_inner = corners.map(|v| self.labels[v as usize].load(Ordering::Relaxed) == label);
            if is_inner == [true; 3] {
                continue;
            }
            rim.push(place as u32);
            let outer = (0..3).filter(|&k| !is_inner[k] && !is_inner[(k + 1) % 3]);
            sides.extend(outer.map(|k| [corners[k], corners[(k + 1) % 3]]));
        }
        if self.is_bounded_well(sides, mask) {
            return Found::Field(rim);
        }
        // 2. If it is no height field, its parts may be.
        let parts: Vec<Piece> =
            branch.parts(self.tree).map(|part| Piece::of_branch(part, mask, label, self.tree)).collect();
        if parts.is_empty() { Found::Nothing } else { Found::Parts(parts) }
    }

    fn corners(&self, place: usize) -> [u32; 3] {
        self.mesh.triangles[self.tree.items()[place] as usize]
    }

    /// Whether what is left of sides when opposite ones are taken away winds once around a region, seen from one of the given ends of
    /// axes.
    fn is_bounded_well(&self, sides: Vec<[u32; 2]>, mask: u8) -> bool {
        let Some(boundary) = boundary(sides) else { return false };
        let mut vertices: Vec<u32> = boundary.iter().flatten().copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        // (All are there.)
        let number = |v: u32| vertices.partition_point(|&other| other < v) as u32;
        let edges: Vec<[u32; 2]> = boundary.iter().map(|side| side.map(number)).collect();
        (0..6).filter(|end| mask >> end & 1 == 1).any(|end| {
            let view = Projection::seen_from(end / 2, end % 2 == 0);
            let points: Vec<[f64; 2]> =
                vertices.iter().map(|&v| view.project(&self.mesh.positions[v as usize])).collect();
            winds_once(&points, &edges)
        })
    }
}

/// The sides that have no opposite one; `None` where some are there several times.
fn boundary(sides: Vec<[u32; 2]>) -> Option<Vec<[u32; 2]>> {
    let mut keyed: Vec<(u64, bool)> =
        sides.into_iter().map(|[u, v]| (u64::from(u.min(v)) << 32 | u64::from(u.max(v)), u < v)).collect();
    keyed.sort_unstable();
    let mut left = Vec::new();
    for same in keyed.chunk_by(|a, b| a.0 == b.0) {
        let forward = same.iter().filter(|side| side.1).count();
        let (low, high) = ((same[0].0 >> 32) as u32, same[0].0 as u32);
        match (forward, same.len() - forward) {
            (x, y) if x == y => {}
            (x, y) if x == y + 1 => left.push([low, high]),
            (x, y) if y == x + 1 => left.push([high, low]),
            _ => return None,
        }
    }
    Some(left)
}

#[cfg(test)]
mod tests {
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    use super::super::self_crossings::count_by_all_pairs;
    use super::super::self_pairs::tree_of;
    use super::*;
    use crate::mesh::Bounds;
    use crate::spatial::Frame;
    use crate::{Control, Solid, primitives};

    fn fields_of(mesh: &Mesh, parallel: bool) -> HeightFields {
        let bounds = Bounds::of(&mesh.positions).unwrap();
        let tree = tree_of(mesh, &Frame::of(bounds.low, bounds.high));
        let control = Control::new();
        HeightFields::new(mesh, &tree, &[], Runner::new(&control, parallel)).unwrap()
    }

    #[test]
    fn a_ball_is_nearly_all_height_fields() {
        let ball = primitives::icosphere(1.0, 5).unwrap();
        let fields = fields_of(&ball, false);
        let inner = fields.inner.iter().filter(|&&inner| inner).count();
        assert!(inner > ball.positions.len() * 3 / 5, "{inner} of {}", ball.positions.len());
        assert!(fields.rim.len() < ball.triangles.len() * 3 / 5, "{}", fields.rim.len());
        assert_eq!(fields.rim.len(), fields.is_rim.iter().filter(|&&rim| rim).count());
        let again = fields_of(&ball, true);
        assert!(again.inner == fields.inner && again.rim == fields.rim);
        // Too few to be worth it.
        let few = fields_of(&primitives::icosphere(1.0, 2).unwrap(), false);
        assert!(few.inner.iter().all(|&inner| !inner) && few.rim.len() == 320);
    }

    /// Balls whose vertices are moved at random, and pairs of balls: all crossings are found.
    #[test]
    fn no_crossing_is_hidden_in_a_height_field() {
        let mut random = ChaCha8Rng::seed_from_u64(1_630);
        let (mut inner, mut crossing) = (0, 0);
        for round in 0..6 {
            let mut mesh = primitives::icosphere(1.0, 3).unwrap();
            let wild = [0.01, 0.04, 0.08, 0.2][round % 4];
            for position in &mut mesh.positions {
                *position = position.map(|x| x + wild * random.random_range(-1.0..1.0));
            }
            if round >= 4 {
                // One layer over another.
                let shift = std::array::from_fn(|_| random.random_range(-0.05..0.05));
                mesh.append(&mesh.clone().translated(shift)).unwrap();
            }
            inner += fields_of(&mesh, false).inner.iter().filter(|&&inner| inner).count();
            let Ok(solid) = Solid::try_from(mesh) else { continue };
            let found = solid.self_crossings(&Control::new()).unwrap();
            assert_eq!((found.count, found.tolerated), count_by_all_pairs(&solid), "{round}");
            crossing += usize::from(found.count > 0);
        }
        assert!(inner > 250 && crossing > 2, "{inner} inner vertices, {crossing} that cross themselves");
    }

    #[test]
    fn sides_cancel() {
        assert_eq!(boundary(vec![[0, 1], [1, 2], [2, 0], [2, 1]]), Some(vec![[0, 1], [2, 0]]));
        assert_eq!(boundary(vec![[0, 1], [1, 0], [0, 1]]), Some(vec![[0, 1]]));
        assert_eq!(boundary(vec![[0, 1], [0, 1]]), None);
    }
}
