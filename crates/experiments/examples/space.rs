//! Networks in space: rooms with gross errors beside the Cramer-Rao bound, the choice between plane and
//! space, and real recordings beside the calibration that starts at the truth. Tables go to the output,
//! single networks that are wrong and called unique to the error output.
//!
//!     cargo run --release -p experiments --example space -- rooms 100
//!     cargo run --release -p experiments --example space -- choice 250
//!     cargo run --release -p experiments --example space -- real DIRECTORY 20 [GROSS MISSING]
//!
//! DIRECTORY has a folder for each recording with pseudoranges_m.csv (a matrix without names) and
//! receivers_gt.csv (name, x, y, z).

use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use std::path::Path;
use std::time::Instant;
use tdoa::accuracy::cramer_rao;
use tdoa::align::align;
use tdoa::calibrate::{Calibrated, KnownReceivers, calibrate_either};
use tdoa::read::{ReadOptions, read, read_nodes};
use tdoa::{CalibrateOptions, Calibration, Layout, Pseudoranges, SimulateOptions, calibrate, calibrate_with, simulate};

const NOISE: f64 = 0.01;

/// The room, metres.
const ROOM: [f64; 3] = [10.0, 8.0, 3.0];

/// Sizes of gross errors of real recordings, metres.
const GROSS: [f64; 2] = [0.3, 5.0];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["rooms", count] => rooms(count.parse()?),
        ["choice", count] => choice(count.parse()?),
        ["real", directory, seeds] => real(Path::new(directory), seeds.parse()?, 0.0, 0.0)?,
        ["real", directory, seeds, gross, missing] => {
            real(Path::new(directory), seeds.parse()?, gross.parse()?, missing.parse()?)?;
        }
        _ => eprintln!("rooms COUNT, choice COUNT, or real DIRECTORY SEEDS [GROSS MISSING]"),
    }
    Ok(())
}

fn options(seed: u64) -> CalibrateOptions<3> {
    let mut options = CalibrateOptions::new();
    options.seed = seed;
    options
}

fn mean(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count();
    values.sum::<f64>() / count.max(1) as f64
}

/// How a calibration of a room came out.
struct Room {
    seed: u64,
    /// Within three times the bound.
    right: bool,
    unique: bool,
    /// Whether an alternative is within three times the bound.
    listed: bool,
    /// Ellipsoids that hold the truth, and all.
    covered: [usize; 2],
    redundancy: usize,
    seconds: f64,
}

/// Rooms of some sizes with gross errors, a tenth of the measurements missing.
fn rooms(count: u64) {
    println!(
        "| size | gross errors | right | wrong, unique | wrong, truth listed | covered | redundancy | s a network |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for (receivers, transmitters) in [(8, 12), (10, 20), (12, 60), (30, 100)] {
        for gross in [0.0, 0.1, 0.2] {
            let run = |seed| room(receivers, transmitters, gross, seed);
            let all: Vec<Room> = (0..count).into_par_iter().map(run).collect();
            let with = |is: fn(&Room) -> bool| all.iter().filter(|room| is(room)).count();
            let covered = all.iter().fold([0, 0], |sum, room| [sum[0] + room.covered[0], sum[1] + room.covered[1]]);
            println!(
                "| {receivers}r/{transmitters}s | {:.0} % | {} of {count} | {} | {} | {:.1} % | {:.0} | {:.2} |",
                100.0 * gross,
                with(|room| room.right),
                with(|room| room.unique && !room.right),
                with(|room| room.listed && !room.right),
                100.0 * covered[0] as f64 / covered[1].max(1) as f64,
                mean(all.iter().map(|room| room.redundancy as f64)),
                mean(all.iter().map(|room| room.seconds)),
            );
            for room in all.iter().filter(|room| room.unique && !room.right) {
                eprintln!("{receivers}r/{transmitters}s, {gross} gross errors, seed {}: wrong and unique", room.seed);
            }
        }
    }
}

fn room(receivers: usize, transmitters: usize, gross: f64, seed: u64) -> Room {
    let mut made = SimulateOptions::<3>::new();
    (made.receivers, made.transmitters, made.noise, made.seed) = (receivers, transmitters, NOISE, seed);
    (made.layout, made.outliers, made.missing) = (Layout::Room { extent: ROOM }, gross, 0.1);
    let made = simulate(&made).expect("options within their range");
    let bound = cramer_rao(&made.pseudoranges, &made.outliers, &made.network, NOISE);
    let truth: Vec<_> = made.network.receivers.iter().copied().map(Some).collect();
    let near = |found: &[Option<[f64; 3]>]| off(found, &truth).is_some_and(|rms| rms < 3.0 * bound);
    let started = Instant::now();
    let found = calibrate(&made.pseudoranges, &options(seed));
    let seconds = started.elapsed().as_secs_f64();
    let Ok(found) = found else {
        return Room { seed, right: false, unique: false, listed: false, covered: [0; 2], redundancy: 0, seconds };
    };
    Room {
        seed,
        right: near(&found.receivers),
        unique: found.unique,
        listed: found.alternatives.iter().any(|other| near(&other.receivers)),
        covered: covered(&found, &truth),
        redundancy: found.redundancy,
        seconds,
    }
}

