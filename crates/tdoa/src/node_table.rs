//! A calibration, or the networks of an exact solution, as a CSV table of the nodes.

use crate::calibrate::Calibration;
use crate::minimal::MinimalSolution;

/// The table `kind,name,x,y,std_x,std_y,cov_xy,offset,std_offset,measurements,outliers`, with
/// receivers first, in metres, empty where nothing could be determined. In space it has `z`, `std_z`,
/// `cov_xz` and `cov_yz` too. Deviations and covariances are those
/// [to trust](Calibration::trusted_covariances). [`crate::read::read_nodes`] reads its receivers back.
pub fn node_table<const D: usize>(calibration: &Calibration<D>) -> String {
    const { assert!(D == 2 || D == 3, "a network is in the plane or in space") }
    let mut table = Table(csv::Writer::from_writer(Vec::new()));
    let axes = &["x", "y", "z"][..D];
    let pairs = || (0..D).flat_map(|a| (a + 1..D).map(move |b| (a, b)));
    let mut heading = vec!["kind".to_string(), "name".to_string()];
    heading.extend(axes.iter().map(|axis| axis.to_string()));
    heading.extend(axes.iter().map(|axis| format!("std_{axis}")));
    heading.extend(pairs().map(|(a, b)| format!("cov_{}{}", axes[a], axes[b])));
    heading.extend(["offset", "std_offset", "measurements", "outliers"].map(str::to_string));
    table.row(heading);
    let place = |position: Option<[f64; D]>, std: Option<[f64; D]>, covariance: Option<[[f64; D]; D]>| {
        let numbers = (0..D).map(|k| position.map(|p| p[k])).chain((0..D).map(|k| std.map(|std| std[k])));
        numbers.chain(pairs().map(|(a, b)| covariance.map(|c| c[a][b]))).map(text).collect::<Vec<_>>()
    };
    let (covariances, deviations) = (calibration.trusted_covariances(), calibration.trusted_deviations());
    for (i, name) in calibration.receiver_names.iter().enumerate() {
        let mut row = vec!["receiver".to_string(), name.clone()];
        row.extend(place(calibration.receivers[i], deviations[0][i], covariances[0][i]));
        row.extend([String::new(), String::new()]);
        row.extend(calibration.counts_of_receiver(i).map(|count| count.to_string()));
        table.row(row);
    }
    for (j, name) in calibration.transmitter_names.iter().enumerate() {
        let mut row = vec!["transmitter".to_string(), name.clone()];
        row.extend(place(calibration.transmitters[j], deviations[1][j], covariances[1][j]));
        row.extend([text(calibration.offsets[j]), text(calibration.offset_std[j])]);
        row.extend(calibration.counts_of_transmitter(j).map(|count| count.to_string()));
        table.row(row);
    }
    table.finish()
}

/// The table `network,kind,name,x,y,offset` of every physical network of an exact solution, in metres, with
/// receivers, which have no offset, first; in space it has `z` too. The column `network` has the rank, from 1. The names
/// are those of the receivers and of the transmitters.
pub fn network_table<const D: usize>(solution: &MinimalSolution<D>, names: [&[String]; 2]) -> String {
    const { assert!(D == 2 || D == 3, "a network is in the plane or in space") }
    let mut table = Table(csv::Writer::from_writer(Vec::new()));
    let heading = ["network", "kind", "name"].into_iter().chain(["x", "y", "z"].into_iter().take(D)).chain(["offset"]);
    table.row(heading.map(str::to_string).collect());
    for (k, candidate) in solution.candidates.iter().enumerate().filter(|(_, candidate)| candidate.physical) {
        let mut row = |kind: &str, name: &str, position: &[f64; D], offset: Option<f64>| {
            let mut row = vec![(k + 1).to_string(), kind.to_string(), name.to_string()];
            row.extend(position.iter().map(f64::to_string));
            row.push(text(offset));
            table.row(row);
        };
        let network = &candidate.network;
        for (name, position) in names[0].iter().zip(&network.receivers) {
            row("receiver", name, position, None);
        }
        for ((name, position), offset) in names[1].iter().zip(&network.transmitters).zip(&network.offsets) {
            row("transmitter", name, position, Some(*offset));
        }
    }
    table.finish()
}

struct Table(csv::Writer<Vec<u8>>);

impl Table {
    fn row(&mut self, cells: Vec<String>) {
        // Writing to memory does not fail, and all rows are of one length.
        let _ = self.0.write_record(cells);
    }

    fn finish(self) -> String {
        let bytes = self.0.into_inner().unwrap_or_default();
        // All that was written was text.
        String::from_utf8(bytes).unwrap_or_default()
    }
}

fn text(value: Option<f64>) -> String {
    value.map(|value| value.to_string()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::align::Transform;
    use crate::minimal::{Candidate, PathCounts, RootCounts};
    use crate::{CalibrateOptions, Emissions, SimulateOptions, calibrate, simulate};

    #[test]
    fn receivers_are_read_back() {
        let options = SimulateOptions { noise: 0.01, ..Default::default() };
        let simulation = simulate(&options).unwrap();
        let names = |kind: &str, count: usize| (0..count).map(|k| format!("{kind}, \"{k}\"")).collect();
        let measured = simulation.pseudoranges.with_names(names("a", 8), names("b", 12)).unwrap();
        let mut calibration = calibrate(&measured, &CalibrateOptions::default()).unwrap();
        calibration.receivers[3] = None;
        let table = node_table(&calibration);
        assert_eq!(table.lines().count(), 1 + 8 + 12);
        let nodes = crate::read::read_nodes_from(table.as_bytes(), "nodes.csv").unwrap();
        assert_eq!(nodes.in_order(&calibration.receiver_names).unwrap(), calibration.receivers);
    }
    #[test]
    fn a_table_has_every_physical_network() {
        let simulation =
            simulate(&SimulateOptions::<3> { receivers: 8, transmitters: 5, ..SimulateOptions::new() }).unwrap();
        let measured = simulation.pseudoranges;
        let candidate = |rank: usize, physical: bool| Candidate {
            network: Transform { scale: rank as f64, ..Transform::IDENTITY }.apply_network(&simulation.network),
            residual: 0.0,
            physical,
            condition: 1.0,
        };
        let solution = MinimalSolution {
            emissions: Emissions::Unknown,
            configuration: "8r/5s".to_string(),
            solver: "8r/5s",
            paths: PathCounts::default(),
            counts: RootCounts::default(),
            stopped_early: false,
            warnings: Vec::new(),
            candidates: vec![candidate(1, true), candidate(2, false), candidate(3, true)],
        };
        let table = network_table(&solution, [measured.receiver_names(), measured.transmitter_names()]);
        let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
        assert_eq!(rows[0], ["network", "kind", "name", "x", "y", "z", "offset"]);
        assert_eq!(rows.len(), 1 + 2 * (8 + 5));
        // The last transmitter of the third network, whose lengths are three times as large.
        let numbers: Vec<f64> = rows[26][3..].iter().map(|cell| cell.parse().unwrap()).collect();
        let (network, number) = (&simulation.network, 3.0);
        let expected = network.transmitters[4].iter().chain([&network.offsets[4]]);
        assert!(numbers.iter().zip(expected).all(|(x, y)| (x - number * y).abs() < 1e-9) && rows[26][0] == "3");
        assert_eq!(&rows[1][..3], ["1", "receiver", "r1"]);
        assert_eq!(rows[1][6], "");
    }
}
