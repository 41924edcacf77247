//! Networks that fit the measurements: starts, rivals, and their last refinement.

pub(crate) mod candidates;
pub(crate) mod choices;
pub(crate) mod dense;
pub(crate) mod deviation;
pub(crate) mod finish;
pub(crate) mod hypotheses;
pub(crate) mod local;
pub(crate) mod minimal;
pub(crate) mod mixture;
pub(crate) mod one_sided;
pub(crate) mod propagation;
pub(crate) mod rivals;
pub(crate) mod same_network;
mod shaken;
pub(crate) mod starts;
mod strays;
pub(crate) mod submaps;
pub(crate) mod truncated_cost;