/// Root mean square distance of the receivers from the truth; `None` if one has no place.
fn off(found: &[Option<[f64; 3]>], truth: &[Option<[f64; 3]>]) -> Option<f64> {
    let pairs: Option<Vec<_>> = found.iter().zip(truth).map(|(p, q)| Some(((*p)?, (*q)?))).collect();
    let (from, to): (Vec<_>, Vec<_>) = pairs?.into_iter().unzip();
    Some(align(&from, &to, false)?.rms)
}

/// How many ellipsoids hold the true receiver, and how many there are.
fn covered(found: &Calibration<3>, truth: &[Option<[f64; 3]>]) -> [usize; 2] {
    let mut found = found.clone();
    found.compare(truth);
    let (Some(truth), Some(radius)) = (&found.truth, found.ellipse_radius) else { return [0; 2] };
    let nodes = found.receivers.iter().zip(&truth.positions).zip(&found.receiver_covariance);
    nodes.fold([0, 0], |[inside, all], ((p, q), c)| match (p, q, c) {
        (Some(p), Some(q), Some(c)) => {
            let d = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
            [inside + usize::from(square(c, d) <= radius * radius), all + 1]
        }
        _ => [inside, all],
    })
}

/// d' C^-1 d by Cramer's rule.
fn square(c: &[[f64; 3]; 3], d: [f64; 3]) -> f64 {
    let det = |m: &[[f64; 3]; 3]| -> f64 {
        let minor = |a: usize, b: usize| m[1][a] * m[2][b] - m[1][b] * m[2][a];
        m[0][0] * minor(1, 2) - m[0][1] * minor(0, 2) + m[0][2] * minor(0, 1)
    };
    let solved = |k: usize| {
        let mut replaced = *c;
        for (row, d) in replaced.iter_mut().zip(d) {
            row[k] = d;
        }
        det(&replaced)
    };
    (0..3).map(|k| d[k] * solved(k)).sum::<f64>() / det(c)
}

/// Planar networks and rooms, of whose dimension nothing is said.
fn choice(count: u64) {
    println!(
        "| network | gross errors | networks | in the plane | in space | gain over what is needed: 1 %, 50 %, 99 % |"
    );
    println!("|---|---|---|---|---|---|");
    for (receivers, transmitters) in [(8, 12), (10, 20), (12, 40)] {
        for gross in [0.0, 0.05] {
            for height in [0.0, 0.5, 3.0] {
                let run = |seed| {
                    let measured = measured_of(receivers, transmitters, gross, height, seed);
                    let found = calibrate_either(&measured, &options(seed), &Default::default()).ok()?;
                    let (space, test) = match &found {
                        Calibrated::Plane(found) => (false, found.dimension_test),
                        Calibrated::Space(found) => (true, found.dimension_test),
                    };
                    let ratio = test.and_then(|test| Some(test.gain? / test.needed?));
                    Some((space, ratio.unwrap_or(0.0)))
                };
                let all: Vec<(bool, f64)> = (0..count).into_par_iter().filter_map(run).collect();
                let space = all.iter().filter(|(space, _)| *space).count();
                let mut ratios: Vec<f64> = all.iter().map(|(_, ratio)| *ratio).collect();
                ratios.sort_by(f64::total_cmp);
                let at = |share: f64| ratios.get((share * ratios.len() as f64) as usize).copied().unwrap_or(f64::NAN);
                let what = if height == 0.0 { "plane".to_string() } else { format!("room {height} m high") };
                println!(
                    "| {receivers}r/{transmitters}s, {what} | {:.0} % | {} | {} | {space} | {:.2}, {:.2}, {:.2} |",
                    100.0 * gross,
                    all.len(),
                    all.len() - space,
                    at(0.01),
                    at(0.5),
                    at(0.99)
                );
            }
        }
    }
}

fn measured_of(receivers: usize, transmitters: usize, gross: f64, height: f64, seed: u64) -> Pseudoranges {
    let extent = [ROOM[0], ROOM[1], height];
    if height > 0.0 {
        let mut made = SimulateOptions::<3>::new();
        (made.receivers, made.transmitters, made.noise, made.seed) = (receivers, transmitters, NOISE, seed);
        (made.layout, made.outliers) = (Layout::Room { extent }, gross);
        return simulate(&made).expect("options within their range").pseudoranges;
    }
    let mut made = SimulateOptions::default();
    (made.receivers, made.transmitters, made.noise, made.seed) = (receivers, transmitters, NOISE, seed);
    (made.layout, made.outliers) = (Layout::Room { extent: [extent[0], extent[1]] }, gross);
    simulate(&made).expect("options within their range").pseudoranges
}

