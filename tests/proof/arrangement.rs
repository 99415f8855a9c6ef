//! Any closed surfaces and any expressions, in one arrangement: operands that cross and touch themselves and each other.
//!
//! Boxes on coarse grids are judged cell by cell: volume, and area in every plane by the way it looks, so that no wall and no
//! double face goes unseen. Tetrahedra, octahedra and boxes with corners anywhere are judged at points by exact rays. Seeds
//! are the numbers of the rounds; `TRISECT_PROOF=10` tries ten times as many.

use std::collections::BTreeMap;

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use trisect::exact::{Sign, collinear, orient3d};
use trisect::mesh::SelfCrossings;
use trisect::{
    BooleanOptions, Control, Embed, Expression, Grid, Mesh, OperandState, Operation, Outcome, Rule, Solid,
    primitives,
};

/// Rounds of a test that usually runs `usual`.
fn rounds(usual: u64) -> u64 {
    match std::env::var("TRISECT_PROOF").as_deref() {
        Ok("all") => 10 * usual,
        Ok(times) => usual * times.parse::<u64>().expect("TRISECT_PROOF is a number or all").max(1),
        Err(_) => usual,
    }
}

/// A random expression of operands that may occur more than once.
fn random_expression(rng: &mut ChaCha8Rng, operands: usize, depth: u32) -> Expression {
    if depth == 0 || rng.random_range(0..4) == 0 {
        return Expression::Operand(rng.random_range(0..operands));
    }
    let count = rng.random_range(2..4);
    let sets: Vec<_> = (0..count).map(|_| random_expression(rng, operands, depth - 1)).collect();
    match rng.random_range(0..5) {
        0 => Expression::Union(sets),
        1 => Expression::Intersection(sets),
        2 => Expression::Difference(sets),
        3 => Expression::SymmetricDifference(sets),
        _ => Expression::AtLeast(rng.random_range(1..=count), sets),
    }
}

/// The union first, then random ones.
fn expressions(rng: &mut ChaCha8Rng, operands: usize, count: usize) -> Vec<Expression> {
    let mut all = vec![Expression::Union((0..operands).map(Expression::Operand).collect())];
    all.extend((1..count).map(|_| random_expression(rng, operands, 2)));
    all
}

fn random_rule(rng: &mut ChaCha8Rng) -> Rule {
    Rule::ALL[rng.random_range(0..3)]
}

/// Appends triangles with vertices of their own.
fn append(mesh: &mut Mesh, positions: Vec<[f64; 3]>, triangles: &[[u32; 3]]) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(positions);
    mesh.triangles.extend(triangles.iter().map(|corners| corners.map(|v| v + first)));
}

/// A box of the grid, and how often it counts.
struct GridBox {
    operand: usize,
    low: [i32; 3],
    high: [i32; 3],
    count: i32,
}

impl GridBox {
    fn random(rng: &mut ChaCha8Rng, operand: usize, size: i32, count: i32) -> Self {
        let (mut low, mut high) = ([0; 3], [0; 3]);
        for k in 0..3 {
            low[k] = rng.random_range(0..size);
            high[k] = rng.random_range(low[k] + 1..=size);
        }
        Self { operand, low, high, count }
    }

    fn contains(&self, cell: [i32; 3]) -> bool {
        (0..3).all(|k| self.low[k] <= cell[k] && cell[k] < self.high[k])
    }

    /// Its surface, each face with either diagonal.
    fn surface(&self, rng: &mut ChaCha8Rng) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
        let mesh = primitives::cuboid(self.low.map(f64::from), self.high.map(f64::from)).unwrap();
        let mut triangles = mesh.triangles;
        for pair in triangles.chunks_exact_mut(2) {
            if rng.random_range(0..2) == 0 {
                let (x, y) = (pair[0], pair[1]);
                let i = x.iter().position(|v| !y.contains(v)).unwrap();
                let q = *y.iter().find(|v| !x.contains(v)).unwrap();
                let (p, u, v) = (x[i], x[(i + 1) % 3], x[(i + 2) % 3]);
                (pair[0], pair[1]) = ([p, u, q], [p, q, v]);
            }
        }
        if self.count < 0 {
            triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
        (mesh.positions, triangles)
    }
}

/// Area by plane: the axis across it, its place in millionths, and whether it looks up.
type AreaByPlane = BTreeMap<(usize, i64, bool), f64>;

