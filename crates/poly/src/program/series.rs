//! Taylor arithmetic on coefficients that stay in memory, shared by the interpreter and generated code.
//!
//! An array holds four coefficients, of orders 0 to 3, for every operand and every result. Each function
//! computes coefficients `FROM ..= TO` of result `t` from those of its operands and relies on
//! the result's coefficients below `FROM`. Formulas: Griewank and Walther, *Evaluating Derivatives*, chapter 13.

use crate::scalar::Scalar;

/// Coefficients kept for each value: orders 0 to 3.
pub const WIDTH: usize = 4;

/// The coefficients of one value.
pub type Series<S> = [S; WIDTH];

/// Coefficient `k` of a product.
#[inline(always)]
fn product<S: Scalar>(a: &Series<S>, b: &Series<S>, k: usize) -> S {
    match k {
        0 => S::mul(&a[0], &b[0]),
        1 => S::mul_mul_add(&a[0], &b[1], &a[1], &b[0]),
        2 => S::mul_add(&a[1], &b[1], &S::mul_mul_add(&a[0], &b[2], &a[2], &b[0])),
        _ => S::add(&S::mul_mul_add(&a[0], &b[3], &a[3], &b[0]), &S::mul_mul_add(&a[1], &b[2], &a[2], &b[1])),
    }
}

/// Coefficient `k` of a square.
#[inline(always)]
fn square<S: Scalar>(a: &Series<S>, k: usize) -> S {
    match k {
        0 => S::sqr(&a[0]),
        1 => double(&S::mul(&a[0], &a[1])),
        2 => S::add(&double(&S::mul(&a[0], &a[2])), &S::sqr(&a[1])),
        _ => double(&S::mul_mul_add(&a[0], &a[3], &a[1], &a[2])),
    }
}

#[inline(always)]
fn double<S: Scalar>(a: &S) -> S {
    S::add(a, a)
}

/// Coefficient `k` of the reciprocal of `a` from those below, `r`:
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

macro_rules! series {
    ($($(#[$doc:meta])* fn $name:ident($m:ident, $k:ident, $t:ident $(, $operand:ident)*) $value:expr;)*) => {$(
        $(#[$doc])*
        ///
        /// # Panics
        /// If a place lies outside the array.
        #[inline(always)]
        pub fn $name<S: Scalar, const FROM: usize, const TO: usize>(
            $m: &mut [Series<S>],
            $t: usize
            $(, $operand: usize)*
        ) {
            for $k in FROM..=TO {
                let value = {
                    $(let $operand = &$m[$operand];)*
                    $value
                };
                $m[$t][$k] = value;
            }
        }
    )*};
}

series! {
    /// `a + b`
    fn add(m, k, t, a, b) S::add(&a[k], &b[k]);
    /// `a - b`
    fn sub(m, k, t, a, b) S::sub(&a[k], &b[k]);
    /// `-a`
    fn neg(m, k, t, a) S::neg(&a[k]);
    /// `a * b`
    fn mul(m, k, t, a, b) product(a, b, k);
    /// `a * r` for a real constant `r`
    fn mul_real(m, k, t, a, r) S::mul_real(&a[k], &r[0]);
    /// `a * a`
    fn sqr(m, k, t, a) square(a, k);
    /// `1 / a`
    fn inv(m, k, t, a) reciprocal(&m[t], a, k);
    /// `a * b + c`
    fn mul_add(m, k, t, a, b, c) S::add(&product(a, b, k), &c[k]);
    /// `a * b - c`
    fn mul_sub(m, k, t, a, b, c) S::sub(&product(a, b, k), &c[k]);
    /// `c - a * b`
    fn sub_mul(m, k, t, a, b, c) S::sub(&c[k], &product(a, b, k));
    /// `a * r + c` for a real constant `r`
    fn mul_real_add(m, k, t, a, r, c) S::mul_real_add(&a[k], &r[0], &c[k]);
    /// `a * b + c * d`
    fn mul_mul_add(m, k, t, a, b, c, d) S::add(&product(a, b, k), &product(c, d, k));
    /// `a * b - c * d`
    fn mul_mul_sub(m, k, t, a, b, c, d) S::sub(&product(a, b, k), &product(c, d, k));
}
