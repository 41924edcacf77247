//! Axes and values of parameters, as they are written on the command line.

use crate::numbers::{real, shown};
use hc::sweep::Axis;
use std::str::FromStr;

/// An axis: `name=from:to:count`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct GivenAxis(pub(super) Axis);

/// A parameter that stays: `name=value`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fixed {
    pub(super) name: String,
    pub(super) value: f64,
}

/// Why an axis or a value cannot be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(super) enum GivenError {
    /// No name and values.
    #[error("no `=` after the name of a parameter; {expected}")]
    NoName {
        /// What is expected.
        expected: &'static str,
    },
    /// Not three parts.
    #[error("{found} after `=`, separated by `:`; {expected}", found = if *.found == 1 { "1 part".to_owned() } else { format!("{} parts", .found) })]
    Parts { found: usize, expected: &'static str },
    /// Not a number.
    #[error("{0} is not a finite number such as 1.5 or -2e-3")]
    Number(String),
    /// Not a number of values.
    #[error("{0} is not a whole number of values, such as 200")]
    Count(String),
}

const AXIS: &str = "expected NAME=FROM:TO:COUNT, such as p=0:1:200";
const VALUE: &str = "expected NAME=VALUE, such as p=0.5";

/// The name before the first `=`, and the rest.
fn name<'a>(text: &'a str, expected: &'static str) -> Result<(String, &'a str), GivenError> {
    let (name, rest) = text.split_once('=').ok_or(GivenError::NoName { expected })?;
    let name = name.trim();
    if name.is_empty() { Err(GivenError::NoName { expected }) } else { Ok((name.to_owned(), rest)) }
}

fn number(word: &str) -> Result<f64, GivenError> {
    real(word.trim()).filter(|x| x.is_finite()).ok_or_else(|| GivenError::Number(shown(word)))
}

impl FromStr for GivenAxis {
    type Err = GivenError;

    fn from_str(text: &str) -> Result<GivenAxis, GivenError> {
        let (name, rest) = name(text, AXIS)?;
        let parts: Vec<&str> = rest.split(':').collect();
        let [from, to, count] = parts[..] else {
            return Err(GivenError::Parts { found: parts.len(), expected: AXIS });
        };
        let count = count.trim();
        let is_whole = !count.is_empty() && count.bytes().all(|c| c.is_ascii_digit());
        let values = Some(count).filter(|_| is_whole).and_then(|count| count.parse().ok());
        let values = values.ok_or_else(|| GivenError::Count(shown(count)))?;
        Ok(GivenAxis(Axis::new(name, number(from)?, number(to)?, values)))
    }
}

impl FromStr for Fixed {
    type Err = GivenError;

    fn from_str(text: &str) -> Result<Fixed, GivenError> {
        let (name, value) = name(text, VALUE)?;
        Ok(Fixed { name, value: number(value)? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn what_is_no_axis_is_said() {
        let axis = |text: &str| text.parse::<GivenAxis>().map(|given| given.0);
        assert_eq!(axis("p = -1e-3 : 2 : 20"), Ok(Axis::new("p", -1e-3, 2.0, 20)));
        assert_eq!(axis("p=0:1:0"), Ok(Axis::new("p", 0.0, 1.0, 0)));
        for (text, words) in [
            ("p", "no `=`"),
            ("=0:1:2", "no `=` after the name"),
            ("p=", "1 part after `=`"),
            ("p=0:1", "2 parts after"),
            ("p=0:1:2:3", "4 parts after"),
            ("p=nan:1:2", "`nan` is not a finite number"),
            ("p=0:inf:2", "`inf` is not"),
            ("p=0:1e999:2", "`1e999` is not"),
            ("p=0::2", "`` is not"),
            ("p=0:1:-3", "`-3` is not a whole number"),
            ("p=0:1:2.5", "`2.5` is not a whole number"),
            ("p=0:1:99999999999999999999999", "is not a whole number"),
        ] {
            let error = axis(text).unwrap_err().to_string();
            assert!(error.contains(words), "{text}: {error}");
        }
        assert_eq!("a=-2.5".parse(), Ok(Fixed { name: "a".to_owned(), value: -2.5 }));
        assert!(matches!("a=1=2".parse::<Fixed>(), Err(GivenError::Number(_))));
        assert!(matches!("a".parse::<Fixed>(), Err(GivenError::NoName { .. })));
    }

    proptest! {
        #[test]
        fn what_is_written_is_read(from in any::<f64>(), to in any::<f64>(), count in any::<usize>()) {
            prop_assume!(from.is_finite() && to.is_finite());
            for text in [format!("k_1={from}:{to}:{count}"), format!("k_1={from:e}:{to:e}:{count}")] {
                prop_assert_eq!(text.parse(), Ok(GivenAxis(Axis::new("k_1", from, to, count))));
            }
            prop_assert_eq!(format!("k={from}").parse(), Ok(Fixed { name: "k".to_owned(), value: from }));
        }

        #[test]
        fn no_text_panics(text in "[-+.=:0-9eEpinfa µ]{0,40}", any in any::<String>()) {
            for text in [text, any] {
                let _ = text.parse::<GivenAxis>();
                let _ = text.parse::<Fixed>();
            }
        }
    }
}
