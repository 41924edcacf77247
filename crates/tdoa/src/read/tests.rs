mod candidates;
mod tables;

use proptest::prelude::{ProptestConfig, any, proptest};

use super::{ReadError, ReadOptions, Role, Units, read_csv, read_npy};
use crate::pseudoranges::Pseudoranges;

fn parse(text: &str) -> Result<Pseudoranges, ReadError> {
    read_csv(text.as_bytes(), "f.csv", Units::Metres)
}

fn message(text: &str) -> String {
    parse(text).unwrap_err().to_string()
}

#[test]
fn plain_matrix() {
    let f = parse("1,2,3\n4,,nan\n").unwrap();
    assert_eq!((f.receivers(), f.transmitters(), f.observed()), (2, 3, 4));
    assert_eq!((f.get(0, 2), f.get(1, 0), f.get(1, 1), f.get(1, 2)), (Some(3.0), Some(4.0), None, None));
    let f = read_csv("1;2\r\n3;4\r\n".as_bytes(), "f", Units::Seconds { speed: 343.0 }).unwrap();
    assert_eq!(f.get(1, 1), Some(4.0 * 343.0));
}

#[test]
fn named_matrix() {
    let f = parse("\u{feff}receiver,a,b\nleft,1,2\nright,3,4\n").unwrap();
    assert_eq!(f.receiver_names(), ["left", "right"]);
    assert_eq!(f.transmitter_names(), ["a", "b"]);
    assert_eq!(f.get(1, 1), Some(4.0));
    let f = parse("a,b\n1,2\n3,4\n").unwrap();
    assert_eq!(f.transmitter_names(), ["a", "b"]);
    assert_eq!(f.receiver_names(), ["r1", "r2"]);
}

#[test]
fn list_of_measurements() {
    let f = parse("receiver,transmitter,value,sigma\nm1,e1,1.5,0.1\nm2,e2,2.5,0.2\nm1,e2,,\n").unwrap();
    assert_eq!((f.receivers(), f.transmitters(), f.observed()), (2, 2, 2));
    assert_eq!((f.get(0, 0), f.sigma(0, 0), f.get(0, 1)), (Some(1.5), Some(0.1), None));
    assert!(f.knows_sigmas());
    // Deviations as 1 to 2 to 4, and a measurement that does not count.
    let text = "mic,event,value,weight\na,d,1,0.16\na,e,2,0.04\nb,d,3,0.01\nb,e,4,0\n";
    let f = parse(text).unwrap();
    let shares = [f.sigma(0, 0), f.sigma(0, 1), f.sigma(1, 0), f.get(1, 1)];
    assert_eq!((shares, f.knows_sigmas()), ([Some(0.5), Some(1.0), Some(2.0), None], false));
    assert_eq!([f.weight(0, 0), f.weight(1, 0)], [Some(4.0), Some(0.25)]);
    let f = parse("Time,Event,Receiver\n3,e,m\n").unwrap();
    assert_eq!((f.get(0, 0), f.sigma(0, 0)), (Some(3.0), None));
}

