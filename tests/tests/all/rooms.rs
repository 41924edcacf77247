//! The rooms of the house: no circle of imports between files, no file over 500 lines.

mod imports;

use imports::Imports;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::{Path, PathBuf};

/// Most lines of a file that a person wrote.
const LINES: usize = 500;

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("tests lies in the workspace").to_path_buf()
}

/// The shortest circle through each file that lies in one; a circle is named once.
fn circles(imports: &Imports) -> BTreeSet<Vec<PathBuf>> {
    let mut found = BTreeSet::new();
    for start in imports.keys() {
        let mut came_from: BTreeMap<&PathBuf, &PathBuf> = BTreeMap::new();
        let mut queue = VecDeque::from([start]);
        while let Some(file) = queue.pop_front() {
            for next in imports.get(file).into_iter().flatten() {
                if !came_from.contains_key(next) {
                    came_from.insert(next, file);
                    queue.push_back(next);
                }
            }
        }
        let mut circle = Vec::new();
        let mut at = start;
        while let Some(&before) = came_from.get(at) {
            circle.push(before.clone());
            at = before;
            if at == start {
                circle.reverse();
                let least = (0..circle.len()).min_by_key(|&k| &circle[k]).unwrap_or(0);
                circle.rotate_left(least);
                found.insert(circle);
                break;
            }
        }
    }
    found
}

/// Roots of the crates in a folder: `lib.rs` and `main.rs` of each.
fn roots() -> Vec<PathBuf> {
    let folder = workspace().join("crates");
    let crates = std::fs::read_dir(folder).expect("folder of the crates").map(|entry| entry.expect("a crate").path());
    let packages = crates.chain([workspace().join("xtask"), workspace().join("tests")]);
    let mut roots: Vec<PathBuf> =
        packages.flat_map(|package| ["src/lib.rs", "src/main.rs"].map(|root| package.join(root))).collect();
    roots.retain(|root| root.exists());
    roots.sort();
    roots
}

#[test]
fn files_do_not_import_each_other_in_a_circle() {
    let roots = roots();
    assert!(roots.len() >= 7, "poly, hc, tdoa, their programs, what programs share, xtask: {roots:?}");
    let mut text = String::new();
    for root in roots {
        let imports = imports::of_crate(&root);
        let folder = root.parent().expect("a root lies in src");
        for circle in circles(&imports) {
            let names = circle.iter().map(|file| file.strip_prefix(folder).unwrap_or(file).display().to_string());
            text += &format!("{}: {}\n", folder.display(), names.collect::<Vec<_>>().join(" -> "));
        }
    }
    assert!(text.is_empty(), "files that import each other in a circle:\n{text}");
}

#[test]
fn no_file_is_over_500_lines() {
    let mut long = Vec::new();
    let mut folders: Vec<PathBuf> = ["crates", "xtask", "tests"].iter().map(|name| workspace().join(name)).collect();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder of the workspace") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                if !path.ends_with("target") {
                    folders.push(path);
                }
            } else if path.extension().is_some_and(|end| end == "rs") {
                let text = std::fs::read_to_string(&path).expect("a source file");
                if !text.starts_with("// @generated") && text.lines().count() > LINES {
                    long.push(format!("{}: {} lines", path.display(), text.lines().count()));
                }
            }
        }
    }
    assert!(long.is_empty(), "files of over {LINES} lines:\n{}", long.join("\n"));
}

/// A crate of the given files, in a folder that goes with the first value.
fn example(files: &[(&str, &str)]) -> (tempfile::TempDir, Imports) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("folders are made");
        std::fs::write(path, text).expect("files are written");
    }
    let imports = imports::of_crate(&folder.path().join("lib.rs"));
    (folder, imports)
}

fn names(folder: &tempfile::TempDir, circles: &BTreeSet<Vec<PathBuf>>) -> Vec<Vec<String>> {
    let name = |path: &PathBuf| path.strip_prefix(folder.path()).expect("a file of the crate").display().to_string();
    circles.iter().map(|circle| circle.iter().map(name).collect()).collect()
}

#[test]
fn a_circle_is_named() {
    // From a to c by a path in the code, from c to b by a re-export of the root, from b to a
    // through a name.
    let (folder, imports) = example(&[
        ("lib.rs", "mod a; mod b; mod c; pub use b::B;"),
        ("a.rs", "pub struct A; pub fn f() { assert!(crate::c::C::new()); }"),
        ("b.rs", "use crate::a; pub struct B(a::A);"),
        ("c.rs", "use crate::{B as Other}; use std::fmt; pub struct C(Other);"),
    ]);
    assert_eq!(names(&folder, &circles(&imports)), [["a.rs", "c.rs", "b.rs"]]);
    // A parent that holds what its child needs and needs the child.
    let (folder, imports) = example(&[
        ("lib.rs", "mod parent;"),
        ("parent/mod.rs", "mod child; use child::Child; pub struct Options(Child);"),
        ("parent/child.rs", "use super::Options; pub struct Child;"),
    ]);
    assert_eq!(names(&folder, &circles(&imports)), [["parent/child.rs", "parent/mod.rs"]]);
}

#[test]
fn facades_tests_comments_and_visibility_make_no_circle() {
    let (folder, imports) = example(&[
        ("lib.rs", "mod parent; mod other; pub use parent::Options;"),
        ("parent/mod.rs", "mod child; mod options; pub use {child::Child, options::Options};"),
        ("parent/child.rs", "use super::Options; /// See [`crate::other::Other`].\npub struct Child(Options);"),
        (
            "parent/options.rs",
            "pub(in crate::parent) struct Options; #[cfg(test)] mod tests { use super::*; use crate::parent::Child; }",
        ),
        ("other.rs", "use crate::Options; use std::fmt::Display; pub struct Other(Options);"),
    ]);
    assert_eq!(names(&folder, &circles(&imports)), [[""; 0]; 0]);
    let of = |name: &str| {
        imports[&folder.path().join(name)].iter().map(|p| p.file_name().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(of("parent/child.rs"), ["options.rs"]);
    assert_eq!(of("other.rs"), ["options.rs"]);
    assert_eq!(of("parent/options.rs"), [""; 0]);
}
