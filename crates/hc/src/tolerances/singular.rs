//! Thresholds of equations, of the structure of singular ends, and of clusters.

/// Thresholds by which equations are scaled, rewritten and refused before paths are tracked.
pub(crate) mod equations {
    /// If at least this much of an equation of size one is left beside combinations of the equations
    /// before it, the equation stays as it is.
    pub(crate) const DEPENDENT: f64 = 1e-5;
    /// The least part of a row that must be left beside the rows before it by Gram and Schmidt's
    /// orthogonalisation, for rows to count as independent.
    pub(crate) const INDEPENDENT: f64 = 1e-6;
    /// Equations of many terms are refused if their scaled coefficients differ by more decades than
    /// this.
    pub(crate) const SPREAD: f64 = 30.0;
    /// Formulas that multiply as many sums, counted with multiplicity, get unknowns for these. Expanded,
    /// `(x + y)^n - 1` with `x - y^2` takes hardly longer with `n` = 8, twice as long with 10, four times with 15,
    /// and loses solutions with 30.
    pub(crate) const FACTORS: u32 = 10;
    /// Formulas of which components are sought get unknowns for sums from this many on: components are multiple if they
    /// come from powers.
    pub(crate) const FACTORS_OF_COMPONENTS: u32 = 4;
    /// Products of up to this many sums are expanded all the same, where longer ones get unknowns.
    pub(crate) const KEPT_FACTORS: u32 = 3;
    /// Most unknowns for sums: mixed cells and linear algebra take longer with each.
    pub(crate) const NAMED_SUMS: usize = 128;
    /// Coefficients with more bits than this are no doubles, and no decimals of sixteen digits.
    pub(crate) const LONG: u64 = 60;
    /// The logarithm to base 2 of about how large the product of the ratios of coefficients of each equation may be, so
    /// that solutions are no larger than where paths to infinity are followed (`endgame::FAR`).
    pub(crate) const FAR_RATIOS: f64 = 100.0;
    /// Spread of the logarithms (base 2) of coefficients in an equation below which unknowns are
    /// not scaled.
    pub(crate) const MILD: f64 = 14.0;
    /// Scales with a larger exponent (base 2) are not used.
    pub(crate) const MOST_EXPONENT: f64 = 200.0;
    /// In a toric homotopy, terms outside the binomials start at `exp` of minus this number, about
    /// 1e-13, of their size.
    pub(crate) const FADED: f64 = 30.0;
}