#[test]
fn mistakes_are_placed() {
    let text = message("1,2,3\n4,abc,6\n");
    assert!(text.contains("line 2, column 2 (receiver r2, transmitter s2)") && text.contains("abc"), "{text}");
    // The first line too: it has numbers, so it is no header.
    assert!(message("1,x,3\n4,5,6\n").contains("line 1, column 2"));
    let text = message("1,2,3\n4,5\n");
    assert!(text.contains("line 2 (receiver r2)") && text.contains("2 cells in place of 3"), "{text}");
    assert!(message("").contains("no measurements"));
    assert!(message("a,b\n").contains("no measurements"));
    let text = message("1,inf\n2,3\n");
    assert!(text.contains("receiver r1, transmitter s2"), "{text}");
    assert!(message("1,1e300\n2,3\n").contains("1e300") || message("1,1e300\n2,3\n").contains("000000"));
    assert!(message("receiver,transmitter,value\na,b,1\na,b,2\n").contains("line 3"));
    assert!(message("receiver,transmitter,value\na,b\n").contains("line 2"));
    assert!(message("receiver,transmitter,value,sigma\na,b,1,-1\n").contains("must be positive"));
    assert!(message("receiver,transmitter,value,weight\na,b,1,-1\n").contains("must be finite and not negative"));
    assert!(message("receiver,transmitter,value,weight\na,b,1,0\n").contains("all weights are zero"));
    assert!(message("receiver,transmitter,value,sigma,weight\na,b,1,1,1\n").contains("say twice"));
    assert!(message("id,a,a\nx,1,2\n").contains("named \"a\""));
    assert!(matches!(read_csv(&b"1,2\n\xff\xfe"[..], "f", Units::Metres), Err(ReadError::NotText { line: 2, .. })));
    let units = Units::Seconds { speed: -1.0 };
    assert!(matches!(read_csv(&b"1"[..], "f", units), Err(ReadError::Speed(_))));
}

/// Tables of the exact values 1.5, 2.5, 3.5, 4.5 in all spellings.
#[test]
fn spellings_of_one_matrix() {
    let bare = "1.5,2.5\n3.5,4.5\n";
    for (text, named) in [
        (bare, false),
        ("1,5;2,5\n3,5;4,5\n", false),
        ("1,5\t2,5\r\n3,5\t4,5\r\n", false),
        ("1.5e+00 2.5e+00\n3.5e+00 4.5e+00\n", false),
        ("# numbers\n\n \"1.5\" , 2.5\n\n3.5, 4.5\n", false),
        ("\"1,5\",\"2,5\"\n\"3,5\",\"4,5\"\n", false),
        ("receiver,a,b\nm,1.5,2.5\nn,3.5,4.5\n", true),
        ("Mic;a;b\nm;1,5;2,5\nn;3,5;4,5\n", true),
        // Some other word over names, no corner, names without a first line.
        ("channel,a,b\nm,1.5,2.5\nn,3.5,4.5\n", true),
        ("a,b\nm,1.5,2.5\nn,3.5,4.5\n", true),
        ("m,1.5,2.5\nn,3.5,4.5\n", true),
        // As pandas writes a frame with and without names of its rows.
        (",0,1\nm,1.5,2.5\nn,3.5,4.5\n", true),
        (",0,1\n0,1.5,2.5\n1,3.5,4.5\n", true),
        ("receiver,1,2\n1,1.5,2.5\n2,3.5,4.5\n", true),
        // What spreadsheets leave at the ends of lines and of the table.
        (",a,b,\nm,1.5,2.5,\nn,3.5,4.5,\n,,,\n", true),
    ] {
        let f = parse(text).unwrap_or_else(|error| panic!("{text:?}: {error}"));
        assert_eq!(f.dense(), [1.5, 2.5, 3.5, 4.5], "{text:?}");
        assert_eq!(f.receivers_named(), named, "{text:?}");
    }
    for order in [u16::to_le_bytes, u16::to_be_bytes] {
        let wide: Vec<u8> = format!("\u{feff}{bare}").encode_utf16().flat_map(order).collect();
        assert_eq!(read_csv(&wide[..], "f", Units::Metres).unwrap().dense(), [1.5, 2.5, 3.5, 4.5]);
        let cut = read_csv(&wide[..wide.len() - 1], "f", Units::Metres);
        assert!(matches!(cut, Err(ReadError::NotText { line: 2, .. })));
    }
}

