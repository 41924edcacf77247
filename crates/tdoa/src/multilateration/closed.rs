//! A node from as many sights as determine it. `at(k)` is the known node's position and the length of
//! sight `k`.

use std::array::from_fn;

use crate::points::{dot, minus, off};

/// A transmitter and its offset from D + 1 receivers; lengths are pseudoranges.
///
/// With the first receiver as origin and p = o - f_1 = -|s|, the differences of the squared equations
/// are linear, u_k . s = (|u_k|^2 - d_k^2) / 2 + d_k p with d_k = f_k - f_1 (Bancroft 1985). They give
/// a line of solutions linear in p, and |s|^2 = p^2 a quadratic for p; both roots with f_1 - o >= 0
/// are given.
pub(super) fn transmitter<const D: usize>(at: impl Fn(usize) -> ([f64; D], f64)) -> [Option<([f64; D], f64)>; 2] {
    let (origin, length) = at(0);
    let rows: [[f64; D]; D] = from_fn(|k| minus(at(k + 1).0, origin));
    let differences: [f64; D] = from_fn(|k| at(k + 1).1 - length);
    let halves = from_fn(|k| 0.5 * (dot(rows[k], rows[k]) - differences[k] * differences[k]));
    // Subsets in line, or in one plane, are as good as useless; others of the list will do better.
    let Some([alpha, beta]) = solve(rows, [halves, differences]) else { return [None, None] };
    // |alpha + beta p|^2 = p^2 with p = o - f_1 = -distance.
    let roots = quadratic(dot(beta, beta) - 1.0, dot(alpha, beta), dot(alpha, alpha));
    roots.map(|root| {
        let p = root.filter(|p| p.is_finite())?;
        let s: [f64; D] = from_fn(|k| alpha[k] + beta[k] * p);
        Some((from_fn(|k| origin[k] + s[k]), length + p.min(0.0)))
    })
}

/// A receiver from D transmitters, and its mirror image; lengths are distances. Circles or spheres
/// that do not meet get the point between them.
pub(super) fn receiver<const D: usize>(at: impl Fn(usize) -> ([f64; D], f64)) -> [Option<[f64; D]>; 2] {
    if D == 2 { receiver_in_plane(at) } else { receiver_off_hyperplane(at) }
}

/// By the law of cosines.
fn receiver_in_plane<const D: usize>(at: impl Fn(usize) -> ([f64; D], f64)) -> [Option<[f64; D]>; 2] {
    let ((a, to_a), (b, to_b)) = (at(0), at(1));
    let axis = minus(b, a);
    let base = dot(axis, axis).sqrt();
    if base.is_nan() || base <= 0.0 {
        return [None, None];
    }
    let along = ((to_a * to_a - to_b * to_b) / base + base) / 2.0;
    let across = (to_a * to_a - along * along).max(0.0).sqrt();
    let e = [axis[0] / base, axis[1] / base];
    let place = |h: f64| {
        let point = [a[0] + e[0] * along - e[1] * h, a[1] + e[1] * along + e[0] * h];
        from_fn(|k| point[k])
    };
    [Some(place(across)), if across > 0.0 { Some(place(-across)) } else { None }]
}

/// In any dimension: the foot in the hyperplane of the transmitters by its linear equations u_k . x =
/// (|u_k|^2 + l_1^2 - l_k^2) / 2 in an orthonormal basis of the u_k (Gram-Schmidt), then the height
/// above it.
fn receiver_off_hyperplane<const D: usize>(at: impl Fn(usize) -> ([f64; D], f64)) -> [Option<[f64; D]>; 2] {
    let (origin, length) = at(0);
    let mut basis = [[0.0; D]; D];
    let mut foot = [0.0; D];
    for k in 1..D {
        let (position, other) = at(k);
        let u = minus(position, origin);
        let (across, size) = off(u, &basis[..k - 1]);
        if size.is_nan() || size <= FLAT * dot(u, u).sqrt() {
            return [None, None];
        }
        let right = 0.5 * (dot(u, u) + length * length - other * other);
        let along = (right - dot(u, foot)) / size;
        basis[k - 1] = across;
        foot = from_fn(|l| foot[l] + along * across[l]);
    }
    // What is left of the unit vector that is farthest off the hyperplane.
    let normals = (0..D).map(|axis| off(from_fn(|l| f64::from(u8::from(l == axis))), &basis[..D - 1]));
    let Some((normal, _)) = normals.max_by(|a, b| a.1.total_cmp(&b.1)) else { return [None, None] };
    let height = (length * length - dot(foot, foot)).max(0.0).sqrt();
    let place = |h: f64| from_fn(|k| origin[k] + foot[k] + h * normal[k]);
    [Some(place(height)), if height > 0.0 { Some(place(-height)) } else { None }]
}

/// Share of a vector's length below which what is left of it is rounding.
const FLAT: f64 = 1e-9;

/// Solves for two right-hand sides; `None` if the rows hardly differ.
fn solve<const D: usize>(rows: [[f64; D]; D], right: [[f64; D]; 2]) -> Option<[[f64; D]; 2]> {
    if D == 2 { cramer(&rows, &right) } else { eliminate(rows, right) }
}

/// Two equations by Cramer's rule.
fn cramer<const D: usize>(rows: &[[f64; D]; D], right: &[[f64; D]; 2]) -> Option<[[f64; D]; 2]> {
    let (u, v) = (rows[0], rows[1]);
    let det = u[0] * v[1] - u[1] * v[0];
    if det.abs() <= FLAT * (dot(u, u) + dot(v, v)) {
        return None;
    }
    Some(right.map(|r| {
        let (x, y) = (r[0], r[1]);
        let solution = [(x * v[1] - y * u[1]) / det, (u[0] * y - v[0] * x) / det];
        from_fn(|k| solution[k])
    }))
}

/// Gaussian elimination with row pivots.
fn eliminate<const D: usize>(mut rows: [[f64; D]; D], mut right: [[f64; D]; 2]) -> Option<[[f64; D]; 2]> {
    let largest = rows.iter().map(|&row| dot(row, row).sqrt()).fold(0.0, f64::max);
    for k in 0..D {
        let pivot = (k..D).max_by(|&a, &b| rows[a][k].abs().total_cmp(&rows[b][k].abs()))?;
        rows.swap(k, pivot);
        right.iter_mut().for_each(|r| r.swap(k, pivot));
        let size = rows[k][k].abs();
        if size.is_nan() || size <= FLAT * largest {
            return None;
        }
        for l in k + 1..D {
            let factor = rows[l][k] / rows[k][k];
            for column in k..D {
                rows[l][column] -= factor * rows[k][column];
            }
            right.iter_mut().for_each(|r| r[l] -= factor * r[k]);
        }
    }
    for k in (0..D).rev() {
        for r in &mut right {
            let known: f64 = (k + 1..D).map(|l| rows[k][l] * r[l]).sum();
            r[k] = (r[k] - known) / rows[k][k];
        }
    }
    Some(right)
}

/// Real roots of a x^2 + 2 b x + c, or the real part of a complex pair: with noise a double root
/// may become one.
fn quadratic(a: f64, b: f64, c: f64) -> [Option<f64>; 2] {
    let disc = (b * b - a * c).max(0.0).sqrt();
    let q = -(b + if b >= 0.0 { disc } else { -disc });
    let first = if a == 0.0 { None } else { Some(q / a) };
    let second = if q == 0.0 { None } else { Some(if disc > 0.0 { c / q } else { q / a }) };
    [first, second]
}
