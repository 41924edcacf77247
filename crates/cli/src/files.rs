//! What a command reads and writes, checked before its work begins: nothing that is read is
//! overwritten, no two results go to one file, and every place can be written to.

use std::path::{Path, PathBuf};

use crate::standard::{is_standard, name};
use crate::{Failure, output};

/// The files of a command.
#[derive(Default)]
pub struct Files<'a> {
    reads: Vec<&'a Path>,
    /// With the names of the options that ask for them.
    writes: Vec<(&'a str, &'a Path)>,
}

impl<'a> Files<'a> {
    /// No files.
    pub fn new() -> Files<'a> {
        Files::default()
    }

    /// A file that is read, if there is one; `-` for standard input.
    pub fn reads(mut self, path: Option<&'a Path>) -> Files<'a> {
        self.reads.extend(path);
        self
    }

    /// A file that an option asks for, if it does; `-` for standard output.
    pub fn writes(mut self, option: &'a str, path: Option<&'a Path>) -> Files<'a> {
        self.writes.extend(path.map(|path| (option, path)));
        self
    }

    /// Checks the files of the only process.
    ///
    /// # Errors
    /// For standard input that is read twice, a file that is read and written, two results with one
    /// file, and a file that cannot be written. Nothing is left there.
    pub fn check(&self) -> Result<(), Failure> {
        self.check_standard_input(false)?;
        self.check_writes()
    }

    /// Checks the files of one of several processes. The first of them alone writes.
    ///
    /// # Errors
    /// Those of [`Files::check`], and for standard input, which not all processes have.
    pub fn check_shared(&self, is_first: bool) -> Result<(), Failure> {
        self.check_standard_input(true)?;
        if is_first { self.check_writes() } else { Ok(()) }
    }

    fn check_standard_input(&self, is_shared: bool) -> Result<(), Failure> {
        match self.reads.iter().filter(|path| is_standard(path)).count() {
            0 => Ok(()),
            1 if is_shared => Err(Failure::unusable(
                "standard input reaches one of several ranks alone; give a file, which all of them can read",
            )),
            1 => Ok(()),
            _ => Err(Failure::unusable("standard input can be read once; give files in place of all `-` but one")),
        }
    }

    fn check_writes(&self) -> Result<(), Failure> {
        let reads: Vec<Place> = self.reads.iter().map(|path| Place::of(path, "/dev/stdin")).collect();
        let mut seen: Vec<(&str, Place)> = Vec::new();
        for &(option, path) in &self.writes {
            let place = Place::of(path, "/dev/stdout");
            if let Some(k) = reads.iter().position(|read| place.overwrites(read)) {
                let (written, read) = (shown(path), name(self.reads[k]));
                let same = if written == read { "it".to_owned() } else { format!("the same file as {read}, which") };
                return Err(Failure::Unusable(format!(
                    "{written}: {option} would overwrite {same} is read; give {option} another name"
                )));
            }
            if let Some((other, _)) = seen.iter().find(|(_, other)| other.path == place.path || place.overwrites(other))
            {
                let file = shown(path);
                return Err(Failure::Unusable(format!("{file}: is asked for by {other} and {option}; give two names")));
            }
            output::probe(path)?;
            seen.push((option, place));
        }
        Ok(())
    }
}

/// Checks that these files can be written in a directory, and that none is there yet unless `force`
/// is given. The directory need not be there. Nothing is left there.
///
/// # Errors
/// For a directory that cannot be written to, and files that would be replaced.
pub fn check_directory(directory: &Path, names: &[&str], force: bool) -> Result<(), Failure> {
    output::probe_directory(directory)?;
    // A link that leads nowhere is replaced as well.
    let is_there = |name: &&&str| directory.join(name).symlink_metadata().is_ok();
    let there: Vec<&str> = names.iter().filter(is_there).copied().collect();
    if there.is_empty() || force {
        return Ok(());
    }
    let verb = if there.len() == 1 { "is" } else { "are" };
    Err(Failure::Unusable(format!(
        "{}: {} {verb} there already; give another directory, or --force to replace them",
        directory.display(),
        there.join(", ")
    )))
}

/// What a path of something that is written is called in messages.
fn shown(path: &Path) -> String {
    if is_standard(path) { "standard output".to_owned() } else { path.display().to_string() }
}

/// Where a path leads.
struct Place {
    /// Without links and detours, as far as it exists.
    path: PathBuf,
    /// Device and number of a file, where the system has these: it may have several names.
    file: Option<(u64, u64)>,
    /// Whether it is a file, not a device or a pipe, which nothing overwrites.
    is_file: bool,
}

