//! Certified solutions of systems whose counts are known.

use hc::certify::{Certificates, CertifyOptions, certify};
use hc::{SolveOptions, solve};
use num_complex::Complex64;
use poly::{System, parse::phcpack};
use std::path::Path;

/// Solves and certifies. Badly scaled solutions that the solver takes for points on a component are
/// certified as well: what is certified is isolated.
fn run(system: &System) -> Certificates {
    let found = solve(system, &SolveOptions::default()).unwrap();
    let values = found.solutions.iter().map(|s| &s.value).chain(&found.component_points);
    let points: Vec<Vec<Complex64>> = values.cloned().collect();
    certify(system, &[], &points, &CertifyOptions::default()).unwrap()
}

fn cyclic(n: usize) -> System {
    System::build(|s| {
        let x: Vec<_> = (0..n).map(|j| s.variable(&format!("z{j}"))).collect();
        let run = |length: usize, first: usize| s.product((0..length).map(|j| x[(first + j) % n]));
        let mut equations: Vec<_> = (1..n).map(|k| s.sum((0..n).map(|first| run(k, first)))).collect();
        equations.push(run(n, 0) - 1);
        equations
    })
    .unwrap()
}

fn katsura(n: usize) -> System {
    System::build(|s| {
        let u: Vec<_> = (0..=n).map(|j| s.variable(&format!("u{j}"))).collect();
        let mut equations: Vec<_> = (0..n)
            .map(|m| {
                let products = (0..=2 * n).filter_map(|shifted| {
                    let (j, k) = (shifted.abs_diff(n), shifted.abs_diff(m + n));
                    (k <= n).then(|| u[j] * u[k])
                });
                s.sum(products) - u[m]
            })
            .collect();
        equations.push(u[0] + 2 * s.sum(u[1..].iter().copied()) - 1);
        equations
    })
    .unwrap()
}

fn noon(n: usize) -> System {
    System::build(|s| {
        let x: Vec<_> = (0..n).map(|j| s.variable(&format!("x{j}"))).collect();
        let others = |i: usize| s.sum((0..n).filter(|&j| j != i).map(|j| x[j].powi(2)));
        (0..n).map(|i| x[i] * others(i) - s.constant(11) / 10 * x[i] + 1).collect()
    })
    .unwrap()
}

#[test]
fn all_solutions_of_known_systems_are_certified() {
    // Bjorck and Froberg 1991: cyclic-5 has 70; Katsura: 2^n; Noonburg: 3^n - 2n (noon-4: 73). Real
    // ones: PHCpack's lists.
    for (name, system, distinct, real) in
        [("cyclic-5", cyclic(5), 70, Some(10)), ("katsura-6", katsura(6), 64, Some(32)), ("noon-4", noon(4), 73, None)]
    {
        let found = run(&system);
        assert!(found.complete(), "{name}");
        assert_eq!((found.n_certified(), found.n_distinct()), (distinct, distinct), "{name}");
        if let Some(real) = real {
            assert_eq!(found.n_real(), real, "{name}");
        }
    }
}

#[test]
fn a_list_given_twice_has_half_as_many_solutions() {
    // The curve and conic of Breiding, Rose, Timme (2020): 18 solutions, 4 of them real.
    let text = "2\n(x^4 + y^4 - 1)*(x^2 + y^2 - 2) + x^5*y;\nx^2 + 2*x*y^2 - 2*y^2 - 1/2;";
    let system = phcpack(text).unwrap();
    let once = run(&system);
    assert_eq!((once.n_certified(), once.n_distinct(), once.n_real()), (18, 18, 4));
    let mut points: Vec<Vec<Complex64>> = once.solutions().map(|s| s.value.clone()).collect();
    points.extend(points.clone());
    let twice = certify(&system, &[], &points, &CertifyOptions::default()).unwrap();
    assert_eq!((twice.n_certified(), twice.n_distinct(), twice.n_real()), (36, 18, 4));
    assert!(twice.complete() && twice.duplicate_of[18..].iter().zip(0..).all(|(d, k)| *d == Some(k)));
}

/// The sphere-like quadric and the rational surface meet in a curve of degree 4: a plane meets it
/// in four points. The plane's points solve the rational equations themselves, not just those
/// multiplied out.
#[test]
fn a_curve_of_degree_four_given_by_quotients() {
    let plane = "(0.3 + 0.7*i)*x - (1.1 - 0.2*i)*y + (0.4 + 0.5*i)*z - 0.9 + 0.6*i";
    let polynomials = phcpack(&format!("3\nx^2 + y^2 - z;\nx + (y + z - 1)*(y - 1);\n{plane};")).unwrap();
    let quotients = phcpack(&format!("3\nx^2 + y^2 - z;\nx/(y - 1) + y + z - 1;\n{plane};")).unwrap();
    for seed in 0..5 {
        let mut options = SolveOptions::default();
        options.seed = seed;
        let found = solve(&polynomials, &options).unwrap();
        assert_eq!((found.solutions.len(), found.paths.failed), (4, 0), "seed {seed}");
        let points: Vec<Vec<Complex64>> = found.iter().map(|s| s.value.clone()).collect();
        let proofs = certify(&quotients, &[], &points, &CertifyOptions::default()).unwrap();
        assert_eq!((proofs.n_distinct(), proofs.complete()), (4, true), "seed {seed}");
    }
}

#[test]
fn regular_systems_on_record_are_certified_in_full() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/systems");
    let table = std::fs::read_to_string(folder.join("expected.csv")).unwrap();
    let mut seen = 0;
    for line in table.lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let (name, mixed_volume, distinct, real) = (fields[0], fields[3], fields[5], fields[8]);
        let regular = fields[7] == "0" && fields[10] == "no";
        // A thousand paths at most.
        if !regular || mixed_volume.parse::<usize>().unwrap_or(usize::MAX) > 1000 {
            continue;
        }
        let system = phcpack(&std::fs::read_to_string(folder.join(format!("{name}.phc"))).unwrap()).unwrap();
        let found = run(&system);
        assert!(found.complete(), "{name}");
        assert_eq!(found.n_distinct().to_string(), distinct, "{name}");
        if !real.is_empty() {
            assert_eq!(found.n_real().to_string(), real, "{name}: real solutions");
        }
        seen += 1;
    }
    assert!(seen >= 10, "{seen} systems");
}
