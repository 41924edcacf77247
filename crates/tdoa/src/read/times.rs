//! Moments as ISO 8601 writes them: `2024-05-12T05:30:35.405921Z`, or times of the day, `05:30:35.4`.

use crate::pseudoranges::TimeScale;

/// A moment: whole seconds and the rest. The first is since 1970, or since midnight.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Moment {
    pub(super) scale: TimeScale,
    pub(super) seconds: i64,
    pub(super) rest: f64,
}

impl Moment {
    /// The moment in a cell, if it holds one.
    pub(super) fn parse(cell: &str) -> Option<Moment> {
        // Neither is a number, and both are short.
        if !cell.contains(':') && !cell.contains('T') || cell.len() > 64 || !cell.is_ascii() {
            return None;
        }
        let Some((date, time)) = cell.split_once(['T', 't', ' ']) else {
            let (seconds, rest) = time_of_day(cell)?;
            return Some(Moment { scale: TimeScale::OfDay, seconds, rest });
        };
        let days = days_of(date)?;
        let (time, zone) = split_zone(time.trim());
        let (seconds, rest) = time_of_day(time.trim())?;
        let (scale, shift) = match zone {
            None => (TimeScale::Local, 0),
            Some(zone) => (TimeScale::Universal, seconds_of_zone(zone)?),
        };
        Some(Moment { scale, seconds: days * 86_400 + seconds - shift, rest })
    }

    /// The seconds from some whole second of the same kind on.
    pub(super) fn since(self, seconds: i64) -> f64 {
        (self.seconds - seconds) as f64 + self.rest
    }
}

/// Two, or so many, digits and no more.
fn digits(text: &str, count: usize) -> Option<i64> {
    (text.len() == count && text.bytes().all(|b| b.is_ascii_digit())).then(|| text.parse().ok()).flatten()
}

/// Days since 1970 of a date, with or without hyphens (H. Hinnant, chrono-compatible low-level date
/// algorithms).
fn days_of(date: &str) -> Option<i64> {
    let parts: Vec<&str> = match date.len() {
        8 => vec![date.get(..4)?, date.get(4..6)?, date.get(6..)?],
        _ => date.split(['-', '/']).collect(),
    };
    let &[year, month, day] = parts.as_slice() else { return None };
    let (year, month, day) = (digits(year, 4)?, digits(month, 2)?, digits(day, 2)?);
    let leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
    let lengths = [31, if leap { 29 } else { 28 }, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let length = *lengths.get(usize::try_from(month - 1).ok()?)?;
    if !(1..=length).contains(&day) {
        return None;
    }
    // Years begin in March, so that the leap day is the last.
    let shifted = if month <= 2 { year - 1 } else { year };
    let era = shifted.div_euclid(400);
    let of_era = shifted.rem_euclid(400);
    let of_year = (153 * (if month > 2 { month - 3 } else { month + 9 }) + 2) / 5 + day - 1;
    Some(era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468)
}

/// Whole seconds and the rest of `hh:mm:ss`, `hh:mm:ss.fff`, `hhmmss.fff`.
fn time_of_day(time: &str) -> Option<(i64, f64)> {
    let (whole, fraction) = match time.split_once(['.', ',']) {
        Some((whole, fraction)) => (whole, Some(fraction)),
        None => (time, None),
    };
    let parts: Vec<&str> = if whole.contains(':') {
        whole.split(':').collect()
    } else {
        vec![whole.get(..2)?, whole.get(2..4)?, whole.get(4..)?]
    };
    let &[hours, minutes, seconds] = parts.as_slice() else { return None };
    let (hours, minutes, seconds) = (digits(hours, 2)?, digits(minutes, 2)?, digits(seconds, 2)?);
    // A leap second is the sixtieth.
    if hours > 24 || minutes > 59 || seconds > 60 {
        return None;
    }
    let rest = match fraction {
        Some(fraction) if !fraction.is_empty() && fraction.bytes().all(|b| b.is_ascii_digit()) => {
            format!("0.{fraction}").parse().ok()?
        }
        Some(_) => return None,
        None => 0.0,
    };
    Some((hours * 3600 + minutes * 60 + seconds, rest))
}

/// A time without its zone, and the zone.
fn split_zone(time: &str) -> (&str, Option<&str>) {
    match time.find(['Z', 'z', '+', '-']) {
        Some(at) => (&time[..at], Some(&time[at..])),
        None => match time.strip_suffix("UTC") {
            Some(before) => (before, Some("Z")),
            None => (time, None),
        },
    }
}

/// What a zone is ahead of universal time, seconds.
fn seconds_of_zone(zone: &str) -> Option<i64> {
    if zone.eq_ignore_ascii_case("z") {
        return Some(0);
    }
    let sign = if zone.starts_with('-') { -1 } else { 1 };
    let shift = zone.get(1..)?.replace(':', "");
    let (hours, minutes) = (digits(shift.get(..2)?, 2)?, shift.get(2..).filter(|rest| !rest.is_empty()));
    Some(sign * (hours * 3600 + minutes.map_or(Some(0), |minutes| digits(minutes, 2))? * 60))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seconds since 1970 as `date -u -d ... +%s` has them.
    #[test]
    fn moments() {
        for (cell, scale, seconds, rest) in [
            ("1970-01-01T00:00:00Z", TimeScale::Universal, 0, 0.0),
            ("2024-05-12T05:30:35.405921Z", TimeScale::Universal, 1_715_491_835, 0.405921),
            ("2024-05-12 05:30:35.405921", TimeScale::Local, 1_715_491_835, 0.405921),
            ("2024-05-12T07:30:35,5+02:00", TimeScale::Universal, 1_715_491_835, 0.5),
            ("2024-05-12T00:30:35-0500", TimeScale::Universal, 1_715_491_835, 0.0),
            ("20240512T053035.25Z", TimeScale::Universal, 1_715_491_835, 0.25),
            ("2024/05/12 05:30:35 UTC", TimeScale::Universal, 1_715_491_835, 0.0),
            ("2000-02-29T23:59:59Z", TimeScale::Universal, 951_868_799, 0.0),
            ("1969-12-31T23:59:59.5Z", TimeScale::Universal, -1, 0.5),
            ("05:30:35.405921", TimeScale::OfDay, 19_835, 0.405921),
        ] {
            assert_eq!(Moment::parse(cell), Some(Moment { scale, seconds, rest }), "{cell}");
        }
        for cell in [
            "",
            "12",
            "1.5",
            "T",
            "5:30",
            "05:30",
            "25:00:00",
            "05:60:00",
            "2023-02-29T00:00:00Z",
            "2024-13-01T00:00:00Z",
            "12/05/2024 05:30:35",
            "2024-05-12",
            "2024-05-12T",
            "2024-05-12T05:30:35.Z",
            "2024-05-12T05:30:35.1X",
            "a:b:c",
            "2024-05-12T05:30:35+",
            "Tür",
            "05:30:35.-1",
        ] {
            assert_eq!(Moment::parse(cell), None, "{cell}");
        }
    }
}
