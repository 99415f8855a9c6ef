//! What of a surface bounds the space it encloses: fins, strays and walls stored once do not.
//!
//! The triangles of a part cut space into cells. Around every edge two triangles that follow each other have a cell between
//! them, so the sides of triangles fall into sets, one for each cell, by exact comparison of angles and without a look at
//! anything but the edges. One cell goes to infinity: the one whose boundary has a negative volume. A triangle bounds the
//! body if it has the outside before it and the body behind it. One with the same cell on both sides encloses nothing, and
//! one with the body on both sides is a wall inside.

use std::cmp::Ordering;

use rustc_hash::FxHashMap;

use super::super::edges::{Edge, EdgeTable};
use super::super::manifold::Axis;
use super::super::orient::reversed;
use super::super::{Bounds, UnionFind, measure};
use super::Surface;
use crate::exact::{Sign, collinear, orient3d};

/// So many triangles that bound something there must be for each one that hangs on nothing. Where such are more, they may be
/// a body whose triangles all lie apart, and leaving it out would be a guess.
const KEPT_PER_STRAY: usize = 4;

/// What a triangle is to the space the surface encloses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    Bounds,
    Wall,
    /// Hangs on the surface and encloses nothing.
    Flap,
    Stray,
    /// Of a part that is not closed, or of which it cannot be told.
    Open,
}

/// Leaves out what bounds nothing. Parts that remain open are left out too, if `closed_parts`; otherwise the surface stays
/// as it is where there are any. Returns whether the rest is closed.
pub(super) fn drop_unbounding(surface: &mut Surface<'_>, closed_parts: bool) -> bool {
    let table = EdgeTable::new(&surface.triangles, surface.mesh.positions.len());
    let parts = Parts::new(surface, &table);
    let mut roles = parts.roles(surface);
    open_where_not_flat(surface, &table, &parts, closed_parts, &mut roles);
    let count = |role: Role| roles.iter().filter(|&&found| found == role).count();
    if count(Role::Stray) * KEPT_PER_STRAY > count(Role::Bounds) {
        roles.iter_mut().filter(|role| **role == Role::Stray).for_each(|role| *role = Role::Open);
    }
    let open: Vec<bool> = roles.iter().map(|&role| role == Role::Open).collect();
    let any_open = open.contains(&true);
    if any_open && !closed_parts {
        return false;
    }
    let groups = any_open.then(|| pieces(&table, &open));
    let is = |role: Role| roles.iter().map(|&found| found == role).collect::<Vec<bool>>();
    let kinds = [is(Role::Wall), is(Role::Flap), is(Role::Stray)];
    if let Some(groups) = groups {
        surface.set_aside(&open, groups.len());
    }
    surface.drop_of_each_kind(&[
        (&kinds[0], |report| &mut report.walls),
        (&kinds[1], |report| &mut report.fins),
        (&kinds[2], |report| &mut report.strays),
        (&open, |report| &mut report.open_parts),
    ]);
    !surface.triangles.is_empty()
}

/// The parts of a surface that hang together by edges.
struct Parts {
    /// The triangles of each part that is not closed.
    open: Vec<Vec<u32>>,
    /// For each side (of triangle t before it 2 t, behind it 2 t + 1) the lowest side of the same cell. Known for open parts.
    cell: Vec<u32>,
    /// For each of the open parts whether the cells are known.
    known: Vec<bool>,
}

impl Parts {
    fn new(surface: &Surface<'_>, table: &EdgeTable<'_>) -> Self {
        let count = surface.triangles.len();
        // 1. Parts, and which of them are open.
        let mut parts = UnionFind::new(count);
        let mut open_edges = Vec::new();
        for edge in table.iter() {
            let mut all = edge.triangles();
            let Some(first) = all.next() else { continue };
            all.for_each(|next| parts.join(first, next));
            if edge.net() != 0 {
                open_edges.push(first);
            }
        }
        let (part_count, part_of) = parts.labels();
        let mut is_open = vec![false; part_count];
        open_edges.iter().for_each(|&triangle| is_open[part_of[triangle as usize] as usize] = true);
        // 2. Sides that have the same cell before them.
        let mut sides = UnionFind::new(2 * count);
        let mut is_known = vec![true; part_count];
        for edge in table.iter() {
            let part = edge.triangles().next().map_or(0, |first| part_of[first as usize] as usize);
            if is_open[part] && is_known[part] {
                is_known[part] = join_sides(surface, edge, &mut sides);
            }
        }
        // 3. The open ones with their triangles.
        let mut members = vec![Vec::new(); part_count];
        for (&part, triangle) in part_of.iter().zip(0..) {
            if is_open[part as usize] {
                members[part as usize].push(triangle);
            }
        }
        let cell = (0..2 * count as u32).map(|side| sides.root(side)).collect();
        let (mut open, mut known) = (Vec::new(), Vec::new());
        for (members, is_known) in members.into_iter().zip(is_known) {
            if !members.is_empty() {
                open.push(members);
                known.push(is_known);
            }
        }
        Self { open, cell, known }
    }

