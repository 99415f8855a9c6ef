//! R-functions and expressions: signs, identities, derivatives, smoothness; formulas and their errors.

use rand::{RngExt, SeedableRng};
use trisect::field::{Expression, Formula, Graph, System};

const SYSTEMS: [System; 8] = [
    System::R1,
    System::R0,
    System::Alpha(0.5),
    System::Alpha(-0.5),
    System::Alpha(1.0),
    System::R0m(1),
    System::R0m(2),
    System::R0m(3),
];

fn random_pairs(seed: u64, count: usize) -> Vec<(f64, f64)> {
    let mut random = rand::rngs::ChaCha8Rng::seed_from_u64(seed);
    (0..count).map(|_| (random.random::<f64>() * 4.0 - 2.0, random.random::<f64>() * 4.0 - 2.0)).collect()
}

#[test]
fn sign_tables_are_those_of_logic() {
    for system in SYSTEMS {
        for (x, y) in random_pairs(1, 20_000) {
            assert_eq!(system.and(x, y) > 0.0, x > 0.0 && y > 0.0, "{system} {x} and {y}");
            assert_eq!(system.or(x, y) > 0.0, x > 0.0 || y > 0.0, "{system} {x} or {y}");
        }
        // On the axes: zero where the logic is undecided.
        for value in [0.3, 1.0, 7.5] {
            assert!(system.and(0.0, value).abs() < 1e-13 && system.or(0.0, -value).abs() < 1e-13, "{system}");
            assert!(system.and(0.0, -value) < 0.0 && system.or(0.0, value) > 0.0, "{system}");
        }
        assert_eq!((system.and(0.0, 0.0), system.or(0.0, 0.0)), (0.0, 0.0));
    }
}

#[test]
fn identities_hold() {
    for system in SYSTEMS {
        for (x, y) in random_pairs(2, 5000) {
            let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * (1.0 + a.abs());
            assert!(near(system.and(x, y), system.and(y, x)) && near(system.or(x, y), system.or(y, x)));
            assert!(near(-system.and(x, y), system.or(-x, -y)), "De Morgan, {system}");
            assert!(near(-system.or(x, y), system.and(-x, -y)), "De Morgan, {system}");
            // Closure: compositions have the sign of the composed logic.
            let nested = system.or(system.and(x, y), system.and(-x, y + 0.5));
            let logic = (x > 0.0 && y > 0.0) || (-x > 0.0 && y + 0.5 > 0.0);
            assert!(nested.abs() < 1e-12 || (nested > 0.0) == logic);
        }
    }
    for (x, y) in random_pairs(3, 100) {
        assert_eq!(System::R1.and(x, y), x.min(y));
        assert!((System::Alpha(1.0).or(x, y) - x.max(y)).abs() < 1e-14);
    }
}

/// `a op b` as a field of x and y.
fn field(system: System, and: bool) -> Expression {
    let mut graph = Graph::new();
    let [x, y, _] = graph.axes();
    let root = if and { graph.and(system, x, y) } else { graph.or(system, x, y) };
    Expression::new(graph, root)
}

#[test]
fn gradients_are_those_of_differences() {
    let texts = [
        "x * y + z^3 - 2^x",
        "sin(x) * cos(y * z) + exp(x / 3)",
        "sqrt(x^2 + y^2 + z^2 + 1) / (1 + x^2)",
        "(x and y) or not (z - 0.3)",
        "abs(x - 0.1) + min(y, z) * max(x, y) + length(x, y, z)",
        "blend(x, y, 2, 0.5, 0.7) + repeat(x, 0.9) + ln(x^2 + 1.1) + (x^2 + 0.5)^1.5 + tan(z / 4)",
        "normalise(x^2 + y^2 - z)",
    ];
    let mut random = rand::rngs::ChaCha8Rng::seed_from_u64(4);
    for text in texts {
        for system in SYSTEMS {
            let field = Formula::parse(text).and_then(|f| f.compile(system, &[], &[])).expect("a formula");
            for _ in 0..200 {
                let p: [f64; 3] = [0; 3].map(|_| random.random::<f64>() * 2.0 - 1.0);
                let (value, gradient) = field.gradient(p);
                assert_eq!(value.to_bits(), field.at(p).to_bits(), "{text}");
                let h = 1e-6;
                let differences: [f64; 3] = std::array::from_fn(|k| {
                    let shifted = |by: f64| {
                        let mut q = p;
                        q[k] += by;
                        field.at(q)
                    };
                    (shifted(h) - shifted(-h)) / (2.0 * h)
                });
                // Differences across a kink are not derivatives.
                let branch_changes = (0..3).any(|k| {
                    let mut q = p;
                    q[k] += 2.0 * h;
                    let after = field.gradient(q).1;
                    (0..3).any(|j| (after[j] - gradient[j]).abs() > 0.1)
                });
                let error = (0..3).map(|k| (gradient[k] - differences[k]).abs()).fold(0.0, f64::max);
                assert!(
                    branch_changes || error < 1e-5,
                    "{text} {system} at {p:?}: {gradient:?} {differences:?}"
                );
            }
        }
    }
}

