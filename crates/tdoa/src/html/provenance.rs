//! Where a result comes from, as a part of the report.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use super::section::Section;
use crate::picture::escape;
use crate::quantity::number;

/// Where a result comes from. What is not known is left out of the report.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct Provenance {
    /// Name and version of the program, such as `tdoa 0.1.0`.
    pub program: Option<String>,
    /// The file of the measurements.
    pub file: Option<String>,
    /// When the report was made.
    pub date: Option<SystemTime>,
    /// How long the calibration took.
    pub time: Option<Duration>,
    /// The command line.
    pub command: Option<String>,
    /// Names and values of the settings that shape the result.
    pub settings: Vec<(String, String)>,
    /// Who chose between the plane and space, where the measurements did not: `as the anchors have it`.
    pub dimensions: Option<String>,
    /// Parts of the page that show what the measurements come from, such as recordings; they stand last.
    pub sections: Vec<Section>,
}

/// A list of terms and values; nothing where nothing is known.
pub(super) fn list(provenance: &Provenance) -> String {
    let mut entries = String::new();
    let mut entry = |term: &str, value: Option<String>, tag: &str| {
        let Some(value) = value else { return };
        let value = escape(&value);
        entries += &match tag {
            "" => format!("<dt>{term}</dt><dd>{value}</dd>\n"),
            tag => format!("<dt>{term}</dt><dd><{tag}>{value}</{tag}></dd>\n"),
        };
    };
    entry("File", provenance.file.clone(), "");
    entry("Date", provenance.date.map(utc), "");
    entry("Program", provenance.program.clone(), "");
    entry("Time taken", provenance.time.map(|time| format!("{} s", number(time.as_secs_f64(), 2))), "");
    entry("Command", provenance.command.clone(), "code");
    let settings: Vec<String> =
        provenance.settings.iter().map(|(name, value)| format!("{name}\u{a0}{value}")).collect();
    entry("Settings", (!settings.is_empty()).then(|| settings.join(", ")), "");
    if entries.is_empty() { entries } else { format!("<dl class=\"provenance\">\n{entries}</dl>\n") }
}

/// A moment in universal time, to the second: `2026-11-26 18:49:44 UTC`. The day comes from the days since
/// 1970 in years that begin in March, so that the leap day ends them (Hinnant, chrono-compatible low-level
/// date algorithms).
fn utc(moment: SystemTime) -> String {
    let seconds = match moment.duration_since(UNIX_EPOCH) {
        Ok(after) => i128::from(after.as_secs()),
        Err(before) => -before.duration().as_nanos().div_ceil(1_000_000_000).cast_signed(),
    };
    let (days, second) = (seconds.div_euclid(86_400) + 719_468, seconds.rem_euclid(86_400));
    // 400 years are 146,097 days, whatever year they begin in.
    let (era, day) = (days.div_euclid(146_097), days.rem_euclid(146_097));
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    // From March on, five months have 153 days.
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    let year = year + 400 * era + i128::from(month <= 2);
    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    format!("{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02} UTC")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        // Seconds since 1970 of moments with a name of their own: the epoch, the last second before the
        // leap day of 2000, that day, the billennium, the end of 32-bit time, and a century without a leap day.
        for (seconds, date) in [
            (0, "1970-01-01 00:00:00 UTC"),
            (951_782_399, "2000-02-28 23:59:59 UTC"),
            (951_782_400, "2000-02-29 00:00:00 UTC"),
            (1_000_000_000, "2001-09-09 01:46:40 UTC"),
            (2_147_483_647, "2038-01-19 03:14:07 UTC"),
            (4_107_542_400, "2100-03-01 00:00:00 UTC"),
        ] {
            assert_eq!(utc(UNIX_EPOCH + Duration::from_secs(seconds)), date);
        }
        assert_eq!(utc(UNIX_EPOCH - Duration::from_millis(1)), "1969-12-31 23:59:59 UTC");
    }

    #[test]
    fn what_is_known_is_listed_and_escaped() {
        assert_eq!(list(&Provenance::default()), "");
        let provenance = Provenance {
            file: Some("<a>.csv".to_string()),
            settings: vec![("sigma".to_string(), "\"1\"".to_string())],
            command: Some("tdoa '<script>'".to_string()),
            time: Some(Duration::from_millis(1234)),
            ..Provenance::default()
        };
        let text = list(&provenance);
        assert!(
            text.contains("<dd>&lt;a&gt;.csv</dd>") && text.contains("<dd>sigma\u{a0}&quot;1&quot;</dd>"),
            "{text}"
        );
        assert!(text.contains("<code>tdoa &#39;&lt;script&gt;&#39;</code>"), "{text}");
        assert!(text.contains("<dd>1.2 s</dd>") && !text.contains("Date"), "{text}");
    }
}