    fn roles(&self, surface: &Surface<'_>) -> Vec<Role> {
        let mut roles = vec![Role::Bounds; surface.triangles.len()];
        for (members, &known) in self.open.iter().zip(&self.known) {
            let found = if known { self.roles_in(surface, members) } else { None };
            let otherwise = if members.len() == 1 { Role::Stray } else { Role::Open };
            let found = found.unwrap_or_else(|| vec![otherwise; members.len()]);
            for (&triangle, role) in members.iter().zip(found) {
                roles[triangle as usize] = role;
            }
        }
        roles
    }

    /// The roles of the triangles of a part whose cells are known; `None` if it encloses nothing, or nothing that can be told.
    fn roles_in(&self, surface: &Surface<'_>, members: &[u32]) -> Option<Vec<Role>> {
        let mut numbers: FxHashMap<u32, u32> = FxHashMap::default();
        let mut number = |side: u32| {
            let next = numbers.len() as u32;
            *numbers.entry(self.cell[side as usize]).or_insert(next)
        };
        let cells: Vec<[u32; 2]> =
            members.iter().map(|&triangle| [number(2 * triangle), number(2 * triangle + 1)]).collect();
        let count = numbers.len();
        let outer = outer_cell(surface, members, &cells, count)?;
        let roles = roles_of(&cells, count, outer)?;
        roles.contains(&Role::Bounds).then_some(roles)
    }
}

/// Joins the sides of triangles around an edge that have a cell between them. False if it cannot be told which those are,
/// because triangles lie on each other there or have no area.
fn join_sides(surface: &Surface<'_>, edge: Edge<'_>, sides: &mut UnionFind) -> bool {
    let place = |vertex: u32| surface.mesh.positions[vertex as usize];
    let axis = Axis { from: place(edge.low), to: place(edge.high) };
    let apex = |triangle: u32| {
        let corners = surface.triangles[triangle as usize];
        place(
            corners.into_iter().find(|&corner| corner != edge.low && corner != edge.high).unwrap_or(edge.low),
        )
    };
    let mut spokes: Vec<(u32, [f64; 3])> =
        edge.triangles().map(|triangle| (triangle, apex(triangle))).collect();
    if spokes.len() > 2 {
        if spokes.iter().any(|(_, apex)| collinear(&axis.from, &axis.to, apex)) {
            return false;
        }
        let reference = spokes[0].1;
        spokes.sort_by(|x, y| axis.compare(&reference, &x.1, &y.1).then(x.0.cmp(&y.0)));
        let equal =
            |pair: &[(u32, [f64; 3])]| axis.compare(&reference, &pair[0].1, &pair[1].1) == Ordering::Equal;
        if spokes.windows(2).any(equal) {
            return false;
        }
    }
    // Counter-clockwise, seen against the edge, a triangle that runs upwards has what is behind it first, then what is before.
    for (k, &(triangle, _)) in spokes.iter().enumerate() {
        let next = spokes[(k + 1) % spokes.len()].0;
        let after = 2 * triangle + u32::from(!edge.is_upward(triangle));
        let before = 2 * next + u32::from(edge.is_upward(next));
        sides.join(after, before);
    }
    true
}

/// The cell that goes to infinity: the only one whose boundary, seen from inside it, has a negative volume. `None` if the
/// volumes do not tell, as those of a surface that crosses itself.
fn outer_cell(surface: &Surface<'_>, members: &[u32], cells: &[[u32; 2]], count: usize) -> Option<u32> {
    let mut boundaries = vec![Vec::new(); count];
    for (&triangle, &[front, back]) in members.iter().zip(cells) {
        if front != back {
            let corners = surface.triangles[triangle as usize];
            boundaries[front as usize].push(reversed(corners));
            boundaries[back as usize].push(corners);
        }
    }
    let mut outer = None;
    for (boundary, cell) in boundaries.iter().zip(0..) {
        let corners = boundary.iter().flatten().map(|&corner| &surface.mesh.positions[corner as usize]);
        let bounds = Bounds::of(corners)?;
        match measure::signed_volume(&surface.mesh.positions, boundary, &bounds).sign {
            Ordering::Greater => {}
            Ordering::Less if outer.is_none() => outer = Some(cell),
            _ => return None,
        }
    }
    outer
}

