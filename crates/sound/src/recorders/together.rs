//! Files of one recorder that seem not to have begun together.
//!
//! All files of a recorder are taken to have begun together. A recorder that splits a long recording, however, writes files of
//! which each begins where the last one ends: taken to be side by side, they would make events of different sounds. What
//! begins together hears sounds at the same times.

use std::fmt;

use crate::events::{EventOptions, Onset};

use super::coincidence::{LEAST, surprise};
use super::line::Line;
use super::pair::matched;
use super::sounds::{sounds, tolerance};

/// Most sounds of a file that are compared.
const MOST: usize = 256;

/// How often chance may bring forth so many sounds in common.
const CHANCE: f64 = 1e-3;

/// At how many offsets to either side it is counted what chance brings forth.
const OFFSETS: u32 = 16;

/// Which share of the sounds of either file must be in the other in any case, if both began together: few sounds are more than
/// chance only where they are far apart.
const SHARE: f64 = 0.5;

/// What is known of a file.
pub(super) struct File<'a> {
    pub(super) recorder: usize,
    /// Its path.
    pub(super) name: &'a str,
    /// Its length.
    pub(super) seconds: f64,
    /// Of each of its channels, in the order of time.
    pub(super) onsets: &'a [Vec<Onset>],
}

/// Files of a recorder that seem not to have begun together.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FilesApart {
    /// The first two.
    files: [String; 2],
    /// How many sounds both hear at the same time, of how many that either hears.
    common: usize,
    heard: usize,
    /// How many other such pairs there are among the files of this recorder.
    others: usize,
}

impl fmt::Display for FilesApart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let FilesApart { files: [a, b], common, heard, others } = self;
        write!(f, "{a} and {b} are files of one recorder, but hear only {common} of {heard} sounds at the same time")?;
        match others {
            0 => {}
            1 => f.write_str(", as another pair of its files does")?,
            _ => write!(f, ", as {others} other pairs of its files do")?,
        }
        f.write_str(
            "; if one file goes on where the other ends, join them, for instance with `sox A.wav B.wav OUT.wav`, and if they were \
             started apart, give each as a recorder of its own",
        )
    }
}

/// The recorders with files that seem not to have begun together, of files in the order of their recorders. Each file is
/// compared with the next one: somewhere among those of a recorder one follows another.
pub(super) fn apart(files: &[File<'_>], events: &EventOptions) -> Vec<FilesApart> {
    let mut all = Vec::new();
    for files in files.chunk_by(|a, b| a.recorder == b.recorder).filter(|files| files.len() > 1) {
        let sounds: Vec<Vec<f64>> = files.iter().map(|file| sounds(file.onsets, events, MOST)).collect();
        let mut found: Option<FilesApart> = None;
        for (files, sounds) in files.windows(2).zip(sounds.windows(2)) {
            let ([first, second], [a, b]) = (files, sounds) else { continue };
            let seconds = first.seconds.min(second.seconds);
            let Some((common, heard)) = differ([a, b], seconds, tolerance(events)) else { continue };
            let files = [first, second].map(|file| file.name.to_owned());
            let this = FilesApart { files, common, heard, others: 0 };
            found = Some(found.map_or(this, |first| FilesApart { others: first.others + 1, ..first }));
        }
        all.extend(found);
    }
    all
}

/// How many sounds of two files are at the same time, to `tolerance` seconds, of how many that either hears as long as both go
/// on, if that is no more than by chance, which is told by other offsets of the files. `None` also if there are too few to tell.
fn differ(sounds: [&[f64]; 2], seconds: f64, tolerance: f64) -> Option<(usize, usize)> {
    let [a, b] = sounds.map(|sounds| &sounds[..sounds.partition_point(|sound| *sound < seconds)]);
    let heard = a.len().min(b.len());
    let common_at = |offset: f64| matched(a, b, &Line { to: offset, ..Line::same() }, tolerance).len();
    // Sounds may be close together in some part of the files, and so they are at an offset.
    let offsets = (2..2 + OFFSETS).flat_map(|k| [1.0, -1.0].map(|sign| sign * 2.0 * tolerance * f64::from(k)));
    let expected = offsets.map(common_at).sum::<usize>() as f64 / f64::from(2 * OFFSETS);
    let common = common_at(0.0);
    let is_chance = surprise(common as f64, expected) < -CHANCE.ln();
    (heard >= LEAST && is_chance && (common as f64) < SHARE * heard as f64).then_some((common, heard))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    /// Files of one channel each with sounds at these times, ten minutes long.
    fn found(files: &[(usize, Vec<f64>)]) -> Vec<FilesApart> {
        let onset = |&seconds: &f64| Onset { seconds, strength_db: 30.0 };
        let onsets: Vec<[Vec<Onset>; 1]> = files.iter().map(|(_, times)| [times.iter().map(onset).collect()]).collect();
        let names: Vec<String> = (0..files.len()).map(|k| format!("{k}.wav")).collect();
        let file = |k: usize| File { recorder: files[k].0, name: &names[k], seconds: 600.0, onsets: &onsets[k] };
        let files: Vec<File<'_>> = (0..files.len()).map(file).collect();
        apart(&files, &EventOptions::default())
    }

    /// So many times in ten minutes, at least 0.3 s apart.
    fn times(count: usize, rng: &mut Pcg64Mcg) -> Vec<f64> {
        let slot = 600.0 / count as f64;
        (0..count).map(|k| slot * k as f64 + (slot - 0.3) * rng.random::<f64>()).collect()
    }

    #[test]
    fn files_that_follow_one_another_are_told() {
        let rng = &mut Pcg64Mcg::seed_from_u64(3);
        for count in [6, 20, 150, 600] {
            let [a, b, c] = [(); 3].map(|()| times(count, rng));
            // Of one sound a second, 0.18 are within 90 ms of one of the other file by chance.
            let apart = found(&[(0, a.clone()), (0, b.clone()), (0, c.clone())]);
            assert!(apart.len() == 1 && apart[0].others == 1, "{count}: {apart:?}");
            assert_eq!(apart[0].files, ["0.wav", "1.wav"]);
            // Two recorders are not compared, and each has its own.
            assert_eq!(found(&[(0, a.clone()), (1, b.clone())]), []);
            assert_eq!(found(&[(0, a.clone()), (0, b.clone()), (1, a), (1, c)]).len(), 2);
        }
    }

    #[test]
    fn files_side_by_side_hear_the_same() {
        let rng = &mut Pcg64Mcg::seed_from_u64(4);
        for count in [4, 20, 150, 600] {
            let a = times(count, rng);
            // Sound takes up to 87 ms from one microphone to another; a fifth of the sounds is not heard.
            let late: Vec<f64> = a.iter().map(|time| time + 0.087 * rng.random::<f64>()).collect();
            let b: Vec<f64> = late.into_iter().enumerate().filter(|(k, _)| k % 5 != 4).map(|(_, time)| time).collect();
            assert_eq!(found(&[(0, a), (0, b)]), [], "{count}");
        }
    }

    #[test]
    fn few_sounds_do_not_tell() {
        let few = |first: f64| (0, vec![first, first + 10.0, first + 20.0]);
        assert_eq!(found(&[few(1.0), few(2.0)]), []);
        assert_eq!(found(&[(0, Vec::new()), few(1.0)]), []);
    }
}
