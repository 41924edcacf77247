//! Thresholds of tracking, refinement, the endgame, ends and proofs.

/// Thresholds of the [path tracker](crate::tracker). Steps follow Timme 2020, *Mixed precision path
/// tracking for polynomial homotopy continuation* (arXiv:1902.02968), with its `omega`, a Lipschitz
/// constant of Newton's method, and `mu`, the error of a correction.
pub(crate) mod tracking {
    /// Newton iterations in one step, at most.
    pub(crate) const ITERATIONS: usize = 6;
    /// Share of a step that is left after a rejection without a contraction from which a better
    /// share follows (Timme 2020, section 4).
    pub(crate) const HARD_CUT: f64 = 0.25;
    /// Rejections in a row after which steps may be held up by rounding errors of the parameters,
    /// which the corrector does not see.
    pub(crate) const RESISTANT: usize = 4;
    /// `omega` at the start of a path; the first steps replace it.
    pub(crate) const INITIAL_OMEGA: f64 = 10.0;
    /// Least `omega`.
    pub(crate) const LEAST_OMEGA: f64 = 0.1;
    /// Corrections up to this multiple of the noise, the least correction seen, are noise.
    pub(crate) const NOISE_MARGIN: f64 = 16.0;
    /// Larger corrections are no rounding errors, whatever the noise: they say that `omega` is
    /// larger than was assumed.
    pub(crate) const MOST_NOISE: f64 = 1e-10;
    /// A closing correction above this share of the one before it, and above the noise, says that
    /// Newton's method has not converged yet: after quadratic convergence it is far smaller.
    pub(crate) const UNFINISHED: f64 = 0.05;
    /// Least weight of a coordinate, squared.
    pub(crate) const LEAST_WEIGHT_SQR: f64 = 1e-12;
    /// Parts of a path below this share of the region in which Newton's method converges do not
    /// bound the step by their radius alone.
    pub(crate) const FAINT: f64 = 0.01;
    /// A point whose coordinates are all below this share of their weights, squared, is zero up to rounding errors.
    pub(crate) const NO_SIZE: f64 = 1e-16;
    /// The radius of faint parts counts at most so many times.
    pub(crate) const FAINT_REACH: f64 = 10.0;
    /// In logarithmic time a coordinate counts as `exp(v t)` if its derivatives are not larger than those for
    /// this `|v|`.
    pub(crate) const STEEPEST: f64 = 200.0;
}

/// Thresholds of [quick](crate::TrackerOptions::quick) steps. Corrections of an attempt all take the
/// Jacobian at the predicted point; they are relative to the weights of the unknowns.
pub(crate) struct QuickTolerances {
    /// Largest contraction, of the second correction by the first.
    pub(crate) contraction: f64,
    /// Largest first correction.
    pub(crate) first: f64,
    /// The third correction is at most this, or contracts as the second must. It shows attempts that
    /// converge to another path.
    pub(crate) third: f64,
    /// Where the first two corrections are below this, their contraction means nothing.
    pub(crate) small: f64,
    /// Nor do first and second corrections below these tell `omega`.
    pub(crate) telling: [f64; 2],
    /// Largest first correction at a start solution.
    pub(crate) start: f64,
    /// `omega` times the error of the predictor that a step aims at.
    pub(crate) aim: f64,
    /// Least `omega` by which steps are chosen.
    pub(crate) least_omega: f64,
    /// A step is at most this many times as long as the one before.
    pub(crate) growth: f64,
    /// Share of a step that is left after a rejection.
    pub(crate) cut: f64,
    /// Rejections in a row after which more care is cheaper.
    pub(crate) patience: usize,
    /// Attempts after which more care is cheaper.
    pub(crate) attempts: usize,
    /// The `t` below which paths that have not arrived are left: their ends may be singular or at infinity.
    pub(crate) least_t: f64,
    /// Rounding error of the arithmetic.
    pub(crate) epsilon: f64,
}

