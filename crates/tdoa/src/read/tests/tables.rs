//! Tables as programs, recorders and people of several languages write them.

use crate::pseudoranges::Pseudoranges;
use crate::read::{ReadError, ReadOptions, Role, Units, read_csv};

const SECONDS: Units = Units::Seconds { speed: 343.0 };

fn with(text: &str, options: impl Into<ReadOptions>) -> Result<Pseudoranges, String> {
    read_csv(text.as_bytes(), "f.csv", options).map_err(|error| error.to_string())
}

fn parse(text: &str) -> Result<Pseudoranges, String> {
    with(text, Units::Metres)
}

fn columns(all: &[(Role, &str)]) -> ReadOptions {
    let columns = all.iter().map(|(role, heading)| (*role, heading.to_string())).collect();
    ReadOptions { columns, units: Some(SECONDS), ..ReadOptions::default() }
}

/// A matrix of so many rows, with decimals, below a first line and with first cells.
fn table(header: &str, firsts: &[&str], columns: usize) -> String {
    let cell = |i: usize, j: usize| format!("{}.{}", 20 + (i * 7 + j * 3) % 11, 1 + (i + j) % 9);
    let row = |(i, first): (usize, &&str)| {
        let cells: Vec<String> = (0..columns).map(|j| cell(i, j)).collect();
        format!("{first},{}\n", cells.join(","))
    };
    format!("{header}\n{}", firsts.iter().enumerate().map(row).collect::<String>())
}

#[test]
fn a_first_column_of_different_whole_numbers_is_names() {
    let counted: Vec<String> = (1..=6).map(|k| k.to_string()).collect();
    let counted: Vec<&str> = counted.iter().map(String::as_str).collect();
    let serials = ["4711", "4790", "12", "305", "77", "3"];
    let headings = [
        "recorder",
        "hydrophone",
        "phone",
        "serial",
        "device",
        "index",
        "Unnamed: 0",
        "ARU",
        "site",
        "Box",
        "xyz",
        "Nr.",
        "S/N",
        "Gerät",
        "#",
    ];
    for heading in headings {
        for firsts in
            [&counted[..], &serials, &["6", "5", "4", "3", "2", "1"], &["1.0", "2.0", "3.0", "4.0", "5.0", "6.0"]]
        {
            // A line that begins with a hash is a comment, but the numbers below tell.
            let measured = parse(&table(&format!("{heading},a,b,c"), firsts, 3)).unwrap();
            assert_eq!((measured.receivers(), measured.transmitters()), (6, 3), "{heading}");
            assert_eq!(measured.receiver_names(), firsts, "{heading}");
        }
    }
    // Serial numbers of which some have letters, and numbers without a first line.
    let mixed = parse(&table("box,a,b", &["12", "3F", "7", "9A"], 2)).unwrap();
    assert_eq!(mixed.receiver_names(), ["12", "3F", "7", "9A"]);
    let bare = table("", &counted, 3);
    assert_eq!(parse(bare.trim_start()).unwrap().receiver_names(), &counted[..]);
    // Transmitters that are numbered.
    let numbered = parse(&table("box,101,102,107", &["11", "12", "13", "14"], 3)).unwrap();
    assert_eq!(
        (numbered.transmitter_names(), numbered.transmitters()),
        (&["101", "102", "107"].map(String::from)[..], 3)
    );
}

