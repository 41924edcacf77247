//! A calibration as a CSV table of its nodes.

use crate::calibrate::Calibration;

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
    use crate::{CalibrateOptions, SimulateOptions, calibrate, simulate};

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
}