/// The roles of triangles by the cells before and behind them. `None` if the outer cell is before some and behind others.
///
/// What lies behind a triangle between two cells is filled; then every such triangle has either an empty cell before it and a
/// filled one behind it, or filled cells on both sides. Where the outer cell is filled, the part is the wall of a cavity, and
/// a wall may as well have the empty cavity on both sides: what lies before a triangle is empty. Of these two the one that
/// leaves out less.
fn roles_of(cells: &[[u32; 2]], count: usize, outer: u32) -> Option<Vec<Role>> {
    let between = || cells.iter().filter(|[front, back]| front != back);
    let (before, behind) = (between().any(|cell| cell[0] == outer), between().any(|cell| cell[1] == outer));
    if before && behind {
        return None;
    }
    let mut filled = vec![false; count];
    between().for_each(|cell| filled[cell[1] as usize] = true);
    let roles = |filled: &[bool]| -> Vec<Role> {
        let role = |&[front, back]: &[u32; 2]| match (
            front == back,
            filled[front as usize] == filled[back as usize],
        ) {
            (true, _) => Role::Flap,
            (false, true) => Role::Wall,
            (false, false) => Role::Bounds,
        };
        cells.iter().map(role).collect()
    };
    let found = roles(&filled);
    if before {
        return Some(found);
    }
    let mut not_empty = vec![true; count];
    between().for_each(|cell| not_empty[cell[0] as usize] = false);
    let other = roles(&not_empty);
    let kept = |roles: &[Role]| roles.iter().filter(|&&role| role == Role::Bounds).count();
    Some(if kept(&other) > kept(&found) { other } else { found })
}

/// Pieces of flaps must be flat to count as fins; the others open their part (or, with `closed_parts`, themselves alone).
fn open_where_not_flat(
    surface: &Surface<'_>,
    table: &EdgeTable<'_>,
    parts: &Parts,
    closed_parts: bool,
    roles: &mut [Role],
) {
    let flaps: Vec<bool> = roles.iter().map(|&role| role == Role::Flap).collect();
    if !flaps.contains(&true) {
        return;
    }
    let mut not_flat = vec![false; roles.len()];
    for piece in pieces(table, &flaps) {
        if !is_flat(surface, &piece) {
            piece.iter().for_each(|&triangle| not_flat[triangle as usize] = true);
        }
    }
    for members in &parts.open {
        let any = members.iter().any(|&triangle| not_flat[triangle as usize]);
        for &triangle in members {
            if not_flat[triangle as usize] || (any && !closed_parts) {
                roles[triangle as usize] = Role::Open;
            }
        }
    }
}

/// The triangles chosen, in pieces that hang together by edges.
fn pieces(table: &EdgeTable<'_>, chosen: &[bool]) -> Vec<Vec<u32>> {
    let mut sets = UnionFind::new(chosen.len());
    for edge in table.iter() {
        let mut all = edge.triangles().filter(|&triangle| chosen[triangle as usize]);
        if let Some(first) = all.next() {
            all.for_each(|next| sets.join(first, next));
        }
    }
    let (count, labels) = sets.labels();
    let mut pieces = vec![Vec::new(); count];
    for (triangle, &piece) in (0..).zip(&labels).filter(|&(triangle, _): &(u32, _)| chosen[triangle as usize])
    {
        pieces[piece as usize].push(triangle);
    }
    pieces.retain(|piece| !piece.is_empty());
    pieces
}

/// Whether all corners lie exactly in one plane.
fn is_flat(surface: &Surface<'_>, piece: &[u32]) -> bool {
    let corners = |&triangle: &u32| {
        surface.triangles[triangle as usize].map(|corner| surface.mesh.positions[corner as usize])
    };
    let spread = piece.iter().map(corners).find(|[a, b, c]| !collinear(a, b, c));
    let Some([a, b, c]) = spread else { return true };
    piece.iter().flat_map(corners).all(|corner| orient3d(&a, &b, &c, &corner) == Sign::Zero)
}

#[cfg(test)]
mod tests {
    use super::super::super::Mesh;
    use super::*;
    use crate::primitives;

