//! Trials on simulated networks: how far from the truth the exact solvers and the calibration end,
//! and what becomes of their paths.

pub mod calibration;
pub mod checks;
pub mod clean;
pub mod clocks;
pub mod families;
pub mod hard;
pub mod kinds;
pub mod noise;
pub mod reduced;
pub mod sound;
