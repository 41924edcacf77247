//! The experiments: their commands, and how many networks the full and the quick run have.

/// One call of `tdoa experiment`.
pub(super) struct Experiment {
    /// Name of its folder in results/.
    pub(super) name: &'static str,
    /// The subcommand and its options without the number of networks.
    command: &'static str,
    /// Networks of each kind in the full run; none for experiments without that option.
    full: Option<u64>,
    /// Networks of each kind in the quick run, and what else is then said.
    quick: (u64, &'static str),
    /// The recordings that it needs, folders in that of all of them.
    pub(super) recordings: &'static [&'static str],
}

impl Experiment {
    /// The words after `tdoa experiment` for a share of the full run, or for the quick one.
    pub(super) fn words(&self, share: Option<f64>) -> Vec<String> {
        let mut words: Vec<String> = self.command.split(' ').map(str::to_owned).collect();
        if share.is_none() {
            words.extend(self.quick.1.split(' ').filter(|word| !word.is_empty()).map(str::to_owned));
        }
        if let Some(full) = self.full {
            let instances = share.map_or(self.quick.0, |share| ((full as f64 * share).round() as u64).max(1));
            words.extend(["--instances".to_owned(), instances.to_string()]);
        }
        words
    }
}

const fn plain(name: &'static str, command: &'static str, full: u64, quick: u64) -> Experiment {
    Experiment { name, command, full: Some(full), quick: (quick, ""), recordings: &[] }
}

/// Recordings of twelve microphones in rooms.
const ROOMS: &[&str] = &[
    "lund_tdoa_real/data1",
    "lund_tdoa_real/data2",
    "lund_tdoa_real/data3",
    "lund_tdoa_real/data4",
    "lund_tdoa_real/data5",
    "lund_tdoa_real/data6",
    "lund_tdoa_real/data7",
    "xtdoa_real",
];

/// Recordings of six anchors.
const RANGES: &[&str] = &["lps_uwb/data4", "lps_uwb/data5", "lps_uwb/data7"];

/// All of them, in the order of the page.
///
/// The comparisons at equal time have numbers of starts that take about as long as the portfolio
/// does on the same networks; the page shows the processor seconds of each.
pub(super) const PLAN: &[Experiment] = &[
    plain("table2", "table2", 10_000, 200),
    plain("clean-6r3s", "clean --configuration 6r/3s", 100_000, 20),
    plain("clean", "clean --configuration 6r/4s,5r/4s,4r/5s", 20_000, 10),
    plain("clean-larger", "clean --configuration 7r/3s,5r/5s,4r/6s", 20_000, 10),
    plain("clean-others", "clean --configuration 9r/3s,7r/4s,5r/6s", 20_000, 10),
    plain("clean-space", "clean --dimensions 3 --configuration 10r/4s,7r/5s,6r/6s --threads 1", 1_000, 1),
    plain("clean-space-eight", "clean --dimensions 3 --configuration 8r/5s --threads 1", 10_000, 2),
    plain(
        "clean-space-others",
        "clean --dimensions 3 --configuration 9r/5s,10r/5s,7r/6s,6r/8s,6r/7s,8r/6s,11r/4s,12r/4s --threads 1",
        200,
        1,
    ),
    plain("speed", "speed", 300, 10),
    Experiment {
        name: "routes",
        command: "routes",
        full: Some(100),
        quick: (2, "--configuration 6r/3s,5r/6s"),
        recordings: &[],
    },
    plain("noise", "noise", 1000, 5),
    plain("calibrate", "calibrate", 500, 2),
    plain(
        "calibrate-restarts",
        "calibrate --method restarts --starts 220,340,500,170,190,370,96,95,300,74,73,64",
        500,
        1,
    ),
    plain("calibrate-minimal", "calibrate --method minimal --starts 8,23,30,10,11,55,12,14,105,16,22,24", 500, 1),
    plain(
        "small",
        "calibrate --configuration 6r/3s,6r/4s,6r/5s,6r/6s,6r/7s,6r/8s,5r/4s,5r/5s,5r/6s,5r/7s,5r/8s,4r/5s,4r/6s,4r/7s,4r/8s \
         --noise 1e-4,1e-2 --outliers 0 --missing 0 --known-sigma",
        500,
        1,
    ),
    plain("coverage", "coverage", 2000, 10),
    Experiment {
        name: "growth",
        command: "growth",
        full: None,
        quick: (0, "--configuration 10r/20s,20r/50s,30r/100s"),
        recordings: &[],
    },
    Experiment {
        name: "damaged",
        command: "damaged",
        full: Some(20),
        quick: (1, "--triples 20"),
        recordings: &["lund_floor_planar/h40", "lund_floor_planar/h50", "lund_floor_planar/h60"],
    },
    plain(
        "rooms",
        "calibrate --dimensions 3 --configuration 8r/12s,10r/20s,12r/60s,30r/100s --outliers 0,0.1,0.2",
        100,
        1,
    ),
    plain(
        "small-rooms",
        "calibrate --dimensions 3 --configuration 6r/6s,7r/5s,6r/7s,7r/6s,8r/5s,5r/10s,6r/8s,5r/12s,6r/12s,12r/5s,12r/6s,7r/12s \
         --noise 1e-2 --outliers 0 --missing 0 --known-sigma",
        100,
        1,
    ),
    plain(
        "smallest-rooms",
        "calibrate --dimensions 3 --configuration 10r/4s,7r/5s,6r/6s,11r/4s,8r/5s,6r/7s,12r/4s,7r/6s --method restarts,portfolio \
         --noise 0.001 --outliers 0 --missing 0",
        60,
        1,
    ),
    Experiment {
        name: "recordings",
        command: "damaged --dimensions 3 --transmitters 8,12,24 --receivers 7,8",
        full: Some(20),
        quick: (1, ""),
        recordings: ROOMS,
    },
    Experiment {
        name: "ranges",
        command: "damaged --dimensions 3",
        full: Some(20),
        quick: (1, ""),
        recordings: RANGES,
    },
    Experiment {
        name: "reduced",
        command: "reduced --threads 1",
        full: Some(13),
        quick: (1, "--configuration 8r/5s"),
        recordings: ROOMS,
    },
    Experiment {
        name: "reduced-larger",
        command: "reduced --configuration 8r/5s,9r/5s,10r/5s,7r/6s,8r/6s,6r/8s --threads 1",
        full: Some(100),
        quick: (1, ""),
        recordings: ROOMS,
    },
    Experiment {
        name: "reduced-ranges",
        command: "reduced --configuration 6r/6s,6r/8s --threads 1",
        full: Some(4),
        quick: (1, ""),
        recordings: RANGES,
    },
    Experiment {
        name: "smallest-ranges",
        command: "reduced --ranges --configuration 6r/4s,5r/5s,4r/6s --bound 0.1 --threads 1",
        full: Some(100),
        quick: (1, ""),
        recordings: RANGES,
    },
    Experiment {
        name: "smallest-constants",
        command: "reduced --constant --configuration 5r/5s,4r/7s --bound 0.1 --threads 1",
        full: Some(100),
        quick: (1, ""),
        recordings: RANGES,
    },
    plain("dimension", "dimension", 167, 1),
    plain("low", "dimension --height 0.5,1", 20, 1),
    plain("kinds", "kinds", 100, 1),
    plain("clocks", "clocks", 200, 1),
    Experiment { name: "sound", command: "sound", full: Some(20), quick: (1, "--case 2"), recordings: &[] },
    plain("families", "families", 50, 1),
];
