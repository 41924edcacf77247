//! Grids of parameters.

use crate::family::Family;
use poly::counted;

/// Cells of a grid, at most.
pub(super) const MOST_CELLS: usize = 10_000_000;
/// Axes of a grid, at most.
const MOST_AXES: usize = 2;
/// Names that a message lists.
const LISTED: usize = 12;

/// Equally spaced values of a parameter, both ends among them.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The name of the parameter.
    pub parameter: String,
    /// The first value.
    pub from: f64,
    /// The last value, which may be the smaller one.
    pub to: f64,
    /// The number of values, 2 or more.
    pub count: usize,
}

impl Axis {
    /// An axis; [`Grid::new`] checks it.
    pub fn new(parameter: impl Into<String>, from: f64, to: f64, count: usize) -> Axis {
        Axis { parameter: parameter.into(), from, to, count }
    }

    /// The `k`-th value, from 0.
    pub fn value(&self, k: usize) -> f64 {
        let share = k as f64 / self.count.saturating_sub(1).max(1) as f64;
        // So written, both ends are exact, and nothing overflows.
        self.from * (1.0 - share) + self.to * share
    }

    fn check(&self) -> Result<(), GridError> {
        let name = || self.parameter.clone();
        if !self.from.is_finite() || !self.to.is_finite() {
            return Err(GridError::NotFinite { parameter: name() });
        }
        if self.count < 2 {
            return Err(GridError::Count { parameter: name(), count: self.count });
        }
        if self.from == self.to {
            return Err(GridError::EqualEnds { parameter: name(), value: self.from });
        }
        let step = (self.to / (self.count - 1) as f64 - self.from / (self.count - 1) as f64).abs();
        if step <= 8.0 * f64::EPSILON * self.from.abs().max(self.to.abs()) || step < f64::MIN_POSITIVE {
            return Err(GridError::TooFine { parameter: name(), count: self.count });
        }
        Ok(())
    }
}

/// Why a grid is none of a family.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GridError {
    /// No axis, or too many.
    #[error("a grid has one axis or two, not {0}; give the other parameters single values")]
    Axes(usize),
    /// A name that is no parameter of the family.
    #[error("`{parameter}` is no parameter of the family; its parameters are: {known}")]
    Unknown {
        /// The name.
        parameter: String,
        /// The first parameters of the family.
        known: String,
    },
    /// A parameter that is given twice.
    #[error("the parameter {parameter} is given twice; leave one out")]
    Twice {
        /// The parameter.
        parameter: String,
    },
    /// Parameters that are not given.
    #[error("no value for {parameters}; give each a value, or an axis of the grid")]
    Missing {
        /// The first of them.
        parameters: String,
    },
    /// A value that is not finite.
    #[error("parameter {parameter}: a value is not finite; give finite numbers")]
    NotFinite {
        /// The parameter.
        parameter: String,
    },
    /// Too few values.
    #[error("parameter {parameter}: {} on the axis; 2 or more are needed", counted(*.count, "value"))]
    Count {
        /// The parameter.
        parameter: String,
        /// Number of its values.
        count: usize,
    },
    /// An axis of length zero.
    #[error("parameter {parameter}: the axis begins and ends at {value}; give two values, or a single value for it")]
    EqualEnds {
        /// The parameter.
        parameter: String,
        /// Its first and last value.
        value: f64,
    },
    /// Neighbours that are one number in double precision, or nearly so.
    #[error(
        "parameter {parameter}: {count} values between these ends are not told apart in double precision; give fewer, or a longer axis"
    )]
    TooFine {
        /// The parameter.
        parameter: String,
        /// Number of its values.
        count: usize,
    },
    /// Too many cells.
    #[error("a grid of {} cells; {MOST_CELLS} are the most, take fewer values", in_words(.counts))]
    TooLarge {
        /// The numbers of values on the axes.
        counts: Vec<usize>,
    },
    /// More than fits into memory.
    #[error("{cells} cells with up to {} of {} each are too much; take fewer values", counted(*.solutions, "solution"), counted(*.unknowns, "unknown"))]
    TooMuch {
        /// Number of cells.
        cells: usize,
        /// Number of solutions of the fibre.
        solutions: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
}

fn in_words(counts: &[usize]) -> String {
    counts.iter().map(usize::to_string).collect::<Vec<_>>().join(" x ")
}

/// Points in the parameters of a family: one or two of them take the values of an axis each, the others stay.
///
/// A point of the grid is called a cell: it stands for the parameters about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    axes: Vec<Axis>,
    /// The parameters on the axes, by their numbers.
    places: Vec<usize>,
    /// All parameters; those on axes have their first values.
    point: Vec<f64>,
}

