//! Taylor arithmetic on coefficients that stay in memory.
//!
//! Every operand and every result keeps its coefficients of orders 0 to 3. Each step computes
//! coefficients `FROM ..= TO` of result `t` from those of its operands, and relies on the result's
//! coefficients below `FROM`. `TO` is the requested order. At this order the unknowns' coefficients
//! are zero. A factor that is linear in parameters on a straight line has no coefficients beyond
//! order 1. Products with either leave out the terms that vanish. Coefficient 2 of a product is
//! computed twice, without and with coefficient 2 of the unknowns. In between, the place of
//! coefficient 3 keeps the part `a_1 b_1`, which does not change. Formulas: Griewank and Walther,
//! *Evaluating Derivatives*, chapter 13.

use super::instruction::Op;
use crate::scalar::Scalar;

/// Coefficients kept for each value: orders 0 to 3.
pub(crate) const WIDTH: usize = 4;

/// Coefficients of one value.
pub(crate) type Series<S> = [S; WIDTH];

/// Nothing is known of the factors.
pub(crate) const GENERAL: u8 = 0;
/// The second factor is an unknown.
pub(crate) const BY_UNKNOWN: u8 = 1;
/// Both factors are unknowns.
pub(crate) const UNKNOWNS: u8 = 2;
/// The second factor is free of unknowns and linear in `t`.
pub(crate) const BY_LINEAR: u8 = 3;
/// The first factor is free of unknowns and linear in `t`, the second is an unknown.
pub(crate) const LINEAR_BY_UNKNOWN: u8 = 4;
/// Both factors are free of unknowns and linear in `t`.
pub(crate) const LINEARS: u8 = 5;

// Helpers are functions that are always inlined, not closures: a closure that the compiler leaves
// out of line would be compiled without the instruction set of its caller. Every kind adds up what
// does not vanish in the order of the general formula, so that all agree bit for bit.

/// `a_i b_j + a_j b_i`
#[inline(always)]
fn two<S: Scalar>(a: &Series<S>, b: &Series<S>, i: usize, j: usize) -> S {
    S::mul_mul_add(&a[i], &b[j], &a[j], &b[i])
}

#[inline(always)]
fn double<S: Scalar>(z: &S) -> S {
    S::add(z, z)
}

/// `x + y` or, if `MINUS`, `x - y`.
#[inline(always)]
fn combine<S: Scalar, const MINUS: bool>(x: &S, y: &S) -> S {
    if MINUS { S::sub(x, y) } else { S::add(x, y) }
}

/// `a_i b_j + c_k d_l` or, if `MINUS`, their difference.
#[inline(always)]
fn combine_products<S: Scalar, const MINUS: bool>(a: &S, b: &S, c: &S, d: &S) -> S {
    if MINUS { S::mul_mul_sub(a, b, c, d) } else { S::mul_mul_add(a, b, c, d) }
}

/// What remains of a kind of product below the requested order, where the unknowns have
/// coefficients like everything else.
#[inline(always)]
const fn kind_at(kind: u8, top: bool) -> u8 {
    match kind {
        BY_UNKNOWN | UNKNOWNS if !top => GENERAL,
        other => other,
    }
}

