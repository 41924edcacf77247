//! Mirror images: nodes of a network in space that may lie on the other side of the plane of those that they
//! were measured with.

use std::path::{Path, PathBuf};

use end_to_end::run;
use serde_json::Value;

type Point = [f64; 3];

/// Uniform draws between 0 and 1 from a seed (Steele, Lea and Flood 2014, SplitMix64).
struct Draws(u64);

impl Draws {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A standard normal draw (Box and Muller 1958).
    fn normal(&mut self) -> f64 {
        let (a, b) = (1.0 - self.uniform(), self.uniform());
        (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
    }

    /// A point over a room of 8 m by 6 m.
    fn at_height(&mut self, z: f64) -> Point {
        [8.0 * self.uniform(), 6.0 * self.uniform(), z]
    }
}

fn distance(a: Point, b: Point) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// A network and the files of its measurements and of what is known of its receivers.
struct Recording {
    directory: tempfile::TempDir,
    receivers: Vec<Point>,
    transmitters: Vec<Point>,
}

impl Recording {
    /// Receivers and transmitters at these heights, and normal noise.
    fn new(receivers: &[f64], transmitters: &[f64], noise: f64, seed: u64) -> Recording {
        Recording::with_gaps(receivers, transmitters, noise, seed, |_, _| false)
    }

    /// The same without the measurements of some receivers of some transmitters.
    fn with_gaps(
        receivers: &[f64],
        transmitters: &[f64],
        noise: f64,
        seed: u64,
        missing: impl Fn(usize, usize) -> bool,
    ) -> Recording {
        let mut draws = Draws(seed);
        let receivers: Vec<Point> = receivers.iter().map(|&z| draws.at_height(z)).collect();
        let transmitters: Vec<Point> = transmitters.iter().map(|&z| draws.at_height(z)).collect();
        let offsets: Vec<f64> = transmitters.iter().map(|_| 5.0 * draws.uniform()).collect();
        let mut table = String::new();
        for (i, &r) in receivers.iter().enumerate() {
            let mut cell = |j: usize| {
                let f = distance(r, transmitters[j]) + offsets[j] + noise * draws.normal();
                if missing(i, j) { String::new() } else { format!("{f:?}") }
            };
            table += &((0..transmitters.len()).map(&mut cell).collect::<Vec<_>>().join(",") + "\n");
        }
        let directory = tempfile::tempdir().expect("directory");
        std::fs::write(directory.path().join("table.csv"), table).expect("written");
        Recording { directory, receivers, transmitters }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.directory.path().join(name)
    }

    /// Anchors: the first receivers with all coordinates, of the others the height alone, to a millimetre.
    fn anchors(&self, whole: usize, heights: bool) -> PathBuf {
        let mut table = "name,x,y,z,sigma\n".to_string();
        for (i, [x, y, z]) in self.receivers.iter().enumerate() {
            match i < whole {
                true => table += &format!("r{},{x:?},{y:?},{z:?},0\n", i + 1),
                false if heights => table += &format!("r{},,,{z:?},0.001\n", i + 1),
                false => {}
            }
        }
        let path = self.path("anchors.csv");
        std::fs::write(&path, table).expect("written");
        path
    }

    fn calibrate(&self, words: &[&str]) -> Value {
        let file = self.path("table.csv");
        let words = [&["calibrate", text(&file), "--dimensions", "3", "--json", "-"], words].concat();
        let output = run("tdoa", &words);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).expect("JSON")
    }
}

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8 path")
}

fn point(value: &Value) -> Point {
    [0, 1, 2].map(|k| value[k].as_f64().expect("number"))
}

/// Names, positions and heights of the mirror images of a kind.
fn images(found: &Value, kind: &str) -> Vec<(String, Point, f64)> {
    let all = found["mirror_images"].as_array().cloned().unwrap_or_default();
    let of_kind = all.iter().filter(|image| image["kind"] == kind);
    let read = |image: &Value| {
        let height = image["distance_from_plane"].as_f64().expect("number");
        (image["node"].as_str().expect("name").to_string(), point(&image["position"]), height)
    };
    of_kind.map(read).collect()
}