#[test]
fn a_first_column_of_measurements_stays_one() {
    for (header, columns) in [("s1,s2,s3", 3), ("clap1,clap2,clap3", 3), ("event 1,event 2,event 3", 3)] {
        let whole = format!("{header}\n10,25,31\n14,29,30\n11,21,37\n18,22,35\n");
        let measured = parse(&whole).unwrap();
        assert_eq!((measured.transmitters(), measured.receivers_named()), (columns, false), "{header}");
    }
    // Decimals, and numbers that are there twice.
    assert_eq!(parse("dog,cat\n1.5,2\n2.5,3\n3.5,7\n4,8\n").unwrap().transmitters(), 2);
    assert_eq!(parse("dog,cat\n1,2.5\n2,3.5\n2,7.5\n4,8.5\n").unwrap().transmitters(), 2);
    assert_eq!(parse("dog,cat\n-1,2.5\n2,3.5\n3,7.5\n4,8.5\n").unwrap().transmitters(), 2);
    // All are whole: it cannot be told.
    let said = parse("dog,cat,cow\n10,25,31\n14,29,30\n11,21,37\n18,22,35\n").unwrap_err();
    assert!(
        said.contains("line 1") && said.contains("--columns receiver=dog") && said.contains("\"receiver\""),
        "{said}"
    );
    let said = with(&table("time,a,b", &["1", "2", "3", "4"], 2), SECONDS).unwrap_err();
    assert!(said.contains("\"time\"") && said.contains("--columns"), "{said}");
    let options = columns(&[(Role::Receiver, "dog")]);
    let named = with("dog,cat,cow\n10,25,31\n14,29,30\n11,21,37\n18,22,35\n", options).unwrap();
    assert_eq!(named.receiver_names(), ["10", "14", "11", "18"]);
}

#[test]
fn moments_of_iso_8601() {
    let list = "receiver,event,time\nA,1,2024-05-12T05:30:35.405921Z\nB,1,2024-05-12T05:30:35.356071Z\nA,2,2024-05-12T05:31:00Z\n";
    let measured = with(list, SECONDS).unwrap();
    let difference = measured.get(0, 0).unwrap() - measured.get(1, 0).unwrap();
    assert!((difference - 343.0 * 0.04985).abs() < 1e-6, "{difference}");
    assert!((measured.get(0, 1).unwrap() - measured.get(0, 0).unwrap() - 343.0 * 24.594079).abs() < 1e-6);
    let matrix = "recorder;a;b\nA;05:30:35,405921;05:31:00\nB;05:30:35,356071;\n";
    let other = with(matrix, SECONDS).unwrap();
    assert!((other.get(0, 0).unwrap() - other.get(1, 0).unwrap() - difference).abs() < 1e-6);
    assert_eq!(with("2024-05-12 05:30:35,2024-05-12 05:30:37\n2024-05-12 05:30:36,\n", SECONDS).unwrap().observed(), 3);
    for (units, part) in
        [(Units::Metres, "give --units s --speed"), (Units::Milliseconds { speed: 343.0 }, "give --units s")]
    {
        let said = with(list, units).unwrap_err();
        assert!(said.contains("line 2, column 3") && said.contains(part), "{said}");
    }
    let said = with("receiver,event,time\nA,1,12.05.2024 05:30:35\n", SECONDS).unwrap_err();
    assert!(said.contains("ISO 8601"), "{said}");
}

#[test]
fn recorders_have_a_column_of_their_own() {
    let with_channels = "recorder,channel,event,time\nA,1,x,1\nA,2,x,2\nB,1,x,3\nB,1,y,4\n";
    let measured = with(with_channels, SECONDS).unwrap();
    assert_eq!(measured.receiver_names(), ["A:1", "A:2", "B:1"]);
    assert_eq!((measured.recorders(), measured.observed()), (vec![0, 0, 1], 4));
    // Names of receivers are their own.
    let with_names = "event,mic,recorder,time\nx,a,north,1\nx,b,south,2\nx,c,north,3\n";
    let measured = with(with_names, SECONDS).unwrap();
    assert_eq!(
        (measured.receiver_names(), measured.recorder_name(2)),
        (&["a", "b", "c"].map(String::from)[..], "north")
    );
    assert_eq!(measured.recorders(), [0, 1, 0]);
    // As the options say, and alone, where it names the receivers.
    let said = columns(&[(Role::Recorder, "box")]);
    let boxed = with(&with_names.replace("recorder", "box"), said).unwrap();
    assert_eq!(boxed.recorders(), [0, 1, 0]);
    assert_eq!(with("recorder,event,time\nA,x,1\nB,x,2\n", SECONDS).unwrap().recorders(), [0, 1]);
    for (text, part) in [
        (with_names.replace("x,c,north", "x,c,"), "line 4: names no recorder of receiver c"),
        (with_names.replace("x,c,north", "y,a,south"), "line 4: receiver a has the recorders north and south"),
        (with_names.replace("event", "aru"), "may both be the recorder"),
    ] {
        let said = with(&text, SECONDS).unwrap_err();
        assert!(said.contains(part), "{said}");
    }
}

