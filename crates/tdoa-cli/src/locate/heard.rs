//! The sounds of recordings, located.

use serde::{Deserialize, Serialize};
use tdoa::{Calibration, Emissions, LocatedEvent, Locator, Pseudoranges};

use super::arguments::Arguments;
use crate::{Failure, output};

/// The unit of a network's measurements.
#[derive(Deserialize)]
pub(super) struct Unit {
    name: String,
    metres: f64,
}

/// A sound in a place.
#[derive(Serialize)]
#[serde(bound = "LocatedEvent<D>: Serialize")]
struct Sound<const D: usize> {
    #[serde(flatten)]
    event: LocatedEvent<D>,
    /// When it was made, seconds from the first sample of the recordings; of recorders that were started apart those of the
    /// first in the network.
    #[serde(skip_serializing_if = "Option::is_none")]
    seconds: Option<f64>,
}

/// Finds the sounds of recordings and locates each.
pub(super) fn locate<const D: usize>(
    arguments: &Arguments,
    network: &Calibration<D>,
    units: Option<&Unit>,
    locator: &Locator<D>,
) -> Result<(), Failure>
where
    LocatedEvent<D>: Serialize,
{
    let known = match network.emissions {
        Emissions::Unknown => false,
        // By a schedule offsets differ, and new transmitters need not follow it.
        Emissions::Constant => network.offsets.iter().flatten().is_sorted_by(|a, b| a == b),
        _ => true,
    };
    if known {
        let problem = "the network was calibrated with known send times or one constant for all, and a recording does not tell when \
                       sounds were made; calibrate with sounds";
        return Err(Failure::in_file(&arguments.network, problem));
    }
    // The locator takes metres at the speed that was assumed, and corrects them by what was found.
    let factor = network.speed.map_or(1.0, |speed| speed.factor);
    let of_network = units.filter(|unit| unit.name == "s").map(|unit| unit.metres);
    let said = arguments.recording.speed(arguments.input.speed_of_recordings()?)?;
    let speed = match of_network {
        Some(speed) if !said.is_said => speed,
        _ => said.metres_per_second,
    };
    if !said.is_said {
        let origin = if of_network.is_some() { "as the network was calibrated" } else { "that of 20 degrees" };
        eprintln!(
            "note: the speed of sound is taken to be {speed:.1} m/s, {origin}; --temperature or --speed says it better"
        );
    }
    let heard = arguments.recording.listen(&arguments.files, speed / factor, false, arguments.threads)?;
    heard.tell();
    let measured = by_channel(heard.measured()?, arguments, &network.receiver_names)?;
    for event in locator.locate(&measured).map_err(Failure::unusable)? {
        let seconds = event.place.as_ref().map(|place| place.offset / speed);
        output::json_line(&Sound { event, seconds })?;
    }
    Ok(())
}

/// Measurements of one file whose name is new, with the names of the network's receivers: those of one file too, each
/// with the number of its channel.
fn by_channel(measured: Pseudoranges, arguments: &Arguments, known: &[String]) -> Result<Pseudoranges, Failure> {
    let [_] = &arguments.files[..] else { return Ok(measured) };
    if measured.receiver_names().iter().any(|name| known.contains(name)) {
        return Ok(measured);
    }
    let file_of = |name: &str| name.rsplit_once(':').map(|(file, _)| file.to_string());
    let Some(file) = known.first().and_then(|name| file_of(name)) else { return Ok(measured) };
    if known.iter().any(|name| file_of(name).as_ref() != Some(&file)) {
        return Ok(measured);
    }
    let renamed = |name: &String| {
        let channel = name.rsplit_once(':').map_or("", |(_, channel)| channel);
        format!("{file}:{channel}")
    };
    let names: Vec<String> = measured.receiver_names().iter().map(renamed).collect();
    if names.iter().any(|name| !known.contains(name)) {
        return Ok(measured);
    }
    eprintln!("note: channels are taken to be those of the network's recording, {file}, by their numbers");
    measured.with_receiver_names(names).map_err(Failure::unusable)
}
