//! The options of how the measurements are read: --units, --speed, --rate, --variable, --transpose,
//! --columns, --candidates and --decimal-mark.

use tdoa::read::{ReadOptions, Role, Units};

use crate::Failure;
use crate::provenance::{named, said};

/// Unit of the measurements.
#[derive(clap::Args)]
pub(crate) struct UnitArguments {
    /// Unit of the measurements: metres, centimetres, kilometres, seconds, milliseconds,
    /// microseconds, nanoseconds or samples. What is written is in metres; offsets in this unit too.
    /// Metres if not given, but then a table headed by times or another unit is refused.
    #[arg(long, value_enum)]
    units: Option<Choice>,
    /// Propagation speed in metres a second, for all units but lengths; sound in air: 343,
    /// radio: 299792458.
    #[arg(long, allow_negative_numbers = true, value_name = "M/S")]
    speed: Option<f64>,
    /// Samples a second, for --units samples.
    #[arg(long, allow_negative_numbers = true, value_name = "HZ")]
    rate: Option<f64>,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum Choice {
    M,
    Cm,
    Km,
    S,
    Ms,
    #[value(alias = "µs")]
    Us,
    Ns,
    Samples,
}

/// Stands for the speed where that is estimated anyway: sound in air.
const ASSUMED: f64 = 343.0;

impl UnitArguments {
    /// The propagation speed, if it was given, metres per second.
    pub(crate) fn speed(&self) -> Option<f64> {
        self.speed
    }

    /// The unit, if one is given; where the speed is estimated anyway, any speed will do.
    pub(crate) fn units(&self, estimate_speed: bool) -> Result<Option<Units>, Failure> {
        let unusable = |message: String| Err(Failure::Unusable(message));
        let Some(unit) = self.units else { return self.refuse_speed().map(|()| None) };
        // Whether these were given is seen to below.
        let (speed, rate) = (self.speed.unwrap_or(ASSUMED), self.rate.unwrap_or(f64::NAN));
        let units = match unit {
            Choice::M => Units::Metres,
            Choice::Cm => Units::Centimetres,
            Choice::Km => Units::Kilometres,
            Choice::S => Units::Seconds { speed },
            Choice::Ms => Units::Milliseconds { speed },
            Choice::Us => Units::Microseconds { speed },
            Choice::Ns => Units::Nanoseconds { speed },
            Choice::Samples => Units::Samples { speed, rate },
        };
        if units.speed().is_none() {
            return self.refuse_speed().map(|()| Some(units));
        }
        let name = units.name();
        if self.speed.is_none() && !estimate_speed {
            return unusable(format!(
                "--units {name} needs --speed in metres a second, such as 343 for sound in air or 299792458 for radio"
            ));
        }
        match (unit, self.rate) {
            (Choice::Samples, None) => {
                unusable("--units samples needs --rate, the samples a second, such as 48000".to_string())
            }
            (Choice::Samples, _) | (_, None) => Ok(Some(units)),
            (_, Some(_)) => unusable(format!("--rate is for --units samples, not {name}")),
        }
    }

    /// Lengths have neither speed nor rate.
    fn refuse_speed(&self) -> Result<(), Failure> {
        match (self.speed, self.rate) {
            (None, None) => Ok(()),
            (Some(_), _) => Err(Failure::unusable("--speed needs --units s, ms, us, ns or samples")),
            (None, Some(_)) => Err(Failure::unusable("--rate needs --units samples and --speed")),
        }
    }
}

/// A unit other than the metre, and how many metres it stands for.
#[derive(Clone, Copy, serde::Serialize)]
pub(crate) struct Unit {
    pub(crate) name: &'static str,
    metres: f64,
}

impl Unit {
    /// The unit of measurements; `None` for metres.
    pub(crate) fn new(units: Units) -> Option<Unit> {
        (units != Units::Metres).then(|| Unit { name: units.name(), metres: units.metres() })
    }

    /// The unit where the propagation speed is this many times as large.
    pub(crate) fn stretched(self, factor: f64) -> Unit {
        Unit { metres: self.metres * factor, ..self }
    }