/// The thresholds of quick steps in double precision.
pub(crate) const QUICK: QuickTolerances = QuickTolerances {
    contraction: 0.3,
    first: 0.2,
    third: 1e-8,
    small: 1e-7,
    telling: [1e-6, 1e-9],
    start: 1e-6,
    aim: 0.1,
    least_omega: 2.0,
    growth: 4.0,
    cut: 0.5,
    patience: 12,
    attempts: 150,
    least_t: 1e-4,
    epsilon: f64::EPSILON,
};

/// The thresholds of quick steps in single precision.
pub(crate) const SINGLES: QuickTolerances = QuickTolerances {
    contraction: 0.4,
    third: 1e-3,
    small: 1e-3,
    telling: [1e-3, 1e-5],
    start: 1e-3,
    patience: 4,
    attempts: 100,
    epsilon: f32::EPSILON as f64,
    ..QUICK
};

/// Thresholds of the beginning and the end of quick steps in double precision.
pub(crate) mod quick_ends {
    /// Largest first correction of a point at which a path goes on and that Newton's method brings nearer.
    pub(crate) const APPROACH: f64 = 0.04;
    /// Largest contraction there, of the second correction by the first.
    pub(crate) const APPROACH_CONTRACTION: f64 = 0.1;
    /// How often such a point is corrected.
    pub(crate) const APPROACHES: usize = 3;
    /// Largest last correction of an end. The ends of paths are told apart by more.
    pub(crate) const NOISE: f64 = 1e-8;
    /// Largest last correction of an end at which coordinates vanish: Newton's method must still come back to the end from
    /// [near](super::refinement::PERTURBATIONS), which shows that it is regular.
    pub(crate) const VANISHING_NOISE: f64 = 1e-11;
    /// Smallest pivot with which an end is taken for regular.
    pub(crate) const PIVOT: f64 = 1e-13;
}

/// Thresholds of [refinement](crate::refine): Newton's method with residuals in double-double.
pub(crate) mod refinement {
    /// Iterations at most. Quadratic convergence from a tracked end takes two.
    pub(crate) const ITERATIONS: usize = 6;
    /// A Jacobian serves for the next correction too while corrections shrink by this factor: its
    /// error is about that large then.
    pub(crate) const STEADY: f64 = 1e-3;
    /// Corrections up to this size may shrink as fast.
    pub(crate) const NEAR: f64 = 1e-6;
    /// Relative distances from one of which a regular solution must attract Newton's method. The
    /// first may drown in rounding errors, and from the second other solutions may attract.
    pub(crate) const PERTURBATIONS: [f64; 2] = [1e-8, 1e-6];
    /// Such distances where Jacobians are in double-double.
    pub(crate) const PRECISE_PERTURBATIONS: [f64; 2] = [1e-14, 1e-12];
    /// Share of the distance that may be left after two corrections.
    pub(crate) const RETURNED: f64 = 1e-3;
    /// Last correction of solutions that are plainly regular. At a distance of `d` from a singular
    /// solution, corrections are about `d` or more.
    pub(crate) const TINY: f64 = 1e-12;
    /// Lipschitz constants of Newton's method may be so many times as large as the tracker estimates them.
    pub(crate) const OMEGA_MARGIN: f64 = 10.0;
    /// Condition number of solutions that are plainly regular. At a distance of `d` from a singular
    /// solution it is about `1 / d` or more.
    pub(crate) const GOOD_CONDITION: f64 = 1e6;
    /// A Jacobian from elsewhere tells the condition if this times the relative distance is at most this:
    /// the least singular value changes by about the distance.
    pub(crate) const UNMOVED: f64 = 1e-3;
    /// A row of the Jacobian below this share of the largest, or of one, may be what rounding left
    /// of a row that vanishes, as on a double component. The condition does not tell, since rows
    /// are scaled to equal size.
    pub(crate) const FAINT: f64 = 1e-10;
    /// Random changes of all parameters that show how a solution depends on them.
    pub(crate) const BLUR_DRAWS: usize = 3;
    /// Relative size of these changes: it stands out from rounding errors.
    pub(crate) const BLUR_STEP: f64 = 1e-6;
    /// Corrections of a point that is extended to double-double; each gains about as many digits as
    /// the Jacobian is known to.
    pub(crate) const EXTENSIONS: usize = 4;
}

