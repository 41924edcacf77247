//! Thresholds of equations, of the structure of singular ends, and of clusters.

/// Thresholds by which equations are scaled, rewritten and refused before paths are tracked.
pub(crate) struct EquationTolerances {
    /// If at least this much of an equation of size one is left beside combinations of the equations
    /// before it, the equation stays as it is.
    pub(crate) dependent: f64,
    /// The least part of a row that must be left beside the rows before it by Gram and Schmidt's
    /// orthogonalisation, for rows to count as independent.
    pub(crate) independent: f64,
    /// Equations of many terms are refused if their scaled coefficients differ by more decades than
    /// this.
    pub(crate) spread: f64,
    /// Formulas that multiply as many sums, counted with multiplicity, get unknowns for these. Expanded,
    /// `(x + y)^n - 1` with `x - y^2` takes hardly longer with `n` = 8, twice as long with 10, four times with 15,
    /// and loses solutions with 30.
    pub(crate) factors: u32,
    /// The same where components are sought: these are multiple if they come from powers.
    pub(crate) factors_of_components: u32,
    /// Products of up to this many sums are expanded all the same, where longer ones get unknowns.
    pub(crate) kept_factors: u32,
    /// Most unknowns for sums: mixed cells and linear algebra take longer with each.
    pub(crate) named_sums: usize,
    /// Spread of the logarithms (base 2) of coefficients in an equation below which unknowns are
    /// not scaled.
    pub(crate) mild: f64,
    /// Scales with a larger exponent (base 2) are not used.
    pub(crate) most_exponent: f64,
    /// In a toric homotopy, terms outside the binomials start at `exp` of minus this number, about
    /// 1e-13, of their size.
    pub(crate) faded: f64,
}

/// The thresholds of equations.
pub(crate) const EQUATIONS: EquationTolerances = EquationTolerances {
    dependent: 1e-5,
    independent: 1e-6,
    spread: 30.0,
    factors: 10,
    factors_of_components: 4,
    kept_factors: 3,
    named_sums: 128,
    mild: 14.0,
    most_exponent: 200.0,
    faded: 30.0,
};

/// Thresholds by which the local structure of an end is decided: regular, of a multiplicity, or on
/// a set of positive dimension. Logarithms are to base 2; arithmetic is in double-double or in
/// numbers of up to 154 digits.
pub(crate) struct LocalTolerances {
    /// Logarithms of the tolerances at which ranks are read off near a solution, the strictest
    /// first; each gives a hypothesis, which deflation then tests.
    pub(crate) ranks: [f64; 7],
    /// Steps in which stricter ones follow in numbers of more digits.
    pub(crate) finer_ranks: f64,
    /// Orders of series with such tolerances that are tried on sets that are not reduced.
    pub(crate) sheet_ranks: [(usize, f64); 4],
    /// A regular solution is at most this far from the end of a path, relatively.
    pub(crate) near: f64,
    /// A regular solution is at most this many times the error of the end away from it.
    pub(crate) near_errors: f64,
    /// A singular solution is at most this far from the end of a path: such ends are less accurate.
    pub(crate) near_singular: f64,
    /// A point on a set of positive dimension is at most this far from the end of a path.
    pub(crate) near_sheet: f64,
    /// Most of that distance, whatever the error of the end.
    pub(crate) near_sheet_at_most: f64,
    /// That distance in errors of the end.
    pub(crate) near_sheet_errors: f64,
    /// Relative values of equations from which on a point does not solve them.
    pub(crate) not_zero: f64,
    /// Coordinates below this share of the largest may really be zero, whatever their stated error.
    pub(crate) surely_zero: f64,
    /// Relative values of equations up to which a regular solution of combinations of them surely
    /// solves all.
    pub(crate) solves: f64,
    /// Relative values of equations from which on it does not; between the two it is refined.
    pub(crate) misses: f64,
    /// Relative corrections up to this size are due to rounding the point.
    pub(crate) steady: f64,
    /// Logarithm of pivots of the Jacobian that may be due to rounding the point as well.
    pub(crate) faint_pivot: f64,
    /// Logarithm of pivots that are clear in doubles already.
    pub(crate) plain_pivot: f64,
    /// Coordinates of regular solutions have units of their own down to this share of the largest.
    pub(crate) own_units: f64,
    /// Coordinates below this share of the largest, or of one, may be zero in truth where nothing
    /// is known of their error: ends at multiple solutions are not accurate.
    pub(crate) small: f64,
    /// Numbers whose logarithm is at most this share of the digits count as zero at a refined point.
    pub(crate) zero: f64,
    /// Numbers from this share of the digits on count as nonzero; what lies between is not clear.
    pub(crate) clear: f64,
    /// Equations at a refined point are this small at most, relative to their terms, as a share of
    /// the digits.
    pub(crate) solved: f64,
    /// Corrections up to this share of the digits end the iteration.
    pub(crate) converged: f64,
    /// Logarithm of pivots that may be zero on a reduced set.
    pub(crate) doubtful_pivot: f64,
    /// How far a point is moved along a set, in units of the coordinates.
    pub(crate) strides: [f64; 2],
    /// A moved point is still on the set if the logarithms of equations, relative to their terms,
    /// are at most this share of the digits.
    pub(crate) unseen: f64,
    /// A point is moved as far as the logarithm of its way, times the multiplicity that it may have, is more than
    /// this share of the digits.
    pub(crate) visible: f64,
    /// Logarithms of the distances at which solutions beside a point are sought.
    pub(crate) distances: [f64; 5],
    /// An end may be as far from a rational point as this many times its error.
    pub(crate) rational_errors: f64,
    /// An end may be as far from a rational point as this in any case.
    pub(crate) rational_least: f64,
    /// An end is never farther from a rational point than this.
    pub(crate) rational_most: f64,
    /// Denominators of rational coordinates are at most this.
    pub(crate) denominator: f64,
    /// Distance for rational solutions of high multiplicity, at which ends are less accurate than
    /// they seem.
    pub(crate) rough_rational: f64,
    /// Denominators at such solutions.
    pub(crate) rough_denominator: f64,
    /// Sizes of rational coordinates at most.
    pub(crate) rational_size: f64,
    /// The iteration for a root in one unknown ends once the logarithm of its correction is this
    /// small, relative to the root and to the distance of the next one.
    pub(crate) root_correction: f64,
    /// Evaluation errors in one unknown are at most this many bits above the last digit, for degrees
    /// up to 3000.
    pub(crate) root_error: f64,
    /// Logarithm of what is left of an equation at a solution in the plane, relative to its terms,
    /// at most.
    pub(crate) plane_solves: f64,
    /// Logarithm of how much more is left at any other pair of roots.
    pub(crate) plane_clearer: f64,
}

