//! Networks that explain the same measurements, one below another.

use hc::poly::counted;

use super::canvas::Canvas;
use super::layout::Layout;
use super::legend::Legend;
use super::scene::Scene;
use super::view::WIDTH;
use crate::minimal::MinimalSolution;
use crate::quantity::number;

/// Most networks that are drawn.
const DRAWN: usize = 20;

/// Height of the title, and of the line above each network.
const TITLE: f64 = 40.0;

/// Every physical network of an exact solution as SVG text, best first and one below another, each with its residual.
/// The names are those of the receivers and of the transmitters. Each network is in the frame of its coordinates: put
/// them into one frame beforehand to compare them. Of more than 20 networks the picture has the best 20, and says so.
pub fn networks<const D: usize>(solution: &MinimalSolution<D>, names: [&[String]; 2]) -> String {
    let physical = solution.candidates.iter().enumerate().filter(|(_, candidate)| candidate.physical);
    let physical: Vec<_> = physical.collect();
    let mut top = TITLE;
    let mut panels = Vec::new();
    for (k, candidate) in physical.iter().take(DRAWN) {
        let scene = Scene::exact(&candidate.network, names);
        let layout = Layout::of(&scene).down(top);
        let words = format!(
            "rank {}: residual {:.1e} m (rms), condition {}",
            k + 1,
            candidate.residual,
            number(candidate.condition, 2)
        );
        panels.push((top, words, scene, layout));
        top = panels.last().map_or(top, |(_, _, _, layout)| layout.foot);
    }
    let mut canvas = Canvas::new(WIDTH, top + 20.0);
    let left_out = physical.len().saturating_sub(DRAWN);
    let best = if left_out > 0 { format!(", the best {DRAWN} of them here") } else { String::new() };
    let count = counted(physical.len(), "physical network");
    canvas.text([20.0, 28.0], "start", 16.0, &format!("{}, {count}{best}", solution.configuration));
    Legend::exact().draw(&mut canvas, [WIDTH - 150.0, 8.0]);
    for (top, words, scene, layout) in &panels {
        canvas.text([20.0, top + 28.0], "start", 14.0, words);
        for view in &layout.views {
            view.draw(&mut canvas, scene, |p| layout.shows(p), layout.radius(scene));
        }
    }
    canvas.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::minimal::{MinimalOptions, Solver};
    use crate::{SimulateOptions, simulate};

    #[test]
    fn every_physical_network_is_drawn() {
        let simulation = simulate(&SimulateOptions { receivers: 6, transmitters: 3, ..Default::default() }).unwrap();
        let measured = simulation.pseudoranges;
        let mut solution = Solver::new().solve(&measured, &MinimalOptions::default()).unwrap();
        let names = [measured.receiver_names(), measured.transmitter_names()];
        let best = solution.candidates[0].clone();
        assert!(best.physical);
        for (count, drawn) in [(0, 0), (1, 1), (3, 3), (25, 20)] {
            solution.candidates = vec![best.clone(); count];
            // One that is not physical does not count.
            solution.candidates.push(crate::minimal::Candidate { physical: false, ..best.clone() });
            let svg = networks(&solution, names);
            assert_eq!(svg.matches("class=\"receiver\"").count(), 6 * drawn + 1);
            assert_eq!(svg.matches("class=\"transmitter\"").count(), 3 * drawn + 1);
            assert_eq!(svg.matches(">r4<").count(), drawn);
            assert_eq!(svg.contains("the best 20 of them here"), count > 20);
            assert!(svg.contains(&counted(count, "physical network")) && !svg.contains("NaN"));
        }
    }
}
