use super::{Certificates, CertifyError, CertifyOptions, Obstacle, Reality, certify};
use num_complex::Complex64;
use num_rational::BigRational;
use poly::{ComplexInterval, System, parse::phcpack};
use proptest::prelude::*;

fn z(re: f64, im: f64) -> Complex64 {
    Complex64::new(re, im)
}

fn run(text: &str, points: &[Vec<Complex64>]) -> Certificates {
    certify(&phcpack(text).unwrap(), &[], points, &CertifyOptions::default()).unwrap()
}

fn exact(x: f64) -> BigRational {
    BigRational::from_float(x).unwrap()
}

/// Whether the rectangle contains the complex number with these rational parts.
fn holds(set: &ComplexInterval, re: &BigRational, im: &BigRational) -> bool {
    exact(set.re.low) <= *re && *re <= exact(set.re.high) && exact(set.im.low) <= *im && *im <= exact(set.im.high)
}

#[test]
fn reality_is_decided_by_proof() {
    for (text, near, expected) in [
        ("1\nx - 1;", z(1.0, 0.0), Reality::Real),
        ("1\nx - 1 + 1E-16*i;", z(1.0, 0.0), Reality::NotReal),
        ("1\nx - 1 + 1E-25*i;", z(1.0, 0.0), Reality::NotReal),
        // Two solutions 2e-12 apart: real ones, and conjugate ones.
        ("1\nx^2 - 2*x + 1 - 1E-24;", z(1.0 + 1e-12, 0.0), Reality::Real),
        ("1\nx^2 - 2*x + 1 + 1E-24;", z(1.0, 1e-12), Reality::NotReal),
        // A complex system may have real solutions, but not for a reason that the test can see.
        ("1\n(x - 1)*(x - i);", z(1.0, 0.0), Reality::Undecided),
        ("1\n(x - 1)*(x - i);", z(0.0, 1.0), Reality::NotReal),
    ] {
        let found = run(text, &[vec![near]]);
        assert_eq!(found.points[0].as_ref().map(|p| p.reality), Ok(expected), "{text}");
    }
}

#[test]
fn signs_of_real_solutions_are_proved_by_their_boxes() {
    // Row A17 of the list of test systems: two real solutions, one of them positive.
    let root = 0.5f64.sqrt();
    let found = run("2\nx^2 + y^2 - 1;\nx - y;", &[vec![z(root, 0.0); 2], vec![z(-root, 0.0); 2]]);
    assert_eq!((found.n_certified(), found.n_distinct(), found.n_real()), (2, 2, 2));
    let positive = |k: usize| found.points[k].as_ref().is_ok_and(|p| p.enclosure.iter().all(|x| x.re.low > 0.0));
    assert_eq!((positive(0), positive(1)), (true, false));
}

#[test]
fn the_solutions_of_the_written_decimals_are_enclosed() {
    let tenth = BigRational::new(1.into(), 10.into());
    for text in ["1\nx - 0.1;", "1\n10*x - 1;", "1\nx^3 - 0.001;", "1\n1/x - 10;", "1\n(x - 1/10)*(x + 7.3);"] {
        let found = run(text, &[vec![z(0.1, 1e-9)]]);
        let [x] = found.points[0].as_ref().unwrap().enclosure[..] else { panic!("one unknown") };
        assert!(holds(&x, &tenth, &BigRational::from_integer(0.into())), "{text}: {x:?}");
        // The nearest double is not the solution, and the box is hardly wider than the gap between
        // doubles.
        assert!(x.re.low < x.re.high && x.re.high - x.re.low <= 1e-16, "{text}: {x:?}");
    }
}

#[test]
fn points_of_one_solution_are_duplicates() {
    let near = |x: f64, y: f64| vec![z(x, 0.0), z(y, 0.0)];
    let points = [near(3.0, 4.0), near(-3.0, -4.0), near(3.000001, 4.000001), near(3.0, 4.0), near(-3.00001, -4.0)];
    let found = run("2\nx^2 + y^2 - 25;\n4*x - 3*y;", &points);
    assert_eq!((found.n_certified(), found.n_distinct(), found.n_real()), (5, 2, 2));
    assert_eq!(found.duplicate_of, [None, None, Some(0), Some(0), Some(1)]);
    assert!(found.complete());
}

#[test]
fn tiny_coordinates_do_not_set_the_size_of_a_box() {
    // katsura-8: (1, 0, .., 0) is a solution; rounding leaves some coordinates far smaller than any
    // scale of the system.
    let text = include_str!("../../../../examples/systems/katsura8.phc");
    let mut point = vec![z(0.0, 0.0); 9];
    (point[0], point[7], point[8]) = (z(1.0, 0.0), z(0.0, -9.2888628151065e-69), z(-1.85586238071561e-68, 0.0));
    let found = run(&text[..=text.rfind(';').unwrap()], &[point]);
    assert_eq!((found.n_certified(), found.n_real()), (1, 1));
}