#[test]
fn spellings_of_one_list() {
    for text in [
        "receiver,transmitter,value\nm,a,1.5\nm,b,2.5\nn,a,3.5\nn,b,4.5\n",
        "event,microphone,time\na,m,1.5\nb,m,2.5\na,n,3.5\nb,n,4.5\n",
        "channel,shot,arrival time\nm,a,1.5\nm,b,2.5\nn,a,3.5\nn,b,4.5\n",
        "Node\tBeacon\trange (m)\nm\ta\t1.5\nm\tb\t2.5\nn\ta\t3.5\nn\tb\t4.5\n",
        // Where receivers have a column, one of nodes is left out.
        "node,receiver,event,range\n1,m,a,1.5\n1,m,b,2.5\n2,n,a,3.5\n2,n,b,4.5\n",
        "TOA;Mic;Source\n1,5;m;a\n2,5;m;b\n3,5;n;a\n4,5;n;b\n;;\n",
        "anchor_id\ttag_id\trange\tquality\nm\ta\t1.5\t0\nm\tb\t2.5\t0\nn\ta\t3.5\t0\nn\tb\t4.5\t0\n",
    ] {
        let f = parse(text).unwrap_or_else(|error| panic!("{text:?}: {error}"));
        assert_eq!(f.dense(), [1.5, 2.5, 3.5, 4.5], "{text:?}");
        assert_eq!(
            (f.receiver_names(), f.transmitter_names()),
            (&["m", "n"].map(String::from)[..], &["a", "b"].map(String::from)[..])
        );
    }
}

#[test]
fn first_lines_that_are_not_understood() {
    for (text, part) in [
        ("event,microphone,loudness\na,m,1\n", "no column is the value"),
        ("mic,time\nm,1\n", "no column is the transmitter"),
        // A node may be a receiver or a transmitter, which is not guessed.
        ("node,anchor,range\nm,a,1\n", "no column is the transmitter"),
        ("mic,sensor,event,time\nm,m,a,1\n", "\"mic\" and \"sensor\" may both be the receiver"),
        ("a,b,c\nm,e,1\n", "taken for names: a list of measurements has the columns receiver"),
        ("receiver,event,time\nm,a,0,5\n", "semicolons between cells"),
        ("m,e,1\n4,5,6\n", "line 1, column 1"),
        (",a,b\n,1,2\n", "has no name"),
    ] {
        let error = message(text);
        assert!(error.contains(part), "{part:?} is not in: {error}");
    }
}

#[test]
fn units_of_a_matrix_are_heeded() {
    let text = "time_ms,a,b\nm,1.5,2.5\nn,3.5,4.5\n";
    let read = |text: &str, units: Option<Units>| {
        read_csv(text.as_bytes(), "f.csv", ReadOptions { units, ..ReadOptions::default() })
            .map_err(|error| error.to_string())
    };
    let ms = Some(Units::Milliseconds { speed: 343.0 });
    let error = read(text, None).unwrap_err();
    assert!(error.contains("line 1") && error.contains("\"time_ms\" is in ms; give --units ms --speed"), "{error}");
    assert!((read(text, ms).unwrap().dense()[0] - 1.5e-3 * 343.0).abs() < 1e-12);
    assert!(read(text, Some(Units::Seconds { speed: 343.0 })).unwrap_err().contains("but --units s is asked for"));
    for (text, part) in [
        ("time,a,b\nm,1.5,2.5\nn,3.5,4.5\n", "holds times, and their unit is not said"),
        ("Mic (us),a,b\nm,1.5,2.5\nn,3.5,4.5\n", "is in us"),
        ("mic,clap1 [ms],clap2 [ms]\nm,1.5,2.5\nn,3.5,4.5\n", "\"clap1 [ms]\" is in ms"),
        // A column of numbers that was taken for a transmitter.
        ("time_ms,a\n1,2.5\n2,4.5\n", "is in ms"),
        ("range_km,a,b\nm,1.5,2.5\nn,3.5,4.5\n", "is in km; give --units km"),
        ("range_mm,a,b\nm,1.5,2.5\nn,3.5,4.5\n", "mm are not read: convert"),
    ] {
        let error = read(text, None).unwrap_err();
        assert!(error.contains(part), "{part:?} is not in: {error}");
    }
    for text in ["range_m,a,b\nm,1,2\n", "mic,clap_s,knock_s\nm,1,2\n", "mic [m],a,b\nm,1,2\n"] {
        read(text, None).unwrap_or_else(|error| panic!("{text:?}: {error}"));
    }
}

