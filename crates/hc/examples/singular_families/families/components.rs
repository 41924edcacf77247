//! Components of positive dimension beside isolated solutions.

use super::case::Case;
use super::draw::{Draw, apart, meets, show};

/// `g^k l1 l2; g^k l3 l4`: four points and a multiple line.
pub(super) fn not_reduced(draw: &mut Draw) -> Case {
    loop {
        let (g, k) = (draw.line(), draw.between(2, 3));
        let [a, b, c, d] = std::array::from_fn(|_| draw.line());
        let texts = [[&a, &b], [&c, &d]].map(|[a, b]| format!("{}^{k}*{}*{}", show(&g), show(a), show(b)));
        let on = |p: &Vec<f64>| (g[0] as f64 * p[0] + g[1] as f64 * p[1] + g[2] as f64).abs() < 1e-2;
        let Some(points) = meets(&[vec![a, b], vec![c, d]]) else { continue };
        if apart(&points) && !points.iter().any(on) {
            return Case::new(&texts).with_simple(&points).with_component();
        }
    }
}

/// `(u - e) g; v g` with a circle `g` through the point where `u` and `v` vanish.
pub(super) fn near(draw: &mut Draw) -> Case {
    let k = draw.between(3, 7);
    let (c, at) = (draw.nonzero(), [draw.between(-2, 2), draw.between(-2, 2)]);
    // The circle through `at` about (at + (c, 0)).
    let circle = format!("((x-({}))^2+(y-({}))^2-({c})^2)", at[0] + c, at[1]);
    Case::new(&[format!("(x-({})+1E-{k})*{circle}", at[0]), format!("(y-({}))*{circle}", at[1])])
        .with(&[at[0] as f64 - 10f64.powi(-k as i32), at[1] as f64], 1)
        .with_component()
}

/// The line `u = 0` with an embedded point (`u^2; u v`), or with two embedded points and two
/// isolated ones where `u = a` (`u^2 (u - a); u v (v - b)`), or with an isolated one and no
/// embedded one (`u (u - a); u (v - b)`).
pub(super) fn embedded(draw: &mut Draw) -> Case {
    let (frame, a, b) = (draw.frame(2), draw.nonzero(), draw.nonzero());
    let texts = frame.texts();
    let (u, v) = (&texts[0], &texts[1]);
    let point = |v: i128| frame.real_point(&[a as f64, v as f64]);
    let case = match draw.between(0, 2) {
        0 => Case::new(&[format!("{u}^2"), format!("{u}*{v}")]),
        1 => Case::new(&[format!("{u}^2*({u}-({a}))"), format!("{u}*{v}*({v}-({b}))")])
            .with_simple(&[point(0), point(b)]),
        _ => Case::new(&[format!("{u}*({u}-({a}))"), format!("{u}*({v}-({b}))")]).with_simple(&[point(b)]),
    };
    case.with_component()
}