#[test]
fn near_solutions_are_told_apart() {
    // 1 and 1 + 1e-14, 50 doubles apart.
    let found = run("1\n(x - 1)*(x - 1.00000000000001);", &[vec![z(1.0, 0.0)], vec![z(1.0 + 1e-14, 0.0)]]);
    assert_eq!((found.n_certified(), found.n_distinct(), found.n_real()), (2, 2, 2));
    assert!(found.complete());
}

#[test]
fn solutions_closer_than_doubles_are_not_certified() {
    // A box of doubles about one would contain the other.
    for gap in ["1E-16", "1E-17", "1E-20", "1E-30"] {
        let found = run(&format!("1\n(x - 1)*(x - 1 - {gap});"), &[vec![z(1.0, 0.0)], vec![z(1.0, 1e-17)]]);
        assert_eq!(found.n_certified(), 0, "{gap}: {found:?}");
    }
    // Near zero doubles are closer.
    let found = run("1\nx*(x - 1E-30);", &[vec![z(0.0, 0.0)], vec![z(1e-30, 0.0)]]);
    assert_eq!((found.n_certified(), found.n_distinct(), found.n_real()), (2, 2, 2), "{found:?}");
}

#[test]
fn singular_solutions_are_not_certified() {
    for (text, near) in [
        ("1\nx^2 - 2*x + 1;", vec![z(1.0, 0.0)]),
        ("1\n(x - 1/3)^2;", vec![z(1.0 / 3.0, 0.0)]),
        ("1\n(x - 1/3)^3;", vec![z(0.3334, 1e-5)]),
        ("2\nx^2 + y^2 - 1;\nx - 1;", vec![z(1.0, 0.0), z(0.0, 0.0)]),
        ("2\nx*y;\nx*(x - y);", vec![z(0.0, 0.0), z(0.0, 0.0)]),
        // Griewank and Osborne: Newton's method diverges.
        ("2\n29/16*x^3 - 2*x*y;\ny - x^2;", vec![z(0.0, 0.0), z(0.0, 0.0)]),
        // A curve of solutions.
        ("2\nx*y - 1;\n2*x*y - 2;", vec![z(2.0, 0.0), z(0.5, 0.0)]),
    ] {
        for error in [0.0, 1e-12, 1e-9, 1e-7, 1e-5, 1e-4] {
            let point: Vec<Complex64> = near.iter().map(|x| x + z(error, 0.7 * error)).collect();
            let found = run(text, &[point]);
            assert!(found.points[0].is_err(), "{text} from {error}: {found:?}");
            assert!(!found.complete());
        }
    }
}

#[test]
fn points_that_are_no_solutions_are_not_certified() {
    let near = |x: f64, y: f64| vec![z(x, 0.0), z(y, 0.0)];
    let points = [near(3.2, 4.0), near(30.0, 4.0), near(f64::NAN, 1.0), near(3.0, f64::INFINITY), near(0.0, 0.0)];
    let found = run("2\nx^2 + y^2 - 25;\n4*x - 3*y;", &points);
    assert_eq!(found.n_certified(), 0);
    assert_eq!(found.points[0], Err(Obstacle::Away));
    assert_eq!(found.points[2], Err(Obstacle::NotFinite));
    assert_eq!(found.points[3], Err(Obstacle::NotFinite));
    // No solution at all.
    assert_eq!(run("2\nx - y;\nx - y + 1;", &[near(1.0, 1.0)]).points[0], Err(Obstacle::Singular));
    assert!(run("1\n1/x;", &[vec![z(1e9, 0.0)]]).points[0].is_err());
}

#[test]
fn simple_solutions_at_zero_are_certified() {
    let found = run("2\nx^2 + y;\ny^2 + x + x*y;", &[vec![z(0.0, 0.0), z(1e-9, 1e-9)]]);
    assert!(found.points[0].as_ref().is_ok_and(|p| p.enclosure.iter().all(|x| x.contains(z(0.0, 0.0)))), "{found:?}");
    // y*(x - y) at y = 0, where one unknown of the solution is zero.
    let found = run("2\n(x - y)*y;\nx - 3 + y^2;", &[vec![z(3.0, 0.0), z(0.0, 0.0)]]);
    assert_eq!(found.points[0].as_ref().map(|p| p.reality), Ok(Reality::Real));
}

