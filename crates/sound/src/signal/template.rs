//! Signals from files.

use std::path::Path;

use super::error::{SignalError, TemplateError};
use super::known::{LONGEST, Signal};
use crate::recording::{BLOCK, Recording};

impl Signal {
    /// A template from the first channel of a recording, WAV or FLAC.
    ///
    /// # Errors
    /// If the file cannot be read, is silent, or is longer than 10 s.
    ///
    /// ```
    /// # let folder = std::env::temp_dir().join(format!("sound-template-{}", std::process::id()));
    /// # std::fs::create_dir_all(&folder)?;
    /// # let path = folder.join("played.wav");
    /// let samples: Vec<f32> = (0..4800).map(|k| (0.001 * (k as f32).powi(2)).sin()).collect();
    /// sound::write_wav(&path, 48_000, &[samples], sound::SampleFormat::Float32)?;
    /// let signal = sound::Signal::read(&path)?;
    /// assert_eq!(signal.seconds(), 0.1);
    /// # std::fs::remove_dir_all(folder)?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn read(path: impl AsRef<Path>) -> Result<Signal, TemplateError> {
        let mut recording = Recording::open(path)?;
        let (file, sample_rate) = (recording.file().to_owned(), f64::from(recording.sample_rate()));
        let wrong = |source| TemplateError::Signal { file: file.clone(), source };
        let (mut samples, mut block) = (Vec::new(), Vec::new());
        while recording.read_block(BLOCK, &mut block)? > 0 {
            samples.extend(block.first().into_iter().flatten());
            let seconds = samples.len() as f64 / sample_rate;
            if seconds > LONGEST {
                // What the header says is longer than what has been read.
                let seconds = recording.frames().map_or(seconds, |frames| frames as f64 / sample_rate);
                return Err(wrong(SignalError::TooLong { seconds, most: LONGEST }));
            }
        }
        let signal = Signal::Template { samples, sample_rate };
        signal.validate().map_err(wrong)?;
        Ok(signal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::write::{SampleFormat, write_wav};

    #[test]
    fn files_that_are_no_signal_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let read = |channels: &[Vec<f32>]| {
            let path = folder.path().join("template.wav");
            write_wav(&path, 1000, channels, SampleFormat::Float32).unwrap();
            Signal::read(&path)
        };
        let samples = vec![0.0, 0.5, -0.25];
        let first = read(&[[samples.clone(), vec![0.0; 97]].concat(), vec![1.0; 100]]).unwrap();
        let Signal::Template { samples: found, sample_rate: 1000.0 } = first else { panic!("{first:?}") };
        assert!(found.len() == 100 && found[..3] == samples);
        let said = |channels: &[Vec<f32>]| read(channels).unwrap_err().to_string();
        let silent = said(&[vec![0.0; 100], vec![1.0; 100]]);
        assert!(silent.contains("template.wav: the template is silent"), "{silent}");
        let long = said(&[vec![0.5; 12_500]]);
        assert!(long.contains("takes 12.5 s, and at most 10 s"), "{long}");
        assert!(matches!(Signal::read("/there/is/no/such.wav"), Err(TemplateError::Read(_))));
    }
}