#[test]
fn tables_with_receivers_as_columns_are_refused() {
    for text in [
        "event,a,b\nx,1,2\ny,3,4\n",
        "mic1,mic2\n1,2\n3,4\n",
        ",Receiver 1,Receiver 2\nx,1,2\ny,3,4\n",
        "clap,mic1,mic2\nx,1,2\ny,3,4\n",
        "event1,1,2\nevent2,3,4\n",
        "shot,1,2\na,1,2\nb,3,4\n",
        "clap,channel1,channel2\nx,1,2\ny,3,4\n",
    ] {
        let error = message(text);
        assert!(error.contains("transpose the table"), "{text:?}: {error}");
    }
    // Counted names say nothing.
    for text in ["mic,event1,event2\nmic1,1,2\nmic2,3,4\n", "r1,r2\n1,2\n3,4\n", "s1,1,2\ns2,3,4\n"] {
        parse(text).unwrap_or_else(|error| panic!("{text:?}: {error}"));
    }
}

#[test]
fn lines_are_counted_as_an_editor_counts_them() {
    for end in ["\n", "\r\n"] {
        let text = ["# about", "", "  ", "1,2", "", "# more", "\"3\",4", "5,x"].join(end);
        let error = message(&text);
        assert!(error.contains("line 8, column 2 (receiver r3"), "{error}");
    }
    let error = message("\n#\n\n1,x,3\n");
    assert!(error.contains("line 4, column 2"), "{error}");
}

#[test]
fn numbers_in_other_spellings() {
    for (cell, part) in [
        ("1.234,5", "without marks between thousands"),
        ("3 ms", "give that as --units"),
        ("x", "leave the cell empty"),
        ("2.5", "decimal mark ','"),
    ] {
        let error = message(&format!("1,5;2\n{cell};3\n"));
        assert!(error.contains("line 2, column 1") && error.contains(part), "{error}");
    }
    let f = parse("1;n/a;3\n-;NA;null\n").unwrap();
    assert_eq!(f.observed(), 2);
}

#[test]
fn units_that_first_lines_name() {
    let list = |heading: &str, options: ReadOptions| {
        let text = format!("receiver,event,{heading}\nm,a,3\n");
        read_csv(text.as_bytes(), "f", options).map(|f| f.get(0, 0)).map_err(|error| error.to_string())
    };
    let speed = 343.0;
    let milliseconds = Units::Milliseconds { speed };
    assert_eq!(list("time_ms", milliseconds.into()), Ok(Some(3.0 * milliseconds.metres())));
    let samples = Units::Samples { speed, rate: 48_000.0 };
    assert_eq!(list("time (samples)", samples.into()), Ok(Some(3.0 * samples.metres())));
    assert_eq!(list("Arrival time (ms)", milliseconds.into()), Ok(Some(3.0 * milliseconds.metres())));
    // A nanosecond of light is 0.299792458 m.
    let light = Units::Nanoseconds { speed: 299_792_458.0 };
    assert!((list("toa_ns", light.into()).unwrap().unwrap() - 3.0 * 0.299_792_458).abs() < 1e-12);
    assert_eq!(list("range (cm)", Units::Centimetres.into()), Ok(Some(3.0 * 0.01)));
    assert_eq!(list("range_km", Units::Kilometres.into()), Ok(Some(3000.0)));
    assert_eq!(list("time", Units::Metres.into()), Ok(Some(3.0)));
    assert_eq!(list("value", ReadOptions::default()), Ok(Some(3.0)));
    assert_eq!(list("range_m", ReadOptions::default()), Ok(Some(3.0)));
    for (heading, options, part) in [
        ("time", ReadOptions::default(), "give --units s --speed"),
        ("time_ms", ReadOptions::default(), "give --units ms --speed"),
        ("Time [s]", milliseconds.into(), "is in s, but --units ms is asked for"),
        ("samples", ReadOptions::default(), "--rate HZ"),
        ("time_ns", ReadOptions::default(), "give --units ns --speed"),
        ("range (cm)", ReadOptions::default(), "is in cm; give --units cm"),
        ("range (cm)", Units::Kilometres.into(), "is in cm, but --units km is asked for"),
        ("arrival time (ms)", Units::Seconds { speed }.into(), "is in ms, but --units s is asked for"),
        ("range_mm", Units::Centimetres.into(), "mm are not read: convert"),
        ("range_m", milliseconds.into(), "leave out --units"),
    ] {
        let error = list(heading, options).unwrap_err();
        assert!(error.contains("line 1") && error.contains(part), "{part:?} is not in: {error}");
    }
    let text = "receiver,event,time_ms,sigma_s\nm,a,3,1\n";
    let error = read_csv(text.as_bytes(), "f", milliseconds).unwrap_err().to_string();
    assert!(error.contains("different units"), "{error}");
    let units = Units::Samples { speed, rate: 0.0 };
    assert!(matches!(read_csv(&b"1"[..], "f", units), Err(ReadError::Rate(_))));
}

