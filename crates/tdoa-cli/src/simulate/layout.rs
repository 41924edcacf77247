//! Where nodes are.

use tdoa::{Layout, SimulateOptions};

use super::arguments::Shape;
use crate::Failure;

/// The sides of a room, metres.
pub(super) fn sides(text: &str) -> Option<Vec<f64>> {
    text.split('x').map(|side| side.parse().ok()).collect()
}

/// The layout of a network, from the words of --layout.
pub(super) fn layout<const D: usize>(text: Option<&str>, shape: Shape) -> Result<Layout<D>, Failure> {
    if text == Some("normal") && shape == Shape::Anywhere {
        return Ok(Layout::Normal);
    }
    let extent = match text {
        None => Some(SimulateOptions::<D>::new().layout.extent()),
        Some(text) => sides(text).and_then(|sides| sides.try_into().ok()),
    };
    let text = text.unwrap_or_default();
    match (extent, shape) {
        (Some(extent), Shape::Anywhere) => Ok(Layout::Room { extent }),
        (Some(extent), Shape::Chain) => Ok(Layout::Chain { extent }),
        (Some(extent), Shape::Grid) => Ok(Layout::Grid { extent }),
        (None, Shape::Anywhere) => Err(Failure::Unusable(format!(
            "--layout must be normal, WIDTHxHEIGHT or LENGTHxWIDTHxHEIGHT in metres, not {text:?}"
        ))),
        (None, _) => Err(Failure::Unusable(format!(
            "--shape needs --layout WIDTHxHEIGHT or LENGTHxWIDTHxHEIGHT in metres, not {text:?}"
        ))),
    }
}