/// Coefficient `k` of `a b`; `top` says that the unknowns' coefficient is zero, `inner` is
/// `a_1 b_1` where `k` is 2.
#[inline(always)]
fn product<S: Scalar, const KIND: u8>(a: &Series<S>, b: &Series<S>, inner: &S, k: usize, top: bool) -> S {
    match (k, kind_at(KIND, top)) {
        (0, _) => S::mul(&a[0], &b[0]),
        (1, GENERAL | BY_LINEAR | LINEARS) => two(a, b, 0, 1),
        (1, BY_UNKNOWN) => S::mul(&a[1], &b[0]),
        (1, UNKNOWNS) => S::zero(),
        (1, _) if top => S::mul(&a[1], &b[0]),
        (1, _) => two(a, b, 0, 1),
        (2, GENERAL) => S::add(&two(a, b, 0, 2), inner),
        (2, BY_UNKNOWN | BY_LINEAR) => S::mul_add(&a[2], &b[0], inner),
        (2, LINEAR_BY_UNKNOWN) if !top => S::mul_add(&a[0], &b[2], inner),
        (2, _) => inner.clone(),
        (_, GENERAL) => S::add(&two(a, b, 0, 3), &two(a, b, 1, 2)),
        (_, BY_UNKNOWN) => S::mul_add(&a[3], &b[0], &two(a, b, 1, 2)),
        (_, UNKNOWNS) => two(a, b, 1, 2),
        (_, BY_LINEAR) => S::mul_mul_add(&a[3], &b[0], &a[2], &b[1]),
        (_, LINEAR_BY_UNKNOWN) => S::mul(&a[1], &b[2]),
        _ => S::zero(),
    }
}

/// Coefficient `k` of `a b + c d` or, if `MINUS`, of `a b - c d`, both of one kind; `inner` is
/// `a_1 b_1 + c_1 d_1` or their difference.
#[inline(always)]
fn products<S: Scalar, const KIND: u8, const MINUS: bool>(
    [a, b, c, d]: [&Series<S>; 4],
    inner: &S,
    k: usize,
    top: bool,
) -> S {
    match (k, kind_at(KIND, top)) {
        (0, _) => combine_products::<S, MINUS>(&a[0], &b[0], &c[0], &d[0]),
        (2, GENERAL) => S::add(&combine::<S, MINUS>(&two(a, b, 0, 2), &two(c, d, 0, 2)), inner),
        (2, BY_UNKNOWN | BY_LINEAR) => S::add(&combine_products::<S, MINUS>(&a[2], &b[0], &c[2], &d[0]), inner),
        (2, LINEAR_BY_UNKNOWN) if !top => S::add(&combine_products::<S, MINUS>(&a[0], &b[2], &c[0], &d[2]), inner),
        (2, _) => inner.clone(),
        _ => combine::<S, MINUS>(&product::<S, KIND>(a, b, inner, k, top), &product::<S, KIND>(c, d, inner, k, top)),
    }
}

/// Coefficient `k` of `a^2`; `inner` is `a_1^2`.
#[inline(always)]
fn square<S: Scalar, const KIND: u8>(a: &Series<S>, inner: &S, k: usize, top: bool) -> S {
    match (k, kind_at(KIND, top)) {
        (0, _) => S::sqr(&a[0]),
        (1, GENERAL | LINEARS) => double(&S::mul(&a[0], &a[1])),
        (1, _) => S::zero(),
        (2, GENERAL) => S::add(&double(&S::mul(&a[0], &a[2])), inner),
        (2, _) => inner.clone(),
        (_, GENERAL) => double(&S::mul_mul_add(&a[0], &a[3], &a[1], &a[2])),
        (_, LINEARS) => S::zero(),
        _ => double(&S::mul(&a[1], &a[2])),
    }
}

/// Coefficient `k` of the reciprocal `r` of `a` from those below:
/// `r_0 = 1/a_0`, `r_k = -r_0 * sum_{j<k} r_j a_{k-j}`.
#[inline(always)]
fn reciprocal<S: Scalar>(r: &Series<S>, a: &Series<S>, k: usize) -> S {
    let sum = match k {
        0 => return S::inv(&a[0]),
        1 => S::mul(&r[0], &a[1]),
        2 => S::mul_mul_add(&r[0], &a[2], &r[1], &a[1]),
        _ => S::mul_add(&r[2], &a[1], &S::mul_mul_add(&r[0], &a[3], &r[1], &a[2])),
    };
    S::neg(&S::mul(&r[0], &sum))
}

