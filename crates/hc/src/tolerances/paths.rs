//! Thresholds of tracking, refinement, the endgame, ends and proofs.

/// Thresholds of the [path tracker](crate::tracker). Steps follow Timme 2020, *Mixed precision path
/// tracking for polynomial homotopy continuation* (arXiv:1902.02968), with its `omega`, a Lipschitz
/// constant of Newton's method, and `mu`, the error of a correction.
pub(crate) struct TrackingTolerances {
    /// Newton iterations in one step, at most.
    pub(crate) iterations: usize,
    /// Share of a step that is left after a rejection without a contraction from which a better
    /// share follows (Timme 2020, section 4).
    pub(crate) hard_cut: f64,
    /// Rejections in a row after which steps may be held up by rounding errors of the parameters,
    /// which the corrector does not see.
    pub(crate) resistant: usize,
    /// `omega` at the start of a path; the first steps replace it.
    pub(crate) initial_omega: f64,
    /// Least `omega`.
    pub(crate) least_omega: f64,
    /// Corrections up to this multiple of the noise, the least correction seen, are noise.
    pub(crate) noise_margin: f64,
    /// Larger corrections are no rounding errors, whatever the noise: they say that `omega` is
    /// larger than was assumed.
    pub(crate) most_noise: f64,
    /// A closing correction above this share of the one before it, and above the noise, says that
    /// Newton's method has not converged yet: after quadratic convergence it is far smaller.
    pub(crate) unfinished: f64,
    /// Least weight of a coordinate, squared.
    pub(crate) least_weight_sqr: f64,
    /// Parts of a path below this share of the region in which Newton's method converges do not
    /// bound the step by their radius alone.
    pub(crate) faint: f64,
    /// The radius of faint parts counts at most so many times.
    pub(crate) faint_reach: f64,
    /// In logarithmic time a coordinate counts as `exp(v t)` if its derivatives are not larger than those for
    /// this `|v|`.
    pub(crate) steepest: f64,
}

/// The thresholds of the tracker.
pub(crate) const TRACKING: TrackingTolerances = TrackingTolerances {
    iterations: 6,
    hard_cut: 0.25,
    resistant: 4,
    initial_omega: 10.0,
    least_omega: 0.1,
    noise_margin: 16.0,
    most_noise: 1e-10,
    unfinished: 0.05,
    least_weight_sqr: 1e-12,
    faint: 0.01,
    faint_reach: 10.0,
    steepest: 200.0,
};

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
pub(crate) struct QuickEndTolerances {
    /// Largest first correction of a point at which a path goes on and that Newton's method brings nearer.
    pub(crate) approach: f64,
    /// Largest contraction there, of the second correction by the first.
    pub(crate) approach_contraction: f64,
    /// How often such a point is corrected.
    pub(crate) approaches: usize,
    /// Largest last correction of an end. The ends of paths are told apart by more.
    pub(crate) noise: f64,
    /// The same where coordinates vanish: Newton's method must still come back to the end from
    /// [near](RefinementTolerances::perturbations), which shows that it is regular.
    pub(crate) vanishing_noise: f64,
    /// Smallest pivot with which an end is taken for regular.
    pub(crate) pivot: f64,
}

/// The thresholds of the beginning and the end of quick steps in double precision.
pub(crate) const QUICK_ENDS: QuickEndTolerances = QuickEndTolerances {
    approach: 0.04,
    approach_contraction: 0.1,
    approaches: 3,
    noise: 1e-8,
    vanishing_noise: 1e-11,
    pivot: 1e-13,
};

