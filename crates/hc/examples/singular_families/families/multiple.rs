//! Multiplicities to 32 and above, coranks to 5.

use super::case::Case;
use super::draw::{Draw, show};
use hc::poly::Complex64;

const ZERO: Complex64 = Complex64::ZERO;

/// `u^a; v^b`, of multiplicity `a b` to 32.
pub(super) fn two_unknowns(draw: &mut Draw) -> Case {
    let (u, v, at) = draw.cross();
    let a = draw.between(2, 6);
    let b = draw.between(2, 32 / a);
    Case::new(&[format!("{}^{a}", show(&u)), format!("{}^{b}", show(&v))]).with(&at, (a * b) as usize)
}

/// `u^a; v^b; w^c`, of multiplicity `a b c` to 32.
pub(super) fn three_unknowns(draw: &mut Draw) -> Case {
    let frame = draw.frame(3);
    let a = draw.between(2, 4);
    let b = draw.between(1, 16 / a);
    let c = draw.between(2, 32 / (a * b));
    let equations: Vec<String> = frame.texts().iter().zip([a, b, c]).map(|(u, power)| format!("{u}^{power}")).collect();
    Case::new(&equations).with(&frame.real_point(&[0.0; 3]), (a * b * c) as usize)
}

/// `(u^2 - s)^a` and `(v - b u)^c`, of multiplicity `a c` where `u` is a square root of `s`; or
/// `(u^2 - s)^a` and `(v^2 - u)^c`, of multiplicity `a c` where `v` is a root of `u`.
pub(super) fn irrational(draw: &mut Draw) -> Case {
    let frame = draw.frame(2);
    let texts = frame.texts();
    let (u, v) = (&texts[0], &texts[1]);
    let s = [2, 3, 5, 6, 7][draw.between(0, 4) as usize];
    let (a, c, b) = (draw.between(1, 4), draw.between(2, 3), draw.nonzero());
    let first = format!("({u}^2-{s})^{a}");
    let roots = [1.0, -1.0].map(|sign| Complex64::from(sign * f64::from(s).sqrt()));
    let (second, points) = if draw.coin() {
        (format!("({v}-({b})*{u})^{c}"), roots.map(|u| [u, u * b as f64]).to_vec())
    } else {
        let halves = roots.iter().flat_map(|&u| [[u, u.sqrt()], [u, -u.sqrt()]]);
        (format!("({v}^2-{u})^{c}"), halves.collect())
    };
    let case = Case::new(&[first, second]);
    points.iter().fold(case, |case, point| case.with_complex(frame.point(point), (a * c) as usize))
}

/// `y_i^2 = -s` where `s` is the sum of all `y`, for three to six unknowns.
///
/// All are `r` or `-r`, and `s = k r` with the sum `k` of the signs, so that `r = 0` or `r = -k`. A
/// choice of signs and its opposite give the same point, and the Jacobian, `2 y_i` in the diagonal
/// and ones besides, has the determinant `(1 + k / (2 r)) prod 2 y_i`, half of the product: one
/// simple point for two choices with `k` not 0, and the origin has the rest of the `2^n` (none is at
/// infinity, where `y_i^2 = 0`).
pub(super) fn equal_squares(draw: &mut Draw) -> Case {
    let n = draw.between(3, 6) as usize;
    let (frame, plain) = (draw.frame(n), draw.coin() || n > 5);
    // With x = 1 + y these are x_i^2 + sum x - 2 x_i - (n - 1).
    let texts = if plain { (0..n).map(|i| format!("(x{i}-1)")).collect() } else { frame.texts() };
    let place = |y: &[f64]| if plain { y.iter().map(|y| y + 1.0).collect() } else { frame.real_point(y) };
    let sum = texts.join("+");
    let equations: Vec<String> = texts.iter().map(|y| format!("{y}^2+{sum}")).collect();
    let mut points = Vec::new();
    // The first sign is positive.
    for signs in 0..1u32 << (n - 1) {
        let signs: Vec<f64> = (0..n).map(|i| 1.0 - 2.0 * f64::from(signs >> i & 1)).collect();
        let k: f64 = signs.iter().sum();
        if k != 0.0 {
            points.push(place(&signs.iter().map(|sign| -k * sign).collect::<Vec<f64>>()));
        }
    }
    Case::new(&equations).with(&place(&vec![0.0; n]), (1 << n) - points.len()).with_simple(&points)
}

