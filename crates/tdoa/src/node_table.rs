//! A calibration as a CSV table of its nodes.

use crate::calibrate::Calibration;

/// The table `kind,name,x,y,std_x,std_y,cov_xy,offset,std_offset,measurements,outliers`, with
/// receivers first, in metres, empty where nothing could be determined. [`crate::read::read_nodes`]
/// reads its receivers back.
pub fn node_table(calibration: &Calibration) -> String {
    let mut table = Table(csv::Writer::from_writer(Vec::new()));
    table.row(
        ["kind", "name", "x", "y", "std_x", "std_y", "cov_xy", "offset", "std_offset", "measurements", "outliers"]
            .map(str::to_string),
    );
    for (i, name) in calibration.receiver_names.iter().enumerate() {
        let [x, y] = both(calibration.receivers[i]);
        let [std_x, std_y] = both(calibration.receiver_std[i]);
        let covariance = text(calibration.receiver_covariance[i].map(|c| c[0][1]));
        let [count, outliers] = calibration.counts_of_receiver(i).map(|count| count.to_string());
        let kind = "receiver".to_string();
        let none = String::new;
        table.row([kind, name.clone(), x, y, std_x, std_y, covariance, none(), none(), count, outliers]);
    }
    for (j, name) in calibration.transmitter_names.iter().enumerate() {
        let [x, y] = both(calibration.transmitters[j]);
        let [std_x, std_y] = both(calibration.transmitter_std[j]);
        let covariance = text(calibration.transmitter_covariance[j].map(|c| c[0][1]));
        let (offset, std_offset) = (text(calibration.offsets[j]), text(calibration.offset_std[j]));
        let [count, outliers] = calibration.counts_of_transmitter(j).map(|count| count.to_string());
        let kind = "transmitter".to_string();
        table.row([kind, name.clone(), x, y, std_x, std_y, covariance, offset, std_offset, count, outliers]);
    }
    table.finish()
}

struct Table(csv::Writer<Vec<u8>>);

impl Table {
    fn row(&mut self, cells: [String; 11]) {
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

fn both(values: Option<[f64; 2]>) -> [String; 2] {
    values.map_or_else(|| [String::new(), String::new()], |values| values.map(|value| value.to_string()))
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
