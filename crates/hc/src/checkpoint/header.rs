//! The description of a checkpoint: a small JSON file, which people can read too.

use super::error::CheckpointError;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::fmt::Write;
use std::fs::File;
use std::io;
use std::path::Path;

/// The version of records; it changes whenever the records or their order change.
pub(super) const FORMAT: u32 = 1;

/// What a run computes, as far as its result depends on it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Job {
    /// What is done: `solve`, `track` or `monodromy`.
    pub(crate) what: String,
    /// The system, in short.
    pub(crate) system: System,
    /// Settings by their names, and hashes of long input.
    pub(crate) options: Map<String, Value>,
}

impl Job {
    pub(crate) fn new(what: &str, system: System, options: &impl Serialize) -> Job {
        let options = match serde_json::to_value(options) {
            Ok(Value::Object(options)) => options,
            _ => Map::new(),
        };
        Job { what: what.to_owned(), system, options }
    }

    /// Tells jobs apart, and versions of this crate.
    pub(crate) fn fingerprint(&self) -> String {
        let text = serde_json::to_string(&Header::new(self.clone())).unwrap_or_default();
        let Hash(hash) = Hash::of([text]);
        hash
    }
}

/// A system in short.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct System {
    pub(crate) unknowns: Vec<String>,
    pub(crate) equations: usize,
    pub(crate) hash: Hash,
}

/// A hash that separates inputs which differ by accident: FNV-1a of 64 bits, in hexadecimal.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Hash(String);

impl Hash {
    pub(crate) fn of<B: AsRef<[u8]>>(parts: impl IntoIterator<Item = B>) -> Hash {
        let mut hash = 0xcbf2_9ce4_8422_2325u64;
        let mut take = |byte: u8| hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        for part in parts {
            part.as_ref().iter().for_each(|&byte| take(byte));
            // Where a part ends.
            (part.as_ref().len() as u64).to_le_bytes().into_iter().for_each(&mut take);
        }
        Hash(format!("{hash:016x}"))
    }
}

/// The header: what the checkpoint describes, and which program wrote it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Header {
    pub(super) format: u32,
    pub(super) version: String,
    #[serde(flatten)]
    pub(super) job: Job,
}

impl Header {
    pub(super) fn new(job: Job) -> Header {
        Header { format: FORMAT, version: env!("CARGO_PKG_VERSION").to_owned(), job }
    }

    /// Its bytes in the file.
    pub(super) fn bytes(&self) -> Result<Vec<u8>, serde_json::Error> {
        let mut bytes = serde_json::to_vec_pretty(self)?;
        bytes.push(b'\n');
        Ok(bytes)
    }

    /// Writes bytes of a header whole or not at all.
    pub(super) fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
        let folder = path.parent().unwrap_or(Path::new("."));
        let mut file = tempfile::Builder::new().prefix(".header-").tempfile_in(folder)?;
        io::Write::write_all(&mut file, bytes)?;
        file.as_file().sync_all()?;
        file.persist(path).map_err(|error| error.error)?;
        // The name is on the disk once the directory is; not every system can do this.
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
        Ok(())
    }

    /// Reads a header.
    ///
    /// # Errors
    /// If the file cannot be read or is not a header.
    pub(super) fn read(path: &Path) -> Result<(Header, Vec<u8>), CheckpointError> {
        let bytes = std::fs::read(path).map_err(|error| CheckpointError::io(path, &error))?;
        let foreign = |reason: String| CheckpointError::Foreign { path: path.to_owned(), reason };
        let value: Value = serde_json::from_slice(&bytes).map_err(|error| foreign(error.to_string()))?;
        // A later format may have other fields.
        let format = value.get("format").and_then(Value::as_u64);
        if format.is_some_and(|format| format != u64::from(FORMAT)) {
            return Err(CheckpointError::Differs {
                directory: path.parent().unwrap_or(Path::new(".")).to_owned(),
                name: "format".to_owned(),
                recorded: format.unwrap_or_default().to_string(),
                own: FORMAT.to_string(),
            });
        }
        let header = serde_json::from_value(value).map_err(|error| foreign(error.to_string()))?;
        Ok((header, bytes))
    }

    /// The difference between this header, of the checkpoint in a directory, and the header of the
    /// run; `None` if there is none.
    pub(super) fn difference(&self, directory: &Path, run: &Header) -> Option<CheckpointError> {
        let [recorded, own] = [self, run].map(|header| serde_json::to_value(header).unwrap_or_default());
        let (name, recorded, own) = difference(&recorded, &own, "")?;
        Some(CheckpointError::Differs { directory: directory.to_owned(), name, recorded, own })
    }
}

