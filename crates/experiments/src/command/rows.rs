//! Tables of trials that grow by whole rows, so that a run may be stopped at any time and goes on
//! where it was.
//!
//! Every row begins with its key: all that the trial depends on. A row that is in the file is not
//! computed again, whoever wrote it; what an interrupt left of a last line is dropped. When all is
//! done, the file holds the rows in the order of the keys, the same as after one run without a stop
//! (but for columns that measure time).

use cli::bar::Bar;
use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use cli::{Failure, interrupt, output};

/// The finished table: names of the columns, and cells as text.
pub(super) struct Rows {
    columns: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Rows {
    /// The numbers of a column in some rows: `true` is 1, `false` 0, an empty cell not a number.
    ///
    /// # Panics
    /// If there is no such column.
    pub(super) fn numbers(&self, column: &str, rows: std::ops::Range<usize>) -> Vec<f64> {
        let at = self.columns.iter().position(|name| name == column).expect("a column of the table's header");
        let number = |cell: &str| match cell {
            "true" => 1.0,
            "false" => 0.0,
            other => other.parse().unwrap_or(f64::NAN),
        };
        self.rows[rows].iter().map(|row| number(&row[at])).collect()
    }
}

/// Computes the rows that are not yet in the file at `path`. `header` names the columns, those of
/// the key first; `keys` are the key columns of every row, joined by commas; `row` gives the other
/// columns. Rows are computed in parallel, each with a state of its thread.
///
/// # Errors
/// If a row fails, the file is another table, or the run is interrupted; what was computed so far
/// is kept.
pub(super) fn resume<S: Send>(
    path: &Path,
    header: &str,
    keys: &[String],
    threads: Option<usize>,
    state: impl Fn() -> S + Sync,
    row: impl Fn(&mut S, usize) -> Result<String, Failure> + Sync,
) -> Result<Rows, Failure> {
    let failed = |error: std::io::Error| Failure::Unusable(format!("{}: {error}", path.display()));
    let cancelled = interrupt::watch()?;
    let known = match std::fs::read_to_string(path) {
        Ok(text) => parse(&text, header, path)?,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Vec::new(),
        Err(error) => return Err(failed(error)),
    };
    // Dropping half a line is all that a stopped run needs; writing the whole table anew does it.
    output::write(path, join(header, known.iter().map(String::as_str)).as_bytes())?;
    let mut done: HashMap<&str, &str> = HashMap::new();
    let width = keys.first().map_or(0, |key| key.split(',').count());
    for line in &known {
        done.insert(key_of(line, width), line);
    }
    let missing: Vec<usize> = (0..keys.len()).filter(|&k| !done.contains_key(keys[k].as_str())).collect();
    let file = Mutex::new(OpenOptions::new().append(true).open(path).map_err(failed)?);
    let bar = Bar::counted(missing.len() as u64);
    let next = AtomicUsize::new(0);
    let outcome: Mutex<Result<HashMap<usize, String>, Failure>> = Mutex::new(Ok(HashMap::new()));
    let one = |state: &mut S, k: usize| -> Result<String, Failure> {
        if cancelled.load(Ordering::Relaxed) {
            return Err(Failure::Interrupted);
        }
        let line = format!("{},{}", keys[k], row(state, k)?);
        append(&file, &line).map_err(failed)?;
        Ok(line)
    };
    // A row stays on one thread, so that its processor time can be told from that of the others;
    // what it does in parallel runs in a pool of its own.
    let worker = |pool: &rayon::ThreadPool| {
        let mut state = state();
        while let Some(&k) = missing.get(next.fetch_add(1, Ordering::Relaxed)) {
            let line = pool.install(|| one(&mut state, k));
            let mut outcome = outcome.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            match (&mut *outcome, line) {
                (Err(_), _) => break,
                (Ok(rows), Ok(line)) => _ = rows.insert(k, line),
                (all, Err(error)) => {
                    *all = Err(error);
                    break;
                }
            }
            bar.inc(1);
        }
    };
    let pools = pools(threads)?;
    std::thread::scope(|scope| {
        for pool in &pools {
            scope.spawn(|| worker(pool));
        }
    });
    bar.finish_and_clear();
    let fresh = outcome.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner)?;
    let wanted: Vec<&str> =
        (0..keys.len()).map(|k| fresh.get(&k).map_or_else(|| done[keys[k].as_str()], String::as_str)).collect();
    // Rows of other keys, of a run with more networks, stay for another day.
    let asked: std::collections::HashSet<&str> = keys.iter().map(String::as_str).collect();
    let others = known.iter().map(String::as_str).filter(|line| !asked.contains(key_of(line, width)));
    output::write(path, join(header, wanted.iter().copied().chain(others)).as_bytes())?;
    let cells = |line: &str| line.split(',').map(str::to_owned).collect();
    Ok(Rows { columns: cells(header), rows: wanted.into_iter().map(cells).collect() })
}