/// Thresholds for reading a closed loop of the endgame.
#[derive(Clone, Copy)]
pub(crate) struct LoopTolerances {
    /// Fourier coefficients of the highest frequencies may reach this share of a coordinate.
    pub(crate) tail: f64,
    /// Fourier coefficients below this share of their coordinate count as zero.
    pub(crate) zero: f64,
    /// Where lower powers do not vanish, a coordinate is of the order of the lowest power that
    /// makes up this share of it.
    pub(crate) largest: f64,
}

/// Thresholds of the endgame: Cauchy's integral on circles about zero (Morgan, Sommese & Wampler
/// 1991, *Computing singular solutions to nonlinear analytic systems*).
pub(crate) mod endgame {
    use super::LoopTolerances;

    /// A loop that leaves no doubt; aliasing is below 1e-13.
    pub(crate) const CLEAR: LoopTolerances = LoopTolerances { tail: 1e-5, zero: 1e-9, largest: f64::INFINITY };
    /// For paths without a clear loop, because singularities lie so near to zero that double
    /// precision cannot go inside.
    pub(crate) const VAGUE: LoopTolerances = LoopTolerances { tail: 1e-2, zero: 1e-5, largest: 0.35 };
    /// A loop on which rounded coefficients move a coordinate by this share of its size says
    /// nothing.
    pub(crate) const BLURRED: f64 = 1e-4;
    /// The worst rounding of all coefficients moves a coordinate this many times as far as a random
    /// one.
    pub(crate) const BLUR_MARGIN: f64 = 256.0;
    /// The lowest power of a diverging coordinate must reach this share of it. A singularity inside
    /// the loop, unlike a pole at zero, leaves coefficients that fade towards the lower powers.
    pub(crate) const DOMINANT: f64 = 1e-2;
    /// If rounded coefficients move a coordinate by more than this share of its size, a wider
    /// circle is better.
    pub(crate) const SHARP: f64 = 1e-6;
    /// If rounded coefficients move a coordinate by more than this on the widest circle too,
    /// samples would tell nothing.
    pub(crate) const HOPELESS: f64 = 1e-2;
    /// Relative distance below which a loop counts as closed, unless the samples are less accurate.
    pub(crate) const CLOSED: f64 = 1e-10;
    /// Samples per turn if coordinates are of order between `t^(-5/4)` and `t^(5/4)`.
    pub(crate) const SAMPLES: usize = 4;
    /// Largest number of samples per turn: valuations up to 16.
    pub(crate) const MOST_SAMPLES: usize = 64;
    /// Largest number of samples if the radius cannot be made smaller.
    pub(crate) const MOST_SAMPLES_WIDE: usize = 16;
    /// After this many loops that were too wide, the path is tracked straight to zero.
    pub(crate) const STRAIGHT_AFTER: u32 = 2;
    /// Share of a leg to zero that may be left before it is given up.
    pub(crate) const LEFT_OF_LEG: f64 = 1e-7;
    /// Leading terms of an equation cancel on a path to infinity if this share of them is left at most.
    pub(crate) const CANCELS: f64 = 0.1;
    /// Where they do not, paths are followed until coordinates have about this size: products of five are numbers still.
    pub(crate) const FAR: f64 = 1e60;
    /// A path goes on to infinity if the logarithms of its coordinates grow up to there as the first clear loop says,
    /// but for this share.
    pub(crate) const GROWN: f64 = 0.05;
    /// Circles of a smaller radius than this are not looked at.
    pub(crate) const LEAST_RADIUS: f64 = 1e-290;
    /// Each circle is at least this many times smaller than the one before.
    pub(crate) const LEAST_SHRINK: f64 = 1.5;
}