/// `u^a = v w`, `v^a = u w`, `w^a = u v` for `a` = 3 or 4.
///
/// If one is zero, all are. Otherwise `u^(a+1) = v^(a+1) = w^(a+1) = u v w = p` and
/// `p^(a+1) = p^3`: `p` is one of `a - 2` roots of unity, `u` and `v` are any roots of it and
/// `w = p / (u v)` is one. These `(a - 2) (a + 1)^2` are simple, since the exponents have just this
/// determinant; the origin has the rest of the `a^3`.
pub(super) fn powers_equal_products(draw: &mut Draw) -> Case {
    let (frame, a) = (draw.frame(3), draw.between(3, 4));
    let texts = frame.texts();
    let equation = |i: usize| format!("{}^{a}-{}*{}", texts[i], texts[(i + 1) % 3], texts[(i + 2) % 3]);
    let turn = |part: f64| Complex64::from_polar(1.0, std::f64::consts::TAU * part);
    let (a, order) = (a as usize, a as usize + 1);
    let mut case = Case::new(&[0, 1, 2].map(equation));
    for p in 0..a - 2 {
        let p = p as f64 / (a - 2) as f64;
        let root = |k: usize| turn((p + k as f64) / order as f64);
        for (j, k) in (0..order * order).map(|jk| (jk / order, jk % order)) {
            let point = [root(j), root(k), turn(p) / (root(j) * root(k))];
            case = case.with_complex(frame.point(&point), 1);
        }
    }
    case.with_complex(frame.point(&[ZERO; 3]), a.pow(3) - (a - 2) * order * order)
}

/// `y_1^2`, and `y_i^2 + a y_i y_(i-1) + b y_(i-1)^2` with multiples of those before: all are zero
/// one after the other, and forms of degree two that vanish only there have the multiplicity `2^C`.
pub(super) fn corank<const C: usize>(draw: &mut Draw) -> Case {
    let frame = draw.frame(C);
    let y = frame.texts();
    let mut equations = vec![format!("{}^2", y[0])];
    for i in 1..C {
        let (a, b, c) = (draw.between(-3, 3), draw.between(-3, 3), draw.between(-2, 2));
        let before = &equations[i - 1];
        equations.push(format!("{0}^2+({a})*{0}*{1}+({b})*{1}^2+({c})*({before})", y[i], y[i - 1]));
    }
    Case::new(&equations).with(&frame.real_point(&[0.0; C]), 1 << C)
}

/// `y_1^2 (y_1 - s)`, and `(y_i - a y_(i-1)) (y_i - b y_(i-1))` with different `a`, `b`, not zero:
/// the origin is as above, and where `y_1 = s` each next one is one of two.
pub(super) fn corank_beside_regular<const C: usize>(draw: &mut Draw) -> Case {
    let (frame, s) = (draw.frame(C), draw.nonzero_to(2));
    let y = frame.texts();
    let mut equations = vec![format!("{0}^2*({0}-({s}))", y[0])];
    let mut points = vec![vec![s as f64]];
    for i in 1..C {
        let (a, b) = (draw.between(1, 2), -draw.between(1, 2));
        equations.push(format!("{0}^2+({1})*{0}*{2}+({3})*{2}^2", y[i], -a - b, y[i - 1], a * b));
        let next = |point: Vec<f64>| [a, b].map(|factor| [&point[..], &[point[i - 1] * factor as f64]].concat());
        points = points.into_iter().flat_map(next).collect();
    }
    let points: Vec<Vec<f64>> = points.iter().map(|point| frame.real_point(point)).collect();
    Case::new(&equations).with(&frame.real_point(&[0.0; C]), 1 << C).with_simple(&points)
}
