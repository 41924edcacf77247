//! Systems whose coefficients or solutions differ by many powers of ten, so that doubles do not tell what the equations
//! say exactly.

use super::case::Case;
use super::draw::{Draw, meet, show};

/// Two points by two equations, and a third that vanishes at one of them: at the other it is as small as 1e-60. Or a
/// third that vanishes at none of two irrational points.
pub(super) fn nearly_consistent(draw: &mut Draw) -> Case {
    let (e, frame) = (draw.between(12, 60), draw.frame(2));
    let texts = frame.texts();
    let (u, v) = (&texts[0], &texts[1]);
    if draw.coin() {
        let d = [2, 3, 5, 7][draw.between(0, 3) as usize];
        let third = format!("{u}*{v}-{d}-({})*1E-{e}", draw.nonzero());
        return Case::new(&[format!("{u}^2-{d}"), format!("{v}-{u}"), third]).in_unknowns(2);
    }
    let (a, b, c) = (draw.nonzero(), draw.nonzero(), draw.nonzero());
    let third = format!("({})*({v}-({c}))^2+({})*1E-{e}*({u}-({a}))", draw.nonzero(), draw.nonzero());
    Case::new(&[format!("({u}-({a}))*({u}-({}))", if a == b { b + 7 } else { b }), format!("{v}-({c})"), third])
        .in_unknowns(2)
        .with(&frame.real_point(&[a as f64, c as f64]), 1)
}

/// `(x - a) (b x / 10^e - 1)` and the like, in two or three unknowns: all choices of a root in each.
pub(super) fn far(draw: &mut Draw) -> Case {
    let n = draw.between(2, 3) as usize;
    let mut roots: Vec<[f64; 2]> = Vec::new();
    let mut texts = Vec::new();
    for (k, x) in ["x", "y", "z"].into_iter().take(n).enumerate() {
        let (a, b, e) = (draw.nonzero(), draw.nonzero(), draw.between(6, 30) as i32);
        // An equation before it, times another unknown, changes no solution.
        let before: String = if k > 0 { format!("+({})*({})", draw.nonzero(), texts[k - 1]) } else { String::new() };
        texts.push(format!("({x}-({a}))*(({b})*1E-{e}*{x}-1){before}"));
        roots.push([a as f64, 10f64.powi(e) / b as f64]);
    }
    let points = (0..1usize << n).map(|k| (0..n).map(|j| roots[j][k >> j & 1]).collect::<Vec<f64>>());
    points.fold(Case::new(&texts), |case, point| case.with(&point, 1))
}

/// `x^3 / 10^e + x^2 - a` and `y^3 / 10^f + y^2 - b - c x`: nine simple solutions, of three sizes or more. By the
/// theorem on rational roots no root of the first makes the discriminant of the second vanish.
pub(super) fn far_irrational(draw: &mut Draw) -> Case {
    let (e, f) = (draw.between(8, 30), draw.between(8, 30));
    let [a, b] = std::array::from_fn(|_| [2, 3, 5, 7][draw.between(0, 3) as usize]);
    Case::new(&[format!("1E-{e}*x^3+x^2-{a}"), format!("1E-{f}*y^3+y^2-{b}-({})*x", draw.nonzero())])
        .with_others(&[1; 9])
}

/// `p^2 (p - 10^-e)` for an irreducible quadratic `p` in `z`, and `x` and `y` by `z`: two double solutions and two
/// simple ones beside them; or `p^2 - 10^-e` with four simple ones.
pub(super) fn irrational_pairs(draw: &mut Draw) -> Case {
    let (e, k) = (draw.between(8, 60), draw.between(1, 3));
    let p = format!("(z^2-{}*z-1)", 2 * k - 1);
    let (first, others): (String, &[usize]) =
        if draw.coin() { (format!("{p}^2*({p}-1E-{e})"), &[1, 1, 2, 2]) } else { (format!("{p}^2-1E-{e}"), &[1; 4]) };
    Case::new(&[first, "y*z-1".to_owned(), format!("x*z-({})", draw.nonzero())]).with_others(others)
}

/// `l a; l b + 10^-e c; l d + 10^-e f` with planes: four points and no component, though there would be one without the
/// small terms.
pub(super) fn nearly_a_component(draw: &mut Draw) -> Case {
    let e = draw.between(8, 40);
    loop {
        let [l, a, b, c, d, f] = std::array::from_fn(|_| (0..4).map(|_| draw.nonzero()).collect::<Vec<i128>>());
        let [tl, ta, tb, tc, td, tf] = [&l, &a, &b, &c, &d, &f].map(|form| show(form));
        // One solution where l, c and f vanish, one near that of a, b and d, and two near the line of l and a, where
        // c d = b f.
        let [Some(p), Some(q), Some(_), Some(_)] =
            [[&l, &a, &b], [&l, &a, &d], [&l, &c, &f], [&a, &b, &d]].map(|three| meet(&three))
        else {
            continue;
        };
        let at =
            |form: &[i128], p: &[f64]| p.iter().zip(form).map(|(x, &c)| x * c as f64).sum::<f64>() + form[3] as f64;
        let [c0, d0, b0, f0] = [&c, &d, &b, &f].map(|form| at(form, &p));
        let [c1, d1, b1, f1] = [&c, &d, &b, &f].map(|form| at(form, &q));
        let (c1, d1, b1, f1) = (c1 - c0, d1 - d0, b1 - b0, f1 - f0);
        let [leading, linear, constant] = [c1 * d1 - b1 * f1, c0 * d1 + c1 * d0 - b0 * f1 - b1 * f0, c0 * d0 - b0 * f0];
        let discriminant = linear * linear - 4.0 * leading * constant;
        if leading.abs() > 1e-3 && discriminant.abs() > 1e-3 {
            let small = |plane: &str| format!("1E-{e}*{plane}");
            let texts =
                [format!("{tl}*{ta}"), format!("{tl}*{tb}+{}", small(&tc)), format!("{tl}*{td}+{}", small(&tf))];
            return Case::new(&texts).with_others(&[1; 4]);
        }
    }
}

/// `(x - a)^2 + 10^-2e` or `(x - a)^2 - 10^-2e`, with `y` by `x`: two solutions, none of them real or both.
pub(super) fn nearly_real(draw: &mut Draw) -> Case {
    let (e, a, is_real) = (draw.between(5, 12), draw.nonzero(), draw.coin());
    let sign = if is_real { '-' } else { '+' };
    let texts = [format!("(x-({a}))^2{sign}1E-{}", 2 * e), format!("y^2-({})*x*y+{}*x^2", 2 + a.abs(), 1 + a.abs())];
    // (y - x) (y - (1 + |a|) x)
    Case::new(&texts).with_others(&[1; 4]).with_real(if is_real { 4 } else { 0 })
}