fn area_by_plane(mesh: &Mesh) -> AreaByPlane {
    let mut areas = AreaByPlane::new();
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
        let edge = |to: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| to[k] - a[k]) };
        let (u, v) = (edge(b), edge(c));
        let normal: [f64; 3] =
            std::array::from_fn(|k| u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
        let axis = (0..3).max_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs())).unwrap();
        if normal[axis] != 0.0 {
            let plane = (axis, (a[axis] * 1e6).round() as i64, normal[axis] > 0.0);
            *areas.entry(plane).or_insert(0.0) += 0.5 * normal[axis].abs();
        }
    }
    areas
}

/// Volume and area by plane of the cells that are in a set.
fn count_cells(size: i32, is_in: impl Fn([i32; 3]) -> bool) -> (f64, AreaByPlane) {
    let (mut volume, mut areas) = (0.0, AreaByPlane::new());
    for x in -1..=size {
        for y in -1..=size {
            for z in -1..=size {
                let here = is_in([x, y, z]);
                volume += f64::from(u8::from(here));
                for axis in 0..3 {
                    let mut beyond = [x, y, z];
                    beyond[axis] += 1;
                    if is_in(beyond) != here {
                        *areas.entry((axis, i64::from(beyond[axis]) * 1_000_000, here)).or_insert(0.0) += 1.0;
                    }
                }
            }
        }
    }
    (volume, areas)
}

#[test]
fn boxes_on_a_grid_are_right_in_every_plane() {
    let (mut tried, mut crossing) = (0, 0);
    for seed in 0..rounds(400) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let size = rng.random_range(2..5);
        let operands = rng.random_range(1..4);
        let count = rng.random_range(2..6).max(operands);
        // 1. Boxes in operands, some inverted, some welded.
        let mut boxes: Vec<GridBox> = Vec::new();
        let mut meshes = vec![Mesh::default(); operands];
        for i in 0..count {
            let operand = if i < operands { i } else { rng.random_range(0..operands) };
            let count = if i >= operands && rng.random_range(0..100) < 15 { -1 } else { 1 };
            boxes.push(GridBox::random(&mut rng, operand, size, count));
            let (positions, triangles) = boxes[i].surface(&mut rng);
            append(&mut meshes[operand], positions, &triangles);
        }
        let mut solid = |mesh: Mesh| {
            Solid::try_from(if rng.random_range(0..2) == 0 { mesh.welded(0.0).unwrap() } else { mesh })
        };
        let Ok(solids) = meshes.into_iter().map(&mut solid).collect::<Result<Vec<Solid>, _>>() else {
            continue;
        };
        // 2. Expressions of them, by any rules.
        let expressions = expressions(&mut rng, operands, 3);
        let rules: Vec<Rule> = (0..operands).map(|_| random_rule(&mut rng)).collect();
        let options = BooleanOptions::new().rules(rules.clone());
        let outcomes = options.evaluate_all(&expressions, &solids).unwrap();
        for (expression, outcome) in expressions.iter().zip(&outcomes) {
            let is_in = |cell: [i32; 3]| {
                let winding = |operand: usize| -> i32 {
                    let around = boxes.iter().filter(|b| b.operand == operand && b.contains(cell));
                    around.map(|b| b.count).sum()
                };
                expression.contains(&|operand| rules[operand].is_inside(winding(operand)))
            };
            let (volume, areas) = count_cells(size, is_in);
            let mesh = outcome.solid().mesh();
            let context = format!("seed {seed}: {expression:?} {rules:?}");
            assert!(outcome.certificate().closed && outcome.certificate().manifold, "{context}");
            assert_eq!(mesh.volume(), volume, "{context}");
            assert_eq!(area_by_plane(mesh), areas, "{context}");
            assert_eq!(outcome.certificate().walls_left, 0, "{context}");
            tried += 1;
            crossing += u64::from(outcome.certificate().three_face_points > 0);
        }
    }
    assert!(tried > 1_000 && crossing > 50, "{tried} results, {crossing} with three-face points");
}