// In the two kinds of steps the operation is chosen once, outside the loop over coefficients, and
// results are stored after all of them are known: operands need not be loaded twice. No range: the
// order must be known when the code is made, so that the match on it disappears.
macro_rules! each {
    ($m:ident[$t:ident]; $k:ident => $value:expr) => {{
        if FROM < TO {
            let $k = FROM;
            let low = $value;
            let $k = TO;
            let high = $value;
            $m[$t][FROM] = low;
            $m[$t][TO] = high;
        } else {
            let $k = TO;
            $m[$t][TO] = $value;
        }
    }};
}

/// An operation of [`Op`] on series that multiplies no two of them; `TO` is `FROM` or the next
/// order. Products are not done; `false` says so.
#[inline(always)]
pub(crate) fn step_sum<S: Scalar, const FROM: usize, const TO: usize>(
    m: &mut [Series<S>],
    op: Op,
    t: usize,
    operands: [usize; 4],
) -> bool {
    let [a, b, c, _] = operands.map(|k| &m[k]);
    match op {
        Op::Add => each!(m[t]; k => S::add(&a[k], &b[k])),
        Op::Sub => each!(m[t]; k => S::sub(&a[k], &b[k])),
        Op::Neg => each!(m[t]; k => S::neg(&a[k])),
        Op::MulReal => each!(m[t]; k => S::mul_real(&a[k], &b[0])),
        Op::MulRealAdd => each!(m[t]; k => S::mul_real_add(&a[k], &b[0], &c[k])),
        Op::Inv => {
            let a = a.clone();
            if FROM < TO {
                m[t][FROM] = reciprocal(&m[t], &a, FROM);
            }
            m[t][TO] = reciprocal(&m[t], &a, TO);
        }
        _ => return false,
    }
    true
}

/// A product of series by [`Op`]; `TO` is `FROM` or the next order. [`step_sum`] does everything
/// else.
#[inline(always)]
pub(crate) fn step_product<S: Scalar, const FROM: usize, const TO: usize, const KIND: u8>(
    m: &mut [Series<S>],
    op: Op,
    t: usize,
    operands: [usize; 4],
) {
    let [a, b, c, d] = operands.map(|k| &m[k]);
    // `$inner` belongs to order 2; at order 3 it comes back from where order 2 has left it.
    macro_rules! keeping {
        ($inner:ident = $first:expr; $k:ident => $value:expr) => {{
            let $inner = if TO == 2 { $first } else { m[t][3].clone() };
            each!(m[t]; $k => $value);
            if TO == 2 {
                m[t][3] = $inner;
            }
        }};
    }
    match op {
        Op::Mul => keeping!(inner = S::mul(&a[1], &b[1]); k => product::<S, KIND>(a, b, &inner, k, k == TO)),
        Op::Sqr => keeping!(inner = S::sqr(&a[1]); k => square::<S, KIND>(a, &inner, k, k == TO)),
        Op::MulAdd => keeping!(
            inner = S::mul(&a[1], &b[1]);
            k => S::add(&product::<S, KIND>(a, b, &inner, k, k == TO), &c[k])
        ),
        Op::MulSub => keeping!(
            inner = S::mul(&a[1], &b[1]);
            k => S::sub(&product::<S, KIND>(a, b, &inner, k, k == TO), &c[k])
        ),
        Op::SubMul => keeping!(
            inner = S::mul(&a[1], &b[1]);
            k => S::sub(&c[k], &product::<S, KIND>(a, b, &inner, k, k == TO))
        ),
        Op::MulMulAdd => keeping!(
            inner = S::mul_mul_add(&a[1], &b[1], &c[1], &d[1]);
            k => products::<S, KIND, false>([a, b, c, d], &inner, k, k == TO)
        ),
        Op::MulMulSub => keeping!(
            inner = S::mul_mul_sub(&a[1], &b[1], &c[1], &d[1]);
            k => products::<S, KIND, true>([a, b, c, d], &inner, k, k == TO)
        ),
        Op::Add | Op::Sub | Op::Neg | Op::MulReal | Op::MulRealAdd | Op::Inv => {}
    }
}