/// Thresholds of [refinement](crate::refine): Newton's method with residuals in double-double.
pub(crate) struct RefinementTolerances {
    /// Iterations at most. Quadratic convergence from a tracked end takes two.
    pub(crate) iterations: usize,
    /// A Jacobian serves for the next correction too while corrections shrink by this factor: its
    /// error is about that large then.
    pub(crate) steady: f64,
    /// Corrections up to this size may shrink as fast.
    pub(crate) near: f64,
    /// Relative distances from one of which a regular solution must attract Newton's method. The
    /// first may drown in rounding errors, and from the second other solutions may attract.
    pub(crate) perturbations: [f64; 2],
    /// Such distances where Jacobians are in double-double.
    pub(crate) precise_perturbations: [f64; 2],
    /// Share of the distance that may be left after two corrections.
    pub(crate) returned: f64,
    /// Last correction of solutions that are plainly regular. At a distance of `d` from a singular
    /// solution, corrections are about `d` or more.
    pub(crate) tiny: f64,
    /// Lipschitz constants of Newton's method may be so many times as large as the tracker estimates them.
    pub(crate) omega_margin: f64,
    /// Condition number of solutions that are plainly regular. At a distance of `d` from a singular
    /// solution it is about `1 / d` or more.
    pub(crate) good_condition: f64,
    /// A Jacobian from elsewhere tells the condition if this times the relative distance is at most this:
    /// the least singular value changes by about the distance.
    pub(crate) unmoved: f64,
    /// A row of the Jacobian below this share of the largest, or of one, may be what rounding left
    /// of a row that vanishes, as on a double component. The condition does not tell, since rows
    /// are scaled to equal size.
    pub(crate) faint: f64,
    /// Random changes of all parameters that show how a solution depends on them.
    pub(crate) blur_draws: usize,
    /// Relative size of these changes: it stands out from rounding errors.
    pub(crate) blur_step: f64,
    /// Corrections of a point that is extended to double-double; each gains about as many digits as
    /// the Jacobian is known to.
    pub(crate) extensions: usize,
}

/// The thresholds of refinement.
pub(crate) const REFINEMENT: RefinementTolerances = RefinementTolerances {
    iterations: 6,
    steady: 1e-3,
    near: 1e-6,
    perturbations: [1e-8, 1e-6],
    precise_perturbations: [1e-14, 1e-12],
    returned: 1e-3,
    tiny: 1e-12,
    omega_margin: 10.0,
    good_condition: 1e6,
    unmoved: 1e-3,
    faint: 1e-10,
    blur_draws: 3,
    blur_step: 1e-6,
    extensions: 4,
};

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
pub(crate) struct EndgameTolerances {
    /// A loop that leaves no doubt; aliasing is below 1e-13.
    pub(crate) clear: LoopTolerances,
    /// For paths without a clear loop, because singularities lie so near to zero that double
    /// precision cannot go inside.
    pub(crate) vague: LoopTolerances,
    /// A loop on which rounded coefficients move a coordinate by this share of its size says
    /// nothing.
    pub(crate) blurred: f64,
    /// The worst rounding of all coefficients moves a coordinate this many times as far as a random
    /// one.
    pub(crate) blur_margin: f64,
    /// The lowest power of a diverging coordinate must reach this share of it. A singularity inside
    /// the loop, unlike a pole at zero, leaves coefficients that fade towards the lower powers.
    pub(crate) dominant: f64,
    /// If rounded coefficients move a coordinate by more than this share of its size, a wider
    /// circle is better.
    pub(crate) sharp: f64,
    /// If rounded coefficients move a coordinate by more than this on the widest circle too,
    /// samples would tell nothing.
    pub(crate) hopeless: f64,
    /// Relative distance below which a loop counts as closed, unless the samples are less accurate.
    pub(crate) closed: f64,
    /// Samples per turn if coordinates are of order between `t^(-5/4)` and `t^(5/4)`.
    pub(crate) samples: usize,
    /// Largest number of samples per turn: valuations up to 16.
    pub(crate) most_samples: usize,
    /// Largest number of samples if the radius cannot be made smaller.
    pub(crate) most_samples_wide: usize,
    /// After this many loops that were too wide, the path is tracked straight to zero.
    pub(crate) straight_after: u32,
    /// Share of a leg to zero that may be left before it is given up.
    pub(crate) left_of_leg: f64,
    /// Each circle is at least this many times smaller than the one before.
    pub(crate) least_shrink: f64,
}