#[test]
fn spreadsheets_and_archives_are_named() {
    for magic in [&b"PK\x03\x04\x14\x00"[..], b"\xd0\xcf\x11\xe0\xa1\xb1"] {
        let error = read_csv(magic, "f.xlsx", Units::Metres).unwrap_err().to_string();
        assert!(error.contains("f.xlsx") && error.contains("export the sheet as CSV"), "{error}");
    }
}

#[test]
fn endless_garbage_is_refused_early() {
    struct Endless(u8, u64);
    impl std::io::Read for Endless {
        fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
            buffer.fill(self.0);
            self.1 += buffer.len() as u64;
            assert!(self.1 <= super::MAX_BYTES + (1 << 20), "read past the limit");
            Ok(buffer.len())
        }
    }
    assert!(matches!(read_csv(Endless(0xff, 0), "f", Units::Metres), Err(ReadError::NotText { line: 1, .. })));
    assert!(matches!(read_csv(Endless(b'x', 0), "f", Units::Metres), Err(ReadError::TooLarge { .. })));
    assert!(matches!(read_npy(Endless(b'x', 0), "f", Units::Metres), Err(ReadError::Npy { .. })));
}

/// A file of numpy.save.
fn npy(kind: &str, order: &str, shape: &str, values: &[f64]) -> Vec<u8> {
    let mut header = format!("{{'descr': {kind}, 'fortran_order': {order}, 'shape': {shape}, }}");
    while (10 + header.len() + 1) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    for v in values.iter() {
        bytes.extend(v.to_le_bytes());
    }
    bytes
}

#[test]
fn npy_of_another_kind_is_named_without_its_header() {
    for (kind, shape, part) in [
        ("'<c16'", "(1, 2)", "holds complex numbers (c16); real numbers are needed"),
        ("'|b1'", "(1, 2)", "holds truth values (b1)"),
        ("'|O'", "(1, 2)", "holds Python objects (O)"),
        ("'<U3'", "(1, 2)", "holds text (U3)"),
        ("'>i8'", "(1, 2)", "of another size or byte order than is read (i8)"),
        ("[('t', '<f8'), ('x', '<f8')]", "(1, 2)", "holds records of several fields"),
        ("'zzzzzzzzzzzzzz'", "(1, 2)", "holds elements of an unknown type"),
        ("'<f8'", "(2,)", "holds one row of 2; two dimensions are needed"),
        ("'<f8'", "(1, 2, 1)", "has 3 dimensions; two dimensions are needed"),
        ("'<f8'", "()", "holds a single number"),
        ("'<f8'", "(1, -2)", "has an unreadable shape"),
        ("'<f8'", "3", "has an unreadable shape"),
    ] {
        let error =
            read_npy(&npy(kind, "False", shape, &[1.0; 4])[..], "f.npy", Units::Metres).unwrap_err().to_string();
        assert!(error.starts_with("f.npy: ") && error.contains(part), "{part:?} is not in: {error}");
        let raw = ["descr", "fortran_order", "shape':", "{", "}", "'"];
        assert!(raw.iter().all(|word| !error.contains(word)), "{error}");
    }
}