/// How often a surface winds around a point, by the way to a point outside; `None` if that touches an edge.
fn winding(mesh: &Mesh, from: &[f64; 3], to: &[f64; 3]) -> Option<i32> {
    let mut sum = 0;
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|v| &mesh.positions[v as usize]);
        let (start, end) = (orient3d(a, b, c, from), orient3d(a, b, c, to));
        if start == Sign::Zero && end == Sign::Zero && collinear(a, b, c) {
            continue;
        }
        if start == Sign::Zero {
            return None;
        }
        if end == start || end == Sign::Zero {
            continue;
        }
        let sides = [orient3d(from, to, a, b), orient3d(from, to, b, c), orient3d(from, to, c, a)];
        if sides.contains(&Sign::Negative) && sides.contains(&Sign::Positive) {
            continue;
        }
        if sides.contains(&Sign::Zero) {
            return None;
        }
        sum += if start == Sign::Positive { 1 } else { -1 };
    }
    Some(sum)
}

/// A closed surface of any shape, with corners on a grid of so many cells, or anywhere for 0.
fn random_body(rng: &mut ChaCha8Rng, grid: f64) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let mut corner = || -> [f64; 3] {
        std::array::from_fn(|_| {
            let x: f64 = rng.random_range(0.0..1.0);
            if grid > 0.0 { (x * (grid + 1.0)).floor() / grid } else { x }
        })
    };
    let corners: Vec<[f64; 3]> = (0..6).map(|_| corner()).collect();
    match rng.random_range(0..3) {
        0 => (corners[..4].to_vec(), vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]),
        1 => {
            let round = (0..4).map(|i| [i, (i + 1) % 4]);
            (corners, round.flat_map(|[i, j]| [[i, j, 4], [j, i, 5]]).collect())
        }
        _ => {
            let unit = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
            let (low, high) = (corners[0], corners[1]);
            let place = |p: &[f64; 3]| std::array::from_fn(|k| low[k] + p[k] * (high[k] - low[k]));
            (unit.positions.iter().map(place).collect(), unit.triangles)
        }
    }
}

/// A body of several that may cross and touch, turned by an angle; `None` if it encloses nothing.
fn random_operand(rng: &mut ChaCha8Rng, grid: f64, turn: f64) -> Option<Solid> {
    let mut mesh = Mesh::default();
    for _ in 0..rng.random_range(1..4) {
        let (positions, triangles) = random_body(rng, grid);
        append(&mut mesh, positions, &triangles);
    }
    if turn != 0.0 {
        mesh = mesh.rotated([1.0, 2.0, 3.0], turn).unwrap();
    }
    if mesh.volume() < 0.0 {
        mesh = mesh.reversed();
    }
    Solid::try_from(mesh).ok().filter(|solid| !solid.is_empty())
}

#[test]
fn soups_that_cross_themselves_are_right_at_points() {
    let (mut points, mut tried) = (0, 0);
    for seed in 0..rounds(250) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let grid = [0.0, 2.0, 3.0, 8.0][rng.random_range(0..4)];
        let turn = [0.0, 0.0, 42.0][rng.random_range(0..3)];
        let wanted = rng.random_range(1..4);
        let solids: Vec<Solid> = (0..wanted).filter_map(|_| random_operand(&mut rng, grid, turn)).collect();
        if solids.is_empty() {
            continue;
        }
        let expressions = expressions(&mut rng, solids.len(), 4);
        let rules: Vec<Rule> = solids.iter().map(|_| random_rule(&mut rng)).collect();
        let options = BooleanOptions::new().rules(rules.clone());
        let outcomes = options.evaluate_all(&expressions, &solids).unwrap();
        let anywhere: Vec<[f64; 3]> =
            (0..40).map(|_| std::array::from_fn(|_| rng.random_range(-1.0..1.5))).collect();
        for (expression, outcome) in expressions.iter().zip(&outcomes) {
            tried += 1;
            let context = format!("seed {seed}: {expression:?} {rules:?} grid {grid} turned {turn}");
            assert!(outcome.certificate().closed && outcome.certificate().manifold, "{context}");
            for point in &anywhere {
                let outside = [5.0 + 0.1 * point[0], 0.4, 0.6];
                let around = |mesh: &Mesh| winding(mesh, point, &outside);
                let of_operands: Option<Vec<i32>> = solids.iter().map(|solid| around(solid.mesh())).collect();
                let (Some(windings), Some(found)) = (of_operands, around(outcome.solid().mesh())) else {
                    continue;
                };
                let is_in = expression.contains(&|operand| rules[operand].is_inside(windings[operand]));
                assert_eq!(found, i32::from(is_in), "{context} at {point:?}, {windings:?}");
                points += 1;
            }
        }
    }
    assert!(points > 20_000, "{points} points of {tried} results");
}

