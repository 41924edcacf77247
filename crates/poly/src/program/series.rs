//! Taylor arithmetic on coefficients that stay in memory.
//!
//! Four columns hold the coefficients of orders 0 to 3 of every operand and every result. Each function computes
//! coefficients `FROM ..= TO` of result `t` from those of its operands and relies on the result's
//! coefficients below `FROM`. `TO` is the order asked for, at which the unknowns' coefficients are zero: products
//! with an unknown leave out what vanishes. Formulas: Griewank and Walther, *Evaluating Derivatives*, chapter 13.

use crate::scalar::Scalar;

/// Coefficients kept for each value: orders 0 to 3.
pub(crate) const WIDTH: usize = 4;

/// Coefficients of equal order side by side.
pub(crate) type Columns<'a, S> = [&'a mut [S]; WIDTH];

/// Neither factor is known to be an unknown.
pub(crate) const GENERAL: u8 = 0;
/// The second factor is an unknown.
pub(crate) const BY_UNKNOWN: u8 = 1;
/// Both factors are unknowns.
pub(crate) const UNKNOWNS: u8 = 2;

/// Coefficient `k` of the product of values `a` and `b`; `top` says that their unknowns' coefficient is zero.
#[inline(always)]
fn product<S: Scalar, const KIND: u8>(m: &Columns<'_, S>, a: usize, b: usize, k: usize, top: bool) -> S {
    let kind = if top { KIND } else { GENERAL };
    let term = |i: usize| (&m[i][a], &m[k - i][b]);
    let one = |i: usize| {
        let (x, y) = term(i);
        S::mul(x, y)
    };
    let two = |i: usize, j: usize| {
        let ((x, y), (z, w)) = (term(i), term(j));
        S::mul_mul_add(x, y, z, w)
    };
    // Term i pairs coefficient i of `a` with coefficient k - i of `b`.
    match (k, kind) {
        (0, _) => one(0),
        (1, GENERAL) => two(0, 1),
        (1, BY_UNKNOWN) => one(1),
        (1, _) => S::zero(),
        (2, GENERAL) => S::add(&two(0, 2), &one(1)),
        (2, BY_UNKNOWN) => two(1, 2),
        (2, _) => one(1),
        (_, GENERAL) => S::add(&two(0, 3), &two(1, 2)),
        (_, BY_UNKNOWN) => S::add(&two(1, 2), &one(3)),
        _ => two(1, 2),
    }
}

/// Coefficient `k` of a square.
#[inline(always)]
fn square<S: Scalar, const KIND: u8>(m: &Columns<'_, S>, a: usize, k: usize, top: bool) -> S {
    let double = |z: &S| S::add(z, z);
    match (k, if top { KIND } else { GENERAL }) {
        (0, _) => S::sqr(&m[0][a]),
        (1, GENERAL) => double(&S::mul(&m[0][a], &m[1][a])),
        (1, _) => S::zero(),
        (2, GENERAL) => S::add(&double(&S::mul(&m[0][a], &m[2][a])), &S::sqr(&m[1][a])),
        (2, _) => S::sqr(&m[1][a]),
        (_, GENERAL) => double(&S::mul_mul_add(&m[0][a], &m[3][a], &m[1][a], &m[2][a])),
        _ => double(&S::mul(&m[1][a], &m[2][a])),
    }
}

/// Coefficient `k` of the reciprocal of `a` from those below at `r`:
/// `r_0 = 1/a_0`, `r_k = -r_0 * sum_{j<k} r_j a_{k-j}`.
#[inline(always)]
fn reciprocal<S: Scalar>(m: &Columns<'_, S>, r: usize, a: usize, k: usize) -> S {
    let sum = match k {
        0 => return S::inv(&m[0][a]),
        1 => S::mul(&m[0][r], &m[1][a]),
        2 => S::mul_mul_add(&m[0][r], &m[2][a], &m[1][r], &m[1][a]),
        _ => S::mul_add(&m[2][r], &m[1][a], &S::mul_mul_add(&m[0][r], &m[3][a], &m[1][r], &m[2][a])),
    };
    S::neg(&S::mul(&m[0][r], &sum))
}

/// An operation of [`Op`](super::Op) on series.
#[inline(always)]
pub(crate) fn step<S: Scalar, const FROM: usize, const TO: usize, const KIND: u8>(
    m: &mut Columns<'_, S>,
    op: super::Op,
    t: usize,
    [a, b, c, d]: [usize; 4],
) {
    use super::Op;
    // The operation is chosen once, outside the loop over coefficients.
    macro_rules! each {
        ($k:ident => $value:expr) => {
            for $k in FROM..=TO {
                let value = $value;
                m[$k][t] = value;
            }
        };
    }
    match op {
        Op::Add => each!(k => S::add(&m[k][a], &m[k][b])),
        Op::Sub => each!(k => S::sub(&m[k][a], &m[k][b])),
        Op::Neg => each!(k => S::neg(&m[k][a])),
        Op::Mul => each!(k => product::<S, KIND>(m, a, b, k, k == TO)),
        Op::MulReal => each!(k => S::mul_real(&m[k][a], &m[0][b])),
        Op::Sqr => each!(k => square::<S, KIND>(m, a, k, k == TO)),
        Op::Inv => each!(k => reciprocal(m, t, a, k)),
        Op::MulAdd => each!(k => S::add(&product::<S, KIND>(m, a, b, k, k == TO), &m[k][c])),
        Op::MulSub => each!(k => S::sub(&product::<S, KIND>(m, a, b, k, k == TO), &m[k][c])),
        Op::SubMul => each!(k => S::sub(&m[k][c], &product::<S, KIND>(m, a, b, k, k == TO))),
        Op::MulRealAdd => each!(k => S::mul_real_add(&m[k][a], &m[0][b], &m[k][c])),
        Op::MulMulAdd => each!(k => S::add(
            &product::<S, KIND>(m, a, b, k, k == TO),
            &product::<S, KIND>(m, c, d, k, k == TO),
        )),
        Op::MulMulSub => each!(k => S::sub(
            &product::<S, KIND>(m, a, b, k, k == TO),
            &product::<S, KIND>(m, c, d, k, k == TO),
        )),
    }
}
