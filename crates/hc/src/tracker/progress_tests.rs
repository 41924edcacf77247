//! What corrections say of a path.

use super::{Bounds, PathProgress, StepState, h};
use crate::tracker::TrackerOptions;
use crate::tracker::resume::ResumePoint;

/// On its way, with residuals in double-double.
fn under_way(omega: f64, bounds: &Bounds) -> PathProgress {
    let mut progress =
        PathProgress { fresh: false, extended: true, omega, ..PathProgress::from(&ResumePoint::at_start(0), 1) };
    progress.begin_correction(bounds);
    progress
}

/// With `omega = 2.5e5`, quadratic convergence gives corrections of 1.1e-6 and 1.6e-7, although by the
/// omega of the step before, the first should have been enough.
#[test]
fn a_large_closing_correction_is_followed_by_more() {
    let bounds = Bounds::new(&TrackerOptions::fast());
    for closing in [1.6e-7, 5e-8] {
        let mut progress = under_way(5.0, &bounds);
        progress.wide = true;
        progress.judge(1.12e-6, &bounds);
        assert_eq!(progress.state, StepState::Converged);
        progress.judge_closing(closing, None, &bounds);
        assert_eq!(progress.state, StepState::Iterating, "{closing}");
        for share in [0.05, 1e-3] {
            if progress.state == StepState::Iterating {
                progress.judge(share * closing, &bounds);
            }
        }
        progress.judge_closing(1e-16, None, &bounds);
        assert_eq!(progress.state, StepState::Accepted, "{closing}");
        let omega = 2.0 * closing / (1.12e-6 * 1.12e-6);
        assert!((progress.omega / omega - 1.0).abs() < 1e-12, "{}", progress.omega);
    }
}

/// Back in double precision, corrections as large as those that double-double has shown to be nothing
/// are no reason for shorter steps.
#[test]
fn rounding_errors_seen_in_double_double_are_remembered() {
    let bounds = Bounds::new(&TrackerOptions { corrector_tolerance: 1e-5, ..TrackerOptions::fast() });
    let mut progress = under_way(300.0, &bounds);
    progress.judge(1e-9, &bounds);
    progress.judge_closing(1e-15, Some(1e-8), &bounds);
    assert!(progress.state == StepState::Accepted && !progress.extended);
    progress.omega = 300.0;
    progress.begin_correction(&bounds);
    progress.judge(5e-8, &bounds);
    progress.judge(4e-8, &bounds);
    assert_eq!(progress.state, StepState::Converged);
}

#[test]
fn constants_of_the_paper() {
    // Timme 2020 with a = 1/8.
    assert!((h(0.125) - 0.195194).abs() < 1e-6);
    let bounds = Bounds::new(&TrackerOptions::default());
    assert!((bounds.reach - 0.179147).abs() < 1e-6);
    assert!((bounds.leave_double - 5.96e-6).abs() < 1e-8);
}