#[test]
fn several_results_share_their_seams() {
    for seed in 0..rounds(40) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let turn = [0.0, 42.0][rng.random_range(0..2)];
        let solids: Vec<Solid> = (0..2).filter_map(|_| random_operand(&mut rng, 0.0, turn)).collect();
        let [a, b] = solids.as_slice() else { continue };
        let parse = |text: &str| text.parse::<Expression>().unwrap();
        let parts = ["a & b", "a - b", "b - a", "a + b"].map(parse);
        let outcomes = BooleanOptions::new().evaluate_all(&parts, [a, b]).unwrap();
        let volumes: Vec<f64> = outcomes.iter().map(|outcome| outcome.solid().volume()).collect();
        let sum = volumes[0] + volumes[1] + volumes[2];
        assert!((sum - volumes[3]).abs() <= 1e-13, "seed {seed}: {volumes:?}");
        // Every vertex of the union is one of a part's, bit for bit.
        let bits = |p: &[f64; 3]| p.map(f64::to_bits);
        let mut of_parts = std::collections::BTreeSet::new();
        for outcome in &outcomes[1..3] {
            of_parts.extend(outcome.solid().mesh().positions.iter().map(bits));
        }
        let shared = outcomes[3].solid().mesh().positions.iter().filter(|p| of_parts.contains(&bits(p)));
        assert_eq!(shared.count(), outcomes[3].solid().mesh().positions.len(), "seed {seed}");
    }
}

#[test]
fn results_do_not_depend_on_the_order_of_operands_or_on_threads() {
    for seed in 0..rounds(60) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let solids: Vec<Solid> = (0..3).filter_map(|_| random_operand(&mut rng, 3.0, 0.0)).collect();
        let [a, b, c] = solids.as_slice() else { continue };
        let evaluate = |threads: usize, text: &str, operands: [&Solid; 3]| {
            let expression = text.parse::<Expression>().unwrap();
            BooleanOptions::new().threads(threads).evaluate(&expression, operands).unwrap()
        };
        let first = evaluate(1, "a - (b ^ c)", [a, b, c]);
        assert_eq!(first.solid(), evaluate(4, "a - (b ^ c)", [a, b, c]).solid(), "seed {seed}");
        let other = evaluate(1, "c - (b ^ a)", [c, b, a]);
        let (x, y) = (first.solid().volume(), other.solid().volume());
        assert!((x - y).abs() <= 1e-14, "seed {seed}: {x} {y}");
    }
}

#[test]
fn the_commonest_self_crossing_models_are_resolved() {
    // Two boxes that overlap in one file; a body less one of them, where what lies twice inside must not count twice.
    let cuboid = |low: [f64; 3], high: [f64; 3]| primitives::cuboid(low, high).unwrap();
    let mut twice = Mesh::default();
    for low in [0.0, 0.5] {
        let part = cuboid([low; 3], [low + 1.0; 3]);
        append(&mut twice, part.positions, &part.triangles);
    }
    let twice = Solid::try_from(twice).unwrap();
    let big = Solid::try_from(cuboid([-1.0; 3], [2.0; 3])).unwrap();
    assert_eq!(big.difference(&twice).unwrap().solid().volume(), 25.125);
    assert_eq!(big.intersection(&twice).unwrap().solid().volume(), 1.875);
    let resolved = BooleanOptions::new().resolve(&twice).unwrap();
    assert_eq!(resolved.solid().volume(), 1.875);
    assert_eq!(resolved.solid().components(), 1);
    assert!(resolved.solid().self_crossings(&Control::new()).unwrap().is_clean());
    let odd = BooleanOptions::new().rule(Rule::EvenOdd).resolve(&twice).unwrap();
    assert_eq!(odd.solid().volume(), 1.75);
}