/// As many pools of one thread as threads are asked for; as cores for `None`.
fn pools(threads: Option<usize>) -> Result<Vec<rayon::ThreadPool>, Failure> {
    let count = cli::thread_count(threads)?;
    let count = count.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
    (0..count).map(|_| cli::pool(Some(1))).collect()
}

/// The whole lines of a table below its header.
fn parse(text: &str, header: &str, path: &Path) -> Result<Vec<String>, Failure> {
    let whole = text.rfind('\n').map_or("", |end| &text[..end]);
    let mut lines = whole.lines();
    match lines.next() {
        None => Ok(Vec::new()),
        Some(first) if first == header => {
            let columns = header.split(',').count();
            Ok(lines.filter(|line| line.split(',').count() == columns).map(str::to_owned).collect())
        }
        Some(_) => Err(Failure::Unusable(format!(
            "{}: has other columns than this experiment; remove it or choose another --output",
            path.display()
        ))),
    }
}

/// The first columns of a line.
fn key_of(line: &str, width: usize) -> &str {
    let end = line.match_indices(',').nth(width.saturating_sub(1)).map_or(line.len(), |(at, _)| at);
    &line[..end]
}

fn join<'a>(header: &str, lines: impl Iterator<Item = &'a str>) -> String {
    let mut text = format!("{header}\n");
    for line in lines {
        text += line;
        text.push('\n');
    }
    text
}

fn append(file: &Mutex<File>, line: &str) -> std::io::Result<()> {
    let mut file = file.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    // One call, so that a stop leaves whole lines or the beginning of one.
    file.write_all(format!("{line}\n").as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stopped_run_goes_on_and_ends_with_the_same_file() {
        let folder = tempfile::tempdir().unwrap();
        let keys: Vec<String> = (0..40).map(|k| format!("6r/3s,{k}")).collect();
        let computed = AtomicUsize::new(0);
        let run = |path: &Path, keys: &[String], stop: usize| {
            resume(
                path,
                "size,seed,square",
                keys,
                Some(2),
                || (),
                |(), k| {
                    if k == stop {
                        return Err(Failure::Unusable("stop".into()));
                    }
                    computed.fetch_add(1, Ordering::Relaxed);
                    Ok((k * k).to_string())
                },
            )
        };
        let (one, two) = (folder.path().join("one.csv"), folder.path().join("two.csv"));
        assert!(run(&one, &keys, usize::MAX).is_ok());
        assert!(run(&two, &keys, 25).is_err());
        // As if the machine had stopped in the middle of a line.
        let so_far = std::fs::read_to_string(&two).unwrap();
        std::fs::write(&two, so_far.clone() + "6r/3s,3").unwrap();
        computed.store(0, Ordering::Relaxed);
        let Ok(rows) = run(&two, &keys, usize::MAX) else { panic!("goes on") };
        assert_eq!(computed.load(Ordering::Relaxed), 40 - (so_far.lines().count() - 1));
        assert_eq!(std::fs::read(&one).unwrap(), std::fs::read(&two).unwrap());
        assert_eq!(rows.numbers("square", 3..6), [9.0, 16.0, 25.0]);
        // Fewer are a part of it; nothing is computed and nothing lost.
        computed.store(0, Ordering::Relaxed);
        assert!(run(&two, &keys[..7], usize::MAX).is_ok_and(|rows| rows.rows.len() == 7));
        assert_eq!((computed.load(Ordering::Relaxed), std::fs::read_to_string(&two).unwrap().lines().count()), (0, 41));
    }

    #[test]
    fn another_table_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        std::fs::write(&path, "a,b\n1,2\n").unwrap();
        let result = resume(&path, "a,c", &["1".into()], Some(1), || (), |(), _| Ok("3".into()));
        assert!(matches!(result, Err(Failure::Unusable(message)) if message.contains("other columns")));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "a,b\n1,2\n");
    }
}
