//! The frame of a result that three nodes fix, in space three or four.

use tdoa::align::{Transform, frame};
use tdoa::{Calibration, Network, Pseudoranges};

use crate::Failure;

/// The nodes of a frame: the origin, and those of [`tdoa::align::frame`]. Three of them fix one in space too, but for
/// the side on which z is positive.
pub(crate) struct Frame {
    origin: Node,
    axes: Vec<Node>,
}

/// A node by its place among the receivers or the transmitters.
#[derive(Clone, Copy)]
enum Node {
    Receiver(usize),
    Transmitter(usize),
}

impl Frame {
    /// The nodes of these names, with commas between them.
    pub(crate) fn parse(text: &str, measured: &Pseudoranges) -> Result<Frame, Failure> {
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
        let names: Vec<&str> = text.split(',').map(str::trim).collect();
        if !(3..=4).contains(&names.len()) {
            return Err(Failure::Unusable(format!(
                "--frame needs three names of nodes, ORIGIN,XAXIS,UP, or four in space, ORIGIN,XAXIS,YSIDE,UP, not {text:?}"
            )));
        }
        let axes = names[1..].iter().map(|name| find(name)).collect::<Result<_, _>>()?;
        Ok(Frame { origin: find(names[0])?, axes })
    }

    /// Whether it has four nodes, which the plane has no use for.
    pub(crate) fn is_spatial(&self) -> bool {
        self.axes.len() == 3
    }

    /// What to say where four nodes are given for a network in the plane.
    pub(crate) fn too_many_names() -> Failure {
        Failure::Unusable("--frame has four names, but --dimensions 2 is the plane; give three".into())
    }

    /// Moves a calibration into the frame; with three nodes in space, z is positive on the side of most other nodes.
    pub(crate) fn apply<const D: usize>(&self, calibration: &mut Calibration<D>) -> Result<(), Failure> {
        let map = self.map([&calibration.receivers, &calibration.transmitters])?;
        calibration.transform(&map);
        Ok(())
    }

    /// Moves a network of which all is known into the frame, in the same way.
    pub(crate) fn apply_network<const D: usize>(&self, network: &mut Network<D>) -> Result<(), Failure> {
        let [receivers, transmitters] = [&network.receivers, &network.transmitters]
            .map(|positions| positions.iter().copied().map(Some).collect::<Vec<_>>());
        *network = self.map([&receivers, &transmitters])?.apply_network(network);
        Ok(())
    }

    /// The map into the frame of receivers and transmitters at these places.
    fn map<const D: usize>(
        &self,
        [receivers, transmitters]: [&[Option<[f64; D]>]; 2],
    ) -> Result<Transform<D>, Failure> {
        let position = |node: &Node| {
            let position = match *node {
                Node::Receiver(i) => receivers[i],
                Node::Transmitter(j) => transmitters[j],
            };
            let missing = || Failure::Undetermined("--frame: a node of the frame could not be located".to_string());
            position.ok_or_else(missing)
        };
        let origin = position(&self.origin)?;
        let mut axes = [origin; D];
        for (axis, node) in axes.iter_mut().zip(&self.axes) {
            *axis = position(node)?;
        }
        if D > self.axes.len() {
            axes[D - 1] = side(receivers.iter().chain(transmitters).flatten(), origin, axes);
        }
        frame(origin, axes).ok_or_else(|| {
            let count = if self.is_spatial() { "four nodes lie in one plane" } else { "three nodes lie in one line" };
            Failure::Undetermined(format!("--frame: the {count} or in one place; choose others"))
        })
    }
}

/// A point above the plane of an origin and the first two points in space, on the side of these nodes' centroid.
fn side<'a, const D: usize>(
    nodes: impl Iterator<Item = &'a [f64; D]>,
    origin: [f64; D],
    axes: [[f64; D]; D],
) -> [f64; D] {
    let away = |p: [f64; D], k: usize| p[k] - origin[k];
    let up: [f64; D] = std::array::from_fn(|k| {
        let (a, b) = ((k + 1) % D, (k + 2) % D);
        away(axes[0], a) * away(axes[1], b) - away(axes[0], b) * away(axes[1], a)
    });
    let above: f64 = nodes.map(|p| (0..D).map(|k| away(*p, k) * up[k]).sum::<f64>()).sum();
    std::array::from_fn(|k| origin[k] + up[k] * if above < 0.0 { -1.0 } else { 1.0 })
}
