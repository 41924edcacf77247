//! The result: the best network in a frame, its uncertainty, alternatives and warnings.

use crate::align::{Transform, first_axes, frame};
use crate::calibrate::input::selection::Input;
use crate::calibrate::judge::far_transmitters::{Far, FarTransmitter};
use crate::calibrate::judge::judgement::{Judged, Other};
use crate::calibrate::judge::mirror_images::{MirrorImage, Mirrored};
use crate::calibrate::judge::neighbours::Reason;
use crate::calibrate::options::{CalibrateError, Errors};
use crate::calibrate::receivers::take_out::without_errors;
use crate::calibrate::report::calibration::{Alternative, Calibration};
use crate::calibrate::report::residuals::{Residual, Residuals};
use crate::calibrate::search::deviation::typical_deviation;
use crate::calibrate::state::State;
use crate::cells::Cells;
use crate::minimal::NodeKind;
use crate::network::Network;
use crate::pseudoranges::Pseudoranges;
use std::borrow::Cow;

impl<const D: usize> State<'_, D> {
    /// The result of a calibration that has come to its end.
    ///
    /// # Errors
    /// Cancelled.
    pub(crate) fn report(
        &self,
        input: &Input<'_>,
        judged: &Judged<'_, D>,
    ) -> Result<Calibration<D>, CalibrateError<D>> {
        let best = &self.ranked[0].network;
        let Judged { sigma, kept, redundancy, uncertainty, doubtful, .. } = judged;
        let (held, is_held) = (self.observations.held(), self.is_held());
        let (m, n) = (input.table.receivers(), input.table.transmitters());
        let (rows, columns) = (&input.usable.receivers, &input.usable.transmitters);
        let residual = |(a, b, _): (usize, usize, &f64)| {
            let length = best.residual(&self.measured, a, b).unwrap_or_default();
            (rows[a], columns[b], Residual { length, inlier: self.is_inlier(&self.measured, best, *sigma, a, b) })
        };
        let transmitters: Vec<_> = uncertainty.transmitters.iter().map(|c| c.map(|c| c.rows)).collect();
        let of_offset = |corner: f64| if self.sends_at_known_times() { 0.0 } else { corner.max(0.0).sqrt() };
        let offset_std: Vec<_> = uncertainty.transmitters.iter().map(|c| c.map(|c| of_offset(c.corner))).collect();
        let (chosen, with_candidates) = self.chosen(input);
        let mut calibration = Calibration {
            configuration: input.table.configuration(),
            receiver_names: input.table.receiver_names().to_vec(),
            transmitter_names: input.table.transmitter_names().to_vec(),
            receivers: scatter(m, rows, &best.receivers),
            transmitters: scatter(n, columns, &best.transmitters),
            offsets: self.offsets(input, best),
            residuals: Residuals(Cells::new(m, n, self.measured.cells().iter().map(residual))),
            sigma: *sigma,
            sigma_estimated: self.known.is_none(),
            sigma_is_factor: input.table.has_sigmas(),
            residual_rms: self.rms(&self.measured, best, *sigma),
            redundancy: *redundancy,
            ellipse_radius: judged.ellipse_radius,
            receiver_std: Vec::new(),
            receiver_covariance: scatter(m, rows, &uncertainty.receivers),
            transmitter_std: Vec::new(),
            transmitter_covariance: scatter(n, columns, &transmitters).into_iter().map(Option::flatten).collect(),
            offset_std: scatter(n, columns, &offset_std).into_iter().map(Option::flatten).collect(),
            anchored: scatter(m, rows, held).into_iter().map(|held| held == Some(true)).collect(),
            speed: self.speed,
            gauge: Cow::Borrowed(match (is_held, self.speed.is_some()) {
                _ if !self.observations.pins().is_empty() => {
                    "relative to the frame of the known positions, with the errors that these have"
                }
                (false, _) => "inner constraint over the receivers: relative to their best rigid alignment",
                (true, false) => "relative to the receivers of known position, which have no error",
                (true, true) => {
                    "relative to the receivers of known position, which have no error, at the estimated propagation speed"
                }
            }),
            unique: judged.is_unique(),
            unique_receivers: judged.are_receivers_unique(),
            unique_transmitters: judged.are_transmitters_unique(),
            alternatives: judged.others.iter().map(|other| self.alternative(input, other, *sigma)).collect(),
            mirror_images: judged.mirrored.iter().map(|image| self.mirror_image(image)).collect(),
            dimensions: D,
            fits: judged.fits,
            planar: judged.fits && D == 2,
            dimension_test: (D == 3).then_some(self.dimension_test),
            plane_distances: self.plane_distances,
            far_transmitters: judged.far.iter().map(|far| self.far_transmitter(far)).collect(),
            determined: judged.determined,
            anchors_agree: judged.anchors_agree,
            receiver_errors: self.receiver_errors(),
            receiver_echoes: self.receiver_echoes(),
            chosen,
            with_candidates,
            systematic: None,
            warnings: self.warnings(input, judged),
            clocks: self.recorder_clocks(input, uncertainty),
            distances: self.measured_distances(),
            emissions: self.options.clocks.emissions,
            errors: if judged.one_sided.is_some() { Errors::OneSided } else { Errors::Symmetric },
            seed: self.options.seed,
            starts: self.starts,
            laid_together: self.weak.is_some(),
            agreeing: judged.agreeing,
            confidence: 1.0 - 0.95f64.powi(self.starts.min(100_000) as i32),
            truth: None,
        };
        for i in &uncertainty.loose {
            calibration.receiver_covariance[rows[*i]] = None;
        }
        for &i in doubtful.iter().filter(|&&i| !held[i]) {
            calibration.receivers[rows[i]] = None;
            calibration.receiver_covariance[rows[i]] = None;
        }
        // Residuals that may be late do not have the covariance that systematic errors are told by.
        if judged.ellipse_radius.is_some() && judged.one_sided.is_none() {
            calibration.systematic = self.systematic(input, kept, &calibration)?;
        }
        if !is_held {
            calibration.transform(&default_frame(&best.receivers));
        }
        if let Some(speed) = &self.speed {
            calibration.rescale(speed.factor);
        }
        if let Some(anchors) = &self.anchors {
            calibration.put_on(anchors, &input.usable, is_held);
        }
        Ok(calibration)
    }

    /// Root mean square of the residuals of a network's inliers.
    fn rms(&self, measured: &Pseudoranges, network: &Network<D>, sigma: f64) -> f64 {
        let cells = measured.cells().iter().filter(|&(a, b, _)| self.is_inlier(measured, network, sigma, a, b));
        let squares: Vec<f64> = cells.filter_map(|(a, b, _)| Some(network.residual(measured, a, b)?.powi(2))).collect();
        (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
    }

    fn alternative(&self, input: &Input<'_>, other: &Other<D>, sigma: f64) -> Alternative<D> {
        let error = if let Reason::Error(fault) = other.reason { Some(fault) } else { None };
        let residual = match other.reason {
            Reason::Error(error) => self.rms(&without_errors(&self.measured, &[error]), &other.network, sigma),
            Reason::Delays { deviation } => deviation * typical_deviation(&self.measured),
            Reason::Found | Reason::Late { .. } => self.rms(&self.measured, &other.network, sigma),
        };
        let network = &other.network;
        let (rows, columns) = (&input.usable.receivers, &input.usable.transmitters);
        Alternative {
            receivers: scatter(input.table.receivers(), rows, &network.receivers),
            transmitters: scatter(input.table.transmitters(), columns, &network.transmitters),
            offsets: self.offsets(input, network),
            residual,
            log_likelihood_loss: other.loss,
            receiver_error: error.map(|error| self.receiver_error(&error, true)),
        }
    }

    /// The offsets of a network in the clock of the table.
    fn offsets(&self, input: &Input<'_>, network: &Network<D>) -> Vec<Option<f64>> {
        let known = self.sends_at_known_times();
        let offset = |(j, offset): (usize, &f64)| {
            if known { self.measured.emission_time(j) } else { offset + input.shifts[j] }
        };
        let moved: Vec<f64> = network.offsets.iter().enumerate().map(offset).collect();
        scatter(input.table.transmitters(), &input.usable.transmitters, &moved)
    }

    fn far_transmitter(&self, far: &Far<D>) -> FarTransmitter<D> {
        FarTransmitter {
            transmitter: self.measured.transmitter_names()[far.transmitter].clone(),
            direction: far.direction,
            direction_std: far.direction_std,
            least_distance: far.least_distance,
        }
    }

    fn mirror_image(&self, image: &Mirrored<D>) -> MirrorImage<D> {
        let names = match image.kind {
            NodeKind::Receivers => self.measured.receiver_names(),
            NodeKind::Transmitters => self.measured.transmitter_names(),
        };
        MirrorImage {
            node: names[image.index].clone(),
            kind: image.kind,
            position: image.position,
            distance_from_plane: image.height,
            log_likelihood_loss: image.loss,
        }
    }
}

/// Values at these indices of a longer list.
fn scatter<T: Copy>(length: usize, at: &[usize], values: &[T]) -> Vec<Option<T>> {
    let mut all = vec![None; length];
    for (&k, &value) in at.iter().zip(values) {
        all[k] = Some(value);
    }
    all
}

/// First receiver at the origin, second on the x axis, third above it, in space the fourth above the
/// plane of these; other receivers take their place where these coincide or are in line.
fn default_frame<const D: usize>(receivers: &[[f64; D]]) -> Transform<D> {
    first_axes(receivers).and_then(|axes| frame(receivers[0], axes)).unwrap_or(Transform::IDENTITY)
}
