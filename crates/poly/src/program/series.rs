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

// Helpers are functions that are always inlined, not closures: a closure that the compiler leaves out of line would
// be compiled without the instruction set of its caller.

/// Term `i` of coefficient `i + j` of a product: `a_i b_j`.
#[inline(always)]
fn one<S: Scalar>(m: &Columns<'_, S>, a: usize, b: usize, i: usize, j: usize) -> S {
    S::mul(&m[i][a], &m[j][b])
}

/// `a_i b_j + a_j b_i`
#[inline(always)]
fn two<S: Scalar>(m: &Columns<'_, S>, a: usize, b: usize, i: usize, j: usize) -> S {
    S::mul_mul_add(&m[i][a], &m[j][b], &m[j][a], &m[i][b])
}

#[inline(always)]
fn double<S: Scalar>(z: &S) -> S {
    S::add(z, z)
}

/// Coefficient `k` of the product of values `a` and `b`; `top` says that their unknowns' coefficient is zero.
#[inline(always)]
fn product<S: Scalar, const KIND: u8>(m: &Columns<'_, S>, a: usize, b: usize, k: usize, top: bool) -> S {
    match (k, if top { KIND } else { GENERAL }) {
        (0, _) => one(m, a, b, 0, 0),
        (1, GENERAL) => two(m, a, b, 0, 1),
        (1, BY_UNKNOWN) => one(m, a, b, 1, 0),
        (1, _) => S::zero(),
        (2, GENERAL) => S::add(&two(m, a, b, 0, 2), &one(m, a, b, 1, 1)),
        (2, BY_UNKNOWN) => S::mul_add(&m[2][a], &m[0][b], &one(m, a, b, 1, 1)),
        (2, _) => one(m, a, b, 1, 1),
        (_, GENERAL) => S::add(&two(m, a, b, 0, 3), &two(m, a, b, 1, 2)),
        (_, BY_UNKNOWN) => S::mul_add(&m[3][a], &m[0][b], &two(m, a, b, 1, 2)),
        _ => two(m, a, b, 1, 2),
    }
}

/// Coefficient `k` of a square.
#[inline(always)]
fn square<S: Scalar, const KIND: u8>(m: &Columns<'_, S>, a: usize, k: usize, top: bool) -> S {
    match (k, if top { KIND } else { GENERAL }) {
        (0, _) => S::sqr(&m[0][a]),
        (1, GENERAL) => double(&one(m, a, a, 0, 1)),
        (1, _) => S::zero(),
        (2, GENERAL) => S::add(&double(&one(m, a, a, 0, 2)), &S::sqr(&m[1][a])),
        (2, _) => S::sqr(&m[1][a]),
        (_, GENERAL) => double(&S::mul_mul_add(&m[0][a], &m[3][a], &m[1][a], &m[2][a])),
        _ => double(&one(m, a, a, 1, 2)),
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

/// An operation of [`Op`](super::Op) on series; `TO` is `FROM` or the next order.
#[inline(always)]
pub(crate) fn step<S: Scalar, const FROM: usize, const TO: usize, const KIND: u8>(
    m: &mut Columns<'_, S>,
    op: super::Op,
    t: usize,
    [a, b, c, d]: [usize; 4],
) {
    use super::Op;
    // The operation is chosen once, outside the loop over coefficients.
    // No range: the order must be known when the code is made, so that the match on it disappears.
    macro_rules! each {
        ($k:ident => $value:expr) => {{
            if FROM < TO {
                let $k = FROM;
                let value = $value;
                m[$k][t] = value;
            }
            let $k = TO;
            let value = $value;
            m[$k][t] = value;
        }};
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
