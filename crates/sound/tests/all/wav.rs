//! WAV files as recorders write them, well and badly.

use sound::{ReadError, Recording};

use crate::bytes::{chunk, extensible, format, open, refusal, riff, samples, stream, wav};

/// Two channels of 16 bits with these samples of both.
fn stereo(frames: &[[i16; 2]]) -> Vec<u8> {
    frames.iter().flatten().flat_map(|sample| sample.to_le_bytes()).collect()
}

const STEREO: [[i16; 2]; 3] = [[0x4000, -0x4000], [0x2000, -0x8000], [0, 1]];

fn planar() -> [[f32; 3]; 2] {
    [[0.5, 0.25, 0.0], [-0.5, -1.0, 1.0 / 32768.0]]
}

#[test]
fn every_encoding_is_read() {
    // Each has 0.5, -1, 0 and the least amount.
    for (encoding, bytes, least) in [
        (format(1, 1, 48000, 8), vec![192, 0, 128, 129], 2.0_f32.powi(-7)),
        (format(1, 1, 48000, 16), vec![0, 0x40, 0, 0x80, 0, 0, 1, 0], 2.0_f32.powi(-15)),
        (format(1, 1, 48000, 24), vec![0, 0, 0x40, 0, 0, 0x80, 0, 0, 0, 1, 0, 0], 2.0_f32.powi(-23)),
        (format(1, 1, 48000, 32), vec![0, 0, 0, 0x40, 0, 0, 0, 0x80, 0, 0, 0, 0, 1, 0, 0, 0], 2.0_f32.powi(-31)),
        (
            format(3, 1, 48000, 32),
            [0.5_f32, -1.0, 0.0, 1e-9].iter().flat_map(|sample| sample.to_le_bytes()).collect(),
            1e-9,
        ),
        (
            format(3, 1, 48000, 64),
            [0.5_f64, -1.0, 0.0, 0.125].iter().flat_map(|sample| sample.to_le_bytes()).collect(),
            0.125,
        ),
        (extensible(1, 1, 48000, 24, 20), vec![0, 0, 0x40, 0, 0, 0x80, 0, 0, 0, 0x10, 0, 0], 2.0_f32.powi(-19)),
    ] {
        let file = wav(&encoding, &bytes);
        assert_eq!(samples(&file), [[0.5, -1.0, 0.0, least]], "{encoding:?}");
        let recording = open(&file).unwrap();
        assert_eq!((recording.channels(), recording.sample_rate(), recording.frames()), (1, 48000, Some(4)));
        assert!(!recording.is_truncated());
    }
}

#[test]
fn full_scale_is_that_of_the_bits_that_count() {
    let scale = |format: &[u8]| open(&wav(format, &[])).unwrap().full_scale();
    assert_eq!(scale(&format(1, 2, 48000, 16)), 32767.0 / 32768.0);
    assert_eq!(scale(&extensible(1, 2, 48000, 24, 20)), 524_287.0 / 524_288.0);
    assert_eq!(scale(&format(3, 2, 48000, 32)), 1.0);
}

#[test]
fn blocks_have_the_length_that_is_asked_for() {
    let file = wav(&format(1, 2, 44100, 16), &stereo(&[[1, 2]; 10]));
    let mut recording = open(&file).unwrap();
    let mut block = vec![vec![9.0]; 5];
    let lengths: Vec<usize> = (0..5).map(|_| recording.read_block(4, &mut block).unwrap()).collect();
    assert_eq!(lengths, [4, 4, 2, 0, 0]);
    assert_eq!(block, [[0.0; 0]; 2]);
    assert_eq!(open(&file).unwrap().read_block(usize::MAX, &mut block).unwrap(), 10);
    assert_eq!(open(&file).unwrap().read_block(0, &mut block).unwrap(), 0);
}

#[test]
fn long_recordings_are_read_in_pieces() {
    // More than is read at a time, and no divisor of it.
    let frames: Vec<[i16; 3]> = (0..100_001).map(|k| [k as i16, (k >> 8) as i16, 7]).collect();
    let bytes: Vec<u8> = frames.iter().flatten().flat_map(|sample| sample.to_le_bytes()).collect();
    let all = samples(&wav(&format(1, 3, 96000, 16), &bytes));
    for (k, frame) in frames.iter().enumerate() {
        assert_eq!([all[0][k], all[1][k], all[2][k]], frame.map(|sample| f32::from(sample) / 32768.0));
    }
}

