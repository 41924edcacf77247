//! From any matrix of pseudoranges to a network: leave out what cannot be determined, search from
//! many starts, refine the best networks, and say how sure the result is.

mod entry;
mod input;
mod judge;
mod model;
mod options;
mod receivers;
mod report;
mod search;
mod state;
mod steps;
mod unfinished;

pub use entry::{Calibrates, Dimension, calibrate, calibrate_with};
pub use input::speed::SpeedEstimate;
pub use judge::dimension_test::{DimensionTest, PlaneDistances};
pub use judge::far_transmitters::FarTransmitter;
pub use judge::mirror_images::MirrorImage;
pub use model::calibrated::{Calibrated, CalibratedError};
pub use model::dimensions::calibrate_either;
pub use options::{
    CalibrateError, CalibrateOptions, Errors, KnownDistance, MeasuredPosition, ReceiverDelays, SearchOptions,
};
pub use receivers::echo::ReceiverEcho;
pub use receivers::errors::{MovedPlace, ReceiverError, ReceiverErrorKind};
pub use report::calibration::{Alternative, Calibration};
pub use report::candidates::ChosenCandidate;
pub use report::clocks::RecorderClock;
pub use report::distances::MeasuredDistance;
pub use report::residuals::{Residual, Residuals};
pub use report::systematic::SystematicErrors;
pub use report::truth::Truth;
pub use search::hypotheses::{Hypotheses, KnownReceivers, generator};
pub use search::minimal::MinimalHypotheses;
pub use search::same_network::SAME_NETWORK;
pub use unfinished::Unfinished;
