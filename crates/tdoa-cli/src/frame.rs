//! The frame that three nodes fix.

use tdoa::align::frame;
use tdoa::{Calibration, Pseudoranges};

use crate::Failure;

/// The nodes of a frame: origin, x axis, up.
pub(crate) struct Frame([Node; 3]);

/// A node by its place among the receivers or the transmitters.
#[derive(Clone, Copy)]
enum Node {
    Receiver(usize),
    Transmitter(usize),
}

impl Frame {
    /// The nodes of these names, with commas between them.
    pub(crate) fn parse(text: &str, measured: &Pseudoranges) -> Result<Frame, Failure> {
        let names: Vec<&str> = text.split(',').map(str::trim).collect();
        let &[origin, x_axis, up] = names.as_slice() else {
            return Err(Failure::Unusable(format!(
                "--frame needs three names of nodes, ORIGIN,XAXIS,UP, not {text:?}"
            )));
        };
        let find = |name: &str| -> Result<Node, Failure> {
            let place = |names: &[String]| names.iter().position(|other| other == name);
            place(measured.receiver_names())
                .map(Node::Receiver)
                .or_else(|| place(measured.transmitter_names()).map(Node::Transmitter))
                .ok_or_else(|| {
                    Failure::Unusable(format!(
                        "--frame: no node is named {name:?}; receivers are {}, ..., transmitters {}, ...",
                        measured.receiver_names()[0],
                        measured.transmitter_names()[0]
                    ))
                })
        };
        Ok(Frame([find(origin)?, find(x_axis)?, find(up)?]))
    }

    /// Moves a calibration into the frame.
    pub(crate) fn apply(&self, calibration: &mut Calibration) -> Result<(), Failure> {
        let position = |node: Node| match node {
            Node::Receiver(i) => calibration.receivers[i],
            Node::Transmitter(j) => calibration.transmitters[j],
        };
        let [a, b, c] = self.0.map(position);
        let (Some(a), Some(b), Some(c)) = (a, b, c) else {
            return Err(Failure::Undetermined("--frame: a node of the frame could not be located".to_string()));
        };
        let map = frame(a, b, c).ok_or_else(|| {
            Failure::Undetermined("--frame: the three nodes lie in one line or in one place; choose others".to_string())
        })?;
        calibration.transform(&map);
        Ok(())
    }
}
