//! Thresholds of families, of their fibres, and of witness sets.

/// Thresholds of [families](crate::family): their fibres, symmetries and trace tests.
pub(crate) mod families {
    /// Values of this size and below count as zero where a family demands that something does not
    /// vanish.
    pub(crate) const VANISHES: f64 = 1e-9;
    /// Values of this size and below count as zero at singular solutions, which are known to fewer digits.
    pub(crate) const VANISHES_SINGULAR: f64 = 1e-5;
    /// A solution for other parameters may be one for all if its residual there is no more than this, and is one if
    /// Newton's method moves it by no more than this share, some units in the last place.
    pub(crate) const STILL_RESIDUAL: f64 = 1e-8;
    pub(crate) const STILL_MOVED: f64 = 1e-14;
    /// Coordinates below this share of the largest, or of one, are tried as zero; the others may then move by this
    /// share of their sizes.
    pub(crate) const TINY: f64 = 1e-6;
    pub(crate) const NEARBY: f64 = 1e-3;
    /// A first solution that Newton's method moves by more than this share is none.
    pub(crate) const FIRST_MOVED: f64 = 0.1;
    /// A factor that must not vanish has vanished at the end of a path if a change of the coordinates by this
    /// share of the largest would make it vanish.
    pub(crate) const DEGENERATE: f64 = 1e-12;
    /// Ends that are known to fewer digits than this are refined before they are compared. The
    /// remaining error is the square of the last correction, times the Lipschitz constant of
    /// Newton's method.
    pub(crate) const VAGUE: f64 = 1e-7;
    /// After refinement the last correction must be below this.
    pub(crate) const SETTLED: f64 = 1e-10;
    /// Coordinates below this share of the largest, squared, are zero or suspicious.
    pub(crate) const VANISHED_SQR: f64 = 1e-32;
    /// Accuracy to which new solutions, and images of solutions under a symmetry, must be known.
    pub(crate) const ACCURATE: f64 = 1e-12;
    /// Accuracy to which the end of a path that is carried back from another chart must be known.
    pub(crate) const CARRIED: f64 = 1e-8;
    /// Relative values of equations in double-double up to which a regular solution of combinations of them solves
    /// all: the errors of a solution of condition 1e10.
    pub(crate) const SOLVES: f64 = 1e-20;
    /// Relative values from which on it does not; between the two its digits do not tell.
    pub(crate) const MISSES: f64 = 1e-12;
    /// The ratio of one scale of loops to the next.
    pub(crate) const LOOP_SCALE: f64 = 4.0;
    /// The ratio of one scale that is tried for the reach of a fibre to the next.
    pub(crate) const REACH_SCALE: f64 = 64.0;
    /// The square root of that ratio.
    pub(crate) const REACH_MIDDLE: f64 = 8.0;
    /// A coordinate has left its tangent where the second of two equal steps differs from the first
    /// by this share.
    pub(crate) const BENT: f64 = 0.1;
    /// Steps by less than this share of a coordinate are rounding error of double-double.
    pub(crate) const STILL: f64 = 1e-24;
    /// A sum of points moves straight if it deviates from a straight line by less than this share of
    /// their sizes: the rest is rounding error of double-double.
    pub(crate) const STRAIGHT: f64 = 1e-26;
    /// Parts of a fibre whose sum deviates by less than this, in doubles, are looked at in double-double.
    pub(crate) const NEARLY_STRAIGHT: f64 = 1e-12;
    /// Deviations of a trace test below this pass. Those of whole fibres are rounding errors of
    /// double-double, some 1e-30; a missing point of another size than the others deviates by little
    /// more than this.
    pub(crate) const TRACE_PASSED: f64 = 1e-18;
    /// If refinement changes a stored solution by this relative amount or more, it is not a solution.
    pub(crate) const STORED_MOVED: f64 = 1e-12;
    /// Condition number from which on a stored solution counts as singular.
    pub(crate) const STORED_CONDITION: f64 = 1e12;
}

/// Thresholds of [witness sets](crate::witness).
pub(crate) mod witness {
    /// The logarithm (base 2) of pivots of a Jacobian that count as zero: points are known to some 50
    /// bits.
    pub(crate) const ZERO_PIVOT: f64 = -27.0;
    /// Largest relative distance by which refinement moves a witness point.
    pub(crate) const NEAR: f64 = 1e-8;
    /// Coordinates below this share of the largest are zero: Newton's method leaves ever smaller
    /// numbers in their place, and squares of these underflow.
    pub(crate) const NOTHING: f64 = 1e-40;
    /// Coordinates of multiple points below this share of the largest are zero if the equations hold then.
    pub(crate) const ZERO: f64 = 1e-20;
    /// They hold if their residuals are less than this.
    pub(crate) const ZERO_SOLVED: f64 = 1e-9;
    /// Far along a plane, coordinates below this share of the largest may be rounding errors.
    pub(crate) const FAR_SMALL: f64 = 1e-10;
    /// A plane solves the equations if residuals far along it are less than this.
    pub(crate) const FAR_SOLVED: f64 = 1e-4;
}

/// Thresholds of [sweeps](crate::sweep). The number of solutions of a cell rests on the first three.
pub(crate) mod sweeps {
    /// Where another solution is within this share of the size of a solution, or of its conjugate, proofs tell them
    /// apart, not digits: solutions of condition 1e8 are known to as many.
    pub(crate) const NEAR: f64 = 1e-6;
    /// A coordinate that is less than this times the condition, as a share of the largest, may be zero.
    pub(crate) const ROUNDING: f64 = 64.0 * f64::EPSILON;
    /// A coordinate of a multiple solution that is less than this share of the largest may be zero.
    pub(crate) const BLURRED: f64 = 1e-6;
    /// The end of a path between cells is the solution there that is nearest, if it is within this share of the sizes
    /// that the coordinates have in both cells,
    pub(crate) const ARRIVED: f64 = 1e-6;
    /// and nearer than this share of the distance to the next one.
    pub(crate) const ALONE: f64 = 0.1;
    /// Two branches meet where the ways along them break off within this share of the way between two cells,
    pub(crate) const MEETING_TIME: f64 = 1e-2;
    /// and at points that are within this share of the sizes of the coordinates: at a fold, their distance is of the
    /// order of the root of the way that is left.
    pub(crate) const MEETING_PLACE: f64 = 1e-2;
    /// A branch goes to infinity where the way along it breaks off at coordinates so many times as large as in the cells.
    pub(crate) const FAR: f64 = 1e4;
}
