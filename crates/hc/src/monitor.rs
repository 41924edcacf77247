//! Watching and stopping work: its progress, read from another thread or passed to a callback.

use poly::counted;
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// The stage of the work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stage {
    /// Nothing yet, or something short.
    #[default]
    Preparing,
    /// Mixed cells are sought.
    MixedCells,
    /// Solutions of the start system are tracked to generic coefficients.
    Start,
    /// Paths are tracked to the target.
    Paths,
    /// Paths go through the endgame.
    Endgame,
    /// A fibre goes round a loop, three sides per path.
    Loop,
    /// A search goes from start to start.
    Search,
    /// Points are certified.
    Proofs,
    /// Cells of a sweep are filled.
    Cells,
    /// Neighbouring cells of a sweep are joined.
    Branches,
}

/// In the order of their numbers.
const STAGES: [Stage; 10] = [
    Stage::Preparing,
    Stage::MixedCells,
    Stage::Start,
    Stage::Paths,
    Stage::Endgame,
    Stage::Loop,
    Stage::Search,
    Stage::Proofs,
    Stage::Cells,
    Stage::Branches,
];

/// The progress of the work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Progress {
    /// The stage of the work.
    pub stage: Stage,
    /// Paths of this stage that have ended, mixed cells found, or cells of a grid that are done.
    pub done: u64,
    /// Paths of this stage; zero if their number is not known.
    pub total: u64,
    /// For mixed cells, their volume so far. For paths, the number that have ended at regular
    /// points. For a search, the starts that agree on the best result so far. For proofs, the
    /// points with a certificate.
    pub counted: u64,
}

/// What is being done, in words that follow `done` and `total`.
impl fmt::Display for Progress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.stage {
            Stage::Preparing => f.write_str("preparing"),
            Stage::MixedCells => write!(f, "{}, of volume {}", counted(self.done, "mixed cell"), self.counted),
            Stage::Start => f.write_str("paths to generic coefficients"),
            Stage::Paths => write!(f, "paths, {} of them at regular solutions", self.counted),
            Stage::Endgame => f.write_str("paths through the endgame"),
            Stage::Proofs => write!(f, "points, {} of them certified", self.counted),
            Stage::Cells => f.write_str("cells of the grid"),
            Stage::Branches => f.write_str("cells joined to their neighbours"),
            Stage::Search => write!(f, "starts, {} of them agree", self.counted),
            Stage::Loop => write!(f, "paths round a loop, {} so far", counted(self.total / 3, "solution")),
        }
    }
}

/// What is called with the progress.
type Callback = dyn Fn(Progress) + Send + Sync;

/// What is asked whether the work is to stop.
type Question = dyn Fn(Progress) -> bool + Send + Sync;

#[derive(Default)]
struct Shared {
    cancelled: AtomicBool,
    /// A flag of somebody else that cancels too.
    flag: Option<&'static AtomicBool>,
    /// Called whenever the progress changes.
    callback: Option<Box<Callback>>,
    /// Asked whenever the work looks whether it is to stop.
    question: Option<Box<Question>>,
    stage: AtomicU8,
    done: AtomicU64,
    total: AtomicU64,
    counted: AtomicU64,
}

/// A handle on running work; clones share it. Nobody watches the default handle, and it costs
/// nothing.
///
/// ```
/// use hc::{Monitor, Run, SolveOptions, System};
///
/// let system: System = "x^2 + y^2 - 5; x*y - 2".parse()?;
/// let monitor = Monitor::watched();
/// // From any thread, at any time:
/// monitor.cancel();
/// assert!(Run::new().watched(&monitor).solve(&system, &SolveOptions::default())?.interrupted);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Default)]
pub struct Monitor {
    shared: Option<Arc<Shared>>,
    /// Whether progress is kept to itself.
    quiet: bool,
    /// When the work ends in any case.
    deadline: Option<Instant>,
}

impl fmt::Debug for Monitor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Monitor").field("progress", &self.progress()).field("cancelled", &self.is_cancelled()).finish()
    }
}

/// Two handles are equal if they are on the same work.
impl PartialEq for Monitor {
    fn eq(&self, other: &Monitor) -> bool {
        self.shared.as_ref().map(Arc::as_ptr) == other.shared.as_ref().map(Arc::as_ptr)
    }
}

impl Monitor {
    /// A handle that somebody watches.
    pub fn watched() -> Monitor {
        Monitor::of(Shared::default())
    }

    /// A handle that somebody watches. The work stops also when this flag is true, for instance
    /// because a signal handler sets it.
    pub fn heeding(flag: &'static AtomicBool) -> Monitor {
        Monitor::of(Shared { flag: Some(flag), ..Shared::default() })
    }

    /// A handle on work that calls `callback` with its progress, often and from any of its threads.
    /// The callback may hold a clone of another handle that heeds it, but not of this one.
    pub fn calling(callback: impl Fn(Progress) + Send + Sync + 'static) -> Monitor {
        Monitor::of(Shared { callback: Some(Box::new(callback)), ..Shared::default() })
    }

    /// A handle on work that stops once `question` returns true. It is called with the progress,
    /// very often and from any of the threads. It should therefore look at the time first.
    pub fn asking(question: impl Fn(Progress) -> bool + Send + Sync + 'static) -> Monitor {
        Monitor::of(Shared { question: Some(Box::new(question)), ..Shared::default() })
    }

