//! From any matrix of pseudoranges to a network: leave out what cannot be determined, search from
//! many starts, refine the best networks, and say how sure the result is.

mod calibration;
mod clocks;
mod compare;
mod delays;
mod deviation;
mod dimension_test;
mod dimensions;
mod entry;
mod finish;
mod hold;
mod hypotheses;
mod impossible;
mod input;
mod judge;
mod known;
mod late;
mod minimal;
mod mirror;
mod mixture;
mod moves;
mod near;
mod one_sided;
mod options;
mod orientation;
mod propagation;
mod ranking;
mod receiver_errors;
mod refits;
mod report;
mod report_errors;
mod report_systematic;
mod residuals;
mod rivals;
mod same;
mod search;
mod shown;
mod sides;
mod significance;
mod state;
mod steps;
mod submaps;
mod systematic;
mod truth;
mod unfinished;
mod warnings;
mod weak_nodes;
mod whole;

pub use calibration::{Alternative, Calibration};
pub use dimension_test::DimensionTest;
pub use dimensions::{Calibrated, CalibratedError, calibrate_either};
pub use entry::{Calibrates, Dimension, calibrate, calibrate_with};
pub use hypotheses::{Hypotheses, KnownReceivers, generator};
pub use known::SpeedEstimate;
pub use minimal::MinimalHypotheses;
pub use mirror::MirrorImage;
pub use options::{
    CalibrateError, CalibrateOptions, Errors, KnownDistance, MeasuredPosition, ReceiverDelays, SearchOptions,
};
pub use receiver_errors::{MovedPlace, ReceiverError, ReceiverErrorKind};
pub use residuals::{Residual, Residuals};
pub use same::SAME_NETWORK;
pub use systematic::SystematicErrors;
pub use truth::Truth;
pub use unfinished::Unfinished;
