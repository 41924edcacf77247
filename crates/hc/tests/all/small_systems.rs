//! Small systems whose solutions are known by hand or from the tests of other codes, many of them
//! traps.

use crate::common::{multiplicities, options, real, solve_text, solved};
use hc::poly::{Complex64, parse};
use hc::start::MixedError;
use hc::{Solution, Solutions, SolveError, SolveOptions, Start, solve};

const STARTS: [Start; 3] = [Start::Auto, Start::Polyhedral, Start::TotalDegree];

/// From every start system and several seeds: multiplicities and number of real solutions.
fn check(text: &str, expected: &str, expected_real: usize) {
    for start in STARTS {
        for seed in 0..3 {
            let mut options = options(seed);
            options.start = start;
            let found = solved(text, &options);
            assert_eq!(
                (&multiplicities(&found)[..], real(&found)),
                (expected, expected_real),
                "{text} {start:?} {seed}"
            );
            assert_eq!(found.on_components, 0, "{text} {start:?} {seed}");
        }
    }
}

fn has(found: &Solutions, point: &[f64], tolerance: f64) -> bool {
    let near = |value: &[Complex64]| value.iter().zip(point).all(|(z, p)| (z - p).norm() < tolerance);
    found.solutions.iter().any(|s| near(&s.value))
}

#[test]
fn regular_solutions() {
    check("2\nx^2+y^2+1;\n2*x+3*y-1;", "2x1", 0);
    check("2\n(x^4+y^4-1)*(x^2+y^2-2)+x^5*y;\nx^2+2*x*y^2-2*y^2-1/2;", "18x1", 4);
    // Two more are at infinity.
    check("2\n2.3*x^2+1.2*y^2+3*x-2*y+3;\n2.3*x^2+1.2*y^2+5*x+2*y-5;", "2x1", 0);
    check("2\nx^2+4*y^2-4;\n2*y^2-x;", "4x1", 2);
    check("2\nx*y-2;\nx^2-4;", "2x1", 2);
    check("1\nx^3-2*x;", "3x1", 3);
    check("2\nx^2+y^2-1;\nx-y;", "2x1", 2);
    // The critical points of the distance from (-0.32, -0.1) on a curve of degree six.
    let slopes = [
        "(4*x^3*(x^2+y^2-2)+2*x*(x^4+y^4-1)+5*x^4*y)",
        "(4*y^3*(x^2+y^2-2)+2*y*(x^4+y^4-1)+x^5)",
        "(x^4+y^4-1)*(x^2+y^2-2)+x^5*y",
    ];
    let text = format!("3\nx+0.32-l*{};\ny+0.1-l*{};\n{};", slopes[0], slopes[1], slopes[2]);
    check(&text, "36x1", 8);
}

/// Where the number of regular solutions is known, paths to infinity are not taken to their ends.
#[test]
fn known_numbers_spare_the_endgame() {
    // x + y = 3 meets a conic of the pencil in two points; the conics share two points at infinity.
    let text = "2\nx^2+y^2+x-1;\nx^2+y^2-y+2;";
    for start in STARTS {
        for seed in 0..3 {
            let mut options = options(seed);
            options.start = start;
            let whole = solved(text, &options);
            assert_eq!((whole.solutions.len(), whole.paths.at_infinity, whole.paths.dropped), (2, 2, 0));
            options.known = Some(2);
            let known = solve_text(text, &options).unwrap();
            let near = |a: &[Complex64], b: &[Complex64]| a.iter().zip(b).all(|(a, b)| (a - b).norm() < 1e-12);
            let is_known = |s: &Solution| known.solutions.iter().any(|other| near(&s.value, &other.value));
            assert!(known.solutions.len() == 2 && whole.solutions.iter().all(is_known), "{start:?} {seed}");
            assert_eq!((known.paths.finite, known.paths.dropped, known.paths.failed), (2, 2, 0));
            // More than there are: every path is taken to its end.
            options.known = Some(3);
            assert_eq!(solved(text, &options).paths, whole.paths);
        }
    }
}

/// Roots at zero, which paths approach like any others once the origin belongs to the supports.
#[test]
fn zero_coordinates() {
    check("1\n-2*x;", "1x1", 1);
    check("1\ny*(y-5);", "2x1", 2);
    check("2\nx*(x-y);\nx+y-2;", "2x1", 2);
    check("2\ny*(x-y);\nx^2-1;", "4x1", 4);
    check("2\nx*(x-y);\ny*(x+y);", "1x4", 1);
    // Three with a zero coordinate; in the torus x = (2 + 3 y) / y^2 with y^3 - 6 y^2 - 16 y - 8 =
    // 0, discriminant 3136 > 0.
    check("2\n2*y+3*y^2-x*y^3;\nx+4*x^2-2*x^3*y;", "6x1", 6);
}

