//! Sweeps whose numbers of solutions are known: from formulas, or by Sturm's theorem in exact arithmetic.

use super::{Axis, Break, BreakKind, Doubt, Grid, Standing, Sweep, SweepError, SweepOptions};
use crate::family::{Family, Fibre};
use crate::{Monitor, MonodromyOptions, Run};
use num_rational::BigRational;
use num_traits::{Signed, Zero};

const NONE: [(&str, f64); 0] = [];

fn fibre(family: &Family, count: usize) -> Fibre {
    let fibre = family.monodromy(&MonodromyOptions::new()).unwrap().fibre;
    assert_eq!(fibre.len(), count);
    fibre
}

fn axis(name: &str, from: f64, to: f64, count: usize) -> Axis {
    Axis::new(name, from, to, count)
}

fn sweep(family: &Family, fibre: &Fibre, grid: &Grid) -> Sweep {
    family.sweep(fibre, grid, &SweepOptions::new()).unwrap()
}

fn counts(sweep: &Sweep) -> Vec<usize> {
    sweep.cells.iter().map(super::Cell::real).collect()
}

/// Folds lie where the numbers of neighbours differ, and where they differ from that at a point between; nothing is
/// unexplained. `count` has the true number for values on the axes.
fn folds_separate_counts(sweep: &Sweep, grid: &Grid, count: &dyn Fn(&[f64]) -> usize) {
    let counts = counts(sweep);
    assert!(sweep.breaks.iter().all(|b| b.kind == BreakKind::Fold), "{:?}", sweep.breaks);
    let is_broken = |cells: [usize; 2]| sweep.breaks.iter().any(|b| b.cells == cells);
    for cell in 0..grid.len() {
        assert!(grid.next(cell).all(|next| counts[cell] == counts[next] || is_broken([cell, next])), "{cell}");
    }
    for Break { cells: [a, b], ended, .. } in &sweep.breaks {
        assert_eq!(ended[0] as i64 - ended[1] as i64, counts[*a] as i64 - counts[*b] as i64);
        let ends = [grid.values(*a), grid.values(*b)];
        let between = |k: u32| {
            let share = f64::from(k) / 4096.0;
            let at = |(a, b): (&f64, &f64)| a * (1.0 - share) + b * share;
            ends[0].iter().zip(&ends[1]).map(at).collect::<Vec<f64>>()
        };
        assert!(counts[*a] != counts[*b] || (0..4096).any(|k| count(&between(k)) != counts[*a]), "{ends:?}");
    }
}

#[test]
fn a_cubic_has_two_folds() {
    let family = Family::from_formulas(&["x"], &["a"], &["x^3 - 3*x + a"]).unwrap();
    let fibre = fibre(&family, 3);
    // The folds themselves are cells: x = 1 and x = -1 are double there.
    let grid = Grid::new(&family, vec![axis("a", -4.0, 4.0, 9)], &NONE).unwrap();
    let found = sweep(&family, &fibre, &grid);
    assert_eq!(counts(&found), [1, 1, 2, 3, 3, 3, 2, 1, 1]);
    for (k, cell) in found.cells.iter().enumerate() {
        let expected = if k == 2 || k == 6 { Standing::Multiple } else { Standing::Counted };
        assert_eq!(cell.standing, expected, "{k}");
        assert_eq!(cell.complex, if k == 2 || k == 6 { 0 } else { 3 - cell.real() });
    }
    let double = found.cells[6].solutions.iter().find(|s| s.multiplicity == 2).unwrap();
    assert!((double.value[0] - 1.0).abs() < 1e-6 && double.branch.is_none() && double.positive);
    // The two that meet end beside the double solution; all three go on between the folds.
    let breaks: Vec<([usize; 2], [usize; 2])> = found.breaks.iter().map(|b| (b.cells, b.ended)).collect();
    assert_eq!(breaks, [([2, 3], [0, 2]), ([5, 6], [2, 0])]);
    assert!(found.breaks.iter().all(|b| b.kind == BreakKind::Fold));
    assert_eq!(found.branches, 3);
}