/// Relative distances up to which two points are one. Points that are known to more digits have thresholds
/// where they are compared.
pub(crate) mod same {
    /// Regular solutions: ends of paths, images under a symmetry, stored ones.
    pub(crate) const REGULAR: f64 = 1e-8;
    /// Ends of paths that may be singular, which are known to about so many digits.
    pub(crate) const SINGULAR: f64 = 1e-6;
}

/// Thresholds by which ends of paths are compared and classified.
pub(crate) mod ends {
    /// Imaginary parts of regular solutions up to this share of the point count as zero.
    pub(crate) const REAL: f64 = 1e-10;
    /// Imaginary parts of multiple solutions up to this share of the point count as zero: these are known to all digits.
    pub(crate) const REAL_SINGULAR: f64 = 1e-14;
    /// Imaginary parts of regular solutions above this share of the point are surely not zero.
    pub(crate) const SURELY_IMAGINARY: f64 = 1e-6;
    /// Imaginary parts up to this share of the point are rounding errors, if the coefficients are real and the condition
    /// is good: the conjugate is the same solution.
    pub(crate) const SURELY_REAL: f64 = 1e-13;
    /// Components smaller than this share of the largest are compared on its scale.
    pub(crate) const FLOOR: f64 = 1e-4;
    /// Coordinates up to this share of the largest count as zero where solutions with zero
    /// coordinates are left out.
    pub(crate) const TORUS: f64 = 1e-12;
    /// Relative distance below which two paths that have not yet ended are the same: only paths
    /// that have crossed come that near.
    pub(crate) const CROSSED: f64 = 1e-11;
    /// Relative error of a singular end that the tracker reached without being sure of it.
    pub(crate) const REACHED: f64 = 1e-6;
    /// Largest relative distance by which refinement moves the end of a path. Near a component,
    /// Newton's method leads away to regular solutions.
    pub(crate) const ARRIVED: f64 = 1e-5;
    /// Where the endgame begins, if early.
    pub(crate) const EARLY: f64 = 1e-3;
    /// Least radius of the first circle of the endgame in every second attempt, on paths with
    /// further unknowns.
    pub(crate) const LEAST_CIRCLE: f64 = 1e-4;
    /// Condition numbers below which solutions for exact coefficients have all their digits.
    pub(crate) const EXACT_CONDITION: f64 = 1e8;
    /// Residuals of such solutions; for a single equation the condition number says nothing.
    pub(crate) const EXACT_RESIDUAL: f64 = 1e-14;
    /// How far rounded coefficients may move a regular solution that can still be separated from
    /// others.
    pub(crate) const ROUNDED: f64 = 1e-4;
    /// Relative distance up to which two ends, or two multiple solutions, are the same point.
    pub(crate) const ONE_POINT: f64 = 1e-13;
}

/// Thresholds of [proofs](mod@crate::certify). No proof rests on them: they choose the boxes that
/// are tried.
pub(crate) mod proofs {
    /// Newton steps at most. From two digits on each step about doubles them; later steps gain as
    /// much as the inverse is good for.
    pub(crate) const NEWTON_STEPS: usize = 12;
    /// The second correction is at most this share of the first; near a double root it would be one
    /// half.
    pub(crate) const CONTRACTION: f64 = 0.25;
    /// First corrections this small, relative to the weights, are rounding errors; the second
    /// correction then means nothing.
    pub(crate) const ROUNDING: f64 = 1e-12;
    /// What is carried over from other unknowns stays below one part in this many of a box.
    pub(crate) const LEVEL: f64 = 16.0;
    /// Boxes that are tried.
    pub(crate) const BOXES: usize = 16;
    /// Each box is smaller than the one before by at least this factor.
    pub(crate) const SHRINK: f64 = 1.0 / 64.0;
    /// How often a proved box is made smaller, as long as this at least halves it.
    pub(crate) const TIGHTER: usize = 6;
    /// Proved boxes that are this many times wider than the least are made smaller if possible.
    pub(crate) const WIDE: f64 = 16.0;
    /// A box is at least this many times the correction, so that the correction fits well inside.
    pub(crate) const ROOM: f64 = 4.0;
}