fn warns(found: &Value, part: &str) -> bool {
    found["warnings"].as_array().expect("warnings").iter().any(|text| text.as_str().is_some_and(|t| t.contains(part)))
}

/// Heights on both sides of zero, the last one in the plane.
const BOTH_SIDES: [f64; 12] = [1.5, -0.9, 2.0, -1.6, 0.8, -2.2, 1.1, -1.3, 2.4, -0.7, 1.8, 0.0];
const SPREAD: [f64; 10] = [0.1, 2.3, 1.2, 2.9, 0.4, 1.7, 2.6, 0.2, 1.4, 2.0];

#[test]
fn transmitters_off_the_plane_of_all_receivers_have_their_reflections_as_images() {
    for (noise, seed) in [(0.0, 1), (0.01, 2), (0.01, 3)] {
        // With noise, one in the plane may be taken for one off it.
        let heights = if noise == 0.0 { &BOTH_SIDES[..] } else { &BOTH_SIDES[..11] };
        let recording = Recording::new(&[0.0; 10], heights, noise, seed);
        let found = recording.calibrate(&[]);
        let images = images(&found, "transmitter");
        let names: Vec<&str> = images.iter().map(|(name, ..)| name.as_str()).collect();
        assert_eq!(names, (1..12).map(|j| format!("s{j}")).collect::<Vec<_>>(), "seed {seed}");
        for (j, (_, image, height)) in images.iter().enumerate() {
            let place = point(&found["transmitters"][j]);
            let within = |all: &str, k: usize| point(&found[all][k]).iter().map(|x| x * x).sum::<f64>().sqrt();
            // Exact without noise, else within four deviations of the node and of a receiver.
            let sigma = within("transmitter_std", j) + within("receiver_std", 0);
            let off = if noise == 0.0 { 1e-5 } else { 4.0 * sigma };
            assert!((height - BOTH_SIDES[j].abs()).abs() < off, "seed {seed}, s{}: {height}", j + 1);
            assert!((distance(place, *image) - 2.0 * height).abs() < off, "seed {seed}, s{}", j + 1);
            // The reflection is as far from every receiver as the transmitter is.
            for (i, &r) in recording.receivers.iter().enumerate() {
                let far = distance(*image, point(&found["receivers"][i]));
                let truth = distance(r, recording.transmitters[j]);
                assert!((far - truth).abs() < off, "seed {seed}, r{} s{}: {far} {truth}", i + 1, j + 1);
            }
        }
        let claims = ["unique", "unique_receivers", "unique_transmitters"].map(|claim| &found[claim] == true);
        assert_eq!((claims, &found["alternatives"]), ([false, true, false], &Value::Array(Vec::new())), "seed {seed}");
        let count = format!("11 of {} transmitters may lie on the other side of it, s1, s2, s3", heights.len());
        assert!(warns(&found, &count), "{found}");
    }
}

#[test]
fn receivers_off_one_plane_leave_no_mirror_images() {
    let recording = Recording::new(&SPREAD, &BOTH_SIDES, 0.01, 4);
    let found = recording.calibrate(&[]);
    assert!(found.get("mirror_images").is_none() && found["unique"] == true, "{found}");
    // One receiver on a stand is enough.
    let mut raised = [0.0; 10];
    raised[6] = 1.5;
    let found = Recording::new(&raised, &BOTH_SIDES, 0.01, 5).calibrate(&[]);
    assert!(found.get("mirror_images").is_none(), "{found}");
}