#[test]
fn bodies_of_one_file_that_touch_are_one_body() {
    let mut pair = Mesh::default();
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    append(&mut pair, corners[..4].to_vec(), &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
    let below = vec![corners[0], corners[1], corners[2], corners[4]];
    append(&mut pair, below, &[[0, 1, 2], [1, 0, 3], [2, 1, 3], [0, 2, 3]]);
    let resolved = BooleanOptions::new().resolve(&Solid::try_from(pair).unwrap()).unwrap();
    assert_eq!(resolved.solid().volume(), 1.0 / 3.0);
    // The sides in the planes x = 0 and y = 0 are one triangle each.
    assert_eq!((resolved.solid().components(), resolved.solid().mesh().triangles.len()), (1, 4));
    // A square with one diagonal above and the other below encloses nothing.
    let square = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let mut pillow = primitives::cuboid([2.0; 3], [3.0; 3]).unwrap();
    append(&mut pillow, square, &[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]);
    let resolved = BooleanOptions::new().resolve(&Solid::try_from(pillow).unwrap()).unwrap();
    assert_eq!(resolved.solid().components(), 1);
    assert_eq!(resolved.solid().mesh().triangles.len(), 12);
}

#[test]
fn results_on_a_grid_are_free_of_crossings_or_say_how_many_are_left() {
    let (mut tried, mut resolved, mut left) = (0, 0, 0);
    for seed in 0..rounds(60) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let grid = [0.0, 3.0, 8.0][rng.random_range(0..3)];
        let turn = [0.0, 42.0][rng.random_range(0..2)];
        let solids: Vec<Solid> = (0..2).filter_map(|_| random_operand(&mut rng, grid, turn)).collect();
        let [a, b] = solids.as_slice() else { continue };
        let options = BooleanOptions::new().embed(Embed::OnGrid(Grid::Single));
        let outcome = options.evaluate(&"a + b".parse().unwrap(), [a, b]).unwrap();
        let embedding = outcome.certificate().embedding.expect("it was asked for");
        let mesh = outcome.solid().mesh();
        assert!(outcome.certificate().closed, "seed {seed}");
        assert!(mesh.positions.iter().flatten().all(|&x| f64::from(x as f32) == x), "seed {seed}");
        // Read again, by itself: nothing is known of it.
        let again = Solid::try_from(Mesh::new(mesh.positions.clone(), mesh.triangles.clone())).unwrap();
        let found = again.self_crossings(&Control::new()).unwrap();
        if embedding.left == 0 {
            assert!(found.is_simple() && found.tolerated == 0, "seed {seed}: {found:?}");
        }
        tried += 1;
        resolved += u32::from(embedding.rounds > 0 && embedding.left == 0);
        left += u32::from(embedding.left > 0);
        // It encloses what it did, up to what the grid moves.
        assert!(embedding.displacement <= 1e-3, "seed {seed}: {embedding:?}");
        let exact = BooleanOptions::new().evaluate(&"a + b".parse().unwrap(), [a, b]).unwrap();
        let change = (exact.solid().volume() - again.volume()).abs();
        assert!(change <= 20.0 * (embedding.displacement + 1e-7), "seed {seed}: {change:e} {embedding:?}");
    }
    println!("{tried} results, {resolved} resolved, {left} with crossings left");
    assert!(tried > 30 && left * 20 < tried, "{left} of {tried} with crossings left");
}

/// Two random operands that cross themselves, on a grid of 3 or 8 cells or anywhere, turned or not, and what is made of them.
fn random_pair(seed: u64) -> Option<([Solid; 2], Expression)> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let grid = [0.0, 3.0, 8.0][rng.random_range(0..3)];
    let turn = [0.0, 42.0][rng.random_range(0..2)];
    let mut operand = || random_operand(&mut rng, grid, turn);
    let (a, b) = (operand(), operand());
    let expression = ["a + b", "a - b", "a & b"][(seed % 3) as usize].parse().unwrap();
    Some(([a?, b?], expression))
}

/// What crosses in a result as it is read again, when nothing is known of it.
fn crossings_again(outcome: &Outcome) -> SelfCrossings {
    let mesh = outcome.solid().mesh();
    let again = Solid::try_from(Mesh::new(mesh.positions.clone(), mesh.triangles.clone())).unwrap();
    again.self_crossings(&Control::new()).unwrap().clone()
}

