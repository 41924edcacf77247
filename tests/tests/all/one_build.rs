//! One set of features: tests of a single crate and builds of a single program need the same builds
//! of dependencies as those of the whole workspace (crates/one-build).

use std::collections::BTreeSet;
use std::process::Command;

/// Packages with their features, as cargo resolves them.
fn packages(arguments: &[&str], edges: &str) -> BTreeSet<String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let tree = Command::new(cargo)
        .args(["tree", "--locked", "--prefix", "none", "--no-dedupe", "--format", "{p} {f}", "--edges", edges])
        .args(arguments)
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
        .output()
        .expect("cargo runs these tests");
    assert!(tree.status.success(), "{}", String::from_utf8_lossy(&tree.stderr));
    let lines = String::from_utf8(tree.stdout).expect("names are text");
    let lines = lines.lines().map(|line| line.trim_end_matches(" (*)").to_owned());
    // Programs of experiments differ on purpose: xtask must build where tdoa does not.
    lines.filter(|line| !line.is_empty() && !line.starts_with("experiments ")).collect()
}

#[test]
fn nothing_is_built_twice_in_one_target_directory() {
    let mut strays = Vec::new();
    let mut compare = |edges: &str, members: &[&str]| {
        let all = packages(&["--workspace"], edges);
        assert!(all.len() > 100, "{} packages", all.len());
        for member in members {
            let own = packages(&["--package", member], edges);
            strays.extend(own.difference(&all).map(|package| format!("--package {member}: {package}")));
        }
    };
    compare("normal,build,dev", &["poly", "hc", "tdoa", "sound", "cli", "hc-cli", "tdoa-cli", "experiments", "xtask"]);
    compare("normal,build", &["hc-cli", "tdoa-cli", "xtask", "tdoa-python"]);
    assert!(strays.is_empty(), "with other features than in the workspace:\n{}", strays.join("\n"));
}