#[test]
fn other_chunks_and_odd_sizes_are_passed() {
    let (format, data) = (chunk(b"fmt ", &format(1, 2, 48000, 16)), chunk(b"data", &stereo(&STEREO)));
    let text = chunk(b"bext", b"odd");
    assert_eq!(samples(&riff(&[text.clone(), format.clone(), text.clone(), data.clone(), text.clone()])), planar());
    // Without the byte that makes the size even.
    let short = text[..text.len() - 1].to_vec();
    assert_eq!(samples(&riff(&[format, short, data])), planar());
}

/// A file whose sizes of the whole and of the samples are as given.
fn sized(whole: u32, size: u32, samples: &[u8]) -> Vec<u8> {
    let mut bytes = wav(&format(1, 2, 48000, 16), samples);
    bytes[4..8].copy_from_slice(&whole.to_le_bytes());
    bytes[40..44].copy_from_slice(&size.to_le_bytes());
    bytes
}

#[test]
fn recorders_that_stream_do_not_know_the_size() {
    // 36 is the size of a file without samples. 0x7ffff000 is written by SoX.
    for (whole, size) in [(0, 0), (36, 0), (u32::MAX, u32::MAX), (u32::MAX, 0), (0x7fff_ffff, 0), (0, u32::MAX)] {
        let file = sized(whole, size, &stereo(&STEREO));
        let mut recording = open(&file).unwrap();
        assert_eq!(recording.frames(), Some(3));
        assert_eq!(recording.read_to_end().unwrap(), planar());
        assert!(!recording.is_truncated());
    }
    let mut recording = open(&sized(0x7fff_f024, 0x7fff_f000, &stereo(&STEREO))).unwrap();
    assert_eq!((recording.frames(), recording.is_truncated()), (Some(3), false));
    assert_eq!(recording.read_to_end().unwrap(), planar());
    // Of streams nothing else is known.
    let mut recording = stream(&sized(u32::MAX, u32::MAX, &stereo(&STEREO))).unwrap();
    assert_eq!(recording.frames(), None);
    assert_eq!(recording.read_to_end().unwrap(), planar());
    assert!(!recording.is_truncated());
}

#[test]
fn a_recording_may_have_no_samples() {
    let empty = riff(&[chunk(b"fmt ", &format(1, 2, 48000, 16)), chunk(b"data", &[]), chunk(b"LIST", b"text")]);
    assert_eq!(samples(&empty), [[0.0; 0]; 2]);
    assert_eq!(open(&empty).unwrap().frames(), Some(0));
}

#[test]
fn what_is_there_of_a_truncated_file_is_read() {
    let file = wav(&format(1, 2, 48000, 16), &stereo(&STEREO));
    // The last sample is cut off in the middle.
    let cut = &file[..file.len() - 1];
    let mut recording = open(cut).unwrap();
    assert_eq!((recording.frames(), recording.is_truncated()), (Some(2), true));
    assert_eq!(recording.read_to_end().unwrap(), [[0.5, 0.25], [-0.5, -1.0]]);
    let mut recording = stream(cut).unwrap();
    assert_eq!((recording.frames(), recording.is_truncated()), (Some(3), false));
    assert_eq!(recording.read_to_end().unwrap(), [[0.5, 0.25], [-0.5, -1.0]]);
    assert!(recording.is_truncated());
}

#[test]
fn sizes_of_64_bits() {
    for name in [b"RF64", b"BW64"] {
        for said in [12_u64, 0, u64::MAX] {
            let sizes = [0_u64.to_le_bytes(), said.to_le_bytes(), 3_u64.to_le_bytes(), [0; 8]].concat();
            let chunks = [
                chunk(b"ds64", &sizes[..28]),
                chunk(b"fmt ", &format(1, 2, 48000, 16)),
                chunk(b"data", &stereo(&STEREO)),
            ];
            let mut file = riff(&chunks);
            file[..4].copy_from_slice(name);
            file[4..8].copy_from_slice(&u32::MAX.to_le_bytes());
            let at = file.len() - 16;
            file[at..at + 4].copy_from_slice(&u32::MAX.to_le_bytes());
            assert_eq!(samples(&file), planar());
            // What follows the samples is none of them if their size is known.
            file.extend(chunk(b"LIST", b"text"));
            assert_eq!(samples(&file)[0].len(), if said == 12 { 3 } else { 6 });
        }
    }
}

