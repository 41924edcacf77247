//! What the experiments share: their options, the networks, the folder of the results.

use std::ops::Range;
use std::path::{Path, PathBuf};

use tdoa::{Layout, SimulateOptions, Simulation, simulate};

use cli::{Failure, output};

/// Options that every experiment has.
#[derive(clap::Args)]
pub(super) struct Common {
    /// First seed; the networks have this and the following ones.
    #[arg(long, default_value_t = 0)]
    pub(super) seed: u64,
    /// Threads; all cores if not given. Only times depend on it.
    #[arg(long)]
    pub(super) threads: Option<usize>,
    /// Directory for the tables (CSV) and figures (SVG); made if it is not there. Where trials.csv
    /// is there already, the run goes on from it.
    #[arg(long)]
    pub(super) output: PathBuf,
}

impl Common {
    /// The seeds of this many networks.
    pub(super) fn seeds(&self, instances: u64) -> Range<u64> {
        self.seed..self.seed.saturating_add(instances)
    }

    /// So many networks of each size, and the keys of their rows.
    pub(super) fn trials(&self, sizes: &[Size], instances: u64) -> (Vec<(Size, u64)>, Vec<String>) {
        let trials: Vec<(Size, u64)> =
            sizes.iter().flat_map(|&size| self.seeds(instances).map(move |seed| (size, seed))).collect();
        let keys = trials.iter().map(|(size, seed)| format!("{size},{seed}")).collect();
        (trials, keys)
    }

    /// Makes the directory and says where a file in it lies.
    pub(super) fn file(&self, name: &str) -> Result<PathBuf, Failure> {
        std::fs::create_dir_all(&self.output).map_err(|error| {
            Failure::Unusable(format!("{}: cannot be made ({error}); choose another --output", self.output.display()))
        })?;
        Ok(self.output.join(name))
    }

    /// Writes a file of the results.
    pub(super) fn write(&self, name: &str, text: &str) -> Result<(), Failure> {
        output::write(&self.file(name)?, text.as_bytes())
    }
}

/// Numbers of receivers and transmitters.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Size {
    pub(super) receivers: usize,
    pub(super) transmitters: usize,
}

impl std::str::FromStr for Size {
    type Err = String;

    /// Reads `6r/3s`.
    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("`{text}` is not a configuration such as 6r/3s");
        let (receivers, transmitters) = text.split_once('/').ok_or_else(wrong)?;
        let number = |part: &str, unit: char| part.strip_suffix(unit).and_then(|n| n.parse().ok()).ok_or_else(wrong);
        Ok(Size { receivers: number(receivers, 'r')?, transmitters: number(transmitters, 's')? })
    }
}

impl std::fmt::Display for Size {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}r/{}s", self.receivers, self.transmitters)
    }
}

impl Size {
    /// The size as part of a file's name.
    pub(super) fn file(self) -> String {
        format!("{}r{}s", self.receivers, self.transmitters)
    }
}

/// Reads `6r/3s` as two numbers, for an option.
pub(super) fn configuration(text: &str) -> Result<(usize, usize), String> {
    text.parse().map(|size: Size| (size.receivers, size.transmitters))
}

/// A network as in the paper: positions and offsets standard normal.
pub(super) fn normal<const D: usize>(size: Size, noise: f64, seed: u64) -> Result<Simulation<D>, Failure> {
    let mut options = SimulateOptions::new();
    (options.receivers, options.transmitters) = (size.receivers, size.transmitters);
    options.layout = Layout::Normal;
    options.noise = noise;
    options.seed = seed;
    simulate(&options).map_err(Failure::unusable)
}

/// Processor seconds of this thread so far, where the system tells them (Linux); otherwise seconds on
/// the clock. Other programs on the same cores then do not count.
pub(super) fn thread_seconds() -> f64 {
    let told = std::fs::read_to_string(Path::new("/proc/thread-self/schedstat")).ok();
    let nanoseconds = told.and_then(|text| text.split_whitespace().next()?.parse::<u64>().ok());
    match nanoseconds {
        Some(nanoseconds) => nanoseconds as f64 * 1e-9,
        None => {
            std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).map_or(0.0, |since| since.as_secs_f64())
        }
    }
}