const RAVEN: &str = "Selection\tView\tChannel\tBegin Time (s)\tEnd Time (s)\tLow Freq (Hz)\tEvent\n\
    1\tWaveform 1\t1\t35.5\t35.6\t2000\tA\n1\tSpectrogram 1\t1\t35.5\t35.6\t2000\tA\n\
    2\tWaveform 1\t2\t35.25\t35.6\t2000\tA\n3\tWaveform 1\t1\t41\t41.5\t2000\tB\n";

#[test]
fn selection_tables_of_raven() {
    let measured = with(RAVEN, SECONDS).unwrap();
    assert_eq!((measured.receiver_names(), measured.observed()), (&["1", "2"].map(String::from)[..], 3));
    assert_eq!(measured.get(1, 0), Some(35.25 * 343.0));
    let said = with(&RAVEN.replace("Event", "Sex"), SECONDS).unwrap_err();
    assert!(said.contains("no column is the transmitter") && said.contains("--columns transmitter=..."), "{said}");
    let told = with(&RAVEN.replace("Event", "Sex"), columns(&[(Role::Transmitter, "sex")])).unwrap();
    assert_eq!(told.transmitter_names(), ["A", "B"]);
    assert!(with(RAVEN, Units::Milliseconds { speed: 343.0 }).unwrap_err().contains("is in s"));
}

#[test]
fn differences_of_pairs() {
    let pairs = "event,mic_a,mic_b,tdoa_ms\n1,A,B,-50\n1,A,C,-32.5\n2,A,B,4\n2,C,B,3\n";
    let ms = Units::Milliseconds { speed: 343.0 };
    let said = with(pairs, ms).unwrap_err();
    assert!(
        said.contains("receiver=mic_b,reference=mic_a") && said.contains("receiver=mic_a,reference=mic_b"),
        "{said}"
    );
    for (receiver, reference, sign) in [("mic_b", "mic_a", 1.0), ("mic_a", "mic_b", -1.0)] {
        let mut options = columns(&[(Role::Receiver, receiver), (Role::Reference, reference)]);
        options.units = Some(ms);
        let measured = with(pairs, options).unwrap();
        let at = |name: &str, j: usize| {
            let i = measured.receiver_names().iter().position(|other| other == name).unwrap();
            measured.get(i, j).unwrap() / ms.metres() * sign
        };
        for (a, b, j, expected) in [("A", "B", 0, -50.0), ("A", "C", 0, -32.5), ("A", "B", 1, 4.0), ("C", "B", 1, 3.0)]
        {
            assert!((at(b, j) - at(a, j) - expected).abs() < 1e-9, "{a} {b}");
        }
    }
    for heading in ["mic_a,mic_b,tdoa", "Receiver 1,Receiver 2,time difference"] {
        let said = with(&format!("{heading}\n1,2,0.5\n1,3,0.25\n"), SECONDS).unwrap_err();
        assert!(said.contains("which event"), "{heading}: {said}");
    }
    let said = with("event,receiver,reference,tdoa\n1,A,B,1\n1,C,D,2\n", SECONDS).unwrap_err();
    assert!(said.contains("no differences connect"), "{said}");
    assert!(with("event,receiver,reference,tdoa\n1,A,B,1\n1,A,C,2\n", SECONDS).is_ok());
}

