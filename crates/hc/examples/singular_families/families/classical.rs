//! Mignotte's, Wilkinson's and Chebyshev's polynomials, alone and beside a curve.

use super::case::Case;
use super::draw::Draw;

/// `x^n - 2 (a x - 1)^2`, irreducible (Eisenstein at 2), and its two roots near `1/a`:
/// `x = (1 + x^(n/2) / sqrt 2) / a` and the same with a minus.
struct Mignotte {
    n: usize,
    a: i128,
    expanded: bool,
}

impl Mignotte {
    fn draw(draw: &mut Draw) -> Mignotte {
        let largest = 10i128.pow(draw.between(1, 3) as u32);
        Mignotte { n: draw.between(7, 25) as usize, a: draw.between(10, largest), expanded: draw.coin() }
    }

    fn text(&self, x: &str) -> String {
        let (n, a) = (self.n, self.a);
        if self.expanded {
            format!("{x}^{n}-{}*{x}^2+{}*{x}-2", 2 * a * a, 4 * a)
        } else {
            format!("{x}^{n}-2*({a}*{x}-1)^2")
        }
    }

    /// The two roots near `1/a`. The steps shrink at least thirty times each.
    fn close(&self) -> [f64; 2] {
        let a = self.a as f64;
        let step = |sign: f64, x: f64| (1.0 + sign * (x.powi(self.n as i32) / 2.0).sqrt()) / a;
        [1.0, -1.0].map(|sign| (0..20).fold(1.0 / a, |x, _| step(sign, x)))
    }
}

/// `n` simple roots.
pub(super) fn mignotte(draw: &mut Draw) -> Case {
    let f = Mignotte::draw(draw);
    Case::new(&[f.text("x")]).with_simple(&f.close().map(|x| vec![x])).with_others(&vec![1; f.n - 2])
}

/// In `x` beside a parabola, or in `x + y` beside a line that this is a coordinate of.
pub(super) fn mignotte_beside_a_curve(draw: &mut Draw) -> Case {
    let (f, c) = (Mignotte::draw(draw), draw.between(-3, 3));
    let (equations, points) = if draw.coin() {
        ([f.text("x"), format!("y-x^2+({c})")], f.close().map(|x| vec![x, x * x - c as f64]))
    } else {
        let c = c as f64;
        // x = 2 y + c and x + y = t.
        let point = |t: f64| vec![(2.0 * t + c) / 3.0, (t - c) / 3.0];
        ([f.text("(x+y)"), format!("x-2*y-({c})")], f.close().map(point))
    };
    Case::new(&equations).with_simple(&points).with_others(&vec![1; f.n - 2])
}

/// `(d x - 1) ... (d x - n)` for `d` = 1 or 2, and its roots.
fn wilkinson_polynomial(draw: &mut Draw) -> (String, Vec<f64>) {
    let (n, d) = (draw.between(8, 20), draw.between(1, 2));
    let factors: Vec<String> = (1..=n).map(|k| format!("({d}*x-{k})")).collect();
    (factors.join("*"), (1..=n).map(|k| k as f64 / d as f64).collect())
}

/// Integer or half-integer roots.
pub(super) fn wilkinson(draw: &mut Draw) -> Case {
    let (f, roots) = wilkinson_polynomial(draw);
    Case::new(&[f]).with_simple(&roots.iter().map(|&x| vec![x]).collect::<Vec<_>>())
}

/// Beside a line or a parabola.
pub(super) fn wilkinson_beside_a_curve(draw: &mut Draw) -> Case {
    let (f, roots) = wilkinson_polynomial(draw);
    let (power, b, c) = (draw.between(1, 2), draw.nonzero_to(3), draw.between(-3, 3));
    let y = |x: f64| b as f64 * x.powi(power as i32) + c as f64;
    let points: Vec<Vec<f64>> = roots.iter().map(|&x| vec![x, y(x)]).collect();
    Case::new(&[f, format!("y-({b})*x^{power}-({c})")]).with_simple(&points)
}

/// Chebyshev's polynomial of degree one to seven.
fn t(n: usize, x: &str) -> String {
    match n {
        1 => x.to_owned(),
        2 => format!("(2*{x}^2-1)"),
        3 => format!("(4*{x}^3-3*{x})"),
        4 => format!("(8*{x}^4-8*{x}^2+1)"),
        5 => format!("(16*{x}^5-20*{x}^3+5*{x})"),
        6 => format!("(32*{x}^6-48*{x}^4+18*{x}^2-1)"),
        _ => format!("(64*{x}^7-112*{x}^5+56*{x}^3-7*{x})"),
    }
}

/// `T_a(T_b)`, of degree 10 to 49, and `(2 k - 1) pi / (2 a b)`, of which the roots are cosines.
fn chebyshev_polynomial(draw: &mut Draw) -> (String, Vec<f64>) {
    loop {
        let (a, b) = (draw.between(2, 7) as usize, draw.between(2, 7) as usize);
        if a * b >= 10 {
            let angle = |k: usize| (2 * k + 1) as f64 * std::f64::consts::PI / (2 * a * b) as f64;
            return (t(a, &t(b, "x")), (0..a * b).map(angle).collect());
        }
    }
}

/// Real roots, between -1 and 1.
pub(super) fn chebyshev(draw: &mut Draw) -> Case {
    let (f, angles) = chebyshev_polynomial(draw);
    Case::new(&[f]).with_simple(&angles.iter().map(|angle| vec![angle.cos()]).collect::<Vec<_>>())
}

/// Beside `y = T_m(x)`.
pub(super) fn chebyshev_beside_a_curve(draw: &mut Draw) -> Case {
    let ((f, angles), m) = (chebyshev_polynomial(draw), draw.between(1, 4) as usize);
    let point = |angle: &f64| vec![angle.cos(), (m as f64 * angle).cos()];
    Case::new(&[f, format!("y-{}", t(m, "x"))]).with_simple(&angles.iter().map(point).collect::<Vec<_>>())
}