#[test]
fn npy_both_orders_and_damage() {
    let npy = |order: &str, shape: &str, values: &[f64]| npy("'<f8'", order, shape, values);
    let six = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    let f = read_npy(&npy("False", "(2, 3)", &six)[..], "f.npy", Units::Metres).unwrap();
    assert_eq!((f.get(0, 1), f.get(1, 0)), (Some(2.0), Some(4.0)));
    let f = read_npy(&npy("True", "(2, 3)", &six)[..], "f.npy", Units::Metres).unwrap();
    assert_eq!((f.get(0, 1), f.get(1, 0)), (Some(3.0), Some(2.0)));
    for (shape, count) in
        [("(2, 3)", 5), ("(6,)", 6), ("(2, 1, 3)", 6), ("(99999999999, 99999999999)", 6), ("(0, 3)", 0)]
    {
        assert!(read_npy(&npy("False", shape, &six[..count])[..], "f.npy", Units::Metres).is_err(), "{shape}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10_000))]

    #[test]
    fn random_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let _ = read_csv(&bytes[..], "f", Units::Metres);
        let _ = read_npy(&bytes[..], "f", Units::Metres);
    }

    #[test]
    fn random_tables_never_panic(text in "[-0-9.,;e\n\t nar#\"]{0,200}", list in any::<bool>()) {
        let header = if list { "receiver,transmitter,value\n" } else { "" };
        let _ = parse(&format!("{header}{text}"));
    }

    #[test]
    fn random_cells_in_all_separators_never_panic(
        cells in proptest::collection::vec("[a-z]{0,3}|-?[0-9]{0,2}[.,]?[0-9]{0,3}|time_ms|receiver|event|x|y|z|sigma|std_[xyz]|\"|sep=;|#N/A|[0-9]{1,3} [0-9]{3}|mic_[ab]|ref|\u{2212}[0-9]|[0-9]{2}:[0-9]{2}:[0-9]{2}.[0-9]|2024-0[0-9]-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}[Z+-]|view|selection|begin time|e|n|lat|depth", 0..40),
        separator in "[,; \t]",
        width in 1usize..6,
        wide: bool,
        mark in proptest::option::of(proptest::sample::select(vec!['.', ','])),
        columns in proptest::collection::vec((proptest::sample::select(vec![Role::Receiver, Role::Time, Role::Reference, Role::Ignore]), "[a-z]{0,2}"), 0..2),
    ) {
        let seconds = ReadOptions { units: Some(Units::Seconds { speed: 343.0 }), ..ReadOptions::default() };
        let lines: Vec<String> = cells.chunks(width).map(|line| line.join(&separator)).collect();
        let text = lines.join("\n");
        let bytes = if wide {
            format!("\u{feff}{text}").encode_utf16().flat_map(u16::to_le_bytes).collect()
        } else {
            text.into_bytes()
        };
        let _ = read_csv(&bytes[..], "f", ReadOptions::default());
        let options = ReadOptions { transpose: wide, columns: columns.clone(), decimal_mark: mark, ..seconds };
        let _ = read_csv(&bytes[..], "f", options).map(|measured| super::orientation(&measured));
        let _ = super::read_nodes_from(&bytes[..], "f");
        let _ = super::read_distances_from(&bytes[..], "f", &["a".to_string(), "b".to_string()]);
    }

    #[test]
    fn random_npy_headers_never_panic(tail in proptest::collection::vec(any::<u8>(), 0..200), shape in "[0-9,() ]{0,30}") {
        let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({shape}), }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(tail);
        let _ = read_npy(&bytes[..], "f", Units::Metres);
    }
}
