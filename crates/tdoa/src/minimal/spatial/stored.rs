//! The families in space and their stored fibres, compiled and unpacked when they are first needed.

use hc::Family;
use hc::family::{Fibre, unpack_fibre};
use hc::poly::Interpreter;
use std::sync::LazyLock;

/// A family of this crate and its fibre.
pub(crate) struct Stored {
    family: Family,
    fibre: Fibre,
}

impl Stored {
    /// Reads what is part of the program.
    ///
    /// # Panics
    /// If it does not hold together: tests and `cargo xtask codegen --check` read all of it.
    fn new(family: &str, fibre: &[u8]) -> Stored {
        let family: Family = family.parse().unwrap_or_else(|error| panic!("a family of this crate: {error}"));
        let fibre =
            unpack_fibre(family.program(), fibre).unwrap_or_else(|error| panic!("a fibre of this crate: {error}"));
        Stored { family, fibre }
    }

    /// The equations.
    pub(super) fn system(&self) -> &Interpreter {
        self.family.program()
    }

    /// The solutions for one generic parameter point.
    pub(super) fn fibre(&self) -> Fibre {
        self.fibre.clone()
    }
}

/// Defines the stored family of a name, and the text of its equations.
macro_rules! stored {
    ($family:ident, $stored:ident, $name:literal) => {
        pub(super) const $family: &str = include_str!(concat!("../../../families/", $name, ".toml"));
        pub(super) static $stored: LazyLock<Stored> =
            LazyLock::new(|| Stored::new($family, include_bytes!(concat!("../../../families/", $name, ".fibre"))));
    };
}

stored!(TEN_FOUR_FAMILY, TEN_FOUR, "10r4s");
stored!(SEVEN_FIVE_FAMILY, SEVEN_FIVE, "7r5s");
stored!(EIGHT_FIVE_FAMILY, EIGHT_FIVE, "8r5s");
stored!(SIX_SIX_FAMILY, SIX_SIX, "6r6s");
