//! TDOA self-calibration.
