//! Where a result comes from: the command line, the settings, the date.

use std::ffi::{OsStr, OsString};
use std::fmt::Display;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use crate::Failure;

/// The date of a report.
pub(crate) struct Date {
    pub(crate) moment: SystemTime,
    /// Whether it was given, so that the same command makes the same report.
    pub(crate) fixed: bool,
}

/// Seconds since 1970 as the date of what is made, so that it can be made again to the bit
/// (<https://reproducible-builds.org/specs/source-date-epoch/>).
const GIVEN: &str = "SOURCE_DATE_EPOCH";

impl Date {
    /// The date that the environment gives, else the present one.
    pub(crate) fn read() -> Result<Date, Failure> {
        Date::of(std::env::var_os(GIVEN).as_deref())
    }

    fn of(given: Option<&OsStr>) -> Result<Date, Failure> {
        let Some(text) = given else { return Ok(Date { moment: SystemTime::now(), fixed: false }) };
        let seconds = text.to_str().and_then(|text| text.trim().parse().ok()).map(Duration::from_secs);
        match seconds.and_then(|seconds| UNIX_EPOCH.checked_add(seconds)) {
            Some(moment) => Ok(Date { moment, fixed: true }),
            None => Err(Failure::Unusable(format!(
                "{GIVEN} is {text:?}; give seconds since 1970, or unset it for the present date"
            ))),
        }
    }
}

/// An option by its name, with its value if it has one.
pub(crate) fn named(name: &str, value: Option<impl Display>) -> Option<(String, String)> {
    Some((name.to_string(), value?.to_string()))
}

/// One of several values, as the command line says it.
pub(crate) fn said(value: impl clap::ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |value| value.get_name().to_string())
}

/// The command line of the process, which a POSIX shell reads back.
pub(crate) fn command() -> String {
    line(std::env::args_os().skip(1))
}

fn line(arguments: impl Iterator<Item = OsString>) -> String {
    let quoted = arguments.map(|argument| quoted(&argument.to_string_lossy()));
    std::iter::once("tdoa".to_string()).chain(quoted).collect::<Vec<_>>().join(" ")
}

/// A word for the shell: in quotes if it has characters that mean something there.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./:=,+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_string();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn command_lines_are_those_of_a_shell() {
        let words = ["calibrate", "my table.csv", "--sigma=0.01", "it's", "", "$HOME", "räume/ö.csv"];
        assert_eq!(
            line(words.iter().map(OsString::from)),
            r"tdoa calibrate 'my table.csv' --sigma=0.01 'it'\''s' '' '$HOME' räume/ö.csv"
        );
    }

    #[test]
    fn dates_that_are_given_are_seconds_since_1970() {
        let date = Date::of(Some(OsStr::new("1000000000"))).unwrap();
        assert!(date.fixed && date.moment == UNIX_EPOCH + Duration::from_secs(1_000_000_000));
        assert!(!Date::of(None).unwrap().fixed);
        for wrong in ["", "yesterday", "-1", "1.5", "18446744073709551615"] {
            let message = Date::of(Some(OsStr::new(wrong))).err().unwrap().to_string();
            assert!(message.contains(GIVEN) && message.contains("unset"), "{message}");
        }
    }
}
