//! Arrival times of one event in all channels.
//!
//! Each channel tells roughly when the event begins: where its envelope first rises well above the noise, the leading
//! edge. What follows is compared between each two channels by generalised cross-correlation (C. H. Knapp and G. C.
//! Carter, The generalized correlation method for estimation of time delay, IEEE Trans. Acoust. Speech Signal Process. 24,
//! 1976), which has a peak for each pair of ways, echoes included; delays that agree with most pairs lay the channels over
//! one another. What they have in common is the sound, and by it each channel is taken apart into the ways on which it
//! hears the sound. The first of these is the direct one.
//!
//! A signal that is known tells the time of each channel by itself.

mod arrival;
mod arrivals;
mod consistent;
mod correlation;
mod deviation;
mod direct;
mod edge;
mod error;
mod known;
mod options;
mod paths;
mod spectrum;

pub use arrival::Arrival;
pub use arrivals::arrival_times;
pub use error::TimeError;
pub use options::{TimeOptions, Window};
