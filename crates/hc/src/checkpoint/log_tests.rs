//! Logs cut, flipped, exchanged.

use super::*;
use proptest::prelude::*;

const VERSION: u32 = 1;
const HEADER: u32 = 0x1234_5678;

/// The bytes of a log with these records.
fn written(path: &Path, records: &[Vec<u8>]) -> Vec<u8> {
    let mut log = Log::create(path, VERSION, HEADER).unwrap();
    for record in records {
        log.append(record).unwrap();
    }
    std::fs::read(path).unwrap()
}

/// The records that are read from a file, and what is said about the rest.
fn read(path: &Path) -> Result<(Vec<Vec<u8>>, Option<Note>), CheckpointError> {
    let mut records = Vec::new();
    let (mut log, note) = Log::resume(path, VERSION, HEADER, |place, content| {
        records.push((place, content.to_vec()));
        true
    })?;
    for (place, content) in &records {
        assert_eq!(log.read(*place).as_ref(), Some(content));
    }
    Ok((records.into_iter().map(|(_, content)| content).collect(), note))
}

#[test]
fn records_are_read_as_they_were_written_and_gone_on_with() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log");
    let mut records = vec![b"one".to_vec(), Vec::new(), vec![7; 100_000]];
    written(&path, &records);
    assert_eq!(read(&path).unwrap(), (records.clone(), None));
    let (mut log, _) = Log::resume(&path, VERSION, HEADER, |_, _| true).unwrap();
    log.append(b"four").unwrap();
    log.sync().unwrap();
    records.push(b"four".to_vec());
    assert_eq!(read(&path).unwrap(), (records, None));
}

#[test]
fn a_torn_record_is_cut_off_and_a_damaged_one_with_all_after_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log");
    let records = [b"first".to_vec(), b"second".to_vec(), b"third".to_vec()];
    let whole = written(&path, &records);
    std::fs::write(&path, &whole[..whole.len() - 1]).unwrap();
    assert_eq!(read(&path).unwrap(), (records[..2].to_vec(), Some(Note::Torn { dropped: 8 + 5 - 1 })));
    // What was cut off stays cut off.
    assert_eq!(read(&path).unwrap(), (records[..2].to_vec(), None));
    let mut flipped = whole.clone();
    // In the content of the second: 16 bytes, 8 and "first", 8, then it.
    flipped[16 + 13 + 8] ^= 4;
    std::fs::write(&path, &flipped).unwrap();
    assert_eq!(read(&path).unwrap(), (records[..1].to_vec(), Some(Note::Damaged { at: 29, dropped: 14 + 13 })));
    // Records in the places of others: of the same length, but not of the same number.
    let twice = written(&path, &[b"first".to_vec(), b"again".to_vec()]);
    let exchanged = [&twice[..16], &twice[29..], &twice[16..29]].concat();
    std::fs::write(&path, exchanged).unwrap();
    assert_eq!(read(&path).unwrap(), (Vec::new(), Some(Note::Damaged { at: 16, dropped: 26 })));
    // The empty rest of a file whose blocks never came to the disk.
    std::fs::write(&path, [&whole[..], &[0; 64]].concat()).unwrap();
    assert_eq!(read(&path).unwrap().0, records);
}

#[test]
fn other_files_are_refused_and_left_as_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log");
    let is_foreign = |result: Result<(), CheckpointError>| matches!(result, Err(CheckpointError::Foreign { .. }));
    for text in ["a text of somebody else", "x", "hclog\n"] {
        std::fs::write(&path, text).unwrap();
        assert!(is_foreign(read(&path).map(|_| ())), "{text}");
        assert!(is_foreign(Log::create(&path, VERSION, HEADER).map(|_| ())), "{text}");
        assert_eq!(std::fs::read(&path).unwrap(), text.as_bytes());
    }
    std::fs::remove_file(&path).unwrap();
    written(&path, &[b"record".to_vec()]);
    for (version, header) in [(VERSION + 1, HEADER), (VERSION, HEADER + 1)] {
        assert!(is_foreign(Log::resume(&path, version, header, |_, _| true).map(|_| ())));
    }
    assert!(matches!(Log::resume(&folder.path().join("none"), 1, 1, |_, _| true), Err(CheckpointError::Io { .. })));
}

#[test]
fn after_a_record_that_cannot_be_written_the_log_is_as_before() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log");
    written(&path, &[b"first".to_vec()]);
    let (mut log, _) = Log::resume(&path, VERSION, HEADER, |_, _| true).unwrap();
    // For reading only.
    let writable = std::mem::replace(&mut log.file, File::open(&path).unwrap());
    assert!(log.append(b"lost").is_err());
    log.file = writable;
    log.append(b"second").unwrap();
    assert_eq!(read(&path).unwrap(), (vec![b"first".to_vec(), b"second".to_vec()], None));
}

/// What is done to the bytes of a log.
#[derive(Clone, Debug)]
enum Harm {
    Cut(usize),
    Flip(usize, u8),
    Add(Vec<u8>),
    Remove(usize, usize),
}

fn harm() -> impl Strategy<Value = Harm> {
    let place = 0..10_000usize;
    prop_oneof![
        place.clone().prop_map(Harm::Cut),
        (place.clone(), 1..=u8::MAX).prop_map(|(at, bits)| Harm::Flip(at, bits)),
        prop::collection::vec(any::<u8>(), 1..40).prop_map(Harm::Add),
        (place, 1..40usize).prop_map(|(at, count)| Harm::Remove(at, count)),
    ]
}

fn harmed(mut bytes: Vec<u8>, harm: &Harm) -> Vec<u8> {
    let length = bytes.len();
    match harm {
        Harm::Cut(at) => bytes.truncate(at % length),
        Harm::Flip(at, bits) => bytes[at % length] ^= bits,
        Harm::Add(more) => bytes.extend(more),
        Harm::Remove(at, count) => drop(bytes.drain(at % length..(at % length + count).min(length))),
    }
    bytes
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever happens to the bytes: a typed error, or the first of the records; and what is
    /// written then is read again.
    #[test]
    fn whatever_happens_to_a_log_its_records_are_right(
        records in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..60), 0..8),
        harms in prop::collection::vec(harm(), 1..3),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log");
        let mut bytes = written(&path, &records);
        for harm in &harms {
            if !bytes.is_empty() {
                bytes = harmed(bytes, harm);
            }
        }
        std::fs::write(&path, &bytes).unwrap();
        match read(&path) {
            Err(error) => prop_assert!(matches!(error, CheckpointError::Foreign { .. }), "{error}"),
            Ok((found, _)) => {
                prop_assert!(records.starts_with(&found));
                let (mut log, note) = Log::resume(&path, VERSION, HEADER, |_, _| true).unwrap();
                prop_assert_eq!(note, None);
                log.append(b"more").unwrap();
                let expected = [&found[..], &[b"more".to_vec()]].concat();
                prop_assert_eq!(read(&path).unwrap(), (expected, None));
            }
        }
    }
}