#[test]
fn noise_far_below_the_other_coordinates_is_no_scale() {
    // Katsura's system for n = 2, zero coordinates as solvers leave them.
    let text = "3\nu^2 + 2*v^2 + 2*w^2 - u;\n2*u*v + 2*v*w - v;\nu + 2*v + 2*w - 1;";
    let third = 1.0 / 3.0;
    for noise in [0.0, 1e-300, 1e-77, 1e-40, 1e-20, 1e-10] {
        let points = [
            vec![z(third, noise), z(noise, -noise), z(third, 0.0)],
            vec![z(1.0, 0.0), z(noise, noise), z(-noise, 0.0)],
        ];
        let found = run(text, &points);
        assert_eq!((found.n_certified(), found.n_distinct(), found.n_real()), (2, 2, 2), "{noise}: {found:?}");
    }
}

#[test]
fn badly_scaled_systems_need_no_scaling() {
    // x = +-1e15, y = +-1e-30 and a third unknown in between.
    let text = "3\n1E-40*x^2 - 1E-10;\n1E+20*x*y - 1E+5;\n1E-200*w^3 - 1E-200*x*y*w - 6E-200;";
    for sign in [1.0, -1.0] {
        // The third unknown solves w^3 - 1e-15 w - 6 = 0.
        let found = run(text, &[vec![z(sign * 1e15, 0.0), z(sign * 1e-30, 0.0), z(6f64.cbrt(), 0.0)]]);
        assert_eq!(found.points[0].as_ref().map(|p| p.reality), Ok(Reality::Real), "{found:?}");
    }
}

#[test]
fn ill_conditioned_roots_are_certified() {
    // Wilkinson's polynomial with roots 1 to 15, multiplied out: relative condition numbers reach
    // 1e13.
    let mut coefficients = vec![num_bigint::BigInt::from(1)];
    for root in 1..=15 {
        let mut next = vec![num_bigint::BigInt::from(0); coefficients.len() + 1];
        for (k, c) in coefficients.iter().enumerate() {
            next[k + 1] += c;
            next[k] -= c * root;
        }
        coefficients = next;
    }
    let terms: Vec<String> = coefficients.iter().enumerate().map(|(k, c)| format!("({c})*x^{k}")).collect();
    let points: Vec<Vec<Complex64>> = (1..=15).map(|k| vec![z(f64::from(k) + 1e-6, 1e-7)]).collect();
    let found = run(&format!("1\n{};", terms.join("+")), &points);
    assert_eq!((found.n_certified(), found.n_distinct(), found.n_real()), (15, 15, 15), "{found:?}");
    for (k, point) in (1..).zip(&found.points) {
        let x = &point.as_ref().unwrap().enclosure[0];
        assert!(x.contains(z(f64::from(k), 0.0)) && x.radius() < 1e-12, "{x:?}");
    }
}

#[test]
fn parameters_may_be_intervals() {
    let system = System::build(|s| {
        let (x, a) = (s.variable("x"), s.parameter("a"));
        vec![x * x - a]
    })
    .unwrap();
    let a = ComplexInterval::around(z(2.0, 0.0), 0.01);
    let point = [vec![z(2f64.sqrt(), 0.0)]];
    let found = certify(&system, &[a], &point, &CertifyOptions::default()).unwrap();
    let certificate = found.points[0].as_ref().unwrap();
    for end in [1.99f64, 2.01] {
        assert!(certificate.enclosure[0].contains(z(end.sqrt(), 0.0)));
    }
    // The box of parameters is complex, so nothing is said of reality; a real interval tells.
    assert_eq!(certificate.reality, Reality::Undecided);
    let mut real = a;
    real.im = poly::Interval::point(0.0);
    let found = certify(&system, &[real], &point, &CertifyOptions::default()).unwrap();
    assert_eq!(found.points[0].as_ref().map(|p| p.reality), Ok(Reality::Real));
    // An interval that contains a singular instance.
    let wide = ComplexInterval::around(z(1.0, 0.0), 1.5);
    let found = certify(&system, &[wide], &[vec![z(1.0, 0.0)]], &CertifyOptions::default()).unwrap();
    assert_eq!(found.points[0], Err(Obstacle::NoContraction));
}

#[test]
fn what_does_not_fit_is_an_error() {
    let system = phcpack("1\nx + y;").unwrap();
    let options = CertifyOptions::default();
    let error = certify(&system, &[], &[], &options).unwrap_err();
    assert_eq!(error, CertifyError::NotSquare { equations: 1, unknowns: 2 });
    let system = phcpack("1\nx - 1;").unwrap();
    let error = certify(&system, &[], &[vec![], vec![z(1.0, 0.0)]], &options).unwrap_err();
    assert_eq!(error, CertifyError::Length { point: 1, found: 0, expected: 1 });
    let one = ComplexInterval::point(z(1.0, 0.0));
    let error = certify(&system, &[one], &[], &options).unwrap_err();
    assert_eq!(error, CertifyError::Parameters { found: 1, expected: 0 });
    assert!(certify(&phcpack("1\n1/(x + y - x - y) + x + y - y;").unwrap(), &[], &[], &options).is_err());
    assert!(certify(&system, &[], &[], &options).unwrap().complete());
}

