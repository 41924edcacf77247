//! The checkpoint of a run: what is recorded, and what can be read back.

use super::error::CheckpointError;
use super::header::{FORMAT, Header, Job};
use super::log::{Log, RecordSpan};
use super::note::Note;
use crate::runner::Round;
use crate::setters::setters;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Names of the files in the directory.
pub(super) const HEADER: &str = "checkpoint.json";
pub(super) const LOG: &str = "records.log";
pub(super) const LOCK: &str = "lock";

/// Flushing records to disk takes at most one part in this many of the time.
const SHARE: u32 = 100;
/// A lock that is held this long belongs to a run, not to a process that looks at the status.
const PATIENCE: Duration = Duration::from_millis(500);

/// Settings of a checkpoint.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct CheckpointOptions {
    /// Whether to continue with the checkpoint in the directory; if there is none, the work starts
    /// from the beginning. If false, a directory with a checkpoint is refused. Default false.
    pub resume: bool,
    /// Whether the run ends if a record cannot be written; otherwise it goes on without the record.
    /// Default false.
    pub required: bool,
    /// Interval after which records are flushed to disk; flushing takes at most a hundredth of the
    /// time. If the process is killed, nothing that was written is lost. If the machine loses
    /// power, the records since the last flush are lost. Default 5 s.
    pub interval: Duration,
}

impl Default for CheckpointOptions {
    fn default() -> Self {
        CheckpointOptions { resume: false, required: false, interval: Duration::from_secs(5) }
    }
}

impl CheckpointOptions {
    /// The defaults.
    pub fn new() -> CheckpointOptions {
        CheckpointOptions::default()
    }
}

setters!(CheckpointOptions { resume: bool, required: bool, interval: Duration });

/// A directory in which one run records what it has finished; see the [module](crate::checkpoint).
#[derive(Clone)]
pub struct Checkpoint {
    directory: Arc<Path>,
    keeper: Arc<Mutex<Keeper>>,
}

/// A callback for notes.
type Told = dyn Fn(&Note) + Send + Sync;

struct Keeper {
    options: CheckpointOptions,
    /// Locked as long as it is open.
    _lock: File,
    told: Option<Arc<Told>>,
    /// Notes that came before there was a callback.
    notes: Vec<Note>,
    /// The header in the directory, with its bytes.
    header: Option<(Header, Vec<u8>)>,
    recording: Option<Recording>,
    /// Why the run must end.
    failure: Option<CheckpointError>,
}

/// A run that has begun.
struct Recording {
    log: Log,
    places: BTreeMap<Key, RecordSpan>,
    begun: Instant,
    /// Seconds of work in the records.
    before: f64,
    synced: Instant,
    pause: Duration,
    /// Whether the last record could not be written.
    failing: bool,
}

/// Which batch a record holds. No two records of one run have the same key.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) struct Key {
    /// The part of the work: a start system, all targets, a search.
    part: u32,
    round: Round,
    /// The number of the first path, target or loop.
    first: u64,
    /// How many. Zero in the record at the beginning of a round, and in records of steps.
    pub(super) count: u64,
}

impl Key {
    /// Whether two records belong to the same round.
    pub(super) fn is_of_round(self, other: Key) -> bool {
        (self.part, self.round) == (other.part, other.round)
    }

    pub(super) fn part(self) -> u32 {
        self.part
    }
}

/// The head of a record.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Head {
    pub(super) key: Key,
    /// Paths of the whole round.
    pub(super) total: u64,
    /// Solutions so far.
    pub(super) solutions: u64,
    /// Seconds of work so far.
    pub(super) seconds: f64,
}

impl Head {
    /// The head of a record; `None` if it has none.
    pub(super) fn of(record: &[u8]) -> Option<(Head, &[u8])> {
        postcard::take_from_bytes(record).ok()
    }
}