/// How a calibration of a recording came out.
struct Recording {
    rms: Option<f64>,
    oracle: Option<f64>,
    unique: bool,
    listed: bool,
    distrusted: bool,
    seconds: f64,
}

impl Recording {
    fn right(&self) -> bool {
        self.rms.zip(self.oracle).is_some_and(|(rms, oracle)| rms <= 1.1 * oracle)
    }
}

/// Recordings with a truth, with gross errors and gaps added.
fn real(directory: &Path, seeds: u64, gross: f64, missing: f64) -> Result<(), Box<dyn std::error::Error>> {
    println!("Gross errors added: {:.0} %, gaps: {:.0} %.\n", 100.0 * gross, 100.0 * missing);
    println!(
        "| recording | oracle, m (median) | found, m (median) | within 1.1 of it | unique, wrong | wrong, not distrusted, oracle not listed | s |"
    );
    println!("|---|---|---|---|---|---|---|");
    let mut folders: Vec<_> = std::fs::read_dir(directory)?.collect::<Result<Vec<_>, _>>()?;
    folders.sort_by_key(std::fs::DirEntry::file_name);
    for folder in folders {
        let (measured, truth) = (folder.path().join("pseudoranges_m.csv"), folder.path().join("receivers_gt.csv"));
        if !measured.is_file() || !truth.is_file() {
            continue;
        }
        let measured = read(&measured, ReadOptions::default())?;
        let Some(truth) = read_nodes(&truth)?.positions::<3>().into_iter().collect::<Option<Vec<_>>>() else {
            continue;
        };
        let run = |seed| recording(&measured, &truth, gross, missing, seed);
        let all: Vec<Recording> = (0..seeds).into_par_iter().map(run).collect();
        let median = |of: fn(&Recording) -> Option<f64>| {
            let mut values: Vec<f64> = all.iter().filter_map(of).collect();
            values.sort_by(f64::total_cmp);
            values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
        };
        let with = |is: fn(&Recording) -> bool| all.iter().filter(|run| is(run)).count();
        println!(
            "| {} {} | {:.3} | {:.3} | {} of {seeds} | {} | {} | {:.1} |",
            folder.file_name().to_string_lossy(),
            measured.configuration(),
            median(|run| run.oracle),
            median(|run| run.rms),
            with(Recording::right),
            with(|run| run.unique && !run.right()),
            with(|run| !run.right() && !run.distrusted && !run.listed),
            mean(all.iter().map(|run| run.seconds))
        );
    }
    Ok(())
}

fn recording(measured: &Pseudoranges, truth: &[[f64; 3]], gross: f64, missing: f64, seed: u64) -> Recording {
    let measured = damaged(measured, gross, missing, seed);
    let known: Vec<_> = truth.iter().copied().map(Some).collect();
    let positions = measured.receiver_names().iter().cloned().zip(truth.iter().copied()).collect();
    let mut from_truth = options(seed);
    (from_truth.restarts, from_truth.min_starts, from_truth.max_starts) = (false, 1, 1);
    let oracle = calibrate_with(&measured, &from_truth, &[&KnownReceivers { positions }], &Default::default());
    let oracle = oracle.ok().and_then(|oracle| off(&oracle.receivers, &known));
    let started = Instant::now();
    let found = calibrate(&measured, &options(seed));
    let seconds = started.elapsed().as_secs_f64();
    let near = |receivers: &[Option<[f64; 3]>]| {
        off(receivers, &known).zip(oracle).is_some_and(|(rms, oracle)| rms <= 1.1 * oracle)
    };
    match found {
        Ok(found) => Recording {
            rms: off(&found.receivers, &known),
            oracle,
            unique: found.unique,
            listed: found.alternatives.iter().any(|other| near(&other.receivers)),
            distrusted: found.distrust().is_some(),
            seconds,
        },
        Err(_) => Recording { rms: None, oracle, unique: false, listed: false, distrusted: true, seconds },
    }
}

/// The measurements with gaps and gross errors of either sign.
fn damaged(measured: &Pseudoranges, gross: f64, missing: f64, seed: u64) -> Pseudoranges {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut values = measured.dense();
    let mut order: Vec<usize> = (0..values.len()).filter(|&k| values[k].is_finite()).collect();
    order.shuffle(&mut rng);
    let share = |share: f64| (share * order.len() as f64).round() as usize;
    let (gaps, wrong) = (share(missing), share(gross));
    for &k in &order[..gaps] {
        values[k] = f64::NAN;
    }
    for &k in &order[gaps..gaps + wrong] {
        let size = rng.random_range(GROSS[0]..GROSS[1]);
        values[k] += if rng.random::<bool>() { size } else { -size };
    }
    Pseudoranges::new(measured.receivers(), measured.transmitters(), values).expect("a matrix of this size")
}