    /// The triangles that are left, and how many walls, fins, strays and triangles of open parts are not.
    fn bounding(mesh: &Mesh, closed_parts: bool) -> Option<(usize, [usize; 4])> {
        let source = (0..mesh.triangles.len() as u32).collect();
        let mut surface = Surface::new(mesh, mesh.triangles.clone(), source);
        let done = drop_unbounding(&mut surface, closed_parts);
        let report = &surface.report;
        let counts =
            [&report.walls, &report.fins, &report.strays, &report.open_parts].map(|fault| fault.count);
        done.then_some((surface.triangles.len(), counts))
    }

    fn cube() -> Mesh {
        primitives::cuboid([0.0; 3], [1.0; 3]).unwrap()
    }

    /// A row of cells of a grid with all their walls, each stored once.
    fn cells_in_a_row(count: u32) -> Mesh {
        let positions =
            (0..=count).flat_map(|x| [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[y, z]| [x, y, z].map(f64::from)));
        let mut mesh = Mesh::new(positions.collect(), Vec::new());
        let mut quad = |[a, b, c, d]: [u32; 4]| mesh.triangles.extend([[a, b, c], [a, c, d]]);
        for x in 0..count {
            for k in 0..4 {
                let [a, b] = [4 * x + k, 4 * x + (k + 1) % 4];
                quad([a, b, b + 4, a + 4]);
            }
        }
        quad([3, 2, 1, 0]);
        for x in 1..=count {
            quad([0, 1, 2, 3].map(|k| 4 * x + k));
        }
        let volume = mesh.volume();
        if volume < 0.0 { mesh.reversed() } else { mesh }
    }

    #[test]
    fn walls_stored_once_are_no_boundary() {
        for count in 2..5 {
            let mesh = cells_in_a_row(count);
            let walls = 2 * (count as usize - 1);
            assert_eq!(
                bounding(&mesh, false),
                Some((mesh.triangles.len() - walls, [walls, 0, 0, 0])),
                "{count}"
            );
            // As the wall of a cavity.
            let reversed = mesh.clone().reversed();
            assert_eq!(
                bounding(&reversed, false),
                Some((mesh.triangles.len() - walls, [walls, 0, 0, 0])),
                "{count}"
            );
        }
    }

    #[test]
    fn flat_fins_are_left_out_and_others_refused() {
        let mut mesh = cube();
        let [a, b, _] = mesh.triangles[3];
        mesh.positions.extend([[-1.0, -1.0, -1.0], [-2.0, -1.5, -1.0]]);
        mesh.triangles.push([a, b, 8]);
        assert_eq!(bounding(&mesh, false), Some((12, [0, 1, 0, 0])));
        mesh.triangles.push([8, b, 9]);
        let flat = is_flat(&Surface::new(&mesh, mesh.triangles.clone(), (0..14).collect()), &[12, 13]);
        assert!(!flat);
        assert_eq!(bounding(&mesh, false), None);
        assert_eq!(bounding(&mesh, true), Some((12, [0, 0, 0, 2])));
    }

    #[test]
    fn single_triangles_are_strays_where_they_are_few() {
        let mut mesh = cube();
        for k in 0..4u32 {
            let first = mesh.positions.len() as u32;
            mesh.positions.extend([
                [5.0, 0.0, f64::from(k)],
                [6.0, 0.0, f64::from(k)],
                [5.0, 1.0, f64::from(k)],
            ]);
            mesh.triangles.push([first, first + 1, first + 2]);
            let strays = k as usize + 1;
            let expected = (strays <= 3).then_some((12, [0, 0, strays, 0]));
            assert_eq!(bounding(&mesh, false), expected);
        }
        assert_eq!(bounding(&mesh, true), Some((12, [0, 0, 0, 4])));
    }

    #[test]
    fn a_body_with_a_hole_is_open() {
        let mut mesh = cube();
        mesh.triangles.pop();
        assert_eq!(bounding(&mesh, false), None);
        assert_eq!(bounding(&mesh, true), None);
        let both = Mesh::merged([&mesh, &cube().translated([3.0, 0.0, 0.0])]).unwrap();
        assert_eq!(bounding(&both, false), None);
        assert_eq!(bounding(&both, true), Some((12, [0, 0, 0, 11])));
    }

    #[test]
    fn a_turned_triangle_is_not_guessed_at() {
        let mut mesh = cube();
        mesh.triangles[5].swap(0, 1);
        assert_eq!(bounding(&mesh, false), None);
    }
}
