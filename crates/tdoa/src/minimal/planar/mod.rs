//! Formulations of the plane: unknowns, charts, and positions from a root.

pub(super) mod chart;
pub(super) mod collinear;
pub(super) mod dual;
pub(super) mod four_five;
pub(super) mod rank;
pub(super) mod three;
