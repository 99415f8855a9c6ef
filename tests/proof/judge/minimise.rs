//! Shrinks a failing pair of meshes to a few triangles: shells go, edges collapse, coordinates lose digits, as long as the
//! pair still fails.

use std::collections::{BTreeSet, HashMap};

use trisect::Mesh;

use super::surface::{Properties, Sets};
use super::vector::extent;

/// A pair of operands.
pub(crate) type Pair = [Mesh; 2];

/// The smallest pair found that still fails. `fails` is asked of closed 2-manifolds of positive volume only; what else an
/// operand must be is its own affair. Each accepted step makes the pair smaller or its coordinates shorter, so it ends.
///
/// # Panics
/// If the pair does not fail as given.
pub(crate) fn minimised(pair: &Pair, mut fails: impl FnMut(&Pair) -> bool) -> Pair {
    assert!(fails(pair), "the pair does not fail");
    let mut best = pair.clone();
    let mut accept = |best: &mut Pair, which: usize, mesh: Mesh| {
        let mut candidate = best.clone();
        candidate[which] = mesh;
        let accepted = is_operand(&candidate[which]) && fails(&candidate);
        if accepted {
            *best = candidate;
        }
        accepted
    };
    loop {
        let before = best.clone();
        for which in 0..2 {
            for simpler in replacements(&best[which]) {
                if simpler.triangles.len() < best[which].triangles.len() {
                    accept(&mut best, which, simpler);
                }
            }
            while shells(&best[which]).into_iter().any(|rest| accept(&mut best, which, rest)) {}
            collapse_all(&mut best, which, &mut accept);
        }
        shorten(&mut best, &mut accept);
        if best == before {
            return best;
        }
    }
}

fn is_operand(mesh: &Mesh) -> bool {
    let found = Properties::of(mesh);
    found.manifold && found.zero_area == 0 && found.volume > 0.0
}

/// The box round a mesh, and a tetrahedron of its corners.
fn replacements(mesh: &Mesh) -> Vec<Mesh> {
    let [low, high] = extent(&mesh.positions);
    let corner = [low, [high[0], low[1], low[2]], [low[0], high[1], low[2]], [low[0], low[1], high[2]]];
    [trisect::primitives::tetrahedron(corner), trisect::primitives::cuboid(low, high)]
        .into_iter()
        .flatten()
        .collect()
}

/// The mesh without each of its shells in turn, if it has several.
fn shells(mesh: &Mesh) -> Vec<Mesh> {
    let mut sets = Sets::new(mesh.positions.len());
    for &[a, b, c] in &mesh.triangles {
        sets.join(a as usize, b as usize);
        sets.join(b as usize, c as usize);
    }
    let roots: BTreeSet<usize> = mesh.triangles.iter().map(|t| sets.find(t[0] as usize)).collect();
    if roots.len() < 2 {
        return Vec::new();
    }
    let mut without = |root: usize| {
        let rest = mesh.triangles.iter().filter(|t| sets.find(t[0] as usize) != root).copied().collect();
        compacted(Mesh::new(mesh.positions.clone(), rest))
    };
    roots.iter().map(|&root| without(root)).collect()
}

/// Collapses edges while that leaves a failing pair: many at once while that works, then fewer.
fn collapse_all(best: &mut Pair, which: usize, accept: &mut impl FnMut(&mut Pair, usize, Mesh) -> bool) {
    let mut chunk = best[which].triangles.len();
    loop {
        // Collapsing changes the numbers of vertices, so edges are named by their places.
        let accepted = edges(&best[which]).chunks(chunk).any(|some| {
            let mesh = some.iter().fold(best[which].clone(), |mesh, &[keep, lose]| {
                collapsed(&mesh, keep, lose).unwrap_or(mesh)
            });
            mesh.triangles.len() < best[which].triangles.len() && accept(best, which, compacted(mesh))
        });
        if !accepted && chunk == 1 {
            return;
        }
        if !accepted {
            chunk /= 4;
            chunk = chunk.max(1);
        }
    }
}

type Place = [f64; 3];

/// Both directions of every edge, as places.
fn edges(mesh: &Mesh) -> Vec<[Place; 2]> {
    let mut all = Vec::new();
    for &[a, b, c] in &mesh.triangles {
        for (u, v) in [(a, b), (b, c), (c, a)] {
            all.push([mesh.positions[u as usize], mesh.positions[v as usize]]);
        }
    }
    all
}

/// The mesh with the vertex at `lose` moved onto that at `keep`, if they share an edge and exactly two neighbours.
fn collapsed(mesh: &Mesh, keep: Place, lose: Place) -> Option<Mesh> {
    let find = |place: Place| mesh.positions.iter().position(|&p| p == place).map(|at| at as u32);
    let (keep, lose) = (find(keep)?, find(lose)?);
    let neighbours = |v: u32| -> BTreeSet<u32> {
        mesh.triangles.iter().filter(|t| t.contains(&v)).flatten().copied().filter(|&u| u != v).collect()
    };
    let (of_keep, of_lose) = (neighbours(keep), neighbours(lose));
    if keep == lose || !of_keep.contains(&lose) || of_keep.intersection(&of_lose).count() != 2 {
        return None;
    }
    let triangles: Vec<[u32; 3]> = mesh
        .triangles
        .iter()
        .map(|t| t.map(|v| if v == lose { keep } else { v }))
        .filter(|&[a, b, c]| a != b && b != c && c != a)
        .collect();
    (triangles.len() >= 4).then(|| Mesh::new(mesh.positions.clone(), triangles))
}

/// Without vertices that no triangle uses.
fn compacted(mesh: Mesh) -> Mesh {
    let mut number: HashMap<u32, u32> = HashMap::new();
    let mut positions = Vec::new();
    let triangles = mesh.triangles.iter().map(|t| {
        t.map(|v| {
            *number.entry(v).or_insert_with(|| {
                positions.push(mesh.positions[v as usize]);
                positions.len() as u32 - 1
            })
        })
    });
    let triangles = triangles.collect();
    Mesh::new(positions, triangles)
}

/// Rounds coordinates to as few binary digits as the failure allows: all together, then one by one.
fn shorten(best: &mut Pair, accept: &mut impl FnMut(&mut Pair, usize, Mesh) -> bool) {
    let rounded = |x: f64, digits: i32| (x * 2f64.powi(digits)).round() / 2f64.powi(digits);
    for which in 0..2 {
        let all = |digits: i32| {
            let round = |p: &Place| p.map(|x| rounded(x, digits));
            Mesh::new(best[which].positions.iter().map(round).collect(), best[which].triangles.clone())
        };
        let tries: Vec<Mesh> = (0..24).map(all).filter(|mesh| *mesh != best[which]).collect();
        for mesh in tries {
            if accept(best, which, mesh) {
                break;
            }
        }
        for vertex in 0..best[which].positions.len() {
            for axis in 0..3 {
                let value = best[which].positions[vertex][axis];
                let shorter = (0..12).map(|digits| rounded(value, digits)).filter(|&x| x != value);
                for x in shorter.collect::<Vec<_>>() {
                    let mut mesh = best[which].clone();
                    mesh.positions[vertex][axis] = x;
                    if length_of(x) < length_of(value) && accept(best, which, mesh) {
                        break;
                    }
                }
            }
        }
    }
}

/// How many digits a number is written with.
fn length_of(x: f64) -> usize {
    format!("{x}").len()
}
