//! The choice of the model, where the user leaves it open: the plane or space, errors of either sign or one-sided ones.

pub(crate) mod calibrated;
pub(crate) mod dimensions;
pub(crate) mod errors_chosen;
mod excluded;
mod explained;
mod heights_test;
mod known_heights;
mod lifted;
mod question;
