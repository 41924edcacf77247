//! What paths of a system take, as measured.

use cli::Failure;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::path::Path;

/// A portion of paths that another rank than the first has tracked on one thread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Portion {
    /// Number of paths.
    pub paths: usize,
    /// Seconds of tracking.
    pub seconds: f64,
    /// Length of the answer.
    pub bytes: usize,
}

/// What paths of a system take.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    /// Name of the system.
    pub system: String,
    /// Seconds of rank 0 for each path that has come back: reading, judging, keeping its end.
    pub lead: f64,
    /// Seconds until paths begin, which each rank spends for itself.
    pub start: f64,
    /// Portions, in the order in which they came back.
    pub portions: Vec<Portion>,
}

const SYSTEMS: &str = "system,start_seconds,lead_microseconds_a_path";
const PORTIONS: &str = "system,paths,seconds,bytes";

impl Load {
    /// Seconds of tracking for a path.
    pub fn path(&self) -> f64 {
        let seconds: f64 = self.portions.iter().map(|portion| portion.seconds).sum();
        seconds / self.portions.iter().map(|portion| portion.paths).sum::<usize>().max(1) as f64
    }

    /// Bytes of an answer for a path.
    pub fn bytes(&self) -> f64 {
        let bytes: usize = self.portions.iter().map(|portion| portion.bytes).sum();
        bytes as f64 / self.portions.iter().map(|portion| portion.paths).sum::<usize>().max(1) as f64
    }

    /// Seconds of a portion of so many paths, put together from measured ones that are drawn.
    pub(super) fn draw(&self, paths: usize, random: &mut Random) -> f64 {
        let (mut seconds, mut left) = (0.0, paths);
        while left > 0
            && let Some(drawn) = self.portions.get(random.0.random_range(0..self.portions.len().max(1)))
        {
            let part = left.min(drawn.paths.max(1));
            seconds += drawn.seconds * part as f64 / drawn.paths.max(1) as f64;
            left -= part;
        }
        seconds
    }

    /// Writes the tables `systems.csv` and `portions.csv`.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(loads: &[Load], folder: &Path) -> Result<(), Failure> {
        let (mut systems, mut portions) = (format!("{SYSTEMS}\n"), format!("{PORTIONS}\n"));
        for load in loads {
            systems += &format!("{},{:.3},{:.2}\n", load.system, load.start, 1e6 * load.lead);
            for portion in &load.portions {
                portions += &format!("{},{},{:.6},{}\n", load.system, portion.paths, portion.seconds, portion.bytes);
            }
        }
        std::fs::create_dir_all(folder).map_err(|error| Failure::in_file(folder, error))?;
        cli::output::write(&folder.join("systems.csv"), systems.as_bytes())?;
        cli::output::write(&folder.join("portions.csv"), portions.as_bytes())
    }

    /// Reads the tables back.
    ///
    /// # Errors
    /// If a file cannot be read, or a line is none of its table.
    pub fn read(folder: &Path) -> Result<Vec<Load>, Failure> {
        let mut loads: Vec<Load> = Vec::new();
        for [system, start, lead] in rows(&folder.join("systems.csv"), SYSTEMS)? {
            let lead = 1e-6 * number(&lead)?;
            loads.push(Load { system, lead, start: number(&start)?, portions: Vec::new() });
        }
        for [system, paths, seconds, bytes] in rows(&folder.join("portions.csv"), PORTIONS)? {
            let portion = Portion {
                paths: number(&paths)? as usize,
                seconds: number(&seconds)?,
                bytes: number(&bytes)? as usize,
            };
            if let Some(load) = loads.iter_mut().find(|load| load.system == system).filter(|_| portion.paths > 0) {
                load.portions.push(portion);
            }
        }
        Ok(loads)
    }
}

fn number(cell: &str) -> Result<f64, Failure> {
    cell.parse().map_err(|_| Failure::Unusable(format!("`{cell}` is no number")))
}

/// The rows of a table below this header.
fn rows<const N: usize>(path: &Path, header: &str) -> Result<Vec<[String; N]>, Failure> {
    let text = std::fs::read_to_string(path).map_err(|error| Failure::in_file(path, error))?;
    let mut lines = text.lines();
    if lines.next() != Some(header) {
        return Err(Failure::in_file(path, format!("the columns are not {header}")));
    }
    let row = |line: &str| {
        let cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        cells.try_into().map_err(|_| Failure::in_file(path, format!("`{line}` has other columns than the table")))
    };
    lines.map(row).collect()
}

/// Random numbers of a simulation.
pub(super) struct Random(Pcg64Mcg);

impl Random {
    pub(super) fn new(seed: u64) -> Random {
        Random(Pcg64Mcg::seed_from_u64(seed))
    }
}
