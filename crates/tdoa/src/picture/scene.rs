//! What a picture shows of a network: of a calibration all that is known, of an exact solution its nodes.

use crate::calibrate::Calibration;
use crate::minimal::NodeKind;
use crate::network::Network;

/// The receivers or the transmitters; lists in one order, or empty where nothing is known.
pub(super) struct Nodes<const D: usize> {
    pub(super) names: Vec<String>,
    pub(super) positions: Vec<Option<[f64; D]>>,
    pub(super) covariances: Vec<Option<[[f64; D]; D]>>,
    /// True positions.
    pub(super) truth: Vec<Option<[f64; D]>>,
}

/// The nodes of a network, and what belongs to them; lengths in metres.
pub(crate) struct Scene<const D: usize> {
    pub(super) receivers: Nodes<D>,
    pub(super) transmitters: Nodes<D>,
    /// Which receivers are held at known positions.
    pub(super) anchored: Vec<bool>,
    /// Where nodes may be as well, and of which kind these are.
    pub(super) mirror_images: Vec<(NodeKind, [f64; D])>,
    /// Receivers and transmitters of outliers.
    pub(super) outliers: Vec<(usize, usize)>,
    /// Radius of the 95 % region in standard deviations.
    pub(super) radius: f64,
}

impl<const D: usize> Scene<D> {
    /// All that a calibration knows of the nodes.
    pub(crate) fn of(calibration: &Calibration<D>) -> Self {
        let [of_receivers, of_transmitters] = calibration.trusted_covariances().map(<[_]>::to_vec);
        let truth = calibration.truth.as_ref();
        let images = calibration.mirror_images.iter();
        Scene {
            receivers: Nodes {
                names: calibration.receiver_names.clone(),
                positions: calibration.receivers.clone(),
                covariances: of_receivers,
                truth: truth.map(|truth| truth.positions.clone()).unwrap_or_default(),
            },
            transmitters: Nodes {
                names: calibration.transmitter_names.clone(),
                positions: calibration.transmitters.clone(),
                covariances: of_transmitters,
                truth: truth.map(|truth| truth.transmitter_positions.clone()).unwrap_or_default(),
            },
            anchored: calibration.anchored.clone(),
            mirror_images: images.map(|image| (image.kind, image.position)).collect(),
            outliers: calibration.residuals.outliers().map(|(i, j, _)| (i, j)).collect(),
            radius: calibration.ellipse_radius.unwrap_or(0.0),
        }
    }

    /// The nodes of a network that explains its measurements exactly.
    pub(super) fn exact(network: &Network<D>, names: [&[String]; 2]) -> Self {
        let nodes = |names: &[String], positions: &[[f64; D]]| Nodes {
            names: names.to_vec(),
            positions: positions.iter().copied().map(Some).collect(),
            covariances: vec![None; positions.len()],
            truth: Vec::new(),
        };
        Scene {
            receivers: nodes(names[0], &network.receivers),
            transmitters: nodes(names[1], &network.transmitters),
            anchored: vec![false; network.receivers.len()],
            mirror_images: Vec::new(),
            outliers: Vec::new(),
            radius: 0.0,
        }
    }
}