/// The thresholds of local structure.
pub(crate) const LOCAL: LocalTolerances = LocalTolerances {
    ranks: [-40.0, -30.0, -20.0, -13.0, -10.0, -6.5, -3.5],
    finer_ranks: 20.0,
    sheet_ranks: [(2, -20.0), (2, -12.0), (3, -20.0), (3, -12.0)],
    near: 1e-7,
    near_errors: 1e2,
    near_singular: 1e-3,
    near_sheet: 1e-11,
    near_sheet_at_most: 1e-8,
    near_sheet_errors: 10.0,
    not_zero: 1e-4,
    surely_zero: 1e-5,
    solves: 1e-13,
    misses: 1e-6,
    steady: 1e-13,
    faint_pivot: -36.0,
    plain_pivot: -20.0,
    own_units: 1e-14,
    small: 1e-2,
    zero: -0.5,
    clear: -0.27,
    solved: -0.58,
    converged: -0.7,
    doubtful_pivot: -4.0,
    strides: [0.25, 0.0625],
    unseen: -0.77,
    visible: -0.38,
    distances: [-4.0, -9.0, -14.0, -19.0, -24.0],
    rational_errors: 10.0,
    rational_least: 1e-12,
    rational_most: 1e-6,
    denominator: 1e4,
    rough_rational: 1e-3,
    rough_denominator: 12.0,
    rational_size: 1e9,
    root_correction: -50.0,
    root_error: 26.0,
    plane_solves: -100.0,
    plane_clearer: 16.0,
};

/// Thresholds by which several solutions close together are told apart, in numbers of 154 digits.
/// Logarithms are to base 2.
pub(crate) struct ClusterTolerances {
    /// Logarithms of the tolerances at which ranks are read off.
    pub(crate) ranks: [f64; 6],
    /// Logarithm of the distance of a cluster from the end of a path, at most.
    pub(crate) near: f64,
    /// Logarithm of the width of a cluster, at most.
    pub(crate) widest: f64,
    /// Terms below this share of the largest (a logarithm) do not matter for starts of Newton's
    /// method.
    pub(crate) small_term: f64,
    /// Coefficients with a smaller logarithm are rounding errors.
    pub(crate) noise: f64,
    /// Solutions with a smaller logarithm of their distance are the same: half of the digits.
    pub(crate) same: f64,
    /// Relative distance below which two refined regular solutions are the same if none of their
    /// correct digits differ.
    pub(crate) same_regular: f64,
    /// This distance for solutions that are known to more digits.
    pub(crate) same_precise: f64,
    /// Solutions that are this many times farther from the centre than the cluster is wide do not
    /// belong to it.
    pub(crate) outside: f64,
}

/// The thresholds of clusters.
pub(crate) const CLUSTERS: ClusterTolerances = ClusterTolerances {
    ranks: [-40.0, -30.0, -20.0, -13.0, -10.0, -6.5],
    near: -10.0,
    widest: -7.0,
    small_term: -90.0,
    noise: -400.0,
    same: -250.0,
    same_regular: 1e-12,
    same_precise: 2e-15,
    outside: 4096.0,
};
