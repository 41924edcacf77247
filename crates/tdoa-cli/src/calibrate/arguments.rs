//! The options of `tdoa calibrate`.

use std::path::{Path, PathBuf};

use tdoa::CalibrateOptions;

use crate::Failure;
use crate::clocks::{EmissionArguments, ReceiverClockArguments};
use crate::provenance::{named, said};
use crate::recordings::{RecordingArguments, Recordings};

/// Finds positions and offsets of a whole network from its pseudoranges.
///
/// FILE is a CSV matrix (receivers in rows, transmitters in columns, empty or nan where nothing was
/// measured, optionally with names in the first line and the first column), a CSV list with one
/// measurement a line below a header that names the columns receiver (or mic, anchor, sensor),
/// transmitter (or event, source, tag), value (or time, toa, range) and, if wanted, sigma or weight, and value2,
/// value3, ... with further candidates for the value, of which one is picked, in any
/// order, a .npy array, or a .mat file with the matrix z (or --variable) and, as truth, the
/// positions rgt. Cells stand between commas, semicolons, tabs or blanks; with any but commas,
/// numbers may have decimal commas. `-` stands for standard input, and for standard output (in
/// place of the summary) where a result is written.
///
/// Several FILEs, or one, may be recordings (WAV or FLAC) of claps or other short sounds in place of a table: the program finds the
/// sounds and when each channel hears them, as `tdoa listen` does, and calibrates with these times.
///
/// Interrupted, it writes the best network so far as JSON marked "unfinished", with exit status 130.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The measurements, - for standard input; or recordings, which are listened to.
    #[arg(required = true, value_name = "FILE")]
    pub(super) files: Vec<PathBuf>,
    #[command(flatten)]
    pub(super) input: crate::units::InputArguments,
    #[command(flatten, next_help_heading = "Recordings")]
    pub(super) recording: RecordingArguments,
    /// Standard deviation of the measurements in metres; estimated if not given.
    #[arg(long, allow_negative_numbers = true)]
    pub(super) sigma: Option<f64>,
    /// Whether the network is sought in the plane or in space. `auto`: in space where anchors have
    /// different heights or --frame names four nodes; without these, unless the measurements are more likely
    /// in the plane, and says so.
    #[arg(long, value_enum, default_value = "auto")]
    pub(super) dimensions: Dimensions,
    /// Fits a common scale when comparing with --truth and presents the network with it (the
    /// propagation speed is then wrong by that factor).
    #[arg(long)]
    pub(super) scale: bool,
    /// Known positions of some receivers and transmitters (columns name, x, y and, in space, z in any
    /// order, metres): they fix the frame, and two or more (three) are held there, which sharpens the rest.
    /// With a column sigma (or std_x and std_y, std_z) they are measurements with that standard deviation,
    /// exact where it is 0; coordinates may be empty. In space, z of three nodes or more may be all that is known:
    /// it turns the network upright.
    #[arg(long, value_name = "FILE.csv", conflicts_with_all = ["frame", "scale"])]
    pub(super) anchors: Option<PathBuf>,
    /// What is done about receivers whose measurements are all too long or too short, as by a
    /// cable: told (none), or estimated for those that show it (auto; drifting and jumping clocks and
    /// moved receivers too). `all` is short for `--receiver-clocks offset` with a recorder for each receiver.
    #[arg(long, value_enum, default_value = "none")]
    pub(super) receiver_delays: Delays,
    #[command(flatten)]
    pub(super) sending: EmissionArguments,
    #[command(flatten)]
    pub(super) clocks: ReceiverClockArguments,
    /// How measurements are wrong that are wrong by more than noise: too long or too short alike
    /// (symmetric), or nearly all too long, as where sound or radio comes by a detour (one-sided). With auto the
    /// latter is tried where no network fits, and said.
    #[arg(long, value_enum, default_value = "auto")]
    pub(super) errors: Side,
    /// Known distances between some receivers (receiver,receiver,distance,sigma; metres), such as taped ones or ranges
    /// between anchors: measurements beside the others. With --estimate-speed they tell the speed instead, and sigma may
    /// be left out.
    #[arg(long, value_name = "FILE.csv")]
    pub(super) distances: Option<PathBuf>,
    /// Estimates the propagation speed from the known distances and those between anchors: with
    /// --units s, ms, us, ns or samples in metres a second (only --sigma depends on --speed then),
    /// otherwise as a factor on the one that made the measurements metres.
    #[arg(long)]
    pub(super) estimate_speed: bool,
    /// Puts the node ORIGIN at (0, 0), XAXIS on the positive x axis and UP above it; in space
    /// ORIGIN,XAXIS,YSIDE,UP, with YSIDE in the plane of x and y, or the first three of these, with z positive
    /// on the side of most nodes.
    #[arg(long, value_name = "ORIGIN,XAXIS,UP")]
    pub(super) frame: Option<String>,
    /// True positions of receivers (columns name, x, y and, in space, z, or rgt in a .mat file) to compare with:
    /// by name, or in the order of the receivers where one side has no names. The network is turned and moved to
    /// where they are, unless --anchors or --frame fix its frame.
    #[arg(long, value_name = "RECEIVERS.csv")]
    pub(super) truth: Option<PathBuf>,
    /// Seed of the search.
    #[arg(long, default_value_t = 0)]
    pub(super) seed: u64,
    /// Threads; all cores if not given. The result does not depend on it.
    #[arg(long)]
    pub(super) threads: Option<usize>,
    /// Most starts of the search.
    #[arg(long, default_value_t = CalibrateOptions::default().search.max_starts)]
    pub(super) max_starts: usize,
    /// Starts that must have found the best network before the search ends: more for more
    /// certainty.
    #[arg(long, default_value_t = CalibrateOptions::default().search.agreeing)]
    pub(super) agreeing: usize,
    /// Writes the result as JSON; - for standard output instead of the summary.
    #[arg(long)]
    pub(super) json: Option<PathBuf>,
    /// Writes a picture of the network.
    #[arg(long)]
    pub(super) svg: Option<PathBuf>,
    /// Writes a report for a browser and for paper: the picture, tables of nodes and measurements that
    /// sort by a click, and where they come from. One file, without references to others. Where
    /// SOURCE_DATE_EPOCH is set, its date is that one and no time is told: the same bytes each time.
    #[arg(long)]
    pub(super) html: Option<PathBuf>,
    /// Writes the nodes as a CSV table: kind, name, position, standard deviations, offset, numbers
    /// of measurements.
    #[arg(long, value_name = "FILE.csv")]
    pub(super) nodes: Option<PathBuf>,
}