#[test]
fn columns_are_said() {
    let list = "ch;shot;t;quality\n1;7;1,5;0,9\n2;7;2,5;0,9\n1;8;3,5;0,1\n2;8;4,5;0,5\n";
    for options in [
        columns(&[(Role::Receiver, "ch"), (Role::Transmitter, "shot"), (Role::Time, "t")]),
        columns(&[]),
        columns(&[(Role::Value, "T")]),
    ] {
        let measured = with(list, options).unwrap();
        assert_eq!(measured.dense(), [1.5, 3.5, 2.5, 4.5].map(|t| t * 343.0));
    }
    let german = "Mikrofon;Ereignis;Zeit\nm;a;1,5\nn;a;2,5\n";
    assert_eq!(with(german, SECONDS).unwrap().observed(), 2);
    assert_eq!(with("recorder;call;toa_s\nA;1;1,5\nB;1;2,5\n", SECONDS).unwrap().observed(), 2);
    let foreign = "o;e;w\nm;a;1,5\nn;a;2,5\n";
    let said = with(foreign, SECONDS).unwrap_err();
    assert!(said.contains("--columns receiver="), "{said}");
    let told = columns(&[(Role::Receiver, "o"), (Role::Transmitter, "e"), (Role::Time, "w")]);
    assert_eq!(with(foreign, told).unwrap().observed(), 2);
    for (options, part) in [
        (columns(&[(Role::Receiver, "mic")]), "no column is headed \"mic\"; there are \"ch\""),
        (columns(&[(Role::Receiver, "ch"), (Role::Time, "ch")]), "cannot be two things"),
    ] {
        let said = with(list, options).unwrap_err();
        assert!(said.contains(part), "{said}");
    }
    let mut metres = columns(&[(Role::Time, "t")]);
    metres.units = None;
    assert!(with(list, metres).unwrap_err().contains("their unit is not said"));
}

/// Twelve lines of a list whose first line nobody knows, and without one.
#[test]
fn a_list_is_not_taken_for_a_matrix_of_many_receivers() {
    for labels in [["1", "2", "3", "4"], ["A", "B", "C", "D"]] {
        let lines: String =
            (0..20).map(|k| format!("{},{},{}.5,0.9\n", labels[k % 4], k / 4, 30 + k * 3 % 7)).collect();
        let said = parse(&format!("who,what,when,how\n{lines}")).unwrap_err();
        assert!(said.contains("--columns receiver=who,transmitter=what,value=when"), "{said}");
        let said = parse(&lines).unwrap_err();
        assert!(said.contains("first line") && said.contains("receiver,transmitter,value"), "{said}");
    }
}

#[test]
fn rows_and_columns_the_other_way_round() {
    let text = "event,a,b,c\nx,1.5,2.5,3.5\ny,4.5,5.5,6.5\n";
    assert!(parse(text).unwrap_err().contains("--transpose"));
    let options = ReadOptions { transpose: true, ..Units::Metres.into() };
    let measured = with(text, options.clone()).unwrap();
    assert_eq!(measured.dense(), [1.5, 4.5, 2.5, 5.5, 3.5, 6.5]);
    assert_eq!(measured.receiver_names(), ["a", "b", "c"]);
    assert_eq!(measured.transmitter_names(), ["x", "y"]);
    let bare = with("1.5,2.5\n3.5,4.5\n5.5,6.5\n", options.clone()).unwrap();
    assert_eq!((bare.receivers(), bare.dense()), (2, vec![1.5, 3.5, 5.5, 2.5, 4.5, 6.5]));
    // Events in rows, numbered, with a column of something else.
    let finder =
        "idx,r1,r2,r3,temp\n0,0.5,0.25,0.125,20.0\n1,0.5,0.75,0.5,20.0\n2,0.125,0.25,0.5,20.0\n3,0.5,0.5,0.25,20.0\n";
    let said = with(finder, SECONDS).unwrap_err();
    assert!(said.contains("\"temp\"") && said.contains("--columns ignore="), "{said}");
    let without = columns(&[(Role::Ignore, "temp")]);
    let said = with(finder, without.clone()).unwrap_err();
    assert!(said.contains("--transpose"), "{said}");
    let measured = with(finder, ReadOptions { transpose: true, ..without }).unwrap();
    assert_eq!((measured.receivers(), measured.transmitters()), (3, 4));
    assert_eq!(measured.get(2, 0), Some(0.125 * 343.0));
    let lists = with("mic,event,value\nm,a,1\n", options).unwrap_err();
    assert!(!lists.is_empty());
}