/// The cusp `4 a^3 + 27 b^2 = 0`: two of the three solutions are one sheet, which goes about it.
#[test]
fn a_sheet_goes_about_a_cusp() {
    let family = Family::from_formulas(&["x"], &["a", "b"], &["x^3 + a*x + b"]).unwrap();
    let fibre = fibre(&family, 3);
    let count = |p: &[f64]| if 4.0 * p[0].powi(3) + 27.0 * p[1] * p[1] < 0.0 { 3 } else { 1 };
    let grid = Grid::new(&family, vec![axis("a", -2.0, 1.03, 31), axis("b", -1.51, 1.5, 30)], &NONE).unwrap();
    let found = sweep(&family, &fibre, &grid);
    for (k, cell) in found.cells.iter().enumerate() {
        let [a, b] = grid.values(k)[..] else { panic!("two axes") };
        assert_eq!(cell.real(), count(&[a, b]), "{a} {b}");
        assert!(cell.standing.is_shown());
        // All are positive if b < 0 and there is but one, which has the sign of -b.
        if cell.real() == 1 {
            assert_eq!(cell.positive(), usize::from(b < 0.0));
        }
    }
    folds_separate_counts(&found, &grid, &count);
    // Solutions on the outer sheet are joined about the cusp; the one between them has both folds about it.
    let outer = found.cells[0].solutions[0].branch;
    for cell in &found.cells {
        for (k, solution) in cell.solutions.iter().enumerate() {
            assert_eq!(solution.branch == outer, k != 1, "{:?}", cell.solutions);
        }
    }
    assert_eq!(found.branches, 2);
}

/// Steady states of a parametric oscillator in the rotating frame. From the equations `r^2 = u^2 + v^2` solves
/// `(r^2 + d)^2 = l^2 - g^2 w^2` with `d = 1 - w^2`; each positive `r^2` gives two states of opposite phase.
pub(super) fn parametron_states(w: f64, g: f64, l: f64) -> usize {
    let (d, rest) = (1.0 - w * w, l * l - g * g * w * w);
    if rest <= 0.0 {
        return 1;
    }
    1 + 2 * [-d - rest.sqrt(), -d + rest.sqrt()].iter().filter(|r| **r > 0.0).count()
}

fn parametron() -> Family {
    let equations = ["u*(u^2 + v^2) + (1 - w^2 - l)*u + g*w*v", "v*(u^2 + v^2) + (1 - w^2 + l)*v - g*w*u"];
    Family::from_formulas(&["u", "v"], &["w", "g", "l"], &equations).unwrap()
}

#[test]
fn states_of_a_parametric_oscillator() {
    let family = parametron();
    let fibre = fibre(&family, 5);
    let grid = Grid::new(&family, vec![axis("w", 0.9, 1.1, 40), axis("l", 0.001, 0.1, 41)], &[("g", 0.01)]).unwrap();
    let found = sweep(&family, &fibre, &grid);
    let mut seen = [0; 6];
    for (k, cell) in found.cells.iter().enumerate() {
        let [w, l] = grid.values(k)[..] else { panic!("two axes") };
        assert_eq!(cell.real(), parametron_states(w, 0.01, l), "w = {w}, l = {l}: {:?}", cell.standing);
        assert!(cell.standing.is_shown());
        seen[cell.real()] += 1;
    }
    assert!(seen[1] > 100 && seen[3] > 100 && seen[5] > 100, "{seen:?}");
    folds_separate_counts(&found, &grid, &|p| parametron_states(p[0], 0.01, p[1]));
}

/// Number of real roots of a polynomial (coefficients from the constant one on) by Sturm's theorem, exactly.
fn sturm(coefficients: &[f64]) -> usize {
    let mut chain: Vec<Vec<BigRational>> =
        vec![coefficients.iter().map(|&c| BigRational::from_float(c).unwrap()).collect()];
    let derivative =
        chain[0].iter().enumerate().skip(1).map(|(k, c)| c * BigRational::from_integer(k.into())).collect();
    chain.push(derivative);
    while let [.., a, b] = &chain[..] {
        let mut rest = a.clone();
        while rest.len() >= b.len() {
            let factor = rest.last().unwrap() / b.last().unwrap();
            let shift = rest.len() - b.len();
            for (k, c) in b.iter().enumerate() {
                rest[shift + k] -= &factor * c;
            }
            rest.pop();
        }
        while rest.last().is_some_and(Zero::is_zero) {
            rest.pop();
        }
        if rest.is_empty() {
            break;
        }
        chain.push(rest.into_iter().map(|c| -c).collect());
    }
    let changes = |at_minus_infinity: bool| {
        let negative =
            |p: &Vec<BigRational>| p.last().unwrap().is_negative() ^ (at_minus_infinity && p.len().is_multiple_of(2));
        chain.windows(2).filter(|pair| negative(&pair[0]) != negative(&pair[1])).count()
    };
    changes(true) - changes(false)
}