/// Where the network is sought.
#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
pub(super) enum Dimensions {
    #[value(name = "2")]
    Plane,
    #[value(name = "3")]
    Space,
    Auto,
}

/// What is done about errors of whole receivers.
#[derive(Clone, Copy, clap::ValueEnum)]
pub(super) enum Delays {
    None,
    Auto,
    All,
}

/// The side to which measurements are wrong.
#[derive(Clone, Copy, clap::ValueEnum)]
pub(super) enum Side {
    Auto,
    Symmetric,
    OneSided,
}

impl Arguments {
    /// Whether each receiver was started by itself.
    pub(super) fn are_started_apart(&self) -> bool {
        matches!(self.receiver_delays, Delays::All)
    }

    /// The file of the measurements, or the first recording.
    pub(super) fn file(&self) -> &Path {
        self.files.first().map_or(Path::new("-"), PathBuf::as_path)
    }

    /// What was heard in the recordings, if these were given in place of a table.
    pub(super) fn recordings(&self) -> Result<Option<Recordings>, Failure> {
        if !self.recording.are_of(&self.files)? {
            return Ok(None);
        }
        let speed = self.recording.speed(self.input.speed_of_recordings()?)?;
        if !speed.is_said && !self.estimate_speed {
            eprintln!(
                "note: the speed of sound is taken to be {} m/s, that of 20 degrees; --temperature or --speed says it better",
                speed.metres_per_second
            );
        }
        let found = self.recording.listen(&self.files, speed.metres_per_second, self.html.is_some(), self.threads)?;
        found.tell();
        Ok(Some(found))
    }

    /// The options that ask for files, with these.
    pub(super) fn outputs(&self) -> [(&'static str, Option<&Path>); 4] {
        [
            ("--json", self.json.as_deref()),
            ("--svg", self.svg.as_deref()),
            ("--html", self.html.as_deref()),
            ("--nodes", self.nodes.as_deref()),
        ]
    }

    /// Names and values of the options that shape the result: those that have a value, by default too.
    pub(super) fn settings(&self) -> Vec<(String, String)> {
        let path = |path: &Option<PathBuf>| path.as_ref().map(|path| path.display().to_string());
        let switch = |given: bool| given.then_some("yes");
        let own = [
            named("dimensions", Some(said(self.dimensions))),
            named("sigma", self.sigma),
            named("anchors", path(&self.anchors)),
            named("receiver-delays", Some(said(self.receiver_delays))),
            named("errors", Some(said(self.errors))),
            named("distances", path(&self.distances)),
            named("estimate-speed", switch(self.estimate_speed)),
            named("frame", self.frame.as_ref()),
            named("truth", path(&self.truth)),
            named("scale", switch(self.scale)),
            named("seed", Some(self.seed)),
            named("max-starts", Some(self.max_starts)),
            named("agreeing", Some(self.agreeing)),
        ];
        let own = own.into_iter().chain(self.sending.settings()).chain(self.clocks.settings()).flatten();
        let are_recordings = self.recording.are_of(&self.files).unwrap_or_default();
        let of_recordings = are_recordings.then(|| self.recording.settings());
        self.input.settings().into_iter().chain(of_recordings.into_iter().flatten()).chain(own).collect()
    }
}
