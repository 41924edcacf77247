//! The options of `tdoa simulate --sound`.

use sound::RoomOptions;

/// How recordings are made.
#[derive(clap::Args)]
pub(super) struct SoundArguments {
    /// Makes recordings in place of measurements: claps in a room with echoes, in space. Writes recording.wav with a channel a
    /// receiver, or rec1.wav, rec2.wav, ... with --channels each where --delays or --rate-sigma have recorders run by
    /// themselves; receivers.csv and transmitters.csv have the truth. --layout is the room, 8x6x3 if not given.
    #[arg(long, conflicts_with_all = [
        "noise", "outliers", "outlier_size", "missing", "dimensions", "shape", "hearing", "detours", "detour_size", "candidates", "fault",
        "duration", "emissions", "ranges", "units", "rate",
    ])]
    pub(super) sound: bool,
    /// Time in which sound decays by 60 dB, seconds.
    #[arg(long, value_name = "S", requires = "sound", default_value_t = RoomOptions::default().reverberation)]
    pub(super) reverberation: f64,
    /// Power of the direct sound over that of the noise, dB.
    #[arg(long, value_name = "DB", requires = "sound", default_value_t = 20.0, allow_negative_numbers = true)]
    pub(super) signal_to_noise: f64,
    /// Samples a second.
    #[arg(long, value_name = "HZ", requires = "sound", default_value_t = RoomOptions::default().sample_rate)]
    pub(super) sample_rate: u32,
    /// Chirps from one frequency to another, Hz and seconds, in place of claps.
    #[arg(long, value_name = "FROM,TO,SECONDS", requires = "sound", value_delimiter = ',')]
    pub(super) chirp: Vec<f64>,
}