#[test]
fn intervals_contain_the_values() {
    let mut random = rand::rngs::ChaCha8Rng::seed_from_u64(5);
    let texts =
        ["(1 - x^2) and (1 - y^2) or not circle(x - 1, y, 0.5)", "sin(x * y) / (2 + cos(z)) - x^3 * abs(z)"];
    for text in texts {
        for system in SYSTEMS {
            let field = Formula::parse(text).and_then(|f| f.compile(system, &[], &[])).expect("a formula");
            for _ in 0..300 {
                let low: [f64; 3] = [0; 3].map(|_| random.random::<f64>() * 4.0 - 2.0);
                let size: [f64; 3] = [0; 3].map(|_| random.random::<f64>());
                let bounds = field.bounds(low, std::array::from_fn(|k| low[k] + size[k]));
                for _ in 0..20 {
                    let p: [f64; 3] = std::array::from_fn(|k| low[k] + size[k] * random.random::<f64>());
                    let value = field.at(p);
                    assert!(bounds.contains(value), "{text} {system} at {p:?}: {value} {bounds:?}");
                    assert_eq!(field.sign_form().at(p) > 0.0, value > 0.0, "{text} {system} at {p:?}");
                }
            }
        }
    }
}

/// The largest order of differences that stay bounded at the origin as the step shrinks.
fn order_of_continuity(system: System) -> u32 {
    let field = field(system, true);
    let mut order = 0;
    for derivative in 1..8u32 {
        // The derivative along a line through the origin must agree from both sides as the step goes to zero.
        let jump = |h: f64| {
            let sample = |k: i32| field.at([f64::from(k) * h * 0.8, f64::from(k) * h * 0.6, 0.0]);
            let binomial = |n: u32, k: u32| (1..=k).fold(1.0, |c, i| c * f64::from(n + 1 - i) / f64::from(i));
            let difference = |sign: i32| {
                let terms = (0..=derivative).map(|k| {
                    let parity = if (derivative - k) % 2 == 0 { 1.0 } else { -1.0 };
                    parity * binomial(derivative, k) * sample(sign * k as i32)
                });
                f64::from(sign).powi(derivative as i32) * terms.sum::<f64>() / h.powi(derivative as i32)
            };
            (difference(1) - difference(-1)).abs()
        };
        // A continuous derivative's jump falls with the step; a discontinuous one's does not.
        if jump(1e-3) > 0.5 * jump(1e-2) + 1e-9 {
            break;
        }
        order = derivative;
    }
    order
}

#[test]
fn r0m_is_as_smooth_as_it_says() {
    assert_eq!(order_of_continuity(System::R0), 0);
    for m in 1..5 {
        assert_eq!(order_of_continuity(System::R0m(m)), m, "R0^{m}");
    }
}

#[test]
fn normalised_functions_have_unit_gradients_on_their_zero_set() {
    let field = Formula::parse("normalise(4 - x^2 - 4*y^2)").and_then(|f| f.compile(System::R0, &[], &[]));
    let field = field.expect("a formula");
    for k in 0..100 {
        let (sine, cosine) = (f64::from(k) * 0.0628).sin_cos();
        let (value, g) = field.gradient([2.0 * cosine, sine, 0.0]);
        assert!(value.abs() < 1e-14 && ((g[0].hypot(g[1])) - 1.0).abs() < 1e-12, "{value} {g:?}");
    }
}

