//! Written by `cargo xtask codegen` from the families and stored fibres in `families/`; not edited by hand.

#[rustfmt::skip]
pub(crate) mod six_three;
