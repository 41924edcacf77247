//! Looks for the folder of recordings, so that tests which need it show as ignored where it is
//! absent.

use std::path::Path;

/// All of these are needed.
const RECORDINGS: [&str; 5] =
    ["lund_floor_planar/h40", "lund_floor_planar/h50", "lund_floor_planar/h60", "lund_tdoa_real/data1", "xtdoa_real"];

fn main() {
    println!("cargo::rustc-check-cfg=cfg(recordings)");
    println!("cargo::rerun-if-env-changed=SHARED_DIR");
    println!("cargo::rerun-if-changed=build.rs");
    let folder =
        std::env::var("SHARED_DIR").unwrap_or_else(|_| concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared").to_owned());
    let files = RECORDINGS.map(|name| Path::new(&folder).join("data").join(name).join("pseudoranges_m.csv"));
    if files.iter().all(|file| file.exists()) {
        println!("cargo::rustc-cfg=recordings");
        // A folder that is absent is looked for again when SHARED_DIR changes.
        for file in &files {
            println!("cargo::rerun-if-changed={}", file.display());
        }
        println!("cargo::rustc-env=RECORDINGS={folder}/data");
    }
}