#[test]
fn edges_that_cross_by_a_rounding_come_apart() {
    // Results in which edges cross by a rounding: with a vertex where they do the first are resolved, and without, as cleaning up left them, they
    // were what they had been, and crossed again in every round. The next take one of the other manners, and the last are shaken.
    let seeds: [(Grid, f64, &[u64]); 3] = [
        (
            Grid::Double,
            1e-13,
            &[
                100_177, 100_783, 100_885, 101_088, 101_229, 101_361, 101_427, 101_538, 101_563, 101_616,
                101_783, 101_865, 102_037, 102_508, 102_660, 102_691, 102_854, 102_993, 103_639, 109_390,
                112_996, 113_760, 118_774, 118_780, 121_006, 122_916, 124_038, 127_918, 128_871, 132_099,
                138_582,
            ],
        ),
        (Grid::Double, 5e-13, &[224_678, 229_498, 280_638, 284_103]),
        (Grid::Single, 3e-5, &[117_464, 119_349, 121_980, 123_634]),
    ];
    for (grid, furthest, seeds) in seeds {
        for &seed in seeds {
            let (operands, expression) = random_pair(seed).expect("both are operands");
            let exact = BooleanOptions::new().evaluate(&expression, &operands).unwrap();
            let outcome =
                BooleanOptions::new().embed(Embed::OnGrid(grid)).evaluate(&expression, &operands).unwrap();
            let embedding = outcome.certificate().embedding.expect("it was asked for");
            assert!(embedding.rounds > 0 && embedding.left == 0, "seed {seed}: {embedding:?}");
            assert!(embedding.displacement < furthest, "seed {seed}: {embedding:?}");
            assert!(outcome.certificate().closed && outcome.certificate().manifold, "seed {seed}");
            let change = (outcome.solid().volume() - exact.solid().volume()).abs();
            assert!(change < 10.0 * furthest, "seed {seed}: {change:e}");
            let found = crossings_again(&outcome);
            assert!(found.is_simple() && found.tolerated == 0, "seed {seed}: {found:?}");
        }
    }
}

/// Whether a random pair, resolved on a grid, crosses itself nowhere when it is read again.
fn nothing_crosses_on(grid: Grid, seed: u64) {
    let (operands, expression) = random_pair(seed).expect("both are operands");
    let outcome = BooleanOptions::new().embed(Embed::OnGrid(grid)).evaluate(&expression, &operands).unwrap();
    let found = crossings_again(&outcome);
    assert!(found.is_simple() && found.tolerated == 0, "seed {seed}: {found:?}");
}

#[test]
fn what_rounding_has_laid_on_its_own_back_vanishes() {
    // On the grid of single precision two triangles have the same corners and look opposite ways.
    for seed in [113_185, 115_054, 116_386, 120_887] {
        nothing_crosses_on(Grid::Single, seed);
    }
}

#[test]
fn edges_that_touch_crosswise_are_no_crossings() {
    // Edges touch edges in points, exactly, and nothing is inside anything; where all vertices move a little, they cross whichever way.
    for seed in [111_075, 111_135, 115_866, 117_997, 120_939, 123_423, 123_634, 128_017] {
        nothing_crosses_on(Grid::Double, seed);
    }
}

#[test]
fn what_was_cut_and_is_whole_again_is_looked_at() {
    // The tip of a body reaches through an edge by less than rounding: cleaned up, its faces are what they were. They cross the other body in
    // the result, so that what was known of the one half of this contact did not fit the other.
    let (operands, expression) = random_pair(110_385).expect("both are operands");
    let outcome = BooleanOptions::new().embed(Embed::NearCut).evaluate(&expression, &operands).unwrap();
    let embedding = outcome.certificate().embedding.expect("it was asked for");
    assert!(embedding.rounds > 0 && embedding.left == 0, "{embedding:?}");
    let found = crossings_again(&outcome);
    assert!(found.is_simple() && found.tolerated == 0, "{found:?}");
}

