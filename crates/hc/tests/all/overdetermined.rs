//! Families with more equations than unknowns. Numbers of solutions are degrees of determinantal varieties, or those of
//! equations of which the others are multiples.

use hc::family::Stopped;
use hc::random::Random;
use hc::{Family, MonodromyOptions, SolveOptions};

/// Whole numbers of one digit, without zero.
struct Digits(Random);

impl Digits {
    fn next(&mut self) -> i64 {
        let z = self.0.normal();
        (z.re * 4.0).clamp(-8.0, 8.0).round() as i64 * 2 + 1
    }
}

/// Linear forms in so many unknowns with constant terms that are parameters, as a matrix of formulas; the unknowns and
/// the parameters.
fn forms(rows: usize, columns: usize, unknowns: usize) -> (Vec<Vec<String>>, Vec<String>, Vec<String>) {
    let mut digits = Digits(Random::new(3, 5));
    let (x, mut p) = ((0..unknowns).map(|k| format!("x{k}")).collect::<Vec<_>>(), Vec::new());
    let mut form = |i: usize, j: usize| {
        p.push(format!("p{i}{j}"));
        let linear: Vec<String> = x.iter().map(|x| format!("({})*{x}", digits.next())).collect();
        format!("(p{i}{j} + {})", linear.join(" + "))
    };
    let matrix = (0..rows).map(|i| (0..columns).map(|j| form(i, j)).collect()).collect();
    (matrix, x, p)
}

/// The sets of `k` numbers below `n`.
fn sets(n: usize, k: usize) -> Vec<Vec<usize>> {
    (0..1usize << n)
        .map(|set| (0..n).filter(|j| set >> j & 1 == 1).collect())
        .filter(|s: &Vec<_>| s.len() == k)
        .collect()
}

fn determinant(m: &[Vec<String>], rows: &[usize], columns: &[usize]) -> String {
    let Some((&first, rest)) = rows.split_first() else { return "1".to_owned() };
    let expand = |(k, &j): (usize, &usize)| {
        let others: Vec<usize> = columns.iter().copied().filter(|&c| c != j).collect();
        format!("{} {}*({})", if k % 2 == 0 { '+' } else { '-' }, m[first][j], determinant(m, rest, &others))
    };
    let terms: Vec<String> = columns.iter().enumerate().map(expand).collect();
    format!("0 {}", terms.join(" "))
}

/// The family of matrices of linear forms of rank below `k`: all minors with `k` rows.
fn minors(rows: usize, columns: usize, k: usize, unknowns: usize) -> Family {
    let (matrix, x, p) = forms(rows, columns, unknowns);
    let equations: Vec<String> = sets(rows, k)
        .iter()
        .flat_map(|r| sets(columns, k).into_iter().map(|c| determinant(&matrix, r, &c)).collect::<Vec<_>>())
        .collect();
    assert!(equations.len() > unknowns);
    Family::from_formulas(&x, &p, &equations).unwrap()
}

/// Matrices of linear forms (Harris & Tu 1984, Topology 23:71): of 2 x 3 forms in the plane 3 points have rank one, of
/// 3 x 4 forms 6 have rank two, of 3 x 5 forms in space 10, and of 3 x 3 forms in four unknowns 6 have rank one, the
/// degree of the Segre variety of two planes.
#[test]
fn determinantal_families_have_as_many_solutions_as_their_degrees() {
    for (family, count) in
        [(minors(2, 3, 2, 2), 3), (minors(3, 4, 3, 2), 6), (minors(3, 3, 2, 4), 6), (minors(3, 5, 3, 3), 10)]
    {
        for seed in 0..2 {
            let found = family.monodromy(&MonodromyOptions::new().seed(seed)).unwrap();
            let words = format!("{} equations, seed {seed}: {}", family.system().len(), found.stopped);
            assert_eq!((found.fibre.len(), &found.orbits[..]), (count, &[count][..]), "{words}");
            assert!(matches!(found.stopped, Stopped::Trace | Stopped::OrbitsWhole | Stopped::StartSystem), "{words}");
            let mut random = Random::new(seed, 5);
            let targets: Vec<Vec<f64>> = (0..10)
                .map(|_| (0..family.system().parameters().len()).map(|_| 5.0 * random.normal().re).collect())
                .collect();
            for at in family.track(&found.fibre, &targets).run().unwrap() {
                assert_eq!((at.len(), at.paths.failed, at.excess), (count, 0, 0), "{words}");
            }
        }
    }
}

/// A fibre without one of its solutions does not pass the trace test.
#[test]
fn a_hole_is_found_by_the_trace_test() {
    let family = minors(2, 3, 2, 2);
    let mut fibre = family.monodromy(&MonodromyOptions::new()).unwrap().fibre;
    let test = family.trace_test(&fibre, &MonodromyOptions::new()).unwrap();
    assert!(test.passed(3), "{test:?}");
    fibre.solutions.truncate(4);
    let test = family.trace_test(&fibre, &MonodromyOptions::new()).unwrap();
    assert!(!test.passed(2), "{test:?}");
}

/// Each member solved for itself has the same solutions.
#[test]
fn members_agree_with_solve() {
    let family = minors(2, 3, 2, 2);
    let fibre = family.monodromy(&MonodromyOptions::new()).unwrap().fibre;
    let target: Vec<f64> = (0..6).map(|k| f64::from(k * k % 7) - 2.5).collect();
    let tracked = &family.track(&fibre, &[&target]).run().unwrap()[0];
    let parameters: Vec<hc::Complex64> = target.iter().map(|&p| p.into()).collect();
    let solved = hc::solve(&family.system().at(&parameters).unwrap(), &SolveOptions::new()).unwrap();
    assert_eq!((tracked.len(), solved.len()), (3, 3));
    for s in &solved {
        let near = |t: &&hc::Solution| t.value.iter().zip(&s.value).all(|(a, b)| (a - b).norm() < 1e-10);
        assert_eq!(tracked.iter().filter(near).count(), 1);
    }
}

/// Solutions that no parameter moves, and factors that must not vanish: `x` and `y` times the equations of a circle and
/// a hyperbola vanish at the origin besides their four points.
#[test]
fn still_solutions_are_kept_and_degenerate_ones_are_not() {
    let equations: Vec<String> =
        ["x", "y"].iter().flat_map(|z| [format!("{z}*(x^2 + y^2 - a)"), format!("{z}*(x*y - b)")]).collect();
    let given = || hc::poly::Family::from_formulas(&["x", "y"], &["a", "b"], &equations).unwrap();
    let family = Family::new(given()).unwrap();
    let found = family.monodromy(&MonodromyOptions::new()).unwrap();
    assert_eq!((found.fibre.len(), found.stopped), (5, Stopped::Trace), "{:?}", found.orbits);
    assert_eq!(found.orbits, [4, 1]);
    let family = Family::new(given().with_nonzero(&["x"]).unwrap()).unwrap();
    let found = family.monodromy(&MonodromyOptions::new()).unwrap();
    assert_eq!((found.fibre.len(), found.stopped), (4, Stopped::Trace), "{:?}", found.orbits);
}
