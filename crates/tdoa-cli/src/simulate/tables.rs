//! The tables that `tdoa simulate` writes.

use tdoa::Pseudoranges;

/// A matrix, with receivers in rows.
pub(super) fn matrix(measured: &Pseudoranges, cell: impl Fn(Option<f64>) -> String) -> String {
    let mut table = format!("receiver,{}\n", measured.transmitter_names().join(","));
    for (i, name) in measured.receiver_names().iter().enumerate() {
        table += name;
        (0..measured.transmitters()).for_each(|j| table += &cell(measured.get(i, j)));
        table += "\n";
    }
    table
}

/// A list of one measurement a line, with further candidates.
pub(super) fn list(measured: &Pseudoranges, cell: impl Fn(Option<f64>) -> String) -> String {
    let most = measured.cells().iter().map(|(i, j, _)| measured.candidates(i, j).len()).max().unwrap_or(1);
    let further: String = (2..=most).map(|k| format!(",value{k}")).collect();
    let mut table = format!("receiver,transmitter,value{further}\n");
    for (i, j, _) in measured.cells().iter() {
        table += &format!("{},{}", measured.receiver_names()[i], measured.transmitter_names()[j]);
        (0..most).for_each(|k| table += &cell(measured.candidates(i, j).get(k).copied()));
        table += "\n";
    }
    table
}

/// A table of nodes: `id,x,y`, in space `id,x,y,z`.
pub(super) fn positions<const D: usize>(names: &[String], positions: &[[f64; D]]) -> String {
    let row = |(name, p): (&String, &[f64; D])| format!("{name},{}\n", p.map(|x| x.to_string()).join(","));
    let rows: String = names.iter().zip(positions).map(row).collect();
    format!("id,{}\n{rows}", ["x", "y", "z"].into_iter().take(D).collect::<Vec<_>>().join(","))
}