#[test]
fn shared_subexpressions_are_evaluated_once() {
    let mut text = "a0 = x * y + z;".to_owned();
    for k in 1..60 {
        text += &format!("a{k} = a{} * a{} + a{};", k - 1, k - 1, k - 1);
    }
    text += "a59";
    let field = Formula::parse(&text).and_then(|f| f.compile(System::R0, &[], &[])).expect("a formula");
    assert!(field.len() < 200, "{}", field.len());
}

#[test]
fn errors_name_the_place() {
    let cases = [
        ("1 - foo(x)", 1, 5, "unknown function `foo`"),
        ("1 - sinn(x)", 1, 5, "did you mean `sin`?"),
        ("x +\n  y *", 2, 6, "the formula ends"),
        ("x + $", 1, 5, "unexpected character `$`"),
        ("(x + 1", 1, 7, "to close the parenthesis"),
        ("circle(x, y)", 1, 1, "takes 3 arguments, but is given 2 arguments"),
        ("x y", 1, 3, "found `y`"),
        ("f(a) = g(a); g(a) = f(a); f(x)", 1, 21, "defined by itself"),
        ("b = b + 1; b", 1, 5, "defined by itself"),
        ("sin = 3; x", 1, 1, "built in"),
        ("a = 1; a = 2; a", 1, 8, "defined twice"),
        ("system R7; x", 1, 1, "unknown system"),
        ("system Ralpha(-1); x", 1, 1, "out of range"),
        ("repeat(x, y)", 1, 1, "must be a constant"),
        ("1e999", 1, 1, "too large"),
        ("", 1, 1, "expected an expression"),
        ("x and", 1, 6, "the formula ends"),
        ("q + 1", 1, 1, "unknown name `q`"),
    ];
    for (text, line, column, what) in cases {
        let error = match Formula::parse(text) {
            Err(error) => error,
            Ok(formula) => formula.compile(System::R0, &[], &[]).expect_err(text),
        };
        assert_eq!((error.line, error.column), (line, column), "{text}: {error}");
        assert!(error.what.contains(what), "{text}: {error}");
    }
}

#[test]
fn hostile_formulas_end_in_errors() {
    let deep = "(".repeat(100_000) + "x";
    assert!(Formula::parse(&deep).is_err());
    assert!(Formula::parse(&"not ".repeat(100_000)).is_err());
    assert!(Formula::parse(&"-".repeat(100_000)).is_err());
    let long = vec!["x"; 100_000].join(" + ");
    let field =
        Formula::parse(&long).and_then(|f| f.compile(System::R0, &[], &[])).expect("long sums are fine");
    assert_eq!(field.at([1.0, 0.0, 0.0]), 100_000.0);
    let mut bomb = "f0(a) = a + 1;".to_owned();
    for k in 1..60 {
        bomb += &format!("f{k}(a) = f{}(a) + f{}(a + 1);", k - 1, k - 1);
    }
    let error =
        Formula::parse(&(bomb + "f59(x)")).and_then(|f| f.compile(System::R0, &[], &[])).expect_err("bomb");
    assert!(error.what.contains("unfolds to more than"), "{error}");
}

#[test]
fn precedence_is_the_usual_one() {
    let at = |text: &str| {
        Formula::parse(text)
            .and_then(|f| f.compile(System::R1, &[("k".into(), 5.0)], &[]))
            .expect(text)
            .at([2.0, 3.0, 4.0])
    };
    assert_eq!(at("-x^2"), -4.0);
    assert_eq!(at("2^3^2"), 512.0);
    assert_eq!(at("2^-1"), 0.5);
    assert_eq!(at("x - y - z"), -5.0);
    assert_eq!(at("z / x / x"), 1.0);
    assert_eq!(at("not x + y"), -5.0);
    assert_eq!(at("x or y and z"), 3.0);
    assert_eq!(at("k * pi / pi # a comment"), 5.0);
    assert_eq!(at("g(a, b) = a - b; c = 10; g(c, x)"), 8.0);
}
