//! What is decided about the networks that were found: noise, uncertainty, uniqueness, mirror images.

pub(crate) mod dimension_test;
pub(crate) mod far_transmitters;
pub(crate) mod judgement;
pub(crate) mod late;
pub(crate) mod lines_and_planes;
pub(crate) mod mirror_images;
pub(crate) mod neighbours;
pub(crate) mod orientation;
pub(crate) mod raised;
pub(crate) mod upright;
pub(crate) mod weak_nodes;