/// Thresholds by which the local structure of an end is decided: regular, of a multiplicity, or on
/// a set of positive dimension. Logarithms are to base 2; arithmetic is in double-double or in
/// numbers of up to 154 digits.
pub(crate) mod structure {
    /// Logarithms of the tolerances at which ranks are read off near a solution, the strictest
    /// first; each gives a hypothesis, which deflation then tests.
    pub(crate) const RANKS: [f64; 7] = [-40.0, -30.0, -20.0, -13.0, -10.0, -6.5, -3.5];
    /// Steps in which stricter ones follow in numbers of more digits.
    pub(crate) const FINER_RANKS: f64 = 20.0;
    /// Orders of series with such tolerances that are tried on sets that are not reduced.
    pub(crate) const SHEET_RANKS: [(usize, f64); 4] = [(2, -20.0), (2, -12.0), (3, -20.0), (3, -12.0)];
    /// A regular solution is at most this far from the end of a path, relatively.
    pub(crate) const NEAR: f64 = 1e-7;
    /// A regular solution is at most this many times the error of the end away from it.
    pub(crate) const NEAR_ERRORS: f64 = 1e2;
    /// A singular solution is at most this far from the end of a path: such ends are less accurate.
    pub(crate) const NEAR_SINGULAR: f64 = 1e-3;
    /// A point on a set of positive dimension is at most this far from the end of a path.
    pub(crate) const NEAR_SHEET: f64 = 1e-11;
    /// Most of that distance, whatever the error of the end.
    pub(crate) const NEAR_SHEET_AT_MOST: f64 = 1e-8;
    /// That distance in errors of the end.
    pub(crate) const NEAR_SHEET_ERRORS: f64 = 10.0;
    /// Relative values of equations from which on a point does not solve them.
    pub(crate) const NOT_ZERO: f64 = 1e-4;
    /// Coordinates below this share of the largest may really be zero, whatever their stated error.
    pub(crate) const SURELY_ZERO: f64 = 1e-5;
    /// Relative values of equations from which on a regular solution of combinations of them, to all digits of a
    /// double, does not solve them all. Below, it is refined.
    pub(crate) const MISSES: f64 = 1e-6;
    /// Binary digits that rounding may take from values of equations at a refined point.
    pub(crate) const ROUNDED_VALUES: f64 = 24.0;
    /// Relative corrections up to this size are due to rounding the point.
    pub(crate) const STEADY: f64 = 1e-13;
    /// Logarithm of pivots of the Jacobian that may be due to rounding the point as well.
    pub(crate) const FAINT_PIVOT: f64 = -36.0;
    /// Logarithm of pivots that are clear in doubles already.
    pub(crate) const PLAIN_PIVOT: f64 = -20.0;
    /// Coordinates of regular solutions have units of their own down to this share of the largest.
    pub(crate) const OWN_UNITS: f64 = 1e-14;
    /// Coordinates below this share of the largest, or of one, may be zero in truth where nothing
    /// is known of their error: ends at multiple solutions are not accurate.
    pub(crate) const SMALL: f64 = 1e-2;
    /// Numbers whose logarithm is at most this share of the digits count as zero at a refined point.
    pub(crate) const ZERO: f64 = -0.5;
    /// Numbers from this share of the digits on count as nonzero; what lies between is not clear.
    pub(crate) const CLEAR: f64 = -0.27;
    /// Equations at a refined point are this small at most, relative to their terms, as a share of
    /// the digits.
    pub(crate) const SOLVED: f64 = -0.58;
    /// Corrections up to this share of the digits end the iteration.
    pub(crate) const CONVERGED: f64 = -0.7;
    /// Logarithm of pivots that may be zero on a reduced set.
    pub(crate) const DOUBTFUL_PIVOT: f64 = -4.0;
    /// How far a point is moved along a set, in units of the coordinates.
    pub(crate) const STRIDES: [f64; 2] = [0.25, 0.0625];
    /// A moved point is still on the set if the logarithms of equations, relative to their terms,
    /// are at most this share of the digits.
    pub(crate) const UNSEEN: f64 = -0.77;
    /// A point is moved as far as the logarithm of its way, times the multiplicity that it may have, is more than
    /// this share of the digits.
    pub(crate) const VISIBLE: f64 = -0.38;
    /// Logarithms of the distances at which solutions beside a point are sought.
    pub(crate) const DISTANCES: [f64; 5] = [-4.0, -9.0, -14.0, -19.0, -24.0];
    /// An end may be as far from a rational point as this many times its error.
    pub(crate) const RATIONAL_ERRORS: f64 = 10.0;
    /// An end may be as far from a rational point as this in any case.
    pub(crate) const RATIONAL_LEAST: f64 = 1e-12;
    /// An end is never farther from a rational point than this.
    pub(crate) const RATIONAL_MOST: f64 = 1e-6;
    /// Denominators of rational coordinates are at most this.
    pub(crate) const DENOMINATOR: f64 = 1e4;
    /// Distance for rational solutions of high multiplicity, at which ends are less accurate than
    /// they seem.
    pub(crate) const ROUGH_RATIONAL: f64 = 1e-3;
    /// Denominators at such solutions.
    pub(crate) const ROUGH_DENOMINATOR: f64 = 12.0;
    /// Sizes of rational coordinates at most.
    pub(crate) const RATIONAL_SIZE: f64 = 1e9;
    /// The iteration for a root in one unknown ends once the logarithm of its correction is this
    /// small, relative to the root and to the distance of the next one.
    pub(crate) const ROOT_CORRECTION: f64 = -50.0;
    /// Evaluation errors in one unknown are at most this many bits above the last digit, for degrees
    /// up to 3000.
    pub(crate) const ROOT_ERROR: f64 = 26.0;
    /// Logarithm of what is left of an equation at a solution in the plane, relative to its terms,
    /// at most.
    pub(crate) const PLANE_SOLVES: f64 = -100.0;
    /// Logarithm of how much more is left at any other pair of roots.
    pub(crate) const PLANE_CLEARER: f64 = 16.0;
}

/// Thresholds by which several solutions close together are told apart, in numbers of 154 digits.
/// Logarithms are to base 2.
pub(crate) mod clusters {
    /// Logarithms of the tolerances at which ranks are read off.
    pub(crate) const RANKS: [f64; 6] = [-40.0, -30.0, -20.0, -13.0, -10.0, -6.5];
    /// Logarithm of the distance of a cluster from the end of a path, at most.
    pub(crate) const NEAR: f64 = -10.0;
    /// Logarithm of the width of a cluster, at most.
    pub(crate) const WIDEST: f64 = -7.0;
    /// Terms below this share of the largest (a logarithm) do not matter for starts of Newton's
    /// method.
    pub(crate) const SMALL_TERM: f64 = -90.0;
    /// Coefficients with a smaller logarithm are rounding errors.
    pub(crate) const NOISE: f64 = -400.0;
    /// Solutions with a smaller logarithm of their distance are the same: half of the digits.
    pub(crate) const SAME: f64 = -250.0;
    /// Relative distance below which two refined regular solutions are the same if none of their
    /// correct digits differ.
    pub(crate) const SAME_REGULAR: f64 = 1e-12;
    /// This distance for solutions that are known to more digits.
    pub(crate) const SAME_PRECISE: f64 = 2e-15;
    /// Solutions that are this many times farther from the centre than the cluster is wide do not
    /// belong to it.
    pub(crate) const OUTSIDE: f64 = 4096.0;
}