#[test]
fn only_the_torus_where_that_is_asked_for() {
    let mut options = options(0);
    options.torus_only = true;
    let found = solved("2\n2*y+3*y^2-x*y^3;\nx+4*x^2-2*x^3*y;", &options);
    assert_eq!((found.solutions.len(), found.paths.tracked), (3, 3));
    let text = "3\nx1^3*s^15+x1*x2*s+x2^3+s^12;\nx1^2*s^9+x1*x2^2+x2*s^3;\nx1^2*x2*s^5+x1*s^8+x2^2;";
    assert_eq!(solved(text, &options).mixed_volume, Some(54));
    assert_eq!(solved(text, &crate::common::options(0)).mixed_volume, Some(92));
    // A Laurent system: x + 1/x = 5/2 and x y = 1.
    let found = solved("2\nx+x^(-1)-5/2;\nx*y-1;", &options);
    assert!(has(&found, &[2.0, 0.5], 1e-12) && has(&found, &[0.5, 2.0], 1e-12));
}

#[test]
fn multiple_solutions() {
    check("1\n(x-10)^2;", "1x2", 1);
    check("1\n(x-10)^6;", "1x6", 1);
    check("1\n(x-3)^12;", "1x12", 1);
    // Griewank and Osborne: Newton's method diverges from everywhere near the root.
    check("2\n(29/16)*x^3-2*x*y;\nx^2-y;", "1x3", 1);
    check("2\nx^4+x^2;\nx^4+y;", "2x1 1x2", 1);
    // Two tangent conics in general position, and a hyperbolic curve with its polar.
    check("2\nx^2+2*y^2+2*i*y;\n(18+3*i)*x*y+7*i*y^2-(3-18*i)*x-14*y-7*i;", "1x1 1x3", 0);
    check("2\n0.75*x^4+1.5*x^2-2.5*x^2*z^2+0.75-2.5*z^2+0.75*z^4;\n10*x^2*z+10*z-6*z^3;", "2x6", 0);
}

/// `(x - 10)^6` is known to far more than the root of the rounding error.
#[test]
fn multiple_solutions_are_accurate() {
    for seed in 0..5 {
        let found = solved("1\n(x-10)^6;", &options(seed));
        assert!(has(&found, &[10.0], 1e-8), "{:?}", found.solutions);
        assert_eq!(found.solutions[0].winding_number, 6);
    }
}

#[test]
fn wilkinson() {
    let factors: Vec<String> = (1..=12).map(|k| format!("(x-{k})")).collect();
    for start in STARTS {
        for seed in 0..5 {
            let mut options = options(seed);
            options.start = start;
            let found = solved(&format!("1\n{};", factors.join("*")), &options);
            assert_eq!((&multiplicities(&found)[..], real(&found)), ("12x1", 12), "{start:?} {seed}");
            assert!((1..=12).all(|k| has(&found, &[f64::from(k)], 1e-8)));
        }
    }
}

/// The family of winding numbers: `d + 1` solutions, all other paths in one direction.
#[test]
fn directions_at_infinity_are_exact() {
    for d in [2i64, 4, 6] {
        let first = format!("(0.257*x^{d}-0.139*y)");
        let text = format!("2\n{first}*(-1.73*x-0.199*y)+1;\n{first}*(1.79*x-1.32*y)+1;");
        check(&text, &format!("{}x1", d + 1), 1);
        let mut options = options(0);
        options.start = Start::TotalDegree;
        let found = solved(&text, &options);
        let [direction] = &found.directions[..] else { panic!("{:?}", found.directions) };
        // y = x^d up to lower terms, and x^(d + 1) grows like 1 / t over the square of the small
        // factor.
        assert_eq!(direction.valuations[1], d * direction.valuations[0]);
        assert_eq!(direction.paths as i64, (d + 1) * (d + 1) - (d + 1));
        if d == 2 {
            assert_eq!((&direction.valuations[..], direction.denominator), (&[-1, -2][..], 6));
        }
    }
    let found = solved("2\n2.3*x^2+1.2*y^2+3*x-2*y+3;\n2.3*x^2+1.2*y^2+5*x+2*y-5;", &options(0));
    assert_eq!(found.directions.iter().map(|d| (&d.valuations[..], d.paths)).collect::<Vec<_>>(), [(&[-1, -1][..], 2)]);
}

