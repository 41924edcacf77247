//! Trials of the minimal solvers on noisy data (the lower row of the paper's figure 1): errors
//! against noise, with the candidate as it comes from the paths and with it refined over all
//! measurements.

use serde::Serialize;
use tdoa::Candidate;
use tdoa::Simulation;
use tdoa::accuracy::{offset_error, position_error};
use tdoa::minimal::{MinimalError, MinimalOptions, Solver};

/// One noisy instance, solved without and with refinement. Errors are infinite where no candidate
/// was left.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NoiseTrial {
    /// Relative position and offset errors ([`position_error`], [`offset_error`]) of the unrefined
    /// candidate.
    pub raw: [f64; 2],
    /// Errors of the refined candidate.
    pub refined: [f64; 2],
}

/// Solves an instance whose measurements have normal noise of standard deviation `noise` (in units
/// of the normal positions).
///
/// Where more is measured than there are unknowns, the candidate of smallest residual is judged, as
/// in the paper; the minimal sizes 6r/3s and 4r/5s fit every candidate exactly, and there the one
/// nearest to the truth is.
///
/// # Errors
/// If the solver refuses the instance.
pub fn noise_trial(solver: &mut Solver, simulation: &Simulation, noise: f64) -> Result<NoiseTrial, MinimalError> {
    // Noise makes pairs of real roots complex and small distances negative.
    let mut options = MinimalOptions::default();
    (options.near_real, options.tolerance) = (0.1, (5.0 * noise).clamp(1e-6, 0.05));
    let measured = &simulation.pseudoranges;
    let minimal = matches!((measured.receivers(), measured.transmitters()), (6, 3) | (4, 5));
    let mut judge = |polish: bool| -> Result<[f64; 2], MinimalError> {
        options.polish = polish;
        let solution = solver.solve(measured, &options)?;
        let errors = |c: &Candidate| {
            let truth = &simulation.network;
            [position_error(&c.network, truth), offset_error(&c.network, truth)]
        };
        let physical = solution.candidates.iter().filter(|c| c.physical);
        let chosen = if minimal {
            physical.map(errors).min_by(|a, b| a[0].total_cmp(&b[0]))
        } else {
            physical.min_by(|a, b| a.residual.total_cmp(&b.residual)).map(errors)
        };
        Ok(chosen.unwrap_or([f64::INFINITY; 2]))
    };
    Ok(NoiseTrial { raw: judge(false)?, refined: judge(true)? })
}

#[cfg(test)]
mod tests {
    use super::noise_trial;
    use tdoa::minimal::Solver;
    use tdoa::{Layout, SimulateOptions, simulate};

    /// To first order errors are proportional to the noise: the median over the same networks falls
    /// by about the noise's factor.
    #[test]
    fn errors_fall_with_the_noise() {
        let mut solver = Solver::new();
        let mut medians = |noise: f64| {
            let mut errors = [Vec::new(), Vec::new()];
            for seed in 0..15 {
                let mut options = SimulateOptions::default();
                (options.receivers, options.transmitters, options.seed) = (6, 4, seed);
                (options.layout, options.noise) = (Layout::Normal, noise);
                let trial = noise_trial(&mut solver, &simulate(&options).unwrap(), noise).unwrap();
                errors[0].push(trial.raw[0]);
                errors[1].push(trial.refined[0]);
            }
            errors.map(|mut all| {
                all.sort_by(f64::total_cmp);
                all[all.len() / 2]
            })
        };
        let (coarse, fine) = (medians(1e-4), medians(1e-6));
        for k in 0..2 {
            assert!((30.0..300.0).contains(&(coarse[k] / fine[k])), "{coarse:?} {fine:?}");
        }
        // Refinement uses the spare measurements and so is not worse.
        assert!(fine[1] <= fine[0], "{fine:?}");
    }
}
