//! What a column holds, in the words of options.

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Role {
    /// Names of receivers.
    Receiver,
    /// Names of transmitters or events.
    Transmitter,
    /// Measurements that may be lengths or times.
    Value,
    /// Times, whose unit must be said.
    Time,
    /// Further candidates for the value; the columns in the order in which they are given.
    Candidate,
    /// Standard deviations.
    Sigma,
    /// Names of the receivers whose times are taken off.
    Reference,
    /// Names of the recorders of receivers. Receivers below the heading of a channel are numbered for each recorder anew.
    Recorder,
    /// Its weight: one over the square of its standard deviation, in any unit.
    Weight,
    /// Something else, which is not read.
    Ignore,
}

/// The roles by the words that options say.
const ROLES: &[(&str, Role)] = &[
    ("receiver", Role::Receiver),
    ("transmitter", Role::Transmitter),
    ("event", Role::Transmitter),
    ("value", Role::Value),
    ("range", Role::Value),
    ("time", Role::Time),
    ("candidate", Role::Candidate),
    ("sigma", Role::Sigma),
    ("weight", Role::Weight),
    ("reference", Role::Reference),
    ("recorder", Role::Recorder),
    ("ignore", Role::Ignore),
];

impl std::fmt::Display for Role {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let word = ROLES.iter().find(|(_, role)| role == self).map_or("", |(word, _)| *word);
        f.write_str(word)
    }
}

impl std::str::FromStr for Role {
    type Err = String;

    fn from_str(text: &str) -> Result<Role, String> {
        let found = ROLES.iter().find(|(word, _)| *word == text).map(|(_, role)| *role);
        found.ok_or_else(|| {
            let words: Vec<&str> = ROLES.iter().map(|(word, _)| *word).collect();
            format!("{text:?} is none of {}", words.join(", "))
        })
    }
}
