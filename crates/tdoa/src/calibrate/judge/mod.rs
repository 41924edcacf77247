//! What is decided about the networks that were found: noise, uncertainty, uniqueness, mirror images, dimension.

pub(crate) mod dimension_test;
pub(crate) mod dimensions;
pub(crate) mod errors_chosen;
mod excluded;
mod explained;
pub(crate) mod far_transmitters;
pub(crate) mod judgement;
mod known_heights;
pub(crate) mod late;
mod lifted;
pub(crate) mod lines_and_planes;
pub(crate) mod mirror_images;
pub(crate) mod neighbours;
pub(crate) mod orientation;
pub(crate) mod weak_nodes;
