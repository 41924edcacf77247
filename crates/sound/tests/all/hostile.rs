//! Whatever the bytes are, they are read or refused: no panic, and no memory for what is not there.

use proptest::collection::vec;
use proptest::prelude::*;

use crate::bytes::{chunk, extensible, format, riff, stream, wav};
use crate::flac::{WAVES_16, WAVES_24, by_hand};

/// Reads all of it, block by block, as a user with little memory would.
fn read(bytes: &[u8]) {
    let mut most = 0;
    let counted = allocation_counter::measure(|| {
        let Ok(mut recording) = stream(bytes) else { return };
        let mut block = Vec::new();
        while let Ok(count) = recording.read_block(500, &mut block) {
            assert!(block.len() == recording.channels() && block.iter().all(|channel| channel.len() == count));
            assert!(block.iter().flatten().all(|sample| sample.is_finite()));
            most = most.max(count);
            if count == 0 {
                break;
            }
        }
    });
    assert!(most <= 500);
    // A FLAC block has at most 65,535 samples of 8 channels, 2 MB; of a WAV file with 1024 channels, 500 samples are
    // as much. Memory that grows is there twice for a moment.
    assert!(counted.bytes_max < 10_000_000, "{} bytes", counted.bytes_max);
}

/// Valid files, short ones: bytes that are changed are bytes that matter.
fn files() -> Vec<Vec<u8>> {
    let samples: Vec<u8> = (0..48).collect();
    let mut long = riff(&[chunk(b"ds64", &[1; 28]), chunk(b"fmt ", &format(1, 1, 8000, 16)), chunk(b"data", &samples)]);
    long[..4].copy_from_slice(b"RF64");
    vec![
        wav(&format(1, 2, 48000, 16), &samples),
        wav(&format(1, 1, 48000, 24), &samples),
        wav(&format(3, 2, 48000, 32), &samples),
        wav(&format(1, 3, 48000, 8), &samples),
        wav(&extensible(3, 1, 48000, 64, 64), &samples),
        riff(&[chunk(b"LIST", b"odd"), chunk(b"fmt ", &format(1, 1, 8000, 32)), chunk(b"data", &samples)]),
        long,
        WAVES_16.to_vec(),
        WAVES_24.to_vec(),
        by_hand(&[0, 0x40, 0]),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes(bytes in vec(any::<u8>(), 0..300), head in 0..6_usize) {
        let heads: [&[u8]; 6] = [b"", b"RIFF\x24\0\0\0WAVEfmt \x10\0\0\0", b"RIFF____WAVE", b"fLaC", b"ID3", b"RF64____WAVEds64"];
        read(&[heads[head], &bytes].concat());
    }

    #[test]
    fn random_truncations(file in 0..10_usize, share in 0.0..1.0_f64) {
        let bytes = &files()[file];
        read(&bytes[..(share * bytes.len() as f64) as usize]);
    }

    #[test]
    fn random_changes(file in 0..10_usize, changes in vec((0.0..1.0_f64, any::<u8>()), 1..8), in_header in any::<bool>()) {
        let mut bytes = files().swap_remove(file);
        let range = if in_header { bytes.len().min(60) } else { bytes.len() };
        for (place, byte) in changes {
            bytes[(place * range as f64) as usize] = byte;
        }
        read(&bytes);
    }

    /// Checksums are right, so that what stands in the block is believed.
    #[test]
    fn random_flac_blocks(kind in 0..64_u8, bytes in vec(any::<u8>(), 0..120)) {
        read(&by_hand(&[&[kind << 1], &*bytes].concat()));
    }
}

#[test]
fn every_truncation() {
    for file in files() {
        for length in 0..file.len().min(400) {
            read(&file[..length]);
        }
    }
}
