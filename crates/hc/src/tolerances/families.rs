//! Thresholds of families, of their fibres, and of witness sets.

/// Thresholds of [families](crate::family): their fibres, symmetries and trace tests.
pub(crate) struct FamilyTolerances {
    /// Values of this size and below count as zero where a family demands that something does not
    /// vanish.
    pub(crate) vanishes: f64,
    /// A factor that must not vanish has vanished at the end of a path if a change of the coordinates by this
    /// share of the largest would make it vanish.
    pub(crate) degenerate: f64,
    /// Ends that are known to fewer digits than this are refined before they are compared. The
    /// remaining error is the square of the last correction, times the Lipschitz constant of
    /// Newton's method.
    pub(crate) vague: f64,
    /// After refinement the last correction must be below this.
    pub(crate) settled: f64,
    /// Coordinates below this share of the largest, squared, are zero or suspicious.
    pub(crate) vanished_sqr: f64,
    /// Accuracy to which new solutions, and images of solutions under a symmetry, must be known.
    pub(crate) accurate: f64,
    /// Relative distance below which the image of a solution is taken for a solution.
    pub(crate) same: f64,
    /// Accuracy to which the end of a path that is carried back from another chart must be known.
    pub(crate) carried: f64,
    /// The ratio of one scale of loops to the next.
    pub(crate) loop_scale: f64,
    /// The ratio of one scale that is tried for the reach of a fibre to the next.
    pub(crate) reach_scale: f64,
    /// The square root of that ratio.
    pub(crate) reach_middle: f64,
    /// A coordinate has left its tangent where the second of two equal steps differs from the first
    /// by this share.
    pub(crate) bent: f64,
    /// Steps by less than this share of a coordinate are rounding error of double-double.
    pub(crate) still: f64,
    /// A sum of points moves straight if it deviates from a straight line by less than this share of
    /// their sizes: the rest is rounding error of double-double.
    pub(crate) straight: f64,
    /// Deviations of a trace test below this pass. Those of whole fibres are rounding errors of
    /// double-double, some 1e-30; a missing point of another size than the others deviates by little
    /// more than this.
    pub(crate) trace_passed: f64,
    /// If refinement changes a stored solution by this relative amount or more, it is not a solution.
    pub(crate) stored_moved: f64,
    /// Condition number from which on a stored solution counts as singular.
    pub(crate) stored_condition: f64,
    /// Relative distance below which two stored solutions are the same.
    pub(crate) stored_same: f64,
}

/// The thresholds of families.
pub(crate) const FAMILIES: FamilyTolerances = FamilyTolerances {
    vanishes: 1e-9,
    degenerate: 1e-12,
    vague: 1e-7,
    settled: 1e-10,
    vanished_sqr: 1e-32,
    accurate: 1e-12,
    same: 1e-8,
    carried: 1e-8,
    loop_scale: 4.0,
    reach_scale: 64.0,
    reach_middle: 8.0,
    bent: 0.1,
    still: 1e-24,
    straight: 1e-26,
    trace_passed: 1e-18,
    stored_moved: 1e-12,
    stored_condition: 1e12,
    stored_same: 1e-8,
};

/// Thresholds of [witness sets](crate::witness).
pub(crate) struct WitnessTolerances {
    /// The logarithm (base 2) of pivots of a Jacobian that count as zero: points are known to some 50
    /// bits.
    pub(crate) zero_pivot: f64,
    /// Points within this relative distance are the same.
    pub(crate) same: f64,
    /// Largest relative distance by which refinement moves a witness point.
    pub(crate) near: f64,
    /// An end of paths lies on a component if a witness point, tracked to hyperplanes through that
    /// end, arrives within this relative distance: singular ends are known to about as many digits.
    pub(crate) on: f64,
    /// Coordinates below this share of the largest are zero: Newton's method leaves ever smaller
    /// numbers in their place, and squares of these underflow.
    pub(crate) nothing: f64,
    /// Coordinates of multiple points below this share of the largest are zero if the equations hold then.
    pub(crate) zero: f64,
    /// They hold if their residuals are less than this.
    pub(crate) zero_solved: f64,
    /// Far along a plane, coordinates below this share of the largest may be rounding errors.
    pub(crate) far_small: f64,
    /// A plane solves the equations if residuals far along it are less than this.
    pub(crate) far_solved: f64,
}

/// The thresholds of witness sets.
pub(crate) const WITNESS: WitnessTolerances = WitnessTolerances {
    zero_pivot: -27.0,
    same: 1e-8,
    near: 1e-8,
    on: 1e-6,
    nothing: 1e-40,
    zero: 1e-20,
    zero_solved: 1e-9,
    far_small: 1e-10,
    far_solved: 1e-4,
};
