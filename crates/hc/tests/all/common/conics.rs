//! Conics through points and tangent to conics, as a parameter family. The example `steiner` uses
//! this file too.
//!
//! The conic is `a x^2 + b x y + c y^2 + d x + e y + 1`. Through `5 - k` points and tangent to `k`
//! conics in general position there are 1, 6, 36, 184, 816, 3264 smooth conics for `k` = 0 .. 5
//! (Chasles 1864): in the ring of conditions `p^(5-k) (2 p + 2 l)^k` with `p^5 = l^5 = 1`,
//! `p^4 l = p l^4 = 2`, `p^3 l^2 = p^2 l^3 = 4`.

use hc::poly::{Expr, Expressions, System};

/// What [`tangent_conics`] must have regular solutions for generic parameters, by the number of
/// given conics.
#[allow(dead_code, reason = "not every user needs it")]
pub(crate) const COUNTS: [usize; 6] = [1, 6, 36, 184, 816, 3264];

/// `5 + 2 k` equations in the coefficients of the conic and the points of tangency with `k` conics;
/// parameters are the coordinates of `5 - k` points, then six coefficients a conic.
pub(crate) fn tangent_conics(k: usize) -> System {
    System::build(|s| {
        let sought: Vec<Expr<'_>> = ["a", "b", "c", "d", "e"].iter().map(|name| s.variable(name)).collect();
        let conic = [&sought[..], &[s.constant(1)]].concat();
        let mut equations = Vec::new();
        for i in 1..=5 - k {
            let [x, y] = ["p", "q"].map(|name| s.parameter(&format!("{name}{i}")));
            equations.push(value(s, &conic, x, y));
        }
        for i in 1..=k {
            let [x, y] = ["x", "y"].map(|name| s.variable(&format!("{name}{i}")));
            let given: Vec<Expr<'_>> = (0..6).map(|j| s.parameter(&format!("g{i}{j}"))).collect();
            let ([f, g], [u, v]) = (slopes(&conic, x, y), slopes(&given, x, y));
            equations.extend([value(s, &conic, x, y), value(s, &given, x, y), f * v - g * u]);
        }
        equations
    })
    .expect("names and constants are sound")
}

/// The form of a conic with the given coefficients at a point.
fn value<'a>(s: &'a Expressions, c: &[Expr<'a>], x: Expr<'a>, y: Expr<'a>) -> Expr<'a> {
    let terms: [Expr<'a>; 6] = [x * x, x * y, y * y, x, y, s.constant(1)];
    s.sum(c.iter().zip(terms).map(|(&c, term)| c * term))
}

/// Its gradient.
fn slopes<'a>(c: &[Expr<'a>], x: Expr<'a>, y: Expr<'a>) -> [Expr<'a>; 2] {
    [2 * c[0] * x + c[1] * y + c[3], c[1] * x + 2 * c[2] * y + c[4]]
}