impl Grid {
    /// A grid of parameters of `family`: an axis for one parameter or two, and values for all others.
    ///
    /// # Errors
    /// For a name that is no parameter, one that is given twice or not at all, numbers that are not finite, an axis
    /// with fewer than two values or equal ends, none or more than two axes, and more than ten million cells.
    pub fn new<N: AsRef<str>>(family: &Family, axes: Vec<Axis>, fixed: &[(N, f64)]) -> Result<Grid, GridError> {
        if axes.is_empty() || axes.len() > MOST_AXES {
            return Err(GridError::Axes(axes.len()));
        }
        let names = family.system().parameters();
        let listed = |list: &[&str]| {
            let more = if list.len() > LISTED { ", ..." } else { "" };
            list.iter().take(LISTED).copied().collect::<Vec<_>>().join(", ") + more
        };
        let place = |name: &str| {
            names.iter().position(|known| known == name).ok_or_else(|| GridError::Unknown {
                parameter: name.to_owned(),
                known: listed(&names.iter().map(String::as_str).collect::<Vec<_>>()),
            })
        };
        let mut values: Vec<Option<f64>> = vec![None; names.len()];
        let mut places = Vec::new();
        let given = axes.iter().map(|axis| (axis.parameter.as_str(), axis.from, true));
        for (name, value, is_axis) in given.chain(fixed.iter().map(|(name, value)| (name.as_ref(), *value, false))) {
            let k = place(name)?;
            if values[k].is_some() {
                return Err(GridError::Twice { parameter: name.to_owned() });
            }
            if !value.is_finite() {
                return Err(GridError::NotFinite { parameter: name.to_owned() });
            }
            values[k] = Some(value);
            if is_axis {
                places.push(k);
            }
        }
        axes.iter().try_for_each(Axis::check)?;
        let missing: Vec<&str> =
            names.iter().zip(&values).filter(|(_, value)| value.is_none()).map(|(name, _)| name.as_str()).collect();
        if !missing.is_empty() {
            return Err(GridError::Missing { parameters: listed(&missing) });
        }
        let cells = axes.iter().try_fold(1usize, |cells, axis| cells.checked_mul(axis.count));
        if cells.is_none_or(|cells| cells > MOST_CELLS) {
            return Err(GridError::TooLarge { counts: axes.iter().map(|axis| axis.count).collect() });
        }
        Ok(Grid { axes, places, point: values.into_iter().flatten().collect() })
    }

    /// The axes, one or two.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// Number of cells. That of a first axis of `m` values and a second one of `n` is `m n`: cell `k` has the values
    /// `k % m` and `k / m` of them, from 0.
    pub fn len(&self) -> usize {
        self.axes.iter().map(|axis| axis.count).product()
    }

    /// Whether there are no cells; never.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The places of a cell on the axes, from 0.
    pub fn places(&self, cell: usize) -> Vec<usize> {
        let mut rest = cell;
        let mut place = |axis: &Axis| {
            let place = rest % axis.count;
            rest /= axis.count;
            place
        };
        self.axes.iter().map(&mut place).collect()
    }

    /// The values of a cell on the axes.
    pub fn values(&self, cell: usize) -> Vec<f64> {
        self.axes.iter().zip(self.places(cell)).map(|(axis, place)| axis.value(place)).collect()
    }

    /// The parameters of a cell, in the order of the family.
    pub fn parameters(&self, cell: usize) -> Vec<f64> {
        let mut point = self.point.clone();
        for (&k, value) in self.places.iter().zip(self.values(cell)) {
            point[k] = value;
        }
        point
    }

    /// The names and values of the parameters that stay, in the order of the family.
    pub fn fixed<'a>(&'a self, family: &'a Family) -> impl Iterator<Item = (&'a str, f64)> {
        let all = family.system().parameters().iter().zip(&self.point).enumerate();
        all.filter(|(k, _)| !self.places.contains(k)).map(|(_, (name, &value))| (name.as_str(), value))
    }

    /// The neighbours of a cell that come after it: the next one on each axis.
    pub(super) fn next(&self, cell: usize) -> impl Iterator<Item = usize> {
        let mut stride = 1;
        let steps: Vec<usize> = (self.axes.iter().zip(self.places(cell)))
            .filter_map(|(axis, place)| {
                let step = stride;
                stride *= axis.count;
                (place + 1 < axis.count).then_some(step)
            })
            .collect();
        steps.into_iter().map(move |step| cell + step)
    }

    /// An error unless so many solutions of each cell fit into memory.
    pub(super) fn check_room(&self, solutions: usize, unknowns: usize) -> Result<(), GridError> {
        let cells = self.len();
        let room = cells.checked_mul(solutions).and_then(|all| all.checked_mul(unknowns.saturating_add(8)));
        if room.is_none_or(|room| room > MOST_NUMBERS) {
            return Err(GridError::TooMuch { cells, solutions, unknowns });
        }
        Ok(())
    }
}