#[test]
fn boxes_as_small_as_doubles_allow_are_tried() {
    // With the smallest box that doubles can bound, and one a few times larger no longer:
    // coefficients of size one, coordinates from 1e-4 to 1e9, condition 1e10. The equations are
    // those of four receivers and five transmitters (alpha, beta, e, l, h, C).
    let mut text = String::from(
        "name = 'f'\nunknowns = ['a', 'b', 'e', 'l', 'h', 'c']\n\
         parameters = ['x1', 'x2', 'x3', 'x4', 'x5', 'y1', 'y2', 'y3', 'y4', 'y5', 'z1', 'z2', 'z3', 'z4', 'z5']\nequations = [",
    );
    for j in 1..=5 {
        let (n, d) = (format!("(a*x{j}^2 + b*y{j}^2 - z{j}^2 + c)"), format!("(a*x{j} + b*y{j} - z{j})"));
        let u = format!("((e - x{j}^2)*{d} + x{j}*{n})");
        let v = format!("((e*l^2 + h - y{j}^2)*{d} + y{j}*{n})");
        text += &format!("'h*{u}^2 + e*({v} - l*{u})^2 - e*h*{n}^2', ");
    }
    let family = poly::parse::family(&(text + "'(a + b*l)^2*e + b^2*h - a*e - b*(e*l^2 + h) - c']")).unwrap();
    let parameters = [
        -1.4070781888489556,
        1.2771549186307813,
        -1.360980935177995,
        0.25584968417041404,
        0.2792360425296751,
        0.9998129833652363,
        2.2090571750661625,
        1.3235477463365681,
        -0.3579809981076243,
        -1.2409437533845447,
        -0.155479401856555,
        0.09910248582518262,
        -0.13596244338073837,
        -0.15184110132185924,
        -0.13542031438485988,
    ];
    let parameters = parameters.map(|p| ComplexInterval::point(z(p, 0.0)));
    let point: Vec<Complex64> = [
        8.866509395108842e-05,
        -0.002578094059702307,
        4.80024163865396,
        -11932.349460717674,
        -683463030.6554757,
        0.024783058422783947,
    ]
    .map(|x| z(x, 0.0))
    .to_vec();
    let found = certify(&family.system, &parameters, &[point], &CertifyOptions::default()).unwrap();
    assert_eq!((found.n_certified(), found.n_real()), (1, 1), "{found:?}");
}

/// A number with few digits, and its text.
fn small() -> impl Strategy<Value = (i64, i64)> {
    (-40..40i64, 1..9i64)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Two quadrics with a rational solution by construction: what is certified near it contains
    /// it.
    #[test]
    fn boxes_contain_the_rational_solution(
        s in [small(), small()],
        a in proptest::collection::vec(small(), 10),
        noise in -1e-6..1e-6f64,
    ) {
        let term = |(p, q): (i64, i64)| format!("({p}/{q})");
        let (u, v) = (format!("(x - {})", term(s[0])), format!("(y - {})", term(s[1])));
        let equation = |a: &[(i64, i64)]| {
            let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(|k| term(a[k]));
            format!("{a}*{u} + {b}*{v} + {c}*{u}^2 + {d}*{u}*{v} + {e}*{v}^2;")
        };
        let text = format!("2\nx - x + y - y + {}\n{}", equation(&a[..5]), equation(&a[5..]));
        let rational = |(p, q): (i64, i64)| BigRational::new(p.into(), q.into());
        let near = |(p, q): (i64, i64)| z(p as f64 / q as f64 * (1.0 + noise), noise);
        let found = run(&text, &[s.map(near).to_vec()]);
        let determinant = rational(a[0]) * rational(a[6]) - rational(a[1]) * rational(a[5]);
        let zero = BigRational::from_integer(0.into());
        match &found.points[0] {
            Ok(certificate) => {
                // Another solution may be as near; the box of the rational one, taken from the
                // exact point, is apart then.
                let from_exact = run(&text, &[s.map(|(p, q)| z(p as f64 / q as f64, 0.0)).to_vec(), certificate.value.clone()]);
                let inside = certificate.enclosure.iter().zip(s).all(|(x, s)| holds(x, &rational(s), &zero));
                prop_assert!(inside || from_exact.duplicate_of[1].is_none(), "{text} {certificate:?}");
                if inside {
                    prop_assert!(certificate.reality == Reality::Real);
                }
            }
            Err(obstacle) => {
                let size = determinant.numer().bits() as i64 - determinant.denom().bits() as i64;
                // The Jacobian at the solution is far from singular only if its determinant is not
                // small.
                prop_assert!(determinant == zero || size < 2 || *obstacle == Obstacle::Away, "{text} {obstacle:?}");
            }
        }
    }
}
