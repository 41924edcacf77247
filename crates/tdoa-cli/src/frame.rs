//! The frame that three nodes fix, in space four.

use tdoa::align::frame;
use tdoa::{Calibration, Pseudoranges};

use crate::Failure;

/// The nodes of a frame: the origin, and those of [`tdoa::align::frame`].
pub(crate) struct Frame<const D: usize> {
    origin: Node,
    axes: [Node; D],
}

/// The dimensions of the frame that the nodes of these names fix, with commas between them.
pub(crate) fn dimensions(text: &str) -> usize {
    if text.split(',').count() > 3 { 3 } else { 2 }
}

/// A node by its place among the receivers or the transmitters.
#[derive(Clone, Copy)]
enum Node {
    Receiver(usize),
    Transmitter(usize),
}

impl<const D: usize> Frame<D> {
    /// The nodes of these names, with commas between them.
    pub(crate) fn parse(text: &str, measured: &Pseudoranges) -> Result<Frame<D>, Failure> {
        let names: Vec<&str> = text.split(',').map(str::trim).collect();
        let &[origin, ref axes @ ..] = names.as_slice() else { return Err(wrong::<D>(text)) };
        let axes: &[&str; D] = axes.try_into().map_err(|_| wrong::<D>(text))?;
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
        let origin = find(origin)?;
        let mut nodes = [origin; D];
        for (node, name) in nodes.iter_mut().zip(axes) {
            *node = find(name)?;
        }
        Ok(Frame { origin, axes: nodes })
    }

    /// Moves a calibration into the frame.
    pub(crate) fn apply(&self, calibration: &mut Calibration<D>) -> Result<(), Failure> {
        let position = |node: Node| {
            let position = match node {
                Node::Receiver(i) => calibration.receivers[i],
                Node::Transmitter(j) => calibration.transmitters[j],
            };
            let missing = || Failure::Undetermined("--frame: a node of the frame could not be located".to_string());
            position.ok_or_else(missing)
        };
        let origin = position(self.origin)?;
        let mut axes = [origin; D];
        for (axis, node) in axes.iter_mut().zip(self.axes) {
            *axis = position(node)?;
        }
        let map = frame(origin, axes).ok_or_else(|| {
            let what = if D == 2 { "three nodes lie in one line" } else { "four nodes lie in one plane" };
            Failure::Undetermined(format!("--frame: the {what} or in one place; choose others"))
        })?;
        calibration.transform(&map);
        Ok(())
    }
}

fn wrong<const D: usize>(text: &str) -> Failure {
    let what = if D == 2 {
        "three names of nodes, ORIGIN,XAXIS,UP"
    } else {
        "four names of nodes in space, ORIGIN,XAXIS,YSIDE,UP"
    };
    Failure::Unusable(format!("--frame needs {what}, not {text:?}"))
}
