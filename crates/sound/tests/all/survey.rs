//! Surveys of recordings whose content is known.

use std::path::PathBuf;

use sound::survey;

use crate::bytes::{format, wav};

fn written(folder: &tempfile::TempDir, name: &str, rate: u32, channels: &[&[f32]]) -> PathBuf {
    let frames = channels[0].len();
    let samples = (0..frames).flat_map(|k| channels.iter().map(move |channel| channel[k]));
    let bytes: Vec<u8> = samples.flat_map(f32::to_le_bytes).collect();
    let path = folder.path().join(name);
    std::fs::write(&path, wav(&format(3, channels.len() as u16, rate, 32), &bytes)).unwrap();
    path
}

#[test]
fn what_is_in_each_channel() {
    let folder = tempfile::tempdir().unwrap();
    let square = [0.5, -0.5, 0.5, -0.5];
    let a = written(&folder, "a.wav", 4, &[&square, &[0.25; 4], &[1.0, 1.0, f32::NAN, 0.0]]);
    let b = written(&folder, "b.wav", 4, &[&[0.0; 4], &square]);
    // The same samples at another rate are another signal.
    let c = written(&folder, "c.wav", 8, &[&square]);
    let all = survey([&a, &b, &c]).unwrap();
    let file = |path: &PathBuf| path.display().to_string();
    let names: Vec<(String, usize)> = all.iter().map(|channel| (channel.file.clone(), channel.channel)).collect();
    assert_eq!(names, [(file(&a), 1), (file(&a), 2), (file(&a), 3), (file(&b), 1), (file(&b), 2), (file(&c), 1)]);
    assert_eq!(all.iter().map(|channel| channel.seconds).collect::<Vec<_>>(), [1.0, 1.0, 1.0, 1.0, 1.0, 0.5]);
    assert_eq!(all.iter().map(|channel| channel.peak).collect::<Vec<_>>(), [0.5, 0.25, 1.0, 0.0, 0.5, 0.5]);
    // Of two samples of 1 among four, the mean square is one half.
    assert_eq!(all.iter().map(|channel| channel.rms).collect::<Vec<_>>(), [0.5, 0.25, 0.5_f64.sqrt(), 0.0, 0.5, 0.5]);
    assert_eq!(all.iter().map(|channel| channel.clipped).collect::<Vec<_>>(), [0.0, 0.0, 0.5, 0.0, 0.0, 0.0]);
    assert_eq!(all.iter().map(|channel| channel.non_finite).collect::<Vec<_>>(), [0, 0, 1, 0, 0, 0]);
    let constant: Vec<bool> = all.iter().map(|channel| channel.is_constant).collect();
    assert_eq!(constant, [false, true, false, true, false, false]);
    for (k, channel) in all.iter().enumerate() {
        let same = channel.same_as.as_ref().map(|name| (name.file.clone(), name.channel));
        assert_eq!(same, (k == 4).then(|| (file(&a), 1)));
    }
}

#[test]
fn it_is_written_as_json() {
    let folder = tempfile::tempdir().unwrap();
    let path = written(&folder, "a.wav", 4, &[&[0.5, -0.5], &[0.5, -0.5]]);
    let json = serde_json::to_value(survey([&path]).unwrap()).unwrap();
    let file = path.display().to_string();
    assert_eq!(
        json[1],
        serde_json::json!({
            "file": file, "channel": 2, "sample_rate": 4, "seconds": 0.5, "peak": 0.5, "rms": 0.5, "clipped": 0.0,
            "non_finite": 0, "is_constant": false, "same_as": {"file": file, "channel": 1}, "is_truncated": false
        })
    );
}

#[test]
fn a_file_that_is_cut_off_is_said_to_be() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.wav");
    let file = wav(&format(1, 1, 8000, 16), &[1, 0, 2, 0, 3, 0]);
    std::fs::write(&path, &file[..file.len() - 2]).unwrap();
    let all = survey([&path]).unwrap();
    assert!(all[0].is_truncated);
    assert_eq!(all[0].seconds, 2.0 / 8000.0);
}
