//! Bytes to samples: numbers of any width, least byte first, the channels in turn.

/// How the bytes of a sample are a number. Integers fill their bytes from the top.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Decoder {
    /// Unsigned, unlike the others: 128 is zero.
    Integer8,
    Integer16,
    Integer24,
    Integer32,
    Float32,
    Float64,
}

impl Decoder {
    /// Bytes of a sample of one channel.
    pub(super) fn bytes(self) -> usize {
        match self {
            Decoder::Integer8 => 1,
            Decoder::Integer16 => 2,
            Decoder::Integer24 => 3,
            Decoder::Integer32 | Decoder::Float32 => 4,
            Decoder::Float64 => 8,
        }
    }

    /// Appends the samples of these bytes to the channels.
    pub(super) fn decode(self, bytes: &[u8], channels: &mut [Vec<f32>]) {
        match self {
            Decoder::Integer8 => each(bytes, channels, |[b]: [u8; 1]| (f32::from(b) - 128.0) / 128.0),
            Decoder::Integer16 => each(bytes, channels, |b| f32::from(i16::from_le_bytes(b)) / 32768.0),
            // In the upper three bytes of four, the sign is where it belongs.
            Decoder::Integer24 => each(bytes, channels, |[a, b, c]| integer(i32::from_le_bytes([0, a, b, c]))),
            Decoder::Integer32 => each(bytes, channels, |b| integer(i32::from_le_bytes(b))),
            Decoder::Float32 => each(bytes, channels, f32::from_le_bytes),
            Decoder::Float64 => each(bytes, channels, |b| f64::from_le_bytes(b) as f32),
        }
    }
}

fn integer(value: i32) -> f32 {
    value as f32 / 2_147_483_648.0
}

fn each<const N: usize>(bytes: &[u8], channels: &mut [Vec<f32>], sample: impl Fn([u8; N]) -> f32) {
    let (samples, _) = bytes.as_chunks::<N>();
    for frame in samples.chunks_exact(channels.len().max(1)) {
        for (channel, &bytes) in channels.iter_mut().zip(frame) {
            channel.push(sample(bytes));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(decoder: Decoder, bytes: &[u8]) -> Vec<Vec<f32>> {
        let mut channels = vec![Vec::new(); 2];
        decoder.decode(bytes, &mut channels);
        channels
    }

    #[test]
    fn numbers_of_every_width() {
        assert_eq!(decoded(Decoder::Integer8, &[128, 0, 255, 192]), [[0.0, 127.0 / 128.0], [-1.0, 0.5]]);
        assert_eq!(
            decoded(Decoder::Integer16, &[0, 0x40, 0, 0x80, 1, 0, 0xff, 0xff]),
            [[0.5, 1.0 / 32768.0], [-1.0, -1.0 / 32768.0]]
        );
        assert_eq!(decoded(Decoder::Integer24, &[0, 0, 0x40, 0, 0, 0x80]), [[0.5], [-1.0]]);
        assert_eq!(
            decoded(Decoder::Integer24, &[1, 0, 0, 0xff, 0xff, 0xff]),
            [[1.0 / 8_388_608.0], [-1.0 / 8_388_608.0]]
        );
        assert_eq!(decoded(Decoder::Integer32, &[0, 0, 0, 0x20, 0, 0, 0, 0xc0]), [[0.25], [-0.5]]);
        // 0.1 is no single; 1.5 is 0x3fc00000.
        assert_eq!(decoded(Decoder::Float32, &[0, 0, 0xc0, 0x3f, 0, 0, 0xc0, 0xbf]), [[1.5], [-1.5]]);
        assert_eq!(decoded(Decoder::Float64, &[0.1_f64.to_le_bytes(), 2.0_f64.to_le_bytes()].concat()), [[0.1], [2.0]]);
    }
}
