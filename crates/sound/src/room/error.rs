//! Why nothing can be simulated.

use thiserror::Error;

/// Why a room cannot be simulated.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum RoomError {
    /// A number is outside its range.
    #[error("{name} must be {range}, not {value}")]
    Range {
        /// Name of the option.
        name: &'static str,
        /// The allowed range.
        range: &'static str,
        /// The given value.
        value: f64,
    },
    /// Lists whose lengths do not fit.
    #[error("there are {found} {name} for {expected} {of}; give one number that fits")]
    Count {
        /// What is listed.
        name: &'static str,
        /// How many there are.
        found: usize,
        /// What they are for.
        of: &'static str,
        /// How many there should be.
        expected: usize,
    },
    /// A point that is not in the room.
    #[error("the {kind} {number} is at {point:?} m, not inside the room; coordinates count from a corner")]
    Outside {
        /// Microphone or source.
        kind: &'static str,
        /// Its number, from 1.
        number: usize,
        /// Where it is, metres.
        point: [f64; 3],
    },
    /// A source at a microphone, where sound is infinitely loud.
    #[error("microphone {microphone} and source {source_number} are less than 1 cm apart; move one of them")]
    Together {
        /// Number of the microphone, from 1.
        microphone: usize,
        /// Number of the source, from 1.
        source_number: usize,
    },
    /// No place is left for a random point.
    #[error(
        "there is no room for {count} points {separation} m from each other and {wall_distance} m from the walls; lessen their \
         number or these distances"
    )]
    Full {
        /// Number of microphones and sources.
        count: usize,
        /// Least distance from each other, metres.
        separation: f64,
        /// Least distance from the walls, metres.
        wall_distance: f64,
    },
    /// A reverberation that is too short for Sabine's formula.
    #[error("by Sabine's formula, the reverberation time in this room is more than {least:.3} s; use Eyring's")]
    Absorption {
        /// The time if walls absorb everything, seconds.
        least: f64,
    },
    /// More than can be computed.
    #[error("there would be {amount:.0} {name}, more than {limit:.0}; {remedy}")]
    TooMuch {
        /// Of what there is too much.
        name: &'static str,
        /// How much there is, about.
        amount: f64,
        /// How much there may be.
        limit: f64,
        /// What to do.
        remedy: &'static str,
    },
}
