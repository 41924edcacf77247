//! FLAC as the program flac writes it, and made by hand.

use sound::{ReadError, Recording};

use crate::bytes::{open, stream};

pub(crate) const WAVES_16: &[u8] = include_bytes!("../data/waves16.flac");
pub(crate) const WAVES_24: &[u8] = include_bytes!("../data/waves24.flac");

/// Sample `k` of a channel in tests/data, where the waves have this height.
fn wave(k: i32, channel: i32, height: i32) -> i32 {
    let x = k % 200;
    height * (3 * (x * (200 - x)) - 15000 + k * k * 7 % 11) - channel * (k % 7)
}

fn waves(count: i32, height: i32, bits: i32) -> Vec<Vec<f32>> {
    let sample = |k, channel| wave(k, channel, height) as f32 / 2.0_f32.powi(bits - 1);
    (0..2).map(|channel| (0..count).map(|k| sample(k, channel)).collect()).collect()
}

#[test]
fn files_of_the_program_flac() {
    for (bytes, height, bits) in [(WAVES_16, 1, 16), (WAVES_24, 200, 24)] {
        let mut recording = open(bytes).unwrap();
        assert_eq!((recording.channels(), recording.sample_rate(), recording.frames()), (2, 48000, Some(2000)));
        assert_eq!(recording.full_scale(), 1.0 - 2.0_f32.powi(1 - bits));
        assert_eq!(recording.read_to_end().unwrap(), waves(2000, height, bits));
        assert!(!recording.is_truncated());
    }
}

#[test]
fn blocks_need_not_be_those_of_the_file() {
    let (mut recording, mut block, mut all) = (open(WAVES_16).unwrap(), Vec::new(), vec![Vec::<f32>::new(); 2]);
    while recording.read_block(333, &mut block).unwrap() > 0 {
        for (all, channel) in all.iter_mut().zip(&block) {
            all.extend(channel);
        }
    }
    assert_eq!(all, waves(2000, 1, 16));
}

#[test]
fn tags_before_and_after_are_left_out() {
    let tag = [b"ID3\x04\0\0\0\0\x01\x02".to_vec(), vec![0; 130]].concat();
    let after = [b"TAG".to_vec(), vec![b' '; 125]].concat();
    let file = [tag, WAVES_16.to_vec(), after].concat();
    assert_eq!(stream(&file).unwrap().read_to_end().unwrap(), waves(2000, 1, 16));
}

#[test]
fn what_is_there_of_a_truncated_file_is_read() {
    let mut recording = open(&WAVES_16[..WAVES_16.len() - 10]).unwrap();
    // Of four blocks of 576 samples, the last one is missing.
    assert_eq!(recording.read_to_end().unwrap(), waves(3 * 576, 1, 16));
    assert!(recording.is_truncated());
}

#[test]
fn samples_before_damage_are_read() {
    let mut bytes = WAVES_16.to_vec();
    let last = bytes.len() - 10;
    bytes[last] ^= 0x55;
    let (mut recording, mut block) = (open(&bytes).unwrap(), Vec::new());
    assert_eq!(recording.read_block(5000, &mut block).unwrap(), 3 * 576);
    assert_eq!(block, waves(3 * 576, 1, 16));
    // It is no end, however often one asks.
    for _ in 0..3 {
        let error = recording.read_block(5000, &mut block).unwrap_err();
        // 1728 samples at 48 kHz are 36 ms.
        assert!(matches!(error, ReadError::Damaged { .. }) && error.to_string().contains("0.036 s"), "{error}");
    }
}

#[test]
fn headers_that_cannot_be() {
    let said = |bytes: &[u8]| open(bytes).map(|_| ()).unwrap_err().to_string();
    assert!(said(b"fLaC").contains("cut off"));
    assert!(said(&WAVES_16[..20]).contains("cut off"));
    assert!(said(b"fLaC\x81\0\0\0").contains("first block"));
    // The sample rate has 20 bits from byte 18 on.
    let mut bytes = WAVES_16.to_vec();
    bytes[18..20].fill(0);
    bytes[20] &= 0x0f;
    assert!(said(&bytes).contains("a.wav"));
}

/// Cyclic redundancy checks of FLAC: this polynomial, of 8 or 16 bits.
fn checksum(bytes: &[u8], polynomial: u32, bits: u32) -> u32 {
    let step = |sum: u32| if sum >> (bits - 1) & 1 == 1 { sum << 1 ^ polynomial } else { sum << 1 };
    let byte = |sum: u32, &byte: &u8| (0..8).fold(sum ^ u32::from(byte) << (bits - 8), |sum, _| step(sum));
    bytes.iter().fold(0, byte) & ((1 << bits) - 1)
}

/// A file of one channel of 16 bits at 8 kHz with one block of 16 samples, whose content is given.
pub(crate) fn by_hand(content: &[u8]) -> Vec<u8> {
    // Blocks of 16 samples; 8000 Hz (20 bits), 1 channel (3 bits less 1), 16 bits (5 bits less 1), 16 samples.
    let mut bytes = b"fLaC\x80\0\0\x22\0\x10\0\x10\0\0\0\0\0\0\x01\xf4\x00\xf0\0\0\0\x10".to_vec();
    bytes.extend([0; 16]);
    // Size of the block in the next byte but one, 8 kHz; one channel, 16 bits; block 0; 16 - 1 samples.
    let mut frame = vec![0xff, 0xf8, 0x64, 0x08, 0, 15];
    frame.push(checksum(&frame, 0x07, 8) as u8);
    frame.extend(content);
    let sum = checksum(&frame, 0x8005, 16) as u16;
    frame.extend(sum.to_be_bytes());
    [bytes, frame].concat()
}

#[test]
fn constant_and_verbatim_blocks_by_hand() {
    let constant = by_hand(&[0, 0x40, 0]);
    assert_eq!(stream(&constant).unwrap().read_to_end().unwrap(), [[0.5; 16]]);
    let verbatim: Vec<u8> = std::iter::once(2).chain((0..16).flat_map(|k| [k * 8, 0])).collect();
    let ramp: Vec<f32> = (0..16).map(|k| k as f32 / 16.0).collect();
    let mut recording: Recording = stream(&by_hand(&verbatim)).unwrap();
    assert_eq!((recording.sample_rate(), recording.frames()), (8000, Some(16)));
    assert_eq!(recording.read_to_end().unwrap(), [ramp]);
}

#[test]
fn what_cannot_be_decoded_is_no_damage() {
    // Bits less one are five bits from the last one of byte 20 on.
    for (bits, bytes) in [(32, [0x01, 0xf0]), (18, [0x01, 0x10])] {
        let mut file = by_hand(&[0, 0x40, 0]);
        file[20..22].copy_from_slice(&bytes);
        let error = open(&file).map(|_| ()).unwrap_err();
        let said = error.to_string();
        assert!(matches!(error, ReadError::Encoding { .. }) && said.contains("ffmpeg"), "{said}");
        assert!(said.contains(&format!("FLAC of {bits} bits;")), "{said}");
    }
    // A predictor of order 0, and what is left of it: coding method 0, one partition, the escape code for numbers as they
    // are, of 8 bits each, and these: 16 zeros.
    let escaped = [&[0b0001_0000, 0b0000_0011, 0b1101_0000][..], &[0; 16]].concat();
    let (mut recording, mut block) = (open(&by_hand(&escaped)).unwrap(), Vec::new());
    for _ in 0..2 {
        let error = recording.read_block(16, &mut block).unwrap_err();
        assert!(matches!(error, ReadError::Encoding { .. }), "{error}");
    }
}