#[test]
fn folds_that_touch_themselves_in_a_corner_are_no_crossings() {
    // Corners of a ball moved at random, by as much as its sides are long and less: the surface folds over itself, round corners too, where
    // what it winds around touches itself in a point.
    let (mut pinched, mut results) = (0, 0);
    for seed in 0..rounds(12) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut mesh = primitives::icosphere(1.0, 2).unwrap();
        let wild = [0.35, 0.5, 0.7][rng.random_range(0..3)];
        mesh.positions.iter_mut().flatten().for_each(|x| *x += wild * rng.random_range(-1.0..1.0));
        let Ok(solid) = Solid::try_from(mesh) else { continue };
        let exact = BooleanOptions::new().resolve(&solid).unwrap();
        let places: std::collections::BTreeSet<_> =
            exact.solid().mesh().positions.iter().map(|position| position.map(f64::to_bits)).collect();
        pinched += u32::from(places.len() < exact.solid().mesh().positions.len());
        results += 1;
        for (embed, rounding) in [
            (Embed::NearCut, 1e-15),
            (Embed::OnGrid(Grid::Double), 1e-15),
            (Embed::OnGrid(Grid::Single), 1e-6),
        ] {
            let outcome = BooleanOptions::new().embed(embed).resolve(&solid).unwrap();
            let certificate = outcome.certificate();
            let embedding = certificate.embedding.expect("it was asked for");
            assert_eq!(embedding.left, 0, "seed {seed}, {embed:?}");
            assert!(embedding.displacement <= rounding, "seed {seed}, {embed:?}: {embedding:?}");
            assert!(certificate.closed && certificate.manifold, "seed {seed}, {embed:?}");
            let change = (outcome.solid().volume() - exact.solid().volume()).abs();
            assert!(change <= 10.0 * rounding, "seed {seed}, {embed:?}: {change:e}");
            let mesh = outcome.solid().mesh();
            let again = Solid::try_from(Mesh::new(mesh.positions.clone(), mesh.triangles.clone())).unwrap();
            let found = again.self_crossings(&Control::new()).unwrap();
            assert!(found.is_simple() && found.tolerated == 0, "seed {seed}, {embed:?}: {found:?}");
        }
    }
    println!("{results} results, {pinched} that touch themselves");
    assert!(pinched * 2 > results, "{pinched} of {results} touch themselves");
}

#[test]
fn crossings_that_rounding_makes_are_resolved_where_something_was_cut() {
    // Boxes in a row, turned together: flush but for rounding. In the file of the first a ball of many triangles, far away.
    let ball = primitives::icosphere(3.0, 4).unwrap().translated([40.0, 0.0, 0.0]);
    let (mut crossing, mut left) = (0, 0);
    for seed in 0..rounds(60) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let axis = [0, 1, 2].map(|_| rng.random_range(-1.0..1.0));
        let angle = rng.random_range(1.0..90.0);
        let mut row = |first: f64| {
            let mut mesh = Mesh::default();
            for k in 0..3 {
                let low = [first + 2.0 * f64::from(k), 0.0, 0.0].map(|x: f64| x / 3.0);
                let size = [1.0, f64::from(rng.random_range(1..4)), f64::from(rng.random_range(1..4))];
                let high = [0, 1, 2].map(|k| low[k] + size[k] / 3.0);
                let part = primitives::cuboid(low, high).unwrap();
                append(&mut mesh, part.positions, &part.triangles);
            }
            mesh.rotated(axis, angle).unwrap()
        };
        let (mut a, b) = (row(0.0), row(1.0));
        append(&mut a, ball.positions.clone(), &ball.triangles);
        let operands = [a, b].map(|mesh| Solid::try_from(mesh).unwrap());
        for operation in [Operation::Union, Operation::Difference] {
            let run = |embed| BooleanOptions::new().embed(embed).run(operation, &operands).unwrap();
            let again = |outcome: &Outcome| {
                let mesh = outcome.solid().mesh();
                Solid::try_from(Mesh::new(mesh.positions.clone(), mesh.triangles.clone())).unwrap()
            };
            let rounded = run(Embed::Never);
            let found = again(&rounded);
            let crosses = found.self_crossings(&Control::new()).unwrap();
            crossing += u32::from(!crosses.is_simple() || crosses.tolerated > 0);
            let near = run(Embed::NearCut);
            let embedding = near.certificate().embedding.expect("it was looked for");
            let found = again(&near);
            let crosses = found.self_crossings(&Control::new()).unwrap();
            if embedding.left == 0 {
                assert!(crosses.is_simple() && crosses.tolerated == 0, "seed {seed}: {crosses:?}");
            }
            left += u32::from(embedding.left > 0);
            assert!(
                (found.volume() - rounded.solid().volume()).abs() < 1e-9,
                "seed {seed}: {} {} {}",
                found.volume(),
                rounded.solid().volume(),
                run(Embed::OnGrid(Grid::Double)).solid().volume()
            );
        }
    }
    println!("{crossing} results with crossings, {left} with crossings left");
    assert!(crossing > 10 && left * 2 < crossing, "{left} of {crossing}");
}

