//! What is written can be read again.

use std::path::PathBuf;

use sound::{Recording, SampleFormat, WriteError, write_wav};

fn at(folder: &tempfile::TempDir) -> PathBuf {
    folder.path().join("a.wav")
}

#[test]
fn samples_are_read_as_they_were_written() {
    let folder = tempfile::tempdir().unwrap();
    // Multiples of 1/32768 are there in every format; three channels of three samples of 24 bits are odd.
    let channels = [[0.5_f32, -1.0, 1.0 / 32768.0], [0.0, 0.25, -0.75], [0.125, -0.125, 32767.0 / 32768.0]];
    for format in [SampleFormat::Int16, SampleFormat::Int24, SampleFormat::Float32] {
        write_wav(at(&folder), 44100, &channels, format).unwrap();
        let mut recording = Recording::open(at(&folder)).unwrap();
        assert_eq!((recording.sample_rate(), recording.frames()), (44100, Some(3)));
        assert_eq!(recording.read_to_end().unwrap(), channels);
        assert!(!recording.is_truncated());
        // The size of the file, which other programs believe.
        let bytes = std::fs::read(at(&folder)).unwrap();
        assert_eq!(u32::from_le_bytes(bytes[4..8].try_into().unwrap()) as usize, bytes.len() - 8);
    }
}

#[test]
fn integers_end_at_full_scale() {
    let folder = tempfile::tempdir().unwrap();
    let samples = [2.0_f32, -2.0, f32::NAN, f32::INFINITY, 0.6 / 32768.0];
    write_wav(at(&folder), 8000, &[samples], SampleFormat::Int16).unwrap();
    let read = Recording::open(at(&folder)).unwrap().read_to_end().unwrap();
    assert_eq!(read, [[32767.0 / 32768.0, -1.0, 0.0, 32767.0 / 32768.0, 1.0 / 32768.0]]);
    write_wav(at(&folder), 8000, &[samples], SampleFormat::Float32).unwrap();
    assert_eq!(Recording::open(at(&folder)).unwrap().read_to_end().unwrap()[0][..2], [2.0, -2.0]);
}

#[test]
fn what_cannot_be_written_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let write = |rate, channels: &[Vec<f32>]| write_wav(at(&folder), rate, channels, SampleFormat::Int16).unwrap_err();
    assert!(matches!(write(8000, &[]), WriteError::Format { .. }));
    assert!(matches!(write(0, &[vec![0.0]]), WriteError::Format { .. }));
    assert!(matches!(write(8000, &[vec![0.0], vec![]]), WriteError::Lengths { channel: 2, .. }));
    let nowhere = write_wav(folder.path(), 8000, &[[0.0]], SampleFormat::Int16);
    assert!(matches!(nowhere, Err(WriteError::Io { .. })));
}