/// Numbers that all solutions of a sweep have together, at most: 4 GB.
const MOST_NUMBERS: usize = 1 << 29;

#[cfg(test)]
mod tests {
    use super::{Axis, Grid, GridError};
    use crate::family::Family;
    use proptest::prelude::*;

    fn family() -> Family {
        Family::from_formulas(&["x"], &["a", "b", "c"], &["x^3 + a*x^2 + b*x + c"]).unwrap()
    }

    fn axis(name: &str, count: usize) -> Axis {
        Axis::new(name, -1.0, 2.0, count)
    }

    #[test]
    fn cells_have_the_values_of_their_places() {
        let family = family();
        let grid = Grid::new(&family, vec![axis("c", 4), axis("a", 7)], &[("b", 5.0)]).unwrap();
        assert_eq!(grid.len(), 28);
        assert_eq!(grid.parameters(0), [-1.0, 5.0, -1.0]);
        assert_eq!(grid.parameters(3), [-1.0, 5.0, 2.0]);
        assert_eq!(grid.parameters(4), [-0.5, 5.0, -1.0]);
        assert_eq!(grid.parameters(27), [2.0, 5.0, 2.0]);
        assert_eq!(grid.fixed(&family).collect::<Vec<_>>(), [("b", 5.0)]);
        assert_eq!(grid.next(2).collect::<Vec<_>>(), [3, 6]);
        assert_eq!(grid.next(3).collect::<Vec<_>>(), [7]);
        assert_eq!(grid.next(24).collect::<Vec<_>>(), [25]);
        assert_eq!(grid.next(27).count(), 0);
    }

    #[test]
    fn what_is_no_grid_is_said() {
        let family = family();
        let both = [("b", 1.0), ("c", 1.0)];
        let error = |axes: Vec<Axis>, fixed: &[(&str, f64)]| Grid::new(&family, axes, fixed).unwrap_err();
        let a = || "a".to_owned();
        assert_eq!(error(vec![], &both), GridError::Axes(0));
        assert_eq!(error(vec![axis("a", 2), axis("b", 2), axis("c", 2)], &[]), GridError::Axes(3));
        assert_eq!(
            error(vec![axis("d", 2)], &both),
            GridError::Unknown { parameter: "d".to_owned(), known: "a, b, c".to_owned() }
        );
        assert_eq!(error(vec![axis("a", 2), axis("a", 2)], &both), GridError::Twice { parameter: a() });
        assert_eq!(error(vec![axis("b", 2)], &both), GridError::Twice { parameter: "b".to_owned() });
        assert_eq!(error(vec![axis("a", 2)], &both[..1]), GridError::Missing { parameters: "c".to_owned() });
        for count in [0, 1] {
            assert_eq!(error(vec![axis("a", count)], &both), GridError::Count { parameter: a(), count });
        }
        for bad in [f64::NAN, f64::INFINITY] {
            assert_eq!(error(vec![Axis::new("a", bad, 1.0, 5)], &both), GridError::NotFinite { parameter: a() });
            assert_eq!(error(vec![Axis::new("a", 1.0, bad, 5)], &both), GridError::NotFinite { parameter: a() });
            let fixed = [("b", bad), ("c", 1.0)];
            assert_eq!(error(vec![axis("a", 2)], &fixed), GridError::NotFinite { parameter: "b".to_owned() });
        }
        assert_eq!(
            error(vec![Axis::new("a", 1.0, 1.0, 5)], &both),
            GridError::EqualEnds { parameter: a(), value: 1.0 }
        );
        assert_eq!(
            error(vec![Axis::new("a", 1.0, 1.0 + 1e-13, 1000)], &both),
            GridError::TooFine { parameter: a(), count: 1000 }
        );
        assert!(matches!(error(vec![axis("a", 10_000_001)], &both), GridError::TooLarge { .. }));
        let huge = vec![axis("a", usize::MAX / 2), axis("b", 4)];
        assert!(matches!(error(huge, &both[1..]), GridError::TooLarge { .. } | GridError::TooFine { .. }));
        let grid = Grid::new(&family, vec![axis("a", 10_000_000)], &both).unwrap();
        assert!(grid.check_room(usize::MAX, 2).is_err() && grid.check_room(3, usize::MAX).is_err());
        assert!(grid.check_room(3, 1).is_ok());
    }

    proptest! {
        #[test]
        fn values_go_from_end_to_end(from in -1e300..1e300f64, to in -1e300..1e300f64, count in 2usize..50) {
            let axis = Axis::new("a", from, to, count);
            prop_assume!(axis.check().is_ok());
            prop_assert_eq!((axis.value(0), axis.value(count - 1)), (from, to));
            let rises = |k: usize| (axis.value(k) < axis.value(k + 1)) == (from < to) && axis.value(k).is_finite();
            prop_assert!((0..count - 1).all(rises));
        }
    }
}
