//! Written by `cargo xtask codegen` from the families and stored fibres in `families/`; not edited by hand.

#[rustfmt::skip]
pub(crate) mod five_five_ranges;
#[rustfmt::skip]
pub(crate) mod five_four;
#[rustfmt::skip]
pub(crate) mod five_six;
#[rustfmt::skip]
pub(crate) mod four_five;
#[rustfmt::skip]
pub(crate) mod four_seven_constant;
#[rustfmt::skip]
pub(crate) mod four_six_ranges;
#[rustfmt::skip]
pub(crate) mod six_three;
#[rustfmt::skip]
pub(crate) mod three_four_constant;
#[rustfmt::skip]
pub(crate) mod three_three_ranges;