#[test]
fn a_transmitter_that_only_receivers_in_one_plane_hear_has_an_image() {
    let receivers = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.8, 2.5, 1.2, 2.9];
    let far = |i: usize, j: usize| j == 3 && i >= 6;
    let found = Recording::with_gaps(&receivers, &BOTH_SIDES, 0.01, 9, far).calibrate(&[]);
    let images = images(&found, "transmitter");
    let [(name, _, height)] = &images[..] else { panic!("{images:?}") };
    assert!(name == "s4" && (height - 1.6).abs() < 0.3, "{name} {height}");
    assert!(warns(&found, "1 of 12 transmitters may lie on the other side of the plane of the receivers"), "{found}");
    // One in ten may lie elsewhere.
    let claims = ["unique", "unique_receivers", "unique_transmitters"].map(|claim| &found[claim] == true);
    assert_eq!(claims, [false, true, true]);
}

#[test]
fn a_single_transmitter_off_the_plane_has_an_image_beside_anchors() {
    let mut heights = [0.0; 9];
    heights[4] = 1.5;
    let recording = Recording::new(&[0.0; 9], &heights, 0.01, 6);
    let anchors = recording.anchors(4, true);
    let found = recording.calibrate(&["--anchors", text(&anchors)]);
    let images = images(&found, "transmitter");
    let (_, image, height) = images.iter().find(|(name, ..)| name == "s5").unwrap_or_else(|| panic!("{images:?}"));
    let [x, y, _] = recording.transmitters[4];
    let reflection = [x, y, -1.5 * point(&found["transmitters"][4])[2].signum()];
    let off = 4.0 * point(&found["transmitter_std"][4]).iter().map(|x| x * x).sum::<f64>().sqrt();
    assert!(off < 1.0, "{off}");
    assert!((height - 1.5).abs() < off && distance(*image, reflection) < off, "{image:?} {height} {off}");
}

#[test]
fn receivers_off_the_plane_of_all_transmitters_have_images() {
    // Transmitters in one plane, as on a floor, receivers on both sides.
    let heights: Vec<f64> = BOTH_SIDES.iter().take(11).copied().collect();
    let recording = Recording::new(&heights, &[0.0; 14], 0.01, 7);
    let free = recording.calibrate(&[]);
    let names: Vec<String> = images(&free, "receiver").into_iter().map(|(name, ..)| name).collect();
    assert_eq!(names, (1..12).map(|i| format!("r{i}")).collect::<Vec<_>>());
    assert!(free["unique"] == false && free["unique_receivers"] == false);
}

#[test]
fn known_heights_of_receivers_remove_their_mirror_images() {
    // Four receivers on the floor with the transmitters, and seven on both sides of it, as of a gallery.
    let heights = [&[0.0; 4], &BOTH_SIDES[..7]].concat();
    for seed in [8, 9] {
        let recording = Recording::new(&heights, &[0.0; 14], 0.01, seed);
        let held = recording.calibrate(&["--anchors", text(&recording.anchors(4, false))]);
        let names: Vec<String> = images(&held, "receiver").into_iter().map(|(name, ..)| name).collect();
        assert_eq!(names, (5..12).map(|i| format!("r{i}")).collect::<Vec<_>>(), "seed {seed}");
        // The height is the only coordinate of these that is not blank.
        let known = recording.calibrate(&["--anchors", text(&recording.anchors(4, true))]);
        assert!(known.get("mirror_images").is_none(), "seed {seed}: {known}");
        for (i, truth) in recording.receivers.iter().enumerate() {
            let off = distance(point(&known["receivers"][i]), *truth);
            assert!(off < 0.2, "seed {seed}, r{}: {off}", i + 1);
        }
    }
}

#[test]
fn a_nearly_flat_array_says_how_uncertain_heights_are() {
    let flat: Vec<f64> = SPREAD.iter().map(|z| 0.02 * z).collect();
    let recording = Recording::new(&flat, &BOTH_SIDES, 0.01, 8);
    let found = recording.calibrate(&[]);
    assert!(warns(&found, "the receivers lie nearly in one plane (height"), "{found}");
    assert!(warns(&found, "standard deviations across it are"), "{found}");
    assert!(found["unique"] == false || found.get("mirror_images").is_none());
}
