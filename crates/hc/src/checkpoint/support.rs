//! What tests of runs with checkpoints share.

use super::{Checkpoint, CheckpointError, CheckpointOptions, Note};
use std::path::Path;
use std::sync::{Arc, Mutex};

/// Records of which some are passed over.
const MANY: usize = 20;

/// Goes on with what a directory has, on some threads. Returns what `work` does, and what was said.
///
/// # Errors
/// If the checkpoint cannot be opened, or those of `work`.
pub(crate) fn resumed<T: Send, E: From<CheckpointError> + Send>(
    directory: &Path,
    threads: usize,
    work: impl FnOnce(&Checkpoint) -> Result<T, E> + Send,
) -> Result<(T, Vec<Note>), E> {
    let checkpoint = Checkpoint::open(directory, &CheckpointOptions::new().resume(true))?;
    let notes = Arc::new(Mutex::new(Vec::new()));
    let told = Arc::clone(&notes);
    checkpoint.tell(move |note| told.lock().unwrap().push(note.clone()));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let found = pool.install(|| work(&checkpoint))?;
    let notes = notes.lock().unwrap().clone();
    Ok((found, notes))
}

/// Wherever the log ends, at a record or eleven bytes after it (in turn where there are many), `work`
/// gives the same. Returns the number of records.
pub(crate) fn goes_on_from_every_record<T, E>(
    directory: &Path,
    expected: &T,
    work: impl Fn(&Checkpoint) -> Result<T, E> + Sync,
) -> usize
where
    T: Send + PartialEq + std::fmt::Debug,
    E: From<CheckpointError> + Send + std::fmt::Debug,
{
    let log = directory.join("records.log");
    let whole = std::fs::read(&log).unwrap();
    let ends = ends(&whole);
    assert_eq!(ends.last(), Some(&whole.len()));
    for (k, &end) in ends.iter().enumerate() {
        let places = [(0, 1), (11, 2)];
        let places = if ends.len() > MANY { &places[k % 2..=k % 2] } else { &places };
        for &(extra, threads) in places {
            std::fs::write(&log, &whole[..(end + extra).min(whole.len())]).unwrap();
            let (found, notes) = resumed(directory, threads, &work).unwrap();
            assert_eq!(found, *expected, "{k} records, {extra} bytes");
            let torn = end + extra < whole.len() && extra > 0;
            assert_eq!(notes.contains(&Note::Torn { dropped: 11 }), torn, "{notes:?}");
            let resumes = |note: &Note| matches!(note, Note::Resumed { records, .. } if *records == k);
            assert!(notes.iter().any(resumes), "{notes:?}");
            assert!(!notes.contains(&Note::Unfit), "{notes:?}");
            // Whole again; only when records were written may differ.
            assert_eq!(std::fs::metadata(&log).unwrap().len(), whole.len() as u64);
        }
    }
    ends.len() - 1
}

/// Ends of the records of a log: 16 bytes, then each with 8 before it, of which the first four are
/// its length.
fn ends(log: &[u8]) -> Vec<usize> {
    let mut ends = vec![16];
    while let Some(length) = log.get(ends[ends.len() - 1]..).and_then(|rest| rest.first_chunk::<4>()) {
        ends.push(ends[ends.len() - 1] + 8 + u32::from_le_bytes(*length) as usize);
    }
    ends
}
