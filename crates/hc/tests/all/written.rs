//! Formulas that multiply many sums: these have unknowns of their own. What even so cannot be expanded is
//! tracked as it is written.

use crate::common::{multiplicities, options, real, solved};
use hc::poly::{ExpandError, Expr, Expressions, System};
use hc::{SolveError, Start, solve};
use std::collections::BTreeMap;

/// `y^2 + y` is one of 20 roots of unity, so that there are 40 solutions, all simple since none of these is
/// -1/4; those of 1 are real, and those of -1 are not.
#[test]
fn powers_of_sums_keep_all_solutions() {
    for seed in 0..5 {
        let found = solved("2\n(x+y)^20-1;\nx-y^2;", &options(seed));
        assert_eq!((&multiplicities(&found)[..], real(&found)), ("40x1", 2), "{seed}");
        for solution in &found {
            let [x, y] = solution.value[..] else { panic!("two unknowns") };
            assert!((x - y * y).norm() < 1e-12 && ((x + y).powi(20) - 1.0).norm() < 1e-11, "{seed}: {x} {y}");
        }
    }
}

/// Too large to be expanded, or with coefficients that doubles cannot hold together; in the second one,
/// `w^200 = 1` and `x y = 2` with `w = x + y + x^2`, so that `x^3 + x^2 + 2 = w x`: one real root for `w = -1`
/// and one for 1, and none is double, since `4 w^3 + w^2 - 36 w` is never 116. In the third one, `(2 x + 1)^100 = 1`.
#[test]
fn powers_that_are_never_expanded() {
    for (text, solutions, real_solutions) in [
        ("2\n(x+y)^50-1;\nx-y^2;", 100, 2),
        ("3\n(x+y+z)^200-1;\nx*y-2;\nz-x^2;", 600, 2),
        ("2\n(x+y+1)^100-1;\nx-y;", 100, 2),
    ] {
        for seed in 0..5 {
            let found = solved(text, &options(seed));
            let expected = (format!("{solutions}x1"), real_solutions, 0);
            assert_eq!((multiplicities(&found), real(&found), found.paths.failed), expected, "{text} {seed}");
            assert!(found.iter().all(|s| s.value.len() == found.variables.len()), "{text} {seed}");
        }
    }
}

/// More equations than unknowns, zero coordinates that are not asked for, negative exponents, a line of
/// solutions.
#[test]
fn with_everything_that_a_solve_has() {
    // w = x + y with w^20 = 1 and w^3 = w: 1 and -1, and y^2 + y = w has two solutions each, real for 1.
    let found = solved("3 2\n(x+y)^20-1;\nx-y^2;\n(x+y)^3-x-y;", &options(0));
    assert_eq!((multiplicities(&found), real(&found), found.paths.failed), ("4x1".to_owned(), 2, 0));
    // The line x = 0, and x = y^2 with 20 roots of unity y^2 + y, all of them in the torus: y is neither 0
    // nor -1 there.
    for torus_only in [false, true] {
        let found = solved("2\n(x+y)^20*x-x;\nx*(x-y^2);", &options(0).torus_only(torus_only));
        assert_eq!((multiplicities(&found), real(&found), found.paths.failed), ("40x1".to_owned(), 2, 0));
    }
    // Sums that vanish in the torus: x = -y there, so that x^2 = 1.
    let found = solved("2\n(x+y)^16*x;\nx^2*y^2-1;", &options(0).torus_only(true));
    assert_eq!((multiplicities(&found), found.paths.failed), ("4x16".to_owned(), 0));
    // y^2 + 1/y = w for the 20 roots of unity w: cubics y^3 - w y + 1 without double roots, since 4 w^3 is
    // not 27. Those of 1 and -1 have one real root each.
    let found = solved("2\n(x+y^(-1))^20-1;\nx-y^2;", &options(0));
    assert_eq!((multiplicities(&found), real(&found), found.paths.failed), ("60x1".to_owned(), 2, 0));
    // Certified as they were given.
    let found = solved("2\n(x+y)^20-1;\nx-y^2;", &options(0).certify(true));
    assert!(found.iter().all(|s| s.certified == Some(true)));
}

/// `((x^2 + 1)^4 - x^5)^4 = x^16` in `x` alone, of degree 32; its greatest common divisor with its
/// derivative is 1, and it has no real roots (SymPy, exact).
#[test]
fn nested_powers_from_every_start_system() {
    for start in [Start::Auto, Start::Polyhedral, Start::TotalDegree] {
        let mut options = options(1);
        options.start = start;
        let found = solved("2\n((x+y)^4-x)^4-1;\nx*y-1;", &options);
        assert_eq!((&multiplicities(&found)[..], real(&found)), ("32x1", 0), "{start:?}");
        assert!(found.iter().all(|s| (s.value[0] * s.value[1] - 1.0).norm() < 1e-12), "{start:?}");
    }
}

