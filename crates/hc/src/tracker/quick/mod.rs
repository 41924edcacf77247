//! Quick steps: all paths in single precision first, sixteen at once, then on in double precision.
//!
//! A path that ends in single precision needs one attempt in double precision, at its end. One that stops on
//! its way goes on from there. If the point where it stopped turns out not to lie near the path, it starts
//! again in double precision. What these steps leave is for the [careful tracker](super::Tracker).

mod attempts;
mod lanes;
mod stages;
#[cfg(test)]
mod tests;

pub(super) use lanes::QuickMemory;