/// The first difference between two values: its name, and both values. The kind of run and the
/// version come before the system, and the system before the settings.
fn difference(a: &Value, b: &Value, name: &str) -> Option<(String, String, String)> {
    let (Value::Object(a), Value::Object(b)) = (a, b) else {
        return (a != b).then(|| (name.to_owned(), shown(a), shown(b)));
    };
    let mut keys: Vec<&String> = a.keys().chain(b.keys().filter(|key| !a.contains_key(*key))).collect();
    let order = ["format", "version", "what", "system", "options"];
    keys.sort_by_key(|key| order.iter().position(|first| first == key));
    keys.into_iter().find_map(|key| {
        let mut inner = name.to_owned();
        // The seed is called so, not "options seed".
        if key != "options" {
            let _ = write!(inner, "{}{key}", if name.is_empty() { "" } else { " " });
        }
        let of = |map: &Map<String, Value>| map.get(key).cloned().unwrap_or_default();
        difference(&of(a), &of(b), &inner)
    })
}

/// A value as it is shown in a message.
fn shown(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Null => "none".to_owned(),
        Value::Array(items) if items.iter().all(Value::is_string) => {
            items.iter().map(shown).collect::<Vec<_>>().join(", ")
        }
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn header(options: Value, unknowns: &[&str]) -> Header {
        let unknowns = unknowns.iter().map(|name| (*name).to_owned()).collect();
        let system = System { unknowns, equations: 2, hash: Hash::of(["x^2", "y"]) };
        let Value::Object(options) = options else { panic!("an object") };
        Header::new(Job { what: "solve".to_owned(), system, options })
    }

    #[test]
    fn the_difference_is_named() {
        let folder = Path::new("folder");
        let first = header(json!({"seed": 1, "paths": {"retries": 4}}), &["x", "y"]);
        let says = |other: &Header| first.difference(folder, other).map(|error| error.to_string());
        assert_eq!(says(&first), None);
        let seed = says(&header(json!({"seed": 2, "paths": {"retries": 5}}), &["x", "y"])).unwrap();
        assert!(seed.contains("the checkpoint is of paths retries 4, this run has paths retries 5"), "{seed}");
        let seed = says(&header(json!({"seed": 2, "paths": {"retries": 4}}), &["x", "y"])).unwrap();
        assert!(seed.contains("the checkpoint is of seed 1, this run has seed 2"), "{seed}");
        let system = says(&header(json!({"seed": 2}), &["x", "z"])).unwrap();
        assert!(system.contains("is of system unknowns x, y, this run has system unknowns x, z"), "{system}");
        let known = says(&header(json!({"seed": 1, "paths": {"retries": 4}, "known": 3}), &["x", "y"])).unwrap();
        assert!(known.contains("is of known none, this run has known 3"), "{known}");
    }

    #[test]
    fn hashes_tell_parts_apart() {
        assert_eq!(Hash::of(["", ""]), Hash::of(["", ""]));
        assert_ne!(Hash::of(["ab", "c"]), Hash::of(["a", "bc"]));
        // The published test vector of FNV-1a for "a", and then the length of the part.
        let byte = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        let expected = [1, 0, 0, 0, 0, 0, 0, 0].into_iter().fold(0xaf63_dc4c_8601_ec8c, byte);
        assert_eq!(Hash::of(["a"]), Hash(format!("{expected:016x}")));
    }
}
