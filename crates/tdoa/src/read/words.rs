//! The words by which first lines are understood: every table of them is here.

/// What may stand below a heading. For each there are words that say it, and words that may say it
/// where no other column does.
pub(super) struct Words {
    pub(super) sure: &'static [&'static str],
    pub(super) weak: &'static [&'static str],
}

/// Names of receivers.
pub(super) const RECEIVER: Words = Words {
    sure: &[
        "receiver",
        "mic",
        "microphone",
        "anchor",
        "sensor",
        "station",
        "channel",
        "rx",
        "hydrophone",
        "recorder",
        "aru",
        "geophone",
        "empfänger",
        "empfaenger",
        "mikrofon",
        "mikrophon",
        "kanal",
        "récepteur",
        "recepteur",
    ],
    weak: &[
        "node",
        "ch",
        "chan",
        "device",
        "phone",
        "smartphone",
        "unit",
        "site",
        "serial",
        "logger",
        "element",
        "rec",
        "detector",
        "buoy",
        "antenna",
        "gateway",
        "knoten",
        "gerät",
        "geraet",
        "standort",
    ],
};

/// Names of receivers that may be those of recorders of several, and of channels, which each recorder may count for itself.
pub(super) const RECORDER: &[&str] = &["recorder", "aru"];
pub(super) const CHANNEL: &[&str] = &["channel", "ch", "chan", "kanal"];

/// Names of transmitters, or of the events that are heard.
pub(super) const TRANSMITTER: Words = Words {
    sure: &[
        "transmitter",
        "event",
        "source",
        "emitter",
        "sound",
        "shot",
        "tag",
        "beacon",
        "tx",
        "ereignis",
        "sender",
        "quelle",
    ],
    weak: &[
        "call",
        "ping",
        "clap",
        "click",
        "pulse",
        "chirp",
        "knock",
        "blast",
        "speaker",
        "loudspeaker",
        "vocalization",
        "vocalisation",
        "song",
        "burst",
        "impulse",
        "annotation",
        "explosion",
        "strike",
        "schuss",
        "ruf",
        "knall",
        "événement",
        "evenement",
        "émetteur",
        "emetteur",
        "evento",
        "fuente",
    ],
};

/// Lengths.
pub(super) const LENGTH: Words = Words {
    sure: &[
        "value",
        "pseudorange",
        "range",
        "distance",
        "measurement",
        "wert",
        "messwert",
        "entfernung",
        "abstand",
        "distanz",
    ],
    weak: &[],
};

/// Times.
pub(super) const TIME: Words = Words {
    sure: &[
        "time",
        "toa",
        "tdoa",
        "arrival",
        "arrival_time",
        "time_of_arrival",
        "timestamp",
        "sample",
        "seconds",
        "zeit",
        "ankunft",
        "ankunftszeit",
        "zeitstempel",
        "zeitpunkt",
        "temps",
        "tiempo",
    ],
    weak: &[
        "t",
        "dt",
        "begin_time",
        "start_time",
        "onset",
        "onset_time",
        "peak_time",
        "delay",
        "time_difference",
        "lag",
        "datetime",
        "date_time",
        "utc",
        "time_utc",
        "utc_time",
        "gps_time",
        "time_gps",
        "local_time",
    ],
};

/// Standard deviations.
pub(super) const SIGMA: Words =
    Words { sure: &["sigma", "std", "stddev", "std_dev", "standard_deviation", "standardabweichung"], weak: &[] };

/// One over squares of standard deviations, in any unit.
pub(super) const WEIGHT: Words = Words { sure: &["weight", "weights", "gewicht"], weak: &[] };

/// The receiver whose time is taken off that of another.
pub(super) const REFERENCE: Words =
    Words { sure: &["reference", "ref", "reference_receiver", "ref_receiver"], weak: &[] };

/// Nodes of either kind.
pub(super) const NODE: &[&str] = &["name", "id", "node", "label", "knoten", "bezeichnung"];

/// Numbers of rows.
pub(super) const INDEX: &[&str] = &[
    "index",
    "idx",
    "unnamed_0",
    "unnamed",
    "no",
    "nr",
    "num",
    "number",
    "row",
    "serial",
    "sn",
    "s_n",
    "key",
    "nummer",
];

/// What is measured beside arrival times and is none.
pub(super) const OTHER: &[&str] = &[
    "temp",
    "temperature",
    "temperatur",
    "humidity",
    "pressure",
    "wind",
    "wind_speed",
    "speed_of_sound",
    "lat",
    "latitude",
    "lon",
    "longitude",
    "battery",
    "quality",
    "snr",
    "rssi",
    "comment",
    "comments",
    "notes",
    "remark",
    "remarks",
    "kommentar",
    "date",
    "datum",
];

/// Marks of the first and the second of a pair, behind the word for a receiver.
pub(super) const PAIRS: &[[&str; 2]] = &[["a", "b"], ["1", "2"], ["i", "j"], ["first", "second"], ["from", "to"]];

/// Coordinates to the east, to the north and upwards.
pub(super) const COORDINATES: [&[&str]; 3] = [
    &[
        "x",
        "pos_x",
        "x_pos",
        "position_x",
        "easting",
        "east",
        "utm_x",
        "utm_easting",
        "utm_e",
        "x_utm",
        "rechtswert",
        "ostwert",
    ],
    &[
        "y",
        "pos_y",
        "y_pos",
        "position_y",
        "northing",
        "north",
        "utm_y",
        "utm_northing",
        "utm_n",
        "y_utm",
        "hochwert",
        "nordwert",
    ],
    &["z", "pos_z", "z_pos", "position_z", "height", "altitude", "elevation", "elev", "alt", "up", "höhe", "hoehe"],
];

/// Single letters for the same, which say it together.
pub(super) const LETTERS: [&str; 3] = ["e", "n", "u"];

/// Angles on the earth, which are no lengths.
pub(super) const ANGLES: &[&str] = &["lat", "latitude", "lon", "long", "lng", "longitude"];

/// Lengths that count downwards.
pub(super) const DEPTHS: &[&str] = &["depth", "tiefe"];

/// Spellings of units, and the unit they stand for.
pub(super) const UNITS: &[(&str, &str)] = &[
    ("m", "m"),
    ("metre", "m"),
    ("metres", "m"),
    ("meter", "m"),
    ("meters", "m"),
    ("s", "s"),
    ("sec", "s"),
    ("secs", "s"),
    ("second", "s"),
    ("seconds", "s"),
    ("sekunden", "s"),
    ("ms", "ms"),
    ("msec", "ms"),
    ("milliseconds", "ms"),
    ("us", "us"),
    ("µs", "us"),
    ("μs", "us"),
    ("usec", "us"),
    ("microseconds", "us"),
    ("samples", "samples"),
    ("ns", "ns"),
    ("nsec", "ns"),
    ("nanoseconds", "ns"),
    ("mm", "mm"),
    ("millimetres", "mm"),
    ("millimeters", "mm"),
    ("cm", "cm"),
    ("centimetres", "cm"),
    ("centimeters", "cm"),
    ("km", "km"),
    ("kilometres", "km"),
    ("kilometers", "km"),
    ("ft", "ft"),
    ("feet", "ft"),
];

/// What stands in cells of measurements that were not made, in lower case; spreadsheets of several
/// languages among them.
pub(super) const MISSING: &[&str] = &[
    "", "nan", "na", "n/a", "null", "-", "#n/a", "#na", "<na>", "#nv", "#n/d", "#n/v", "nat", "none", "missing",
    "n.a.", "--", "\u{2212}", "\u{2013}", "\u{2014}",
];
