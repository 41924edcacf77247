//! The space in which cells are sought: the supports in three sizes of integers, and cells in any
//! of these sizes.

use super::cell::Cell;
use super::integer::Integer;
use super::points::Points;
use crate::monitor::Monitor;
use poly::simd::Isa;
use std::sync::OnceLock;

/// The supports in the sizes of integers that hold them, and the lifting that is sought.
pub(super) struct Space {
    pub(super) supports: Vec<Vec<Vec<i64>>>,
    small: Option<Points<i32>>,
    /// Made when it is needed.
    medium: OnceLock<Option<Points<i64>>>,
    large: OnceLock<Option<Points<i128>>>,
    /// The lifting of each point, negated; without one the cells of the last stage are what is
    /// looked for.
    pub(super) tau: Option<Vec<i64>>,
    /// Who may stop the search.
    pub(super) monitor: Monitor,
}

impl Space {
    /// Supports whose least exponents are zero.
    pub(super) fn new(supports: Vec<Vec<Vec<i64>>>, tau: Option<Vec<i64>>, monitor: &Monitor) -> Self {
        let small = Points::new(&supports);
        Space { supports, small, medium: OnceLock::new(), large: OnceLock::new(), tau, monitor: monitor.clone() }
    }

    fn small(&self) -> Option<&Points<i32>> {
        self.small.as_ref()
    }

    fn medium(&self) -> Option<&Points<i64>> {
        self.medium.get_or_init(|| Points::new(&self.supports)).as_ref()
    }

    fn large(&self) -> Option<&Points<i128>> {
        self.large.get_or_init(|| Points::new(&self.supports)).as_ref()
    }

    /// The cell in the smallest size that holds it.
    pub(super) fn smallest<T: Integer>(&self, cell: &Cell<T>) -> Option<AnyCell> {
        let small = self.small().and_then(|p| cell.converted(p)).map(AnyCell::Small);
        let medium = || self.medium().and_then(|p| cell.converted(p)).map(AnyCell::Medium);
        let large = || self.large().and_then(|p| cell.converted(p)).map(AnyCell::Large);
        small.or_else(medium).or_else(large)
    }
}

/// A cell in any size of integers.
#[derive(Clone)]
pub(super) enum AnyCell {
    Small(Cell<i32>),
    Medium(Cell<i64>),
    Large(Cell<i128>),
}

/// One of the sizes; a cell that outgrows it goes on in the next.
pub(super) trait Size: Integer {
    /// The next size; the last size is its own next.
    type Next: Size;
    /// Whether there is no larger size.
    const LAST: bool;
    /// The widest instruction set that the search gains anything from.
    const WIDEST: Isa;

    /// The supports in this size, if they fit.
    fn points(space: &Space) -> Option<&Points<Self>>;
    fn any(cell: Cell<Self>) -> AnyCell;
}

macro_rules! size {
    ($type:ident, $next:ident, $last:expr, $widest:ident, $cell:ident, $points:ident) => {
        impl Size for $type {
            type Next = $next;
            const LAST: bool = $last;
            const WIDEST: Isa = Isa::$widest;

            fn points(space: &Space) -> Option<&Points<Self>> {
                space.$points()
            }

            fn any(cell: Cell<Self>) -> AnyCell {
                AnyCell::$cell(cell)
            }
        }
    };
}

size!(i32, i64, false, Avx512, Small, small);
size!(i64, i128, false, Avx512, Medium, medium);
size!(i128, i128, true, Portable, Large, large);
