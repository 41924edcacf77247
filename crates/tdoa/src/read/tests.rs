use proptest::prelude::{ProptestConfig, any, proptest};

use super::{ReadError, Units, read_csv, read_npy};
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
    assert!(text.contains("line 2 (receiver r2)") && text.contains("2 cells where 3"), "{text}");
    assert!(message("").contains("no measurements"));
    assert!(message("a,b\n").contains("no measurements"));
    let text = message("1,inf\n2,3\n");
    assert!(text.contains("receiver r1, transmitter s2"), "{text}");
    assert!(message("1,1e300\n2,3\n").contains("1e300") || message("1,1e300\n2,3\n").contains("000000"));
    assert!(message("receiver,transmitter,value\na,b,1\na,b,2\n").contains("line 3"));
    assert!(message("receiver,transmitter,value\na,b\n").contains("line 2"));
    assert!(message("receiver,transmitter,value,sigma\na,b,1,-1\n").contains("must be positive"));
    assert!(message("id,a,a\nx,1,2\n").contains("named \"a\""));
    assert!(matches!(read_csv(&b"1,2\n\xff\xfe"[..], "f", Units::Metres), Err(ReadError::NotText { line: 2, .. })));
    let units = Units::Seconds { speed: -1.0 };
    assert!(matches!(read_csv(&b"1"[..], "f", units), Err(ReadError::Speed(_))));
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

#[test]
fn npy_both_orders_and_damage() {
    let npy = |order: &str, shape: &str, values: &[f64]| {
        let mut header = format!("{{'descr': '<f8', 'fortran_order': {order}, 'shape': {shape}, }}");
        while (10 + header.len() + 1) % 64 != 0 {
            header.push(' ');
        }
        header.push('\n');
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        values.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
        bytes
    };
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
    fn random_npy_headers_never_panic(tail in proptest::collection::vec(any::<u8>(), 0..200), shape in "[0-9,() ]{0,30}") {
        let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({shape}), }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(tail);
        let _ = read_npy(&bytes[..], "f", Units::Metres);
    }
}