#[test]
fn more_equations_than_unknowns() {
    let quadric = "(x^2+y^2+x*y-3)";
    let text = format!("3\n{quadric}*(x+3);\n{quadric}*(y-x+2);\n2*x+5*y-3;");
    let reordered = format!("3\n2*x+5*y-3;\n{quadric}*(y^2-x+2);\n{quadric}*(x+3);");
    for text in [text, reordered] {
        for seed in 0..3 {
            assert_eq!(multiplicities(&solved(&text, &options(seed))), "2x1");
        }
    }
    // The twisted cubic meets a plane in three points.
    for seed in 0..3 {
        let found = solved("4\nz-x*y;\ny-x^2;\nx*z-y^2;\n2*x+3*y-5*z+7;", &options(seed));
        assert_eq!((&multiplicities(&found)[..], real(&found)), ("3x1", 1));
    }
    assert!(has(&solved("2\nx^2-1;\nx^3-1;", &options(0)), &[1.0], 1e-12));
}

/// Isolated solutions beside components of positive dimension, which are said to be there.
#[test]
fn components_of_positive_dimension() {
    for seed in 0..3 {
        let found = solved("2\nx*(x-1);\nx*(y-2)*(y-3);", &options(seed));
        assert!(has(&found, &[1.0, 2.0], 1e-12) && has(&found, &[1.0, 3.0], 1e-12));
        assert_eq!((found.solutions.len(), found.on_components > 0), (2, true));
        for text in ["3\nx*y;\nx*z;\ny+z-1;", "2\n(x-1)^2*(y-2);\n(x-1)*(y-2)*(x+y);", "3\nz-x*y;\ny-x^2;\nx*z-y^2;"] {
            let found = solved(text, &options(seed));
            assert_eq!((found.solutions.len(), found.on_components > 0), (0, true), "{text}");
        }
    }
    // Rows of the Jacobian vanish on the double line; their rounding errors must not pass for rows.
    for seed in 0..400 {
        let found = solved("2\n(x-1)^2*(y-2);\n(x-1)*(y-2)*(x+y);", &options(seed));
        assert_eq!(found.solutions.len(), 0, "seed {seed}");
    }
    for seed in 0..3 {
        // A surface, a curve and eight points.
        let (p, q) = ("(x*y-x^2+1-z)", "(x^4+x^2-y-1)");
        let text = format!("3\n{p}*{q}*(x-3)*(x-5);\n{p}*{q}*(y-3)*(y-5);\n{p}*(z-3)*(z-5);");
        let found = solved(&text, &options(seed));
        assert_eq!((&multiplicities(&found)[..], found.on_components > 0), ("8x1", true));
        assert!([3.0, 5.0].iter().all(|&z| has(&found, &[3.0, 5.0, z], 1e-10)));
    }
}

/// Coefficients over thirty decades; with x = 1e-9 u the roots are those of u^2 - 3 u + 2 and v =
/// u.
#[test]
fn badly_scaled() {
    for seed in 0..3 {
        let found = solved("2\n1.0E18*x^2-3.0E9*x+2;\n1.0E-10*y-1.0E12*x;", &options(seed));
        assert_eq!((&multiplicities(&found)[..], real(&found)), ("2x1", 2));
        assert!(has(&found, &[1e-9, 1e13], 1.0) && has(&found, &[2e-9, 2e13], 1.0), "{:?}", found.solutions);
    }
}

#[test]
fn no_solution_at_all() {
    for text in ["2\nx+y-1;\nx+y-2;", "2\nx^2+y^2-1;\nx^2+y^2-2;", "2\nx*y-1;\nx*y-2;"] {
        for seed in 0..3 {
            let found = solved(text, &options(seed));
            assert_eq!((found.solutions.len(), found.paths.finite), (0, 0), "{text}");
        }
    }
}

#[test]
fn unusable_systems_are_refused() {
    let error = |text: &str| solve_text(text, &options(0)).unwrap_err();
    assert_eq!(error("2\nx - x;\ny - 1 + 0*x;"), SolveError::Zero(1));
    assert_eq!(error("2\nx + y - 1;\nx - x + 3;"), SolveError::Constant(2));
    assert_eq!(
        error("1\nx + y - 1;"),
        SolveError::Underdetermined { equations: 1, unknowns: vec!["x".to_owned(), "y".to_owned()] }
    );
    assert_eq!(error("1\n5;"), SolveError::Constant(1));
    assert_eq!(error("1\n1.0E999*x - 1;"), SolveError::Coefficient(1));
    let long = "3\nx^2000000000*y-1;\ny^2000000000-x;\nz^2000000000-x;";
    assert_eq!(error(long), SolveError::Mixed(MixedError::TooLarge));
    let many = error("2\nx^2000000000*y-1;\ny^2000000000-x;");
    assert!(matches!(many, SolveError::TooManyPaths { paths, .. } if paths > 1 << 61), "{many:?}");
    assert!(matches!(error("2\nx^40000-1;\ny^40000*x-1;"), SolveError::TooManyPaths { limit, .. } if limit == 1 << 24));
    let mut options = options(0);
    options.start = Start::TotalDegree;
    assert_eq!(solve_text("1\nx - x^(-1);", &options).unwrap_err(), SolveError::NegativeExponents);
    let nothing = hc::System::from_polynomials::<hc::poly::Exact>(&[], &[]).unwrap();
    assert_eq!(
        hc::solve(&nothing, &options).unwrap_err(),
        SolveError::Underdetermined { equations: 0, unknowns: vec![] }
    );
}