    fn of(shared: Shared) -> Monitor {
        Monitor { shared: Some(Arc::new(shared)), ..Monitor::default() }
    }

    /// A handle that stops together with this one but does not change the progress: for parts of
    /// the work.
    #[must_use]
    pub fn quiet(&self) -> Monitor {
        Monitor { quiet: true, ..self.clone() }
    }

    /// A handle that also stops part of the work this long from now.
    #[must_use]
    pub(crate) fn within(&self, time: Duration) -> Monitor {
        Monitor { deadline: Instant::now().checked_add(time), ..self.clone() }
    }

    /// Asks the work to stop soon. What is finished by then is returned, marked as partial. This
    /// has no effect on the default handle.
    pub fn cancel(&self) {
        if let Some(shared) = &self.shared {
            shared.cancelled.store(true, Ordering::Relaxed);
        }
    }

    /// Whether the work has been asked to stop.
    pub fn is_cancelled(&self) -> bool {
        let set = |flag: &AtomicBool| flag.load(Ordering::Relaxed);
        if self.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            return true;
        }
        let Some(shared) = &self.shared else { return false };
        if !set(&shared.cancelled) && shared.question.as_ref().is_some_and(|question| question(self.progress())) {
            self.cancel();
        }
        set(&shared.cancelled) || shared.flag.is_some_and(set)
    }

    /// The progress of the work. The numbers may belong to slightly different instants.
    pub fn progress(&self) -> Progress {
        let Some(shared) = &self.shared else { return Progress::default() };
        let number = usize::from(shared.stage.load(Ordering::Relaxed));
        let stage = STAGES.get(number).copied().unwrap_or(Stage::Preparing);
        let [done, total, counted] =
            [&shared.done, &shared.total, &shared.counted].map(|number| number.load(Ordering::Relaxed));
        Progress { stage, done, total, counted }
    }

    /// Begins a stage of `total` paths, or of starts. Work that is to be watched calls this.
    pub fn enter(&self, stage: Stage, total: u64) {
        if let Some(shared) = self.told() {
            shared.done.store(0, Ordering::Relaxed);
            shared.counted.store(0, Ordering::Relaxed);
            shared.total.store(total, Ordering::Relaxed);
            shared.stage.store(stage as u8, Ordering::Relaxed);
            self.tell(shared);
        }
    }

    /// Adds to the numbers done and counted. Work that is to be watched calls this.
    pub fn add(&self, done: u64, counted: u64) {
        if let Some(shared) = self.told() {
            shared.done.fetch_add(done, Ordering::Relaxed);
            shared.counted.fetch_add(counted, Ordering::Relaxed);
            self.tell(shared);
        }
    }

    /// Sets the numbers done and counted. Work that is to be watched calls this.
    pub fn reach(&self, done: u64, counted: u64) {
        if let Some(shared) = self.told() {
            shared.done.store(done, Ordering::Relaxed);
            shared.counted.store(counted, Ordering::Relaxed);
            self.tell(shared);
        }
    }

    /// The shared state to which progress is reported.
    fn told(&self) -> Option<&Shared> {
        self.shared.as_deref().filter(|_| !self.quiet)
    }

    fn tell(&self, shared: &Shared) {
        if let Some(callback) = &shared.callback {
            callback(self.progress());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clones_share_what_they_count() {
        let monitor = Monitor::watched();
        let other = monitor.clone();
        monitor.enter(Stage::Paths, 10);
        other.add(3, 2);
        let progress = monitor.progress();
        assert_eq!((progress.stage, progress.done, progress.total, progress.counted), (Stage::Paths, 3, 10, 2));
        assert_eq!(progress.to_string(), "paths, 2 of them at regular solutions");
        other.cancel();
        assert!(monitor.is_cancelled() && monitor == other && monitor != Monitor::watched());
        // A flag cancels what heeds it.
        static FLAG: AtomicBool = AtomicBool::new(false);
        let heeding = Monitor::heeding(&FLAG);
        assert!(!heeding.is_cancelled());
        FLAG.store(true, Ordering::Relaxed);
        assert!(heeding.is_cancelled());
        // A callback is told.
        let told = Arc::new(AtomicU64::new(0));
        let count = Arc::clone(&told);
        let calling = Monitor::calling(move |progress| count.store(progress.done, Ordering::Relaxed));
        calling.enter(Stage::Search, 3);
        calling.add(2, 1);
        assert_eq!(told.load(Ordering::Relaxed), 2);
        // A question is asked until it is answered with yes.
        let asked = Arc::new(AtomicU64::new(0));
        let count = Arc::clone(&asked);
        let asking = Monitor::asking(move |progress| count.fetch_add(1, Ordering::Relaxed) + progress.done >= 3);
        assert!(!asking.is_cancelled());
        asking.add(2, 0);
        assert!(asking.is_cancelled() && asking.quiet().is_cancelled());
        assert_eq!(asked.load(Ordering::Relaxed), 2);
        // Nobody watches: nothing to cancel.
        let none = Monitor::default();
        none.cancel();
        assert!(!none.is_cancelled());
    }
}
