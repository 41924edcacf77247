//! Families with more equations than unknowns.

use super::draw::{Draw, plain, sum};
use super::known::Known;

/// Curves or surfaces, and combinations of them with polynomials as factors.
pub(super) fn redundant(draw: &mut Draw) -> Known {
    let parameters = draw.parameters(3);
    let unknowns = draw.between(2, 3);
    let names = plain(unknowns);
    let degrees: Vec<usize> = (0..unknowns).map(|_| draw.between(1, 5 - unknowns).max(2)).collect();
    let mut equations = draw.generals(&names, &degrees, parameters);
    for _ in 0..draw.between(1, 3) {
        let share = |equation: &String| format!("+ ({})*({equation})", draw.dense(&names, 0..=1));
        let further = sum(equations[..unknowns].iter().map(share));
        equations.push(further);
    }
    Known::new(unknowns, parameters.len(), equations, degrees.iter().product())
}

/// Where a matrix of linear polynomials has no full rank: all its maximal minors vanish. A matrix of r rows and r + 1
/// columns loses rank at r (r + 1) / 2 points of a plane, one of 2 rows and 4 columns at 4 points of space (Giambelli).
pub(super) fn minors(draw: &mut Draw) -> Known {
    let parameters = draw.parameters(3);
    let (unknowns, rows, columns, count) = draw.one(&[(2, 2, 3, 3), (2, 3, 4, 6), (3, 2, 4, 4)]);
    let names = plain(unknowns);
    let shares = draw.shares(parameters, rows * columns);
    let entries: Vec<String> = shares.iter().map(|share| format!("({})", draw.general(&names, 1, share))).collect();
    let rows: Vec<&[String]> = entries.chunks(columns).collect();
    let equations = choices(columns, rows.len()).iter().map(|chosen| determinant(&rows, chosen)).collect();
    Known::new(unknowns, parameters.len(), equations, count)
}

/// The ascending choices of so many numbers below this.
fn choices(below: usize, count: usize) -> Vec<Vec<usize>> {
    let all = (0u32..1 << below).map(|set| (0..below).filter(|k| set >> k & 1 == 1).collect::<Vec<_>>());
    all.filter(|chosen| chosen.len() == count).collect()
}

/// The determinant of some columns, expanded along the first row.
fn determinant(rows: &[&[String]], columns: &[usize]) -> String {
    let Some((first, others)) = rows.split_first() else { return "1".to_owned() };
    let term = |(k, &column): (usize, &usize)| {
        let rest: Vec<usize> = columns.iter().copied().filter(|&other| other != column).collect();
        let sign = if k % 2 == 0 { "+" } else { "-" };
        if rest.is_empty() {
            return first[column].clone();
        }
        format!("{sign} {}*({})", first[column], determinant(others, &rest))
    };
    sum(columns.iter().enumerate().map(term))
}