#[test]
fn swallowtails_agree_with_sturm() {
    assert_eq!([sturm(&[-2.0, 0.0, 1.0]), sturm(&[2.0, 0.0, 1.0]), sturm(&[0.0, 2.0, -3.0, 1.0])], [2, 0, 3]);
    let family = Family::from_formulas(&["x"], &["a", "b", "c"], &["x^4 + a*x^2 + b*x + c"]).unwrap();
    let fibre = fibre(&family, 4);
    let (axes, mut seen) = (|| vec![axis("b", -2.0, 2.1, 23), axis("c", -1.0, 1.2, 24)], [0; 5]);
    for a in [-2.3, -0.7, 0.4] {
        let grid = Grid::new(&family, axes(), &[("a", a)]).unwrap();
        let found = sweep(&family, &fibre, &grid);
        for (k, cell) in found.cells.iter().enumerate() {
            let [b, c] = grid.values(k)[..] else { panic!("two axes") };
            assert_eq!(cell.real(), sturm(&[c, b, a, 0.0, 1.0]), "{a} {b} {c}");
            assert!(cell.standing.is_shown());
            seen[cell.real()] += 1;
        }
        folds_separate_counts(&found, &grid, &|p| sturm(&[p[1], p[0], a, 0.0, 1.0]));
    }
    assert!(seen[0] > 10 && seen[2] > 10 && seen[4] > 10, "{seen:?}");
}

#[test]
fn a_branch_goes_to_infinity_and_comes_back() {
    let family = Family::from_formulas(&["x"], &["a"], &["a*x - 1"]).unwrap();
    let fibre = fibre(&family, 1);
    let grid = Grid::new(&family, vec![axis("a", -1.0, 1.0, 8)], &NONE).unwrap();
    let found = sweep(&family, &fibre, &grid);
    assert_eq!((counts(&found), found.branches), (vec![1; 8], 2));
    let [broken] = &found.breaks[..] else { panic!("one break: {:?}", found.breaks) };
    assert_eq!((broken.cells, broken.ended, broken.kind), ([3, 4], [1, 1], BreakKind::Infinity));
    // Where a is zero, the only path goes to infinity.
    let grid = Grid::new(&family, vec![axis("a", -1.0, 1.0, 3)], &NONE).unwrap();
    let found = sweep(&family, &fibre, &grid);
    assert_eq!(counts(&found), [1, 0, 1]);
    assert_eq!((found.cells[1].at_infinity, &found.cells[1].standing), (1, &Standing::Counted));
    assert!(found.breaks.iter().all(|b| b.kind == BreakKind::Infinity), "{:?}", found.breaks);
}

/// The real cube root is one branch, though its slope is infinite at zero.
#[test]
fn a_branch_goes_through_a_multiple_point() {
    let family = Family::from_formulas(&["x"], &["a", "b"], &["x^3 + b*x - a"]).unwrap();
    let grid = Grid::new(&family, vec![axis("a", -1.0, 2.0, 8)], &[("b", 0.0)]).unwrap();
    let found = sweep(&family, &fibre(&family, 3), &grid);
    assert_eq!((counts(&found), found.branches, found.breaks.len()), (vec![1; 8], 1, 0));
    for (k, cell) in found.cells.iter().enumerate() {
        assert!((cell.solutions[0].value[0] - grid.values(k)[0].cbrt()).abs() < 1e-12);
    }
}

/// Two solutions `1 +- sqrt(a)` that are 2e-7 apart are real for positive `a` and conjugates for negative `a`.
#[test]
fn near_pairs_are_certified() {
    let family = Family::from_formulas(&["x"], &["a"], &["x^2 - 2*x + 1 - a"]).unwrap();
    let fibre = fibre(&family, 2);
    let grid = Grid::new(&family, vec![axis("a", -1e-14, 1e-14, 2)], &NONE).unwrap();
    let found = sweep(&family, &fibre, &grid);
    assert_eq!(counts(&found), [0, 2]);
    assert!(found.cells.iter().all(|cell| cell.standing == Standing::Certified), "{:?}", found.cells);
    assert_eq!(found.breaks.iter().map(|b| (b.ended, b.kind)).collect::<Vec<_>>(), [([0, 2], BreakKind::Fold)]);
    let all = family.sweep(&fibre, &grid, &SweepOptions::new().certify(true)).unwrap();
    assert_eq!(all.cells, found.cells);
}