/// The thresholds of the endgame.
pub(crate) const ENDGAME: EndgameTolerances = EndgameTolerances {
    clear: LoopTolerances { tail: 1e-5, zero: 1e-9, largest: f64::INFINITY },
    vague: LoopTolerances { tail: 1e-2, zero: 1e-5, largest: 0.35 },
    blurred: 1e-4,
    blur_margin: 256.0,
    dominant: 1e-2,
    sharp: 1e-6,
    hopeless: 1e-2,
    closed: 1e-10,
    samples: 4,
    most_samples: 64,
    most_samples_wide: 16,
    straight_after: 2,
    left_of_leg: 1e-7,
    least_shrink: 1.5,
};

/// Thresholds by which ends of paths are compared and classified.
pub(crate) struct EndTolerances {
    /// Imaginary parts of regular solutions up to this share of the point count as zero.
    pub(crate) real: f64,
    /// Imaginary parts of singular solutions up to this share of the point count as zero: they are
    /// known to fewer digits.
    pub(crate) real_singular: f64,
    /// Components smaller than this share of the largest are compared on its scale.
    pub(crate) floor: f64,
    /// Relative distance below which two singular ends are one point.
    pub(crate) cluster: f64,
    /// Coordinates up to this share of the largest count as zero where solutions with zero
    /// coordinates are left out.
    pub(crate) torus: f64,
    /// Relative distance below which two paths that have not yet ended are the same: only paths
    /// that have crossed come that near.
    pub(crate) crossed: f64,
    /// Relative error of a singular end that the tracker reached without being sure of it.
    pub(crate) reached: f64,
    /// Largest relative distance by which refinement moves the end of a path. Near a component,
    /// Newton's method leads away to regular solutions.
    pub(crate) arrived: f64,
    /// Where the endgame begins, if early.
    pub(crate) early: f64,
    /// Least radius of the first circle of the endgame in every second attempt, on paths with
    /// further unknowns.
    pub(crate) least_circle: f64,
    /// Condition numbers below which solutions for exact coefficients have all their digits.
    pub(crate) exact_condition: f64,
    /// Residuals of such solutions; for a single equation the condition number says nothing.
    pub(crate) exact_residual: f64,
    /// How far rounded coefficients may move a regular solution that can still be separated from
    /// others.
    pub(crate) rounded: f64,
    /// Relative distance up to which two ends, or two multiple solutions, are the same point.
    pub(crate) one_point: f64,
}

/// The thresholds for ends of paths.
pub(crate) const ENDS: EndTolerances = EndTolerances {
    real: 1e-10,
    real_singular: 1e-7,
    floor: 1e-4,
    cluster: 1e-6,
    torus: 1e-12,
    crossed: 1e-11,
    reached: 1e-6,
    arrived: 1e-5,
    early: 1e-3,
    least_circle: 1e-4,
    exact_condition: 1e8,
    exact_residual: 1e-14,
    rounded: 1e-4,
    one_point: 1e-13,
};

/// Thresholds of [proofs](mod@crate::certify). No proof rests on them: they choose the boxes that
/// are tried.
pub(crate) struct ProofTolerances {
    /// Newton steps at most. From two digits on each step about doubles them; later steps gain as
    /// much as the inverse is good for.
    pub(crate) newton_steps: usize,
    /// The second correction is at most this share of the first; near a double root it would be one
    /// half.
    pub(crate) contraction: f64,
    /// First corrections this small, relative to the weights, are rounding errors; the second
    /// correction then means nothing.
    pub(crate) rounding: f64,
    /// What is carried over from other unknowns stays below one part in this many of a box.
    pub(crate) level: f64,
    /// Boxes that are tried.
    pub(crate) boxes: usize,
    /// Each box is smaller than the one before by at least this factor.
    pub(crate) shrink: f64,
    /// How often a proved box is made smaller, as long as this at least halves it.
    pub(crate) tighter: usize,
    /// Proved boxes that are this many times wider than the least are made smaller if possible.
    pub(crate) wide: f64,
    /// A box is at least this many times the correction, so that the correction fits well inside.
    pub(crate) room: f64,
}

/// The thresholds of proofs.
pub(crate) const PROOFS: ProofTolerances = ProofTolerances {
    newton_steps: 12,
    contraction: 0.25,
    rounding: 1e-12,
    level: 16.0,
    boxes: 16,
    shrink: 1.0 / 64.0,
    tighter: 6,
    wide: 16.0,
    room: 4.0,
};
