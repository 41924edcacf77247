//! `tdoa calibrate` of networks as deployments bring them: receivers with errors of their own, and
//! networks that nobody hears whole.

use std::path::Path;

use end_to_end::{run, simulated};
use serde_json::Value;

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8 path")
}

fn calibrate(folder: &Path, file: &Path, words: &[&str]) -> Value {
    let truth = folder.join("receivers.csv");
    let arguments = [&["calibrate", text(file), "--truth", text(&truth), "--json", "-"], words].concat();
    let output = run("tdoa", &arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

fn warned(found: &Value, part: &str) -> bool {
    let warnings = found["warnings"].as_array().expect("warnings");
    warnings.iter().any(|warning| warning.as_str().is_some_and(|warning| warning.contains(part)))
}

#[test]
fn a_delayed_receiver_is_named_and_mended() {
    let (directory, file) = simulated("--receivers 10 --transmitters 20 --noise 0.01 --fault delay=0.3 --seed 5");
    let told = calibrate(directory.path(), &file, &[]);
    assert!(warned(&told, "receiver r1 seems to have a delay of 0.3"), "{}", told["warnings"]);
    assert_eq!((&told["unique"], &told["receiver_errors"][0]["receiver"]), (&Value::Bool(false), &"r1".into()));
    let mended = calibrate(directory.path(), &file, &["--receiver-delays", "auto"]);
    assert!(warned(&mended, "it was taken out"), "{}", mended["warnings"]);
    // Noise of 1 cm leaves errors of about 1 cm.
    assert!(mended["truth"]["receiver_rms"].as_f64().expect("number") < 0.03, "{}", mended["truth"]);
}

#[test]
fn clean_networks_are_called_unique_without_a_word() {
    let (directory, file) = simulated("--receivers 10 --transmitters 20 --noise 0.01 --seed 6");
    let found = calibrate(directory.path(), &file, &["--sigma", "0.01"]);
    for name in ["unique", "unique_receivers", "unique_transmitters"] {
        assert_eq!(found[name], Value::Bool(true), "{name}: {}", found["warnings"]);
    }
    assert_eq!((found.get("receiver_errors"), &found["warnings"]), (None, &Value::Array(Vec::new())));
    // Residuals of 1 cm are no draw of noise of half a centimetre.
    let small = calibrate(directory.path(), &file, &["--sigma", "0.005"]);
    assert!(warned(&small, "as large as the given standard deviation"), "{}", small["warnings"]);
}

#[test]
fn a_road_that_nobody_hears_whole_is_found() {
    let words = "--receivers 16 --transmitters 90 --layout 320x50 --shape chain --hearing 8 --noise 0.1 --seed 3";
    let (directory, file) = simulated(words);
    let found = calibrate(directory.path(), &file, &[]);
    assert_eq!(found["unique"], Value::Bool(true), "{}", found["warnings"]);
    assert!(found["truth"]["receiver_rms"].as_f64().expect("number") < 3.0, "{}", found["truth"]);
}