/// For `a = b = 0` all `(0, y)` are solutions.
#[test]
fn a_cell_with_a_line_of_solutions_is_doubtful() {
    let family = Family::from_formulas(&["x", "y"], &["a", "b"], &["x*y - a", "x*(y + 1) - b"]).unwrap();
    let fibre = fibre(&family, 1);
    let grid = Grid::new(&family, vec![axis("a", -1.0, 1.0, 3), axis("b", -2.0, 2.0, 3)], &NONE).unwrap();
    let found = sweep(&family, &fibre, &grid);
    let doubtful: Vec<usize> = (0..9).filter(|&k| !found.cells[k].standing.is_shown()).collect();
    assert_eq!((doubtful, found.doubtful()), (vec![4], 1));
    assert_eq!(found.cells[4].standing.doubt(), Some(&Doubt::Component { paths: 1 }));
}

#[test]
fn the_same_on_any_number_of_threads_and_with_every_cell_for_itself() {
    let family = parametron();
    let fibre = fibre(&family, 5);
    let grid = Grid::new(&family, vec![axis("w", 0.9, 1.1, 30), axis("l", 0.001, 0.1, 20)], &[("g", 0.01)]).unwrap();
    let on = |threads: usize| Run::new().threads(threads).unwrap().sweep(&family, &fibre, &grid, &SweepOptions::new());
    let one = on(1).unwrap();
    assert_eq!(on(3).unwrap(), one);
    // A factor that vanishes nowhere: cells are not tracked side by side then.
    let text = "name = ''\nunknowns = ['u', 'v']\nparameters = ['w', 'g', 'l']\nnonzero = ['u^2 + v^2 - 1e9']\n\
                equations = ['u*(u^2 + v^2) + (1 - w^2 - l)*u + g*w*v', 'v*(u^2 + v^2) + (1 - w^2 + l)*v - g*w*u']";
    let single = sweep(&text.parse().unwrap(), &fibre, &grid);
    assert_eq!((counts(&single), single.branches), (counts(&one), one.branches));
    assert_eq!(single.breaks, one.breaks);
    // And with one path for each pair of states of opposite phase.
    let text = format!("{text}\nsymmetry = [['-u', '-v']]");
    let symmetric: Family = text.parse().unwrap();
    let folded = symmetric.folded(fibre.clone());
    assert_eq!(folded.representatives.as_ref().map(Vec::len), Some(3));
    let half = sweep(&symmetric, &folded, &grid);
    assert_eq!((counts(&half), half.doubtful(), &half.breaks), (counts(&one), 0, &one.breaks));
}

#[test]
fn work_that_is_stopped_says_so() {
    let family = parametron();
    let fibre = fibre(&family, 5);
    let grid = Grid::new(&family, vec![axis("w", 0.9, 1.1, 9), axis("l", 0.001, 0.1, 9)], &[("g", 0.01)]).unwrap();
    let monitor = Monitor::watched();
    monitor.cancel();
    let found = Run::new().watched(&monitor).sweep(&family, &fibre, &grid, &SweepOptions::new()).unwrap();
    assert!(found.interrupted && found.cells.iter().all(|cell| cell.standing == Standing::Unreached));
    assert_eq!((found.doubtful(), found.branches), (0, 0));
}

#[test]
fn what_cannot_be_swept_is_refused() {
    let family = Family::from_formulas(&["x"], &["a"], &["x^2 - i*a"]).unwrap();
    let start = Fibre::new(vec![1.0.into()], 1, vec![num_complex::Complex64::new(0.5f64.sqrt(), 0.5f64.sqrt())]);
    let grid = Grid::new(&family, vec![axis("a", 0.0, 1.0, 3)], &NONE).unwrap();
    assert_eq!(family.sweep(&start, &grid, &SweepOptions::new()), Err(SweepError::NotReal));
    let other = parametron();
    let refused = other.sweep(&start, &grid, &SweepOptions::new());
    assert_eq!(refused, Err(SweepError::Misfit { found: 1, expected: 3 }));
    let grid = Grid::new(&other, vec![axis("w", 0.0, 1.0, 3)], &[("l", 1.0), ("g", 1.0)]).unwrap();
    assert!(matches!(other.sweep(&start, &grid, &SweepOptions::new()), Err(SweepError::Family(_))));
}