#[test]
fn threads_do_not_change_the_result() {
    // Regular, singular and diverging paths.
    let text = "3\nx^2+y*z-x-1;\n(y^2+x*z-2*y+3)*(x-z);\n(z-1)^2*(x*y-5);";
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solve_text(text, &options(5)).unwrap())
    };
    assert_eq!(on(1), on(3));
}

/// The eigenvalues of a matrix: as many paths as there are, where Bezout's number is 2^n.
#[test]
fn groups_of_unknowns() {
    // Rows of the matrix (2 1 0; 1 3 1; 0 1 4) times (x, y, z) minus l (x, y, z), and a random
    // normalisation.
    let text = "4\n2*x + y - l*x;\nx + 3*y + z - l*y;\ny + 4*z - l*z;\n3*x - 2*y + 5*z - 1;";
    let mut options = options(0);
    options.start = Start::Multihomogeneous;
    assert_eq!(solve_text(text, &options).unwrap_err(), SolveError::Groups(4));
    let polynomials = hc::poly::parse::phcpack(text).unwrap();
    let index = |name: &str| polynomials.variables().iter().position(|v| v == name).unwrap();
    options.groups = vec![["x", "y", "z"].map(index).to_vec(), vec![index("l")]];
    for seed in 0..5 {
        options.seed = seed;
        let found = solve_text(text, &options).unwrap();
        assert_eq!(
            (found.start, found.multihomogeneous_number, found.bezout_number),
            (Some(Start::Multihomogeneous), Some(3), Some(8))
        );
        assert_eq!((found.paths.tracked, found.paths.finite, found.paths.failed), (3, 3, 0));
        // The characteristic polynomial is l^3 - 9 l^2 + 24 l - 18 = (l - 3)(l^2 - 6 l + 6).
        let mut values: Vec<f64> = found.solutions.iter().map(|s| s.value[index("l")].re).collect();
        values.sort_by(f64::total_cmp);
        let expected = [3.0 - 3f64.sqrt(), 3.0, 3.0 + 3f64.sqrt()];
        assert!(values.iter().zip(expected).all(|(v, e)| (v - e).abs() < 1e-12), "{values:?}");
    }
    options.groups.push(vec![0]);
    assert_eq!(solve_text(text, &options).unwrap_err(), SolveError::Groups(4));
    // auto takes the groups: the polyhedral one has no fewer paths, and two stages. Without groups
    // the polyhedral one has far fewer than the total degree.
    options.groups.pop();
    options.start = Start::Auto;
    let found = solve_text(text, &options).unwrap();
    assert_eq!(
        (found.start, found.paths.tracked, found.mixed_volume, found.multihomogeneous_number),
        (Some(Start::Multihomogeneous), 3, Some(3), Some(3))
    );
    options.groups.clear();
    let found = solve_text(text, &options).unwrap();
    assert_eq!((found.start, found.paths.tracked, found.bezout_number), (Some(Start::Polyhedral), 3, Some(8)));
}

/// Settings out of range are named, whichever they are.
#[test]
fn settings_out_of_range() {
    type Set = fn(&mut SolveOptions);
    let wrong: [(&str, Set); 7] = [
        ("contraction", |o| o.paths.tracker.contraction = f64::NAN),
        ("beta_tau", |o| o.paths.tracker.beta_tau = -0.1),
        ("max_steps", |o| o.paths.tracker.max_steps = 0),
        ("min_t", |o| o.paths.tracker.min_t = f64::NAN),
        ("coincidence", |o| o.paths.coincidence = 0.0),
        ("endgame.shrink", |o| o.endgame.shrink = 1.0),
        ("endgame.turns", |o| o.endgame.turns = 0),
    ];
    let system = parse::phcpack("2\nx*y-2;\nx^2-4;").unwrap();
    for (name, set) in wrong {
        let mut options = SolveOptions::default();
        set(&mut options);
        let error = solve(&system, &options).unwrap_err();
        assert!(matches!(&error, SolveError::Option(e) if e.name == name), "{name}: {error}");
        assert!(error.to_string().starts_with(&format!("option {name} must be")), "{error}");
    }
}