#[test]
fn a_solid_that_lies_on_itself_is_resolved_without_being_asked() {
    // Two boxes with half a face in common, in one mesh.
    let mut both = primitives::cuboid([0.0; 3], [1.0; 3]).unwrap();
    let other = primitives::cuboid([0.5, 0.0, 1.0], [1.5, 1.0, 2.0]).unwrap();
    append(&mut both, other.positions, &other.triangles);
    let both = Solid::try_from(both).unwrap();
    let found = both.self_crossings(&Control::new()).unwrap();
    assert!(found.is_clean() && !found.is_simple() && found.touching > 0);
    let far = Solid::try_from(primitives::cuboid([5.0; 3], [6.0; 3]).unwrap()).unwrap();
    let united = both.union(&far).unwrap();
    assert_eq!((united.solid().volume(), united.solid().components()), (3.0, 2));
    assert!(matches!(
        united.certificate().operands[0],
        OperandState::Resolved { touching: 1.., crossings: 0, .. }
    ));
}

#[test]
fn what_is_wound_around_inwards_is_told() {
    // A box, one that overlaps it, and far away one that is turned inside out: by the rule positive that is no material.
    let mut mesh = primitives::cuboid([0.0; 3], [2.0; 3]).unwrap();
    let other = primitives::cuboid([1.0; 3], [3.0; 3]).unwrap();
    append(&mut mesh, other.positions, &other.triangles);
    let inverted = primitives::cuboid([5.0; 3], [6.0; 3]).unwrap().reversed();
    append(&mut mesh, inverted.positions, &inverted.triangles);
    let solid = Solid::try_from(mesh).unwrap();
    for (rule, volume) in [(Rule::Positive, 15.0), (Rule::NonZero, 16.0), (Rule::EvenOdd, 15.0)] {
        let outcome = BooleanOptions::new().rule(rule).resolve(&solid).unwrap();
        assert_eq!(outcome.solid().volume(), volume, "{rule}");
        let state = outcome.certificate().operands[0];
        let OperandState::Resolved { winding_volume, inward_volume, .. } = state else { panic!("{state:?}") };
        assert_eq!((winding_volume, inward_volume), (15.0, 1.0));
    }
}

#[test]
fn what_lies_between_crossings_is_what_walking_over_all_of_it_makes() {
    // A second body that touches itself in a vertex: then no patches are made, and every face is walked over.
    let pinched = || {
        let tetrahedron = |s: f64| {
            Mesh::new(
                vec![[0.0; 3], [s, 0.0, 0.0], [0.0, s, 0.0], [0.0, 0.0, s]],
                if s > 0.0 {
                    vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
                } else {
                    vec![[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]
                },
            )
        };
        let mut both = tetrahedron(0.5);
        let other = tetrahedron(-0.5);
        both.triangles
            .extend(other.triangles.iter().map(|corners| corners.map(|v| if v == 0 { 0 } else { v + 3 })));
        both.positions.extend(&other.positions[1..]);
        both
    };
    for seed in 0..rounds(12) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        // A ball with spikes that cross each other and the ball.
        let mut mesh = primitives::geodesic_sphere(3.0, 8).unwrap();
        for _ in 0..rng.random_range(1..6) {
            let spike = primitives::cone(0.3, 2.5, 7).unwrap();
            let angle = rng.random_range(0.0..360.0);
            let axis = std::array::from_fn(|_| rng.random_range(-1.0..1.0f64));
            let at = std::array::from_fn(|_| rng.random_range(-2.0..2.0));
            mesh.append(&spike.rotated(axis, angle).unwrap().translated(at)).unwrap();
        }
        let mut with_pinched = mesh.clone();
        with_pinched.append(&pinched().translated([20.0, 0.0, 0.0])).unwrap();
        let [alone, beside] = [mesh, with_pinched].map(|mesh| {
            let solid = Solid::try_from(mesh).unwrap();
            BooleanOptions::new().resolve(&solid).unwrap()
        });
        let extra = Solid::try_from(pinched()).unwrap().volume();
        let (v, w) = (alone.solid().volume(), beside.solid().volume() - extra);
        assert!((v - w).abs() <= 1e-12 * v, "seed {seed}: {v} and {w}");
        let [x, y] = [&alone, &beside].map(|outcome| outcome.solid().mesh().triangles.len());
        assert_eq!(x + 8, y, "seed {seed}");
    }
}
