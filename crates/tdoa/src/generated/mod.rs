//! Written by `cargo xtask codegen` from the families and stored fibres in `families/`; not edited by hand.

#[rustfmt::skip]
pub(crate) mod five_four;
#[rustfmt::skip]
pub(crate) mod five_six;
#[rustfmt::skip]
pub(crate) mod four_five;
#[rustfmt::skip]
pub(crate) mod six_three;
