//! What the benches of this workspace measure: systems of polynomials, and the code that the build
//! generates from them.

pub mod systems;

/// The systems as straight-line code, written by this crate's build script.
pub mod generated {
    include!(concat!(env!("OUT_DIR"), "/generated.rs"));
}