impl Checkpoint {
    /// Opens a directory and locks it; a missing directory is made.
    ///
    /// # Errors
    /// If the directory cannot be written, if another process records in it, if it has a checkpoint
    /// that is not to be resumed, or if it has a file that does not belong to a checkpoint.
    pub fn open(directory: impl AsRef<Path>, options: &CheckpointOptions) -> Result<Checkpoint, CheckpointError> {
        let directory = directory.as_ref();
        std::fs::create_dir_all(directory).map_err(|error| CheckpointError::io(directory, &error))?;
        let lock = locked(directory)?;
        let path = directory.join(HEADER);
        let found = path.try_exists().map_err(|error| CheckpointError::io(&path, &error))?;
        if found && !options.resume {
            return Err(CheckpointError::Taken(directory.to_owned()));
        }
        let header = if found { Some(Header::read(&path)?) } else { None };
        let notes = if options.resume && !found { vec![Note::Nothing] } else { Vec::new() };
        let options = options.clone();
        let keeper = Keeper { options, _lock: lock, told: None, notes, header, recording: None, failure: None };
        Ok(Checkpoint { directory: directory.into(), keeper: Arc::new(Mutex::new(keeper)) })
    }

    /// The directory.
    pub fn directory(&self) -> &Path {
        &self.directory
    }

    /// Sets a callback for notes: which records could be used, and what cannot be written. It is
    /// called from any thread of the run. Earlier notes are passed to it at once.
    pub fn tell(&self, told: impl Fn(&Note) + Send + Sync + 'static) {
        let mut keeper = self.keeper();
        std::mem::take(&mut keeper.notes).iter().for_each(&told);
        keeper.told = Some(Arc::new(told));
    }

    fn keeper(&self) -> MutexGuard<'_, Keeper> {
        self.keeper.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins the run of a job, or continues it.
    ///
    /// # Errors
    /// If the checkpoint belongs to another job, has served a job already, or cannot be read or
    /// written.
    pub(crate) fn begin(&self, job: Job) -> Result<(), CheckpointError> {
        let mut keeper = self.keeper();
        if keeper.recording.is_some() || keeper.failure.is_some() {
            return Err(CheckpointError::Used(self.directory.to_path_buf()));
        }
        let recording = Recording::new(&self.directory, Header::new(job), keeper.header.as_ref(), &mut |note| {
            match &keeper.told {
                Some(told) => told(&note),
                // Nobody will ask for it later.
                None => drop(note),
            }
        })?;
        keeper.recording = Some(recording);
        Ok(())
    }

    /// Why the run must end: a required record could not be written.
    pub(crate) fn failure(&self) -> Option<CheckpointError> {
        self.keeper().failure.clone()
    }
}

impl fmt::Debug for Checkpoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Checkpoint").field("directory", &self.directory).finish_non_exhaustive()
    }
}

/// A part of the work of a run: the paths of one start system, all targets of a family, a search.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part<'a> {
    pub(crate) checkpoint: &'a Checkpoint,
    pub(crate) number: u32,
}

impl Part<'_> {
    pub(crate) fn key(self, round: Round, first: usize, count: usize) -> Key {
        Key { part: self.number, round, first: first as u64, count: count as u64 }
    }

    /// The recorded content for this key; `None` if nothing is recorded, or nothing that `fits`.
    pub(crate) fn take<T: DeserializeOwned>(self, key: Key, fits: impl FnOnce(&T) -> bool) -> Option<T> {
        let mut keeper = self.checkpoint.keeper();
        let recording = keeper.recording.as_mut()?;
        let place = *recording.places.get(&key)?;
        let content = recording.log.read(place);
        let of = |content: Vec<u8>| Head::of(&content).and_then(|(_, rest)| postcard::from_bytes(rest).ok());
        let found = content.and_then(of).filter(fits);
        if found.is_none() {
            recording.places.remove(&key);
            keeper.say(Note::Unfit);
        }
        found
    }

    /// Records this content, unless it is recorded already. `total` is the number of paths of the
    /// round, `solutions` the number of solutions so far.
    pub(crate) fn record<T: Serialize>(self, key: Key, total: u64, solutions: u64, content: &T) {
        let Some(content) = self.checkpoint.encoded(key, total, solutions, content) else { return };
        self.checkpoint.keeper().write(key, &content);
    }
}

