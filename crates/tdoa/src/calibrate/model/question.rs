//! What speaks for space: a search there, compared with a planar network by how likely they make the measurements.

use crate::calibrate::judge::dimension_test::DimensionTest;
use crate::calibrate::model::calibrated::CalibratedError;
use crate::calibrate::model::explained::explained_by_errors;
use crate::calibrate::model::heights_test::InSpace;
use crate::calibrate::model::lifted::{Known, from_sources, unless_stopped};
use crate::calibrate::options::{CalibrateError, CalibrateOptions, Errors, ReceiverDelays};
use crate::calibrate::report::calibration::Calibration;
use crate::calibrate::search::hypotheses::Hypotheses;
use crate::calibrate::steps::{Draft, calibrate_with};
use crate::pseudoranges::Pseudoranges;
use hc::Monitor;

/// Measurements of which the plane or space is asked.
pub(super) struct Question<'a> {
    pub(super) measured: &'a Pseudoranges,
    pub(super) in_space: &'a CalibrateOptions<3>,
    pub(super) in_plane: &'a CalibrateOptions,
    pub(super) monitor: &'a Monitor,
}

impl Question<'_> {
    /// The network in space if it fits, without a look at the errors that receivers would have in the plane.
    pub(super) fn without_plane(&self, flat: &Draft<'_, 2>) -> Result<Option<Calibration<3>>, CalibratedError> {
        let found = unless_stopped(calibrate_with(self.measured, self.in_space, &[], self.monitor))?;
        let Some(found) = found.filter(|found| found.fits) else { return Ok(None) };
        let test = self.compare(&flat.clone().judged()?, &found);
        Ok(test.is_space().then_some(Calibration { dimension_test: Some(test), ..found }))
    }

    /// The network that a search in space finds, with what the measurements say of its heights, and whether it is to be
    /// preferred to the planar one. `raised` is what starts at the planar network find, with its `test`.
    pub(super) fn search_space(
        &self,
        flat: &Calibration,
        raised: Option<Calibration<3>>,
        test: DimensionTest,
    ) -> Result<Option<(Calibration<3>, bool)>, CalibratedError> {
        let known = raised.as_ref().map(Known);
        let sources: Vec<&dyn Hypotheses<3>> = known.iter().map(|source| source as &dyn Hypotheses<3>).collect();
        let mut options = self.in_space.clone();
        if flat.fits && !test.is_space() {
            // Planar measurements have many networks in space that fit alike, on which starts do not agree.
            options.search.max_starts = self.in_plane.search.max_starts;
        }
        let Some(mut whole) = unless_stopped(calibrate_with(self.measured, &options, &sources, self.monitor))? else {
            return Ok(None);
        };
        let otherwise = self.otherwise_cleared(flat)?;
        let takes_out = self.in_plane.receiver_delays == ReceiverDelays::Auto;
        // With the errors of receivers, and without.
        let [bent, judged] = match &otherwise {
            Some(otherwise) if takes_out => [otherwise, flat],
            Some(otherwise) => [flat, otherwise],
            None => [flat; 2],
        };
        let found = self.compare(judged, &whole);
        // What fits best need not be likeliest: a few heights may say about what many do.
        let likelier = if found.evidence >= test.evidence { found } else { test };
        if let Some(first) = raised.filter(|first| first.determined && test.is_likelier_than(&found)) {
            whole = first;
            whole.call_not_unique(
                "another network fits the measurements more closely, with heights that are less likely".into(),
            );
        }
        let explained = otherwise.as_ref().map_or(0.0, |_| explained_by_errors(self.measured, bent, judged));
        let evidence = likelier.evidence.map(|evidence| evidence - explained);
        let test = DimensionTest { evidence, change: likelier.change, ..found };
        // Where nothing fits, the better one is told.
        let is_space = (whole.fits || !flat.fits) && (test.is_space() || (whole.fits && !judged.fits));
        if is_space && test.leaves_both() && judged.fits {
            whole.call_not_unique("the measurements are nearly as likely in the plane as in space".into());
        }
        whole.dimension_test = Some(test);
        Ok(Some((whole, is_space)))
    }

    /// The planar network without the errors that receivers show in it, or with them where they are taken out; `None`
    /// if it shows none.
    fn otherwise_cleared(&self, flat: &Calibration) -> Result<Option<Calibration>, CalibrateError> {
        let options = self.in_plane;
        if flat.receiver_errors.is_empty() || options.errors == Errors::OneSided {
            return Ok(None);
        }
        let receiver_delays = match options.receiver_delays {
            ReceiverDelays::None => ReceiverDelays::Auto,
            ReceiverDelays::Auto => ReceiverDelays::None,
        };
        // Its search would find the same.
        let options = CalibrateOptions { receiver_delays, search: from_sources(1, options.search), ..options.clone() };
        unless_stopped(calibrate_with(self.measured, &options, &[&Known(flat)], self.monitor))
    }

    /// The likelihood ratio of a calibration in space and one in the plane.
    pub(super) fn compare(&self, flat: &Calibration, whole: &Calibration<3>) -> DimensionTest {
        self.test(flat, &InSpace::of(whole))
    }

    /// The likelihood ratio of a network in space and a calibration in the plane.
    pub(super) fn test(&self, flat: &Calibration, space: &InSpace) -> DimensionTest {
        let is_given = self.in_space.sigma.is_some() || self.measured.knows_sigmas();
        space.beside(flat, self.measured, is_given)
    }
}
