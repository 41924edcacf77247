//! Tables of trials that grow by whole rows, so that a run may be stopped at any time and goes on
//! where it was.
//!
//! Every row begins with its key: all that the trial depends on. A row that is in the file is not
//! computed again, whoever wrote it; what an interrupt left of a last line is dropped. When all is
//! done, the file holds the rows in the order of the keys, the same as after one run without a stop
//! (but for columns that measure time), on any number of threads and ranks.

use super::book::{Book, Rows};
use super::common::Common;
use super::crew::Crew;
use cli::{Failure, interrupt};
use hc::Monitor;
use hc::ranks::{Ranks, compute_on_ranks};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};

/// A table that is to be computed.
pub(super) struct Table<'a> {
    common: &'a Common,
    name: &'a str,
    header: &'a str,
    keys: &'a [String],
    threads: Option<usize>,
    ranks: Option<&'a Ranks<'a>>,
}

impl<'a> Table<'a> {
    /// The table in the file `name` of the experiment's folder. `header` names the columns, those of the
    /// key first; `keys` are the key columns of every row, joined by commas.
    pub(super) fn new(
        common: &'a Common,
        name: &'a str,
        header: &'a str,
        keys: &'a [String],
        ranks: Option<&'a Ranks<'a>>,
    ) -> Table<'a> {
        Table { common, name, header, keys, threads: common.threads, ranks }
    }

    /// A table whose rows are computed one after the other.
    pub(super) fn one_by_one(self) -> Table<'a> {
        Table { threads: Some(1), ..self }
    }

    /// Computes the rows that are not yet in the file, in parallel, each with a state of its thread:
    /// `row` gives the columns that come after the key. Several ranks share the rows; rank 0 alone has
    /// the file and the finished table.
    ///
    /// # Errors
    /// If a row fails, the file is another table, or the run is interrupted; what was computed so far
    /// is kept.
    pub(super) fn resume<S: Send>(
        &self,
        state: impl Fn() -> S + Sync,
        row: impl Fn(&mut S, usize) -> Result<String, Failure> + Sync,
    ) -> Result<Option<Rows>, Failure> {
        let crew = Crew::new(self.threads, state)?;
        let Some(ranks) = self.ranks else {
            let path = self.common.file(self.name)?;
            let mut book = Book::open(&path, self.header, self.keys)?;
            let missing = book.missing();
            let monitor = Monitor::heeding(interrupt::watch()?);
            let shared = Mutex::new(&mut book);
            crew.each(&missing, |state, k| {
                let row = if monitor.is_cancelled() { Err(Failure::Interrupted) } else { row(state, k) };
                shared.lock().unwrap_or_else(PoisonError::into_inner).enter(k, row)
            });
            return book.close().map(Some);
        };
        // Failures of rows are sent as words.
        let compute = |numbers: &[usize], monitor: &Monitor| {
            let rows = Mutex::new(BTreeMap::new());
            crew.each(numbers, |state, k| {
                if monitor.is_cancelled() {
                    return ControlFlow::Break(());
                }
                let row = row(state, k).map_err(|failure| failure.to_string());
                rows.lock().unwrap_or_else(PoisonError::into_inner).insert(k, row);
                ControlFlow::Continue(())
            });
            let rows = rows.into_inner().unwrap_or_else(PoisonError::into_inner);
            rows.into_values().collect::<Vec<Result<String, String>>>()
        };
        let job = format!("{}\n{}", self.header, self.keys.join("\n"));
        if !ranks.is_lead() {
            let never = |_, _| ControlFlow::Break(());
            let worked = cli::on_threads(self.threads, || {
                compute_on_ranks(&job, &[], &Monitor::default(), compute, never, ranks)
            })?;
            return worked.map(|()| None).map_err(Failure::unusable);
        }
        let path = self.common.file(self.name)?;
        let mut book = Book::open(&path, self.header, self.keys)?;
        let missing = book.missing();
        let monitor = Monitor::heeding(interrupt::watch()?);
        let enter = |k, row: Result<String, String>| book.enter(k, row.map_err(Failure::Unusable));
        let worked =
            cli::on_threads(self.threads, || compute_on_ranks(&job, &missing, &monitor, compute, enter, ranks))?;
        worked.map_err(Failure::unusable)?;
        book.close().map(Some)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hc::ranks::{Local, RanksOptions};
    use std::path::Path;
    use std::sync::atomic::{AtomicUsize, Ordering};

    fn common(folder: &Path) -> Common {
        Common { seed: 0, threads: Some(2), output: folder.to_owned() }
    }

    #[test]
    fn a_stopped_run_goes_on_and_ends_with_the_same_file() {
        let folder = tempfile::tempdir().unwrap();
        let keys: Vec<String> = (0..40).map(|k| format!("6r/3s,{k}")).collect();
        let computed = AtomicUsize::new(0);
        let common = common(folder.path());
        let run = |name: &str, keys: &[String], stop: usize| {
            let square = |(): &mut (), k: usize| {
                if k == stop {
                    return Err(Failure::Unusable("stop".into()));
                }
                computed.fetch_add(1, Ordering::Relaxed);
                Ok((k * k).to_string())
            };
            let rows = Table::new(&common, name, "size,seed,square", keys, None).resume(|| (), square)?;
            Ok::<Rows, Failure>(rows.expect("a program alone has the table"))
        };
        let (one, two) = (folder.path().join("one.csv"), folder.path().join("two.csv"));
        assert!(run("one.csv", &keys, usize::MAX).is_ok());
        assert!(run("two.csv", &keys, 25).is_err());
        // As if the machine had stopped in the middle of a line.
        let so_far = std::fs::read_to_string(&two).unwrap();
        std::fs::write(&two, so_far.clone() + "6r/3s,3").unwrap();
        computed.store(0, Ordering::Relaxed);
        let Ok(rows) = run("two.csv", &keys, usize::MAX) else { panic!("goes on") };
        assert_eq!(computed.load(Ordering::Relaxed), 40 - (so_far.lines().count() - 1));
        assert_eq!(std::fs::read(&one).unwrap(), std::fs::read(&two).unwrap());
        assert_eq!(rows.numbers("square", 3..6), [9.0, 16.0, 25.0]);
        // Fewer are a part of it; nothing is computed and nothing lost.
        computed.store(0, Ordering::Relaxed);
        assert!(run("two.csv", &keys[..7], usize::MAX).is_ok_and(|rows| rows.numbers("square", 0..7).len() == 7));
        assert_eq!((computed.load(Ordering::Relaxed), std::fs::read_to_string(&two).unwrap().lines().count()), (0, 41));
    }

    #[test]
    fn another_table_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        std::fs::write(&path, "a,b\n1,2\n").unwrap();
        let (common, keys) = (common(folder.path()), ["1".to_owned()]);
        let result = Table::new(&common, "t.csv", "a,c", &keys, None).resume(|| (), |(), _| Ok("3".into()));
        assert!(matches!(result, Err(Failure::Unusable(message)) if message.contains("other columns")));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "a,b\n1,2\n");
    }

    #[test]
    fn ranks_share_the_rows_and_a_failure_of_one_is_said() {
        let folder = tempfile::tempdir().unwrap();
        let keys: Vec<String> = (0..200).map(|k| k.to_string()).collect();
        let run = |name: &str, count: usize, stop: usize| {
            let one = |exchange: Local| {
                let ranks = Ranks::new(&exchange, &RanksOptions::new());
                // The time of another machine.
                let output = if ranks.is_lead() { folder.path().to_owned() } else { folder.path().join("none") };
                let common = Common { output, ..common(folder.path()) };
                let cube = |(): &mut (), k: usize| match k == stop {
                    true => Err(Failure::Unusable("stop".into())),
                    false => Ok((k * k * k).to_string()),
                };
                let rows = Table::new(&common, name, "number,cube", &keys, Some(&ranks)).resume(|| (), cube);
                let is_lead = ranks.is_lead();
                ranks.finish(None);
                rows.map(|rows| assert_eq!(rows.is_some(), is_lead)).map_err(|failure| failure.to_string())
            };
            std::thread::scope(|scope| {
                let one = &one;
                let all: Vec<_> =
                    Local::ranks(count).into_iter().map(|local| scope.spawn(move || one(local))).collect();
                all.into_iter().map(|rank| rank.join().unwrap()).collect::<Vec<_>>()
            })
        };
        let text = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
        let expected: String = (0..200).map(|k| format!("{k},{}\n", k * k * k)).collect();
        assert_eq!(run("three.csv", 3, usize::MAX), [Ok(()), Ok(()), Ok(())]);
        assert_eq!(text("three.csv"), format!("number,cube\n{expected}"));
        assert_eq!(run("stopped.csv", 2, 150)[0], Err("stop".to_owned()));
        assert!(text("stopped.csv").starts_with("number,cube\n"));
        // A program alone goes on with it.
        let common = common(folder.path());
        let table = Table::new(&common, "stopped.csv", "number,cube", &keys, None);
        assert!(table.resume(|| (), |(), k| Ok((k * k * k).to_string())).is_ok_and(|rows| rows.is_some()));
        assert_eq!(text("stopped.csv"), text("three.csv"));
        assert!(!folder.path().join("none").exists());
    }
}