impl Checkpoint {
    /// A record in bytes; `None` if it exists already.
    fn encoded<T: Serialize>(&self, key: Key, total: u64, solutions: u64, content: &T) -> Option<Vec<u8>> {
        let seconds = {
            let keeper = self.keeper();
            let recording = keeper.recording.as_ref().filter(|recording| !recording.places.contains_key(&key))?;
            recording.before + recording.begun.elapsed().as_secs_f64()
        };
        let bytes = postcard::to_stdvec(&Head { key, total, solutions, seconds });
        bytes.and_then(|head| postcard::to_extend(content, head)).ok()
    }
}

impl Keeper {
    fn say(&self, note: Note) {
        if let Some(told) = &self.told {
            told(&note);
        }
    }

    fn write(&mut self, key: Key, content: &[u8]) {
        let Some(recording) = &mut self.recording else { return };
        let written = recording.log.append(content).and_then(|place| {
            recording.places.insert(key, place);
            recording.sync(self.options.interval)
        });
        let before = std::mem::replace(&mut recording.failing, written.is_err());
        match written {
            Err(error) if self.options.required => {
                self.failure = Some(CheckpointError::io(recording.log.path(), &error));
            }
            Err(error) if !before => self.say(Note::Unwritten(error.to_string())),
            Ok(()) if before => self.say(Note::WrittenAgain),
            _ => {}
        }
    }
}

impl Recording {
    fn new(
        directory: &Path,
        header: Header,
        found: Option<&(Header, Vec<u8>)>,
        say: &mut dyn FnMut(Note),
    ) -> Result<Recording, CheckpointError> {
        let (log, path) = (directory.join(LOG), directory.join(HEADER));
        let mut places = BTreeMap::new();
        let mut before = 0.0;
        let log = match found {
            Some((recorded, bytes)) => {
                if let Some(difference) = recorded.difference(directory, &header) {
                    return Err(difference);
                }
                let mut records = 0;
                let (log, note) = Log::resume(&log, FORMAT, crc32fast::hash(bytes), |place, record| {
                    let Some((head, _)) = Head::of(record) else { return false };
                    places.insert(head.key, place);
                    before = head.seconds;
                    records += 1;
                    true
                })?;
                note.into_iter().for_each(&mut *say);
                say(Note::Resumed { records, seconds: before });
                log
            }
            None => {
                let foreign = |error: serde_json::Error| CheckpointError::Foreign {
                    path: path.clone(),
                    reason: error.to_string(),
                };
                let bytes = header.bytes().map_err(foreign)?;
                let log = Log::create(&log, FORMAT, crc32fast::hash(&bytes))?;
                Header::write(&path, &bytes).map_err(|error| CheckpointError::io(&path, &error))?;
                log
            }
        };
        let now = Instant::now();
        Ok(Recording { log, places, begun: now, before, synced: now, pause: Duration::ZERO, failing: false })
    }

    /// Flushes what is written to disk, if that is due.
    fn sync(&mut self, interval: Duration) -> std::io::Result<()> {
        let begun = Instant::now();
        if begun.duration_since(self.synced) < interval.max(self.pause) {
            return Ok(());
        }
        let result = self.log.sync();
        self.synced = Instant::now();
        self.pause = self.synced.duration_since(begun).saturating_mul(SHARE);
        result
    }
}

/// The lock of a directory, held.
fn locked(directory: &Path) -> Result<File, CheckpointError> {
    let path: PathBuf = directory.join(LOCK);
    let failed = |error: std::io::Error| CheckpointError::io(&path, &error);
    let file = File::options().write(true).create(true).truncate(false).open(&path).map_err(failed)?;
    let begun = Instant::now();
    loop {
        match file.try_lock() {
            Ok(()) => return Ok(file),
            Err(TryLockError::Error(error)) => return Err(failed(error)),
            Err(TryLockError::WouldBlock) if begun.elapsed() > PATIENCE => {
                return Err(CheckpointError::InUse(directory.to_owned()));
            }
            Err(TryLockError::WouldBlock) => std::thread::sleep(PATIENCE / 10),
        }
    }
}