/// `(1, -1)` and `(-1, 1)`, where one equation vanishes to order 16 and the other to order 1.
#[test]
fn powers_that_vanish_have_their_multiplicities() {
    let found = solved("2\n(x+y)^16;\nx^2-1;", &options(0));
    let mut multiplicities: Vec<usize> = found.iter().map(|s| s.multiplicity).collect();
    multiplicities.sort_unstable();
    assert_eq!((multiplicities, found.paths.failed), (vec![16, 16], 0));
}

/// The systems of examples/written, whose numbers of solutions are known from eliminations.
#[test]
fn systems_with_known_numbers_of_solutions() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/written");
    let table = std::fs::read_to_string(folder.join("expected.csv")).expect("the table");
    let mut systems = 0;
    for line in table.lines().skip(1) {
        let mut fields = line.split(',');
        let (name, expected) = fields.next().zip(fields.next()).expect("a name and a structure");
        let text = std::fs::read_to_string(folder.join(format!("{name}.txt"))).expect("a system");
        let system: System = text.parse().expect("a system");
        for seed in 0..2 {
            let found = solve(&system, &options(seed)).unwrap();
            assert_eq!((&multiplicities(&found)[..], found.paths.failed), (expected, 0), "{name} {seed}");
            assert!(found.iter().all(|s| s.residual < 1e-11), "{name} {seed}");
        }
        systems += 1;
    }
    assert_eq!(systems, 25);
}

/// The determinant by Laplace's expansion along the rows, each minor once; `minors` are those of the last rows
/// by their columns.
fn determinant<'a>(
    arena: &'a Expressions,
    rows: &[Vec<Expr<'a>>],
    columns: &[usize],
    minors: &mut BTreeMap<Vec<usize>, Expr<'a>>,
) -> Expr<'a> {
    let Some((row, below)) = rows.split_first() else { return arena.constant(1) };
    if let Some(&known) = minors.get(columns) {
        return known;
    }
    let mut sum = arena.constant(0);
    for (k, &column) in columns.iter().enumerate() {
        let others: Vec<usize> = columns.iter().copied().filter(|&other| other != column).collect();
        let term = row[column] * determinant(arena, below, &others, minors);
        sum = if k % 2 == 0 { sum + term } else { sum - term };
    }
    minors.insert(columns.to_vec(), sum);
    sum
}

/// `det(L D U)` with unit triangular matrices `L` and `U` and `D` = diag(`x_k - k^2`), and `x_k = k x_0 + 1` for
/// `k` above 0, so that the determinant is the product of `x_0` and of these `k x_0 + 1 - k^2`.
fn large_determinant(n: usize) -> System {
    System::build(|s| {
        let x: Vec<Expr<'_>> = (0..n).map(|k| s.variable(&format!("x{k}"))).collect();
        let entry = |i: usize, j: usize| {
            let (i, j) = (i as i64, j as i64);
            if i == j { 1 } else { (3 * i + 5 * j + i * j) % 7 - 3 }
        };
        let row = |i: usize| {
            let term = |j: usize| {
                let terms = (0..=i.min(j)).map(|k| (x[k] - (k * k) as i64) * entry(i, k) * entry(k, j));
                s.sum(terms)
            };
            (0..n).map(term).collect::<Vec<_>>()
        };
        let rows: Vec<Vec<Expr<'_>>> = (0..n).map(row).collect();
        let columns: Vec<usize> = (0..n).collect();
        let lines = (1..n).map(|k| x[k] - x[0] * k as i64 - 1);
        std::iter::once(determinant(s, &rows, &columns, &mut BTreeMap::new())).chain(lines).collect()
    })
    .expect("names and constants are sound")
}

/// `x_0` is 0 or `(k^2 - 1) / k` for `k` = 1 .. 9, of which that for 1 is 0 too: eight simple solutions and a
/// double one.
#[test]
fn what_cannot_be_expanded_is_tracked_as_written() {
    let system = large_determinant(10);
    assert!(matches!(system.expand(&Default::default()), Err(ExpandError::TooLarge { equation: 1, .. })));
    for seed in 0..2 {
        let found = solve(&system, &options(seed)).unwrap();
        // The double solution cannot be judged without the terms, and its paths count as lost.
        assert_eq!((multiplicities(&found), found.paths.failed), ("8x1".to_owned(), 2), "{seed}");
        for k in 2..10 {
            let root = f64::from(k * k - 1) / f64::from(k);
            assert!(found.iter().any(|s| (s.value[0] - root).norm() < 1e-10), "{seed}: {root}");
        }
    }
    // No other start system serves.
    let polyhedral = solve(&system, &options(0).start(Start::Polyhedral));
    assert!(matches!(polyhedral, Err(SolveError::Expand(_))));
}
