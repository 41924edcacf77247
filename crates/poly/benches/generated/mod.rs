//! Code written by `poly::program::emit` for the systems that are measured.

pub(crate) mod cyclic_7;
pub(crate) mod katsura_8;
pub(crate) mod noon_5;
pub(crate) mod pencils;
pub(crate) mod s4r_5s;
pub(crate) mod s6r_3s;
