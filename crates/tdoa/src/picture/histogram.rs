//! The distribution of the residuals.

use super::canvas::{Canvas, nice};
use crate::calibrate::Calibration;
use crate::quantity::number;
use hc::poly::counted;

const BINS: usize = 32;

/// Bars of the residuals in metres over plus and minus about four standard deviations; what lies
/// beyond is counted at the ends.
pub(super) fn draw<const D: usize>(
    canvas: &mut Canvas,
    calibration: &Calibration<D>,
    corner: [f64; 2],
    size: [f64; 2],
) {
    // Measurements with their own deviations make sigma a factor, so the spread of the inliers sets
    // the scale.
    let reach = 4.0 * calibration.residual_rms.max(1e-12);
    let mut bins = [0usize; BINS];
    let (mut below, mut above) = (0, 0);
    for e in calibration.residuals.values().iter().map(|residual| residual.length) {
        let at = ((e / reach + 1.0) * 0.5 * BINS as f64).floor();
        if at < 0.0 {
            below += 1;
        } else if at >= BINS as f64 {
            above += 1;
        } else {
            bins[at as usize] += 1;
        }
    }
    let most = bins.iter().copied().max().unwrap_or(1).max(1) as f64;
    let width = size[0] / BINS as f64;
    let base = corner[1] + size[1];
    for (k, &count) in bins.iter().enumerate() {
        let height = size[1] * count as f64 / most;
        canvas.rectangle([corner[0] + k as f64 * width + 0.5, base - height], [width - 1.0, height], "#56B4E9");
    }
    canvas.line([corner[0], base], [corner[0] + size[0], base], "#222", 1.0, "");
    let step = nice(reach / 2.0);
    let ticks = (reach / step).floor() as i64;
    for k in -ticks..=ticks {
        let x = corner[0] + 0.5 * size[0] * (1.0 + k as f64 * step / reach);
        canvas.line([x, base], [x, base + 5.0], "#222", 1.0, "");
        canvas.text([x, base + 19.0], "middle", 11.0, &number(k as f64 * step, 4));
    }
    let label = format!("residuals in metres ({})", counted(calibration.residuals.len(), "measurement"));
    canvas.text([corner[0] + 0.5 * size[0], base + 38.0], "middle", 12.0, &label);
    canvas.text([corner[0], corner[1] - 8.0], "start", 11.0, &format!("{most} in the highest bar"));
    if below > 0 {
        canvas.text([corner[0] - 6.0, base - 4.0], "end", 11.0, &format!("{below} <"));
    }
    if above > 0 {
        canvas.text([corner[0] + size[0] + 6.0, base - 4.0], "start", 11.0, &format!("> {above}"));
    }
}
