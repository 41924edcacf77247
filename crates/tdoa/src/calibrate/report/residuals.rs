//! Residuals of the measurements.

use std::ops::Deref;

use crate::cells::Cells;
use serde::de::Error;
use serde::ser::{SerializeMap, SerializeSeq};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The residual of one measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// f_ij - o_j - |r_i - s_j|, metres.
    pub length: f64,
    /// Whether the measurement agrees with the network.
    pub inlier: bool,
}

/// The residuals of all measurements. In JSON they are two matrices, `residuals` and `inliers`;
/// cells that were not measured are null and false.
#[derive(Debug, Clone, PartialEq)]
pub struct Residuals(pub(crate) Cells<Residual>);

impl Residuals {
    /// Receiver, transmitter and residual (metres) of the measurements that do not agree with the
    /// network.
    pub fn outliers(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        self.iter().filter(|(.., residual)| !residual.inlier).map(|(i, j, residual)| (i, j, residual.length))
    }
}

impl Deref for Residuals {
    type Target = Cells<Residual>;

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

/// A matrix of which each cell is written.
struct Dense<'a, F>(&'a Cells<Residual>, F);

/// A row of it.
struct Row<'a, F>(&'a Cells<Residual>, usize, &'a F);

impl<T: Serialize, F: Fn(Option<&Residual>) -> T> Serialize for Dense<'_, F> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq((0..self.0.rows()).map(|i| Row(self.0, i, &self.1)))
    }
}

impl<T: Serialize, F: Fn(Option<&Residual>) -> T> Serialize for Row<'_, F> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Row(cells, i, value) = self;
        let mut row = serializer.serialize_seq(Some(cells.columns()))?;
        let mut measured = cells.row(*i).peekable();
        for j in 0..cells.columns() {
            let here = measured.next_if(|(column, _)| *column == j);
            row.serialize_element(&value(here.map(|(_, residual)| residual)))?;
        }
        row.end()
    }
}

impl Serialize for Residuals {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(2))?;
        map.serialize_entry("inliers", &Dense(&self.0, |r: Option<&Residual>| r.is_some_and(|r| r.inlier)))?;
        map.serialize_entry("residuals", &Dense(&self.0, |r: Option<&Residual>| r.map(|r| r.length)))?;
        map.end()
    }
}

/// As they are written.
#[derive(Deserialize)]
struct Written {
    inliers: Vec<Vec<bool>>,
    residuals: Vec<Vec<Option<f64>>>,
}

impl<'de> Deserialize<'de> for Residuals {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let Written { inliers, residuals } = Written::deserialize(deserializer)?;
        let columns = residuals.first().map_or(0, Vec::len);
        let fits = residuals.iter().all(|row| row.len() == columns) && inliers.len() == residuals.len();
        if !fits || inliers.iter().any(|row| row.len() != columns) {
            return Err(D::Error::custom("inliers and residuals are not matrices of one size"));
        }
        let cells = residuals.iter().zip(&inliers).enumerate().flat_map(|(i, (residuals, inliers))| {
            let row = residuals.iter().zip(inliers).enumerate();
            row.filter_map(move |(j, (length, inlier))| Some((i, j, Residual { length: (*length)?, inlier: *inlier })))
        });
        Ok(Residuals(Cells::new(residuals.len(), columns, cells)))
    }
}

#[cfg(test)]
mod tests {
    use super::{Residual, Residuals};
    use crate::cells::Cells;

    #[test]
    fn json_has_matrices_and_comes_back() {
        let residual = |length, inlier| Residual { length, inlier };
        let cells = [(0, 1, residual(0.5, true)), (1, 0, residual(-2.0, false)), (1, 2, residual(0.25, true))];
        let all = Residuals(Cells::new(2, 3, cells));
        let json = serde_json::to_string(&all).unwrap();
        assert_eq!(
            json,
            "{\"inliers\":[[false,true,false],[false,false,true]],\"residuals\":[[null,0.5,null],[-2.0,null,0.25]]}"
        );
        assert_eq!(serde_json::from_str::<Residuals>(&json).unwrap(), all);
        assert_eq!(all.outliers().collect::<Vec<_>>(), [(1, 0, -2.0)]);
        for bad in ["[[true]]", "[[true,true],[true]]", "[[true,true,true]]"] {
            let json = format!("{{\"inliers\":{bad},\"residuals\":[[1.0,2.0],[3.0,4.0]]}}");
            assert!(serde_json::from_str::<Residuals>(&json).unwrap_err().to_string().contains("one size"));
        }
    }
}