impl Place {
    /// The place of a path; `-` is what stands at `standard`.
    fn of(path: &Path, standard: &str) -> Place {
        let path = if is_standard(path) { Path::new(standard) } else { path };
        let meta = std::fs::metadata(path).ok().filter(std::fs::Metadata::is_file);
        Place { path: canonical(path), file: meta.as_ref().and_then(number), is_file: meta.is_some() }
    }

    /// Whether what is written here takes the place of another file.
    fn overwrites(&self, other: &Place) -> bool {
        other.is_file && (self.path == other.path || (self.file.is_some() && self.file == other.file))
    }
}

/// A path without links; of a file that is not there yet, its directory without links.
fn canonical(path: &Path) -> PathBuf {
    let beside = || {
        let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Some(parent.canonicalize().ok()?.join(path.file_name()?))
    };
    path.canonicalize().ok().or_else(beside).unwrap_or_else(|| path.to_path_buf())
}

#[cfg(unix)]
fn number(meta: &std::fs::Metadata) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt;
    Some((meta.dev(), meta.ino()))
}

#[cfg(not(unix))]
fn number(_: &std::fs::Metadata) -> Option<(u64, u64)> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(files: &Files<'_>) -> String {
        files.check().unwrap_err().to_string()
    }

    #[test]
    fn standard_input_is_read_once_and_by_one_process() {
        let (file, standard) = (Some(Path::new("a")), Some(Path::new("-")));
        assert!(Files::new().reads(standard).reads(None).reads(file).check().is_ok());
        assert!(Files::new().reads(file).reads(file).check_shared(true).is_ok());
        assert!(message(&Files::new().reads(standard).reads(standard)).contains("can be read once"));
        let shared = Files::new().reads(standard).check_shared(true).unwrap_err().to_string();
        assert!(shared.contains("give a file"), "{shared}");
    }

    #[test]
    fn nothing_that_is_read_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let (read, other) = (at("in.csv"), at("out.csv"));
        std::fs::write(&read, "1").unwrap();
        std::fs::create_dir(at("sub")).unwrap();
        let mut names = vec![read.clone(), at("sub/../in.csv"), at("./in.csv")];
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(&read, at("link.csv")).unwrap();
            std::os::unix::fs::symlink(folder.path(), at("sub/up")).unwrap();
            names.extend([at("link.csv"), at("sub/up/in.csv")]);
        }
        std::fs::hard_link(&read, at("hard.csv")).unwrap();
        if cfg!(unix) {
            names.push(at("hard.csv"));
        }
        for name in &names {
            for (read, written) in [(&read, name), (name, &read)] {
                let said = message(&Files::new().reads(Some(read)).writes("--svg", Some(written)));
                assert!(said.contains("--svg would overwrite") && said.contains("another name"), "{said}");
            }
        }
        assert!(Files::new().reads(Some(&read)).writes("--svg", Some(&other)).check().is_ok());
        assert!(!other.exists());
        assert_eq!(std::fs::read_to_string(&read).unwrap(), "1");
    }

    #[test]
    fn two_results_have_two_files() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("sub")).unwrap();
        for (a, b) in [(at("a"), at("a")), (at("a"), at("sub/../a")), ("-".into(), "-".into())] {
            let said = message(&Files::new().writes("--json", Some(&a)).writes("--html", Some(&b)));
            assert!(said.contains("--json and --html") && said.contains("two names"), "{said}");
        }
        for a in [at("a"), "-".into()] {
            assert!(Files::new().writes("--json", Some(&a)).writes("--html", Some(&at("b"))).check().is_ok());
        }
    }

    #[test]
    fn devices_are_not_overwritten() {
        let null = Some(Path::new("/dev/null"));
        if cfg!(unix) {
            assert!(Files::new().reads(null).writes("--json", null).check().is_ok());
        }
    }

    #[test]
    fn directories_keep_what_they_have() {
        let folder = tempfile::tempdir().unwrap();
        let inner = folder.path().join("new/inner");
        assert!(check_directory(&inner, &["a.csv"], false).is_ok());
        assert!(!inner.exists());
        std::fs::write(folder.path().join("a.csv"), "1").unwrap();
        let said = |directory: &Path, force| check_directory(directory, &["a.csv", "b.csv"], force);
        let error = said(folder.path(), false).unwrap_err().to_string();
        assert!(error.contains("a.csv is there already") && error.contains("--force"), "{error}");
        assert!(said(folder.path(), true).is_ok());
        let error = said(&folder.path().join("a.csv/inner"), true).unwrap_err().to_string();
        assert!(error.contains("give a directory"), "{error}");
        assert!(said(Path::new("-"), true).unwrap_err().to_string().contains("standard output"));
    }
}