    /// A length in this unit.
    pub(crate) fn of(self, metres: f64) -> f64 {
        metres / self.metres
    }

    /// Decimals that show as much of a length as these do in metres.
    pub(crate) fn decimals(self, of_metres: usize) -> usize {
        (of_metres as f64 + self.metres.log10()).round().clamp(1.0, 15.0) as usize
    }
}

/// Which numbers of the file are read, and in what unit.
#[derive(clap::Args)]
pub(crate) struct InputArguments {
    #[command(flatten)]
    units: UnitArguments,
    /// The matrix to read of a .mat file, where that is not z.
    #[arg(long, value_name = "NAME")]
    variable: Option<String>,
    /// The rows of the matrix are the transmitters (events), and its columns the receivers.
    #[arg(long)]
    transpose: bool,
    /// What columns hold whose headings do not say it, such as receiver=ch,transmitter=shot,time=t. Roles are
    /// receiver, transmitter (or event), value (or range), time, candidate (a further value), sigma, ignore, and reference where each line has
    /// the time of the receiver minus that of the reference. Of a matrix: receiver (with --transpose
    /// transmitter) for the column of names, and ignore.
    #[arg(long, value_name = "ROLE=HEADING,...", value_delimiter = ',', value_parser = column)]
    columns: Vec<(Role, String)>,
    /// Several lines of a list for one receiver and transmitter are candidates, as where a detector finds several peaks
    /// and cannot tell which is the direct arrival; one of them is picked. Columns value2, value3, ... (toa2, ...)
    /// beside value say the same without this option.
    #[arg(long)]
    candidates: bool,
    /// What stands before decimals; the other mark may stand between thousands. As the numbers have it
    /// if not given.
    #[arg(long, value_enum)]
    decimal_mark: Option<Mark>,
}

/// What stands before decimals.
#[derive(Clone, Copy, clap::ValueEnum)]
enum Mark {
    Point,
    Comma,
}

/// What a column holds, and its heading.
fn column(text: &str) -> Result<(Role, String), String> {
    let (role, heading) = text.split_once('=').ok_or("expected ROLE=HEADING, such as receiver=ch")?;
    Ok((role.trim().parse()?, heading.trim().to_string()))
}

impl InputArguments {
    /// The speed of sound for recordings, metres per second, if it was given.
    ///
    /// # Errors
    /// For an option that says how tables are read.
    pub(crate) fn speed_of_recordings(&self) -> Result<Option<f64>, Failure> {
        let of_tables = self.settings().into_iter().find(|(name, _)| name != "speed");
        match of_tables {
            Some((name, _)) => {
                Err(Failure::Unusable(format!("--{name} is for tables; recordings are read by themselves")))
            }
            None => Ok(self.units.speed),
        }
    }

    /// How the file is read; where the speed is estimated anyway, any speed will do.
    pub(crate) fn options(&self, estimate_speed: bool) -> Result<ReadOptions, Failure> {
        let mut options = ReadOptions::default();
        options.units = self.units.units(estimate_speed)?;
        options.variable.clone_from(&self.variable);
        options.transpose = self.transpose;
        options.columns.clone_from(&self.columns);
        options.candidates = self.candidates;
        options.decimal_mark = self.decimal_mark.map(|mark| match mark {
            Mark::Point => '.',
            Mark::Comma => ',',
        });
        Ok(options)
    }

    /// Names and values of the options that were given.
    pub(crate) fn settings(&self) -> Vec<(String, String)> {
        let units = &self.units;
        let columns: Vec<String> = self.columns.iter().map(|(role, heading)| format!("{role}={heading}")).collect();
        [
            named("units", units.units.map(said)),
            named("speed", units.speed),
            named("rate", units.rate),
            named("variable", self.variable.as_ref()),
            named("transpose", self.transpose.then_some("yes")),
            named("columns", Some(columns.join(",")).filter(|columns| !columns.is_empty())),
            named("candidates", self.candidates.then_some("yes")),
            named("decimal-mark", self.decimal_mark.map(said)),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}
