//! Formulas as a hash-consed graph: equal subformulas are stored and computed once.

use crate::arena::Arena;
use crate::display;
use crate::exact::{Exact, ToExact};
use crate::graph::{Graph, Id};
use num_complex::Complex64;
use num_rational::BigRational;
use num_traits::Zero;
use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// An arena of formulas in named unknowns and parameters.
///
/// ```
/// use poly::Expressions;
/// let arena = Expressions::new();
/// let (x, a) = (arena.variable("x"), arena.parameter("a"));
/// let f = (x - a).powi(2) + 1;
/// assert_eq!(f, 1 + (x - a) * (x - a));
/// ```
#[derive(Debug, Default)]
pub struct Expressions {
    inner: RefCell<Arena>,
}

/// A formula in an arena of [`Expressions`], as cheap to copy as a pointer.
///
/// Formulas of two different arenas cannot be combined: that panics.
#[derive(Clone, Copy)]
pub struct Expr<'a> {
    arena: &'a Expressions,
    id: Id,
}

impl Expressions {
    /// An empty arena.
    pub fn new() -> Expressions {
        Expressions::default()
    }

    /// The unknown of this name. Unknowns are ordered by first mention.
    pub fn variable(&self, name: &str) -> Expr<'_> {
        self.wrap(self.inner.borrow_mut().variable(name))
    }

    /// The parameter of this name. Parameters are ordered by first mention.
    pub fn parameter(&self, name: &str) -> Expr<'_> {
        self.wrap(self.inner.borrow_mut().parameter(name))
    }

    /// A constant: an integer, a finite `f64` (taken exactly), a rational or a complex number.
    pub fn constant(&self, value: impl ToExact) -> Expr<'_> {
        let mut inner = self.inner.borrow_mut();
        let value = value.to_exact().unwrap_or_else(|| {
            inner.non_finite = true;
            Exact::zero()
        });
        self.wrap(inner.graph.constant(value))
    }

    /// The sum of some formulas, zero if there are none.
    pub fn sum<'a>(&'a self, terms: impl IntoIterator<Item = Expr<'a>>) -> Expr<'a> {
        terms.into_iter().fold(self.constant(0), |sum, term| sum + term)
    }

    /// The product of some formulas, one if there are none.
    pub fn product<'a>(&'a self, factors: impl IntoIterator<Item = Expr<'a>>) -> Expr<'a> {
        factors.into_iter().fold(self.constant(1), |product, factor| product * factor)
    }

    /// Number of distinct subformulas in the arena.
    pub fn len(&self) -> usize {
        self.inner.borrow().graph.len()
    }

    /// Whether the arena has no formulas.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn wrap(&self, id: Id) -> Expr<'_> {
        Expr { arena: self, id }
    }

    pub(crate) fn into_arena(self) -> Arena {
        self.inner.into_inner()
    }
}

impl<'a> Expr<'a> {
    /// The formula to an integer power; a negative exponent is a power of the reciprocal.
    pub fn powi(self, exponent: i32) -> Expr<'a> {
        let id = self.arena.inner.borrow_mut().graph.pow(self.id, exponent);
        self.arena.wrap(id)
    }

    /// The arena that holds the formula.
    pub fn arena(self) -> &'a Expressions {
        self.arena
    }

    pub(crate) fn id(self) -> Id {
        self.id
    }

    fn combine(self, other: Expr<'a>, f: fn(&mut Graph, Id, Id) -> Id) -> Expr<'a> {
        assert!(std::ptr::eq(self.arena, other.arena), "formulas of two different arenas cannot be combined");
        let id = f(&mut self.arena.inner.borrow_mut().graph, self.id, other.id);
        self.arena.wrap(id)
    }
}

impl PartialEq for Expr<'_> {
    /// Whether both are the same node; formulas that are equal only after expansion differ.
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.arena, other.arena) && self.id == other.id
    }
}

impl std::fmt::Debug for Expr<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let arena = self.arena.inner.borrow();
        display::write_node(f, &arena, self.id)
    }
}

impl<'a> Neg for Expr<'a> {
    type Output = Expr<'a>;
    fn neg(self) -> Expr<'a> {
        let id = self.arena.inner.borrow_mut().graph.neg(self.id);
        self.arena.wrap(id)
    }
}

macro_rules! operators {
    ($($trait:ident $method:ident),*) => {$(
        impl<'a> $trait for Expr<'a> {
            type Output = Expr<'a>;
            fn $method(self, other: Expr<'a>) -> Expr<'a> {
                self.combine(other, Graph::$method)
            }
        }
        operators!(@constants $trait $method: i32, i64, f64, Complex64, BigRational, Exact);
    )*};
    (@constants $trait:ident $method:ident: $($constant:ty),*) => {$(
        impl<'a> $trait<$constant> for Expr<'a> {
            type Output = Expr<'a>;
            fn $method(self, other: $constant) -> Expr<'a> {
                $trait::$method(self, self.arena.constant(other))
            }
        }
        impl<'a> $trait<Expr<'a>> for $constant {
            type Output = Expr<'a>;
            fn $method(self, other: Expr<'a>) -> Expr<'a> {
                $trait::$method(other.arena.constant(self), other)
            }
        }
    )*};
}

operators!(Add add, Sub sub, Mul mul, Div div);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_formulas_are_one_node() {
        let arena = Expressions::new();
        let (x, y) = (arena.variable("x"), arena.variable("y"));
        assert_eq!(x * y, y * x);
        assert_eq!(x + y, y + x);
        assert_eq!(x * x * x, x.powi(3));
        assert_eq!((x * 2) * (y * 3), 6 * (x * y));
        assert_eq!(-(x - y), y - x);
        assert_eq!(x - -y, x + y);
        assert_eq!((-x) * (-y), x * y);
        assert_eq!(x + x, 2 * x);
        assert_eq!(x.powi(2).powi(3), x.powi(6));
        assert_eq!((-x).powi(3), -x.powi(3));
        assert_eq!(x / 4, 0.25 * x);
    }

    #[test]
    fn trivial_identities() {
        let arena = Expressions::new();
        let x = arena.variable("x");
        let zero = arena.constant(0);
        assert_eq!(x * zero, zero);
        assert_eq!(x * arena.constant(1), x);
        assert_eq!(x + zero, x);
        assert_eq!(x - x, zero);
        assert_eq!(x.powi(0), arena.constant(1));
        assert_eq!(arena.constant(2) * 3.5, arena.constant(7));
        let i = arena.constant(Complex64::new(0.0, 1.0));
        assert_eq!(i * i, arena.constant(-1));
    }

    #[test]
    fn giant_constants_are_not_folded() {
        let arena = Expressions::new();
        let huge = arena.constant(3).powi(1_000_000_000);
        assert_eq!(huge * huge, huge.powi(2));
        assert!(arena.len() < 10);
    }
}
