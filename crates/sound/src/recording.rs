//! Recordings, read block by block.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::error::ReadError;
use crate::flac::Flac;
use crate::format::Format;
use crate::input::Input;
use crate::kind::{Kind, kind};
use crate::monitor::ListenMonitor;
use crate::wav::Wav;

/// Samples of each channel that are read at a time where all are read.
pub(crate) const BLOCK: usize = 1 << 14;

/// A recording that is being read, from its beginning to its end: WAV (also RF64 and BW64) with integers of 8 to 32
/// bits or floats, or FLAC of 8, 12, 16, 20 or 24 bits. Its content says which, not its name.
pub struct Recording {
    source: Source,
    /// Of each channel, samples that were no numbers.
    non_finite: Vec<u64>,
    /// Who is told what is read, and may stop it.
    monitor: ListenMonitor,
}

enum Source {
    Wav(Box<Wav>),
    Flac(Box<Flac>),
}

impl Recording {
    /// Opens a recording and reads its header.
    ///
    /// # Errors
    /// If the file cannot be read, is no recording, or is one of a kind that is not read.
    pub fn open(path: impl AsRef<Path>) -> Result<Recording, ReadError> {
        let path = path.as_ref();
        let file = path.display().to_string();
        let io = |source| ReadError::Io { file: path.display().to_string(), source };
        let opened = File::open(path).map_err(io)?;
        let metadata = opened.metadata().map_err(io)?;
        if metadata.is_dir() {
            return Err(ReadError::Directory { file });
        }
        // Pipes and devices do not know how long they are.
        let length = metadata.is_file().then_some(metadata.len());
        Recording::new(Input::new(file, Box::new(opened), length))
    }

    /// Opens several recordings, in their order.
    ///
    /// # Errors
    /// Those of [`Recording::open`], for the first that has one.
    pub fn open_all<P: AsRef<Path>>(paths: impl IntoIterator<Item = P>) -> Result<Vec<Recording>, ReadError> {
        paths.into_iter().map(Recording::open).collect()
    }

    /// A recording from bytes that come in order, such as standard input; `name` stands for it in messages.
    ///
    /// # Errors
    /// If the bytes cannot be read, are no recording, or are one of a kind that is not read.
    ///
    /// ```
    /// // One channel of 16 bits at 8 kHz, from a program that did not know how long it would become.
    /// let mut bytes = b"RIFF\xff\xff\xff\xffWAVEfmt \x10\0\0\0\x01\0\x01\0\x40\x1f\0\0\x80\x3e\0\0\x02\0\x10\0".to_vec();
    /// bytes.extend(b"data\xff\xff\xff\xff\0\x40\0\xc0");
    /// let mut recording = sound::Recording::from_reader("stream", std::io::Cursor::new(bytes))?;
    /// assert_eq!((recording.channels(), recording.sample_rate(), recording.frames()), (1, 8000, None));
    /// let mut block = Vec::new();
    /// assert_eq!(recording.read_block(100, &mut block)?, 2);
    /// assert_eq!(block, [[0.5, -0.5]]);
    /// # Ok::<(), sound::ReadError>(())
    /// ```
    pub fn from_reader(name: &str, reader: impl Read + Send + 'static) -> Result<Recording, ReadError> {
        Recording::new(Input::new(name.to_owned(), Box::new(reader), None))
    }

    fn new(mut input: Input) -> Result<Recording, ReadError> {
        let source = match kind(&mut input)? {
            Kind::Wav => Source::Wav(Box::new(Wav::new(input)?)),
            Kind::Flac => Source::Flac(Box::new(Flac::new(input)?)),
        };
        let mut recording = Recording { source, non_finite: Vec::new(), monitor: ListenMonitor::default() };
        recording.non_finite = vec![0; recording.channels()];
        Ok(recording)
    }

    /// Reading is watched from now on. It ends with [`ReadError::Stopped`] once the monitor stops it.
    pub(crate) fn watch(&mut self, monitor: &ListenMonitor) {
        self.monitor = monitor.clone();
    }

    /// Path of the file, as text, or the name that was given.
    pub fn file(&self) -> &str {
        match &self.source {
            Source::Wav(wav) => wav.file(),
            Source::Flac(flac) => flac.file(),
        }
    }

    fn format(&self) -> &Format {
        match &self.source {
            Source::Wav(wav) => &wav.format,
            Source::Flac(flac) => &flac.format,
        }
    }

    /// Samples per second of each channel, Hz: 1 to [`MAX_SAMPLE_RATE`](crate::MAX_SAMPLE_RATE).
    pub fn sample_rate(&self) -> u32 {
        self.format().sample_rate
    }

    /// Number of channels: 1 to [`MAX_CHANNELS`](crate::MAX_CHANNELS).
    pub fn channels(&self) -> usize {
        self.format().channels
    }

    /// Number of samples of each channel; `None` if it is not known before all are read. Of FLAC it is what the header
    /// says: [`is_truncated`](Recording::is_truncated) at the end if there are fewer.
    pub fn frames(&self) -> Option<u64> {
        self.format().frames
    }

    /// The amount from which on a sample may stand for a greater one: the greatest integer as a share of the range, 1
    /// for floats.
    pub fn full_scale(&self) -> f32 {
        self.format().full_scale
    }

    /// Whether the file has ended before its samples did. Of WAV files it is known from the beginning, of others at
    /// the end.
    pub fn is_truncated(&self) -> bool {
        match &self.source {
            Source::Wav(wav) => wav.is_truncated,
            Source::Flac(flac) => flac.is_truncated,
        }
    }

    /// Of each channel, the number of samples so far that were infinite or no numbers. They are read as 0.
    pub fn non_finite(&self) -> &[u64] {
        &self.non_finite
    }

    /// Reads the next samples of every channel, at most `frames` of each, and says how many: fewer only at the end, or
    /// before damage, and 0 after the end. `block` becomes one vector a channel; its memory is used again. Integers are
    /// in [-1, 1]; floats are as they are written.
    ///
    /// # Errors
    /// If the file cannot be read, or FLAC is damaged. What comes before the damage is read first.
    pub fn read_block(&mut self, frames: usize, block: &mut Vec<Vec<f32>>) -> Result<usize, ReadError> {
        block.resize_with(self.channels(), Vec::new);
        block.iter_mut().for_each(Vec::clear);
        self.append(frames, block)
    }

    /// All samples that are left, one vector a channel: 4 bytes each.
    ///
    /// # Errors
    /// Those of [`read_block`](Recording::read_block).
    pub fn read_to_end(&mut self) -> Result<Vec<Vec<f32>>, ReadError> {
        let mut all = vec![Vec::new(); self.channels()];
        while self.append(1 << 16, &mut all)? > 0 {}
        Ok(all)
    }

    fn append(&mut self, frames: usize, block: &mut [Vec<f32>]) -> Result<usize, ReadError> {
        if self.monitor.is_stopped() {
            return Err(ReadError::Stopped);
        }
        let before = block.first().map_or(0, Vec::len);
        let count = match &mut self.source {
            Source::Wav(wav) => wav.read(frames, block)?,
            Source::Flac(flac) => flac.read(frames, block)?,
        };
        self.monitor.add((count as u64).saturating_mul(self.channels() as u64));
        for (channel, non_finite) in block.iter_mut().zip(&mut self.non_finite) {
            for sample in channel.iter_mut().skip(before).filter(|sample| !sample.is_finite()) {
                *sample = 0.0;
                *non_finite += 1;
            }
        }
        Ok(count)
    }
}