#[test]
fn sizes_that_did_not_fit_their_32_bits() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.wav");
    // 400 bytes are said, and 4 GB more are there: nothing but a hole, which takes no space.
    std::fs::write(&path, sized(436, 400, &[])).unwrap();
    let file = std::fs::File::options().write(true).open(&path).unwrap();
    file.set_len(44 + (1 << 32) + 400).unwrap();
    let recording = Recording::open(&path).unwrap();
    assert_eq!((recording.frames(), recording.is_truncated()), (Some((1 << 30) + 100), false));
}

#[test]
fn numbers_that_are_none_become_zero() {
    let bytes: Vec<u8> = [1.0_f32, f32::NAN, f32::INFINITY, 0.5, f32::NEG_INFINITY, -2.0]
        .iter()
        .flat_map(|sample| sample.to_le_bytes())
        .collect();
    let mut recording = open(&wav(&format(3, 2, 48000, 32), &bytes)).unwrap();
    assert_eq!(recording.read_to_end().unwrap(), [[1.0, 0.0, 0.0], [0.0, 0.5, -2.0]]);
    assert_eq!(recording.non_finite(), [2, 1]);
}

#[test]
fn what_cannot_be_read_is_said() {
    let pcm = |channels, rate, bits| wav(&format(1, channels, rate, bits), &[0; 8]);
    let mut align = format(1, 2, 48000, 16);
    align[12] = 5;
    let mut unnamed = extensible(1, 2, 48000, 16, 16);
    unnamed[30] = 1;
    let good = wav(&format(1, 2, 48000, 16), &[0; 8]);
    for (file, said) in [
        (vec![], "empty"),
        (b"0.1,0.2\n".to_vec(), "is text"),
        (b"RIFF".to_vec(), "cut off"),
        (chunk(b"RIFF", b"AVI LIST"), "no sound"),
        (good[..16].to_vec(), "before the format"),
        (good[..30].to_vec(), "ends in the format"),
        (good[..36].to_vec(), "before its samples"),
        (good[..40].to_vec(), "before its samples"),
        (riff(&[chunk(b"data", &[0; 4])]), "no format"),
        (wav(&[1, 0, 2, 0], &[]), "too short"),
        (wav(&extensible(1, 2, 48000, 16, 16)[..20], &[]), "too short"),
        (wav(&unnamed, &[]), "WAVE_FORMAT_EXTENSIBLE"),
        (wav(&align, &[]), "take 5 bytes, not 4"),
        (pcm(0, 48000, 16), "no channels"),
        (pcm(65535, 48000, 16), "65535 channels"),
        (pcm(2, 0, 16), "rate is 0 Hz"),
        (pcm(2, u32::MAX, 16), "rate is 4294967295 Hz"),
        (pcm(2, 48000, 0), "0 bits"),
        (pcm(2, 48000, 64), "integers of 64 bits"),
        (wav(&format(3, 1, 48000, 16), &[]), "floats of 16 bits"),
        (wav(&format(6, 1, 8000, 8), &[]), "A-law"),
        (wav(&format(7, 1, 8000, 8), &[]), "mu-law"),
        (wav(&format(2, 1, 8000, 4), &[]), "Microsoft ADPCM"),
        (wav(&format(0x11, 1, 8000, 4), &[]), "IMA ADPCM"),
        (wav(&extensible(6, 1, 8000, 8, 8), &[]), "A-law"),
        (wav(&format(0x1234, 1, 8000, 8), &[]), "0x1234"),
    ] {
        let refusal = refusal(&file);
        assert!(refusal.contains(said), "{refusal}");
    }
}

#[test]
fn paths_that_lead_nowhere() {
    let folder = tempfile::tempdir().unwrap();
    assert!(matches!(Recording::open(folder.path()), Err(ReadError::Directory { .. })));
    assert!(matches!(Recording::open(folder.path().join("none.wav")), Err(ReadError::Io { .. })));
    assert!(Recording::open_all([folder.path()]).is_err());
}
