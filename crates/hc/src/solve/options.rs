//! Settings of a solve.

use crate::endgame::EndgameOptions;
use crate::family::FibreOptions;
use crate::setters::setters;
use crate::tracker::{OptionError, TrackerOptions};
use serde::{Deserialize, Serialize};
use std::fmt;

/// The kind of start system.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Start {
    /// The start system with the least work. The polyhedral one never has more paths than the
    /// others, but two stages instead of one. If another start system has hardly more paths (an
    /// eighth), it is tried first. It is abandoned for the polyhedral one if more than an eighth of
    /// its paths do not end at regular solutions, or if one is lost. Systems whose mixed cells do
    /// not fit into 126 bits are also left to the others.
    #[default]
    Auto,
    /// Polyhedral: as many paths as the mixed volume.
    Polyhedral,
    /// Products of linear forms in the unknowns of given groups ([`SolveOptions::groups`]): as many
    /// paths as the multihomogeneous Bezout number, with no stage before them.
    Multihomogeneous,
    /// Total degree: as many paths as the product of the degrees, with no stage before them. Its
    /// coefficients are so special that paths may go to infinity in degenerate ways.
    TotalDegree,
}

/// The name in words.
impl fmt::Display for Start {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Start::Auto => "automatic",
            Start::Polyhedral => "polyhedral",
            Start::Multihomogeneous => "multihomogeneous",
            Start::TotalDegree => "total degree",
        })
    }
}

/// Settings of [`solve`](crate::solve), which checks them. The serialized settings are those on
/// which paths depend.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct SolveOptions {
    /// Seed of everything random. Default 0.
    pub seed: u64,
    /// The start system. Default [`Start::Auto`].
    pub start: Start,
    /// Groups of unknowns, by their indices, for [`Start::Multihomogeneous`]. Every unknown belongs
    /// to exactly one group. Default none.
    pub groups: Vec<Vec<usize>>,
    /// Whether to leave out solutions with zero coordinates and the paths that lead to them.
    /// Default false.
    pub torus_only: bool,
    /// Largest number of paths; more are refused. Default 2^24.
    #[serde(skip)]
    pub max_paths: u64,
    /// Settings of both stages. Default [`TrackerOptions::fast`] with
    /// [quick steps](TrackerOptions::quick): paths that jump are found by their ends and tracked again.
    pub paths: FibreOptions,
    /// Settings for the ends of paths that are not regular.
    pub endgame: EndgameOptions,
    /// The number of regular solutions, if it is known, for instance for a family. Once that many
    /// are found, paths without an end are left where they are and count as dropped. As long as
    /// paths share an end, only these are tracked again. Default `None`: every path is tracked to
    /// its end.
    pub known: Option<usize>,
    /// How often everything is repeated from another start system as long as paths are lost.
    /// Default 2.
    pub restarts: u32,
    /// Whether to certify regular solutions ([`Solutions::certify`](super::Solutions::certify)).
    /// This needs a system with as many equations as unknowns. Default false.
    #[serde(skip)]
    pub certify: bool,
}

impl Default for SolveOptions {
    fn default() -> Self {
        SolveOptions {
            seed: 0,
            start: Start::Auto,
            groups: Vec::new(),
            torus_only: false,
            max_paths: 1 << 24,
            paths: FibreOptions {
                tracker: TrackerOptions { quick: true, ..TrackerOptions::fast() },
                ..FibreOptions::default()
            },
            endgame: EndgameOptions::default(),
            known: None,
            restarts: 2,
            certify: false,
        }
    }
}

impl SolveOptions {
    /// The defaults.
    pub fn new() -> SolveOptions {
        SolveOptions::default()
    }

    /// Checks the numbers.
    ///
    /// # Errors
    /// The first setting that is outside its range.
    pub fn validate(&self) -> Result<(), OptionError> {
        self.paths.validate()?;
        self.endgame.validate()
    }
}

setters!(SolveOptions {
    seed: u64,
    start: Start,
    groups: Vec<Vec<usize>>,
    torus_only: bool,
    max_paths: u64,
    paths: FibreOptions,
    endgame: EndgameOptions,
    known: usize,
    restarts: u32,
    certify: bool,
});