#[test]
fn thousands_are_never_read_as_decimals() {
    let samples = Units::Samples { speed: 343.0, rate: 48_000.0 };
    for (text, mark) in [
        ("r,a,b\nm,\"51,335\",\"50,728\"\nn,\"51,866\",\n", '.'),
        ("r;a;b\nm;51,335;50,728\nn;51,866;998\n", '.'),
        ("r;a;b\nm;51.335;50.728\nn;51.866;998\n", ','),
        ("r\ta\tb\nm\t51.335\t50.728\nn\t51.866\t998\n", ','),
        ("mic;event;value\nm;a;51.335\nm;b;50.728\nn;a;51.866\n", ','),
    ] {
        let said = with(text, samples).unwrap_err();
        assert!(said.contains("thousands") && said.contains("--decimal-mark"), "{text}: {said}");
        let options = ReadOptions { decimal_mark: Some(mark), ..samples.into() };
        let measured = with(text, options).unwrap();
        assert!((measured.get(0, 0).unwrap() - 51_335.0 * samples.metres()).abs() < 1e-9, "{text}");
    }
    for text in ["r;a;b\nm;51 335;50 728\nn;51 866;998\n", "r,a,b\nm,51'335,50'728\nn,51'866,998\n"] {
        assert!((with(text, samples).unwrap().get(1, 0).unwrap() - 51_866.0 * samples.metres()).abs() < 1e-9);
    }
    // Millimetres, and decimals that are no thousands.
    assert!(parse("r;a;b\nm;1,335;7,728\nn;5,866;9,998\n").is_ok());
    assert!(with("r;a;b\nm;51,335;0,728\nn;51,866;\n", samples).is_ok());
    assert!(with("r,a,b\nm,51.335,50.728\nn,51.866,\n", samples).is_ok());
}

#[test]
fn what_spreadsheets_leave() {
    let plain = parse("receiver,s1,s2,s3\nm,1.5,,2.5\nn,3.5,4.5,-5.5\n").unwrap();
    for text in [
        "sep=;\nreceiver;s1;s2;s3\nm;1,5;;2,5\nn;3,5;4,5;-5,5\n",
        "\u{feff}sep=;\r\nreceiver;s1;s2;s3\r\nm;1,5;#NV;2,5\r\nn;3,5;4,5;\u{2212}5,5\r\n",
        "receiver,s1,s2,s3\nm,1.5,#N/A,2.5\nn,3.5,4.5,\u{2212}5.5\n",
        "receiver,s1,,s2,s3\nm,1.5,,,2.5\nn,3.5,,4.5,-5.5\n",
        ",receiver,s1,s2,s3\n,m,1.5,,2.5\n,n,3.5,4.5,-5.5\n",
        "receiver,s1,s2,s3,,\nm,1.5,,2.5,,\nn,3.5,4.5,-5.5,,\n,,,,,\n",
    ] {
        let measured = parse(text).unwrap_or_else(|error| panic!("{text:?}: {error}"));
        let shown = |measured: &Pseudoranges| {
            let names = [measured.receiver_names(), measured.transmitter_names()];
            format!("{names:?} {:?}", measured.dense())
        };
        assert_eq!(shown(&measured), shown(&plain), "{text:?}");
    }
    // A column without a heading that has measurements is no transmitter that is there already.
    let measured = parse("receiver,s1,,s2\nm,1.5,7,2.5\nn,3.5,4.5,-5.5\n").unwrap();
    assert_eq!(measured.transmitter_names(), ["s1", "column 3", "s2"]);
    let missing = "#N/A,1.5\n2.5,#N/A\n#N/A,3.5\n";
    assert_eq!((parse(missing).unwrap().receivers(), parse(missing).unwrap().observed()), (3, 3));
    let said = parse("receiver,a\nm,#VALUE!\n").unwrap_err();
    assert!(said.contains("line 2, column 2") && said.contains("error of a spreadsheet"), "{said}");
}

#[test]
fn latin_1_is_text() {
    let text = b"Empf\xe4nger;s1;s2\nK\xfcche;1,5;2,5\nB\xfcro;3,5;4,5\n";
    let measured = read_csv(&text[..], "f", Units::Metres).unwrap();
    assert_eq!((measured.receiver_names(), measured.observed()), (&["Küche", "Büro"].map(String::from)[..], 4));
    for binary in [&b"\x00\x01\x02\xff"[..], b"\x89PNG\r\n\x1a\n", b"1,2,3,4\n5,6,7,\x81\n"] {
        let error = read_csv(binary, "f", Units::Metres);
        assert!(matches!(error, Err(ReadError::NotText { .. })));
    }
}
