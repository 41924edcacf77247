//! Builds a determinant without expanding it: minors that occur several times are one node of the
//! graph.
//!
//! The 8 x 8 determinant of a matrix of parameters plus `x` on the diagonal has more than a hundred
//! thousand terms when multiplied out, but takes fewer than a thousand operations as a program.

use poly::{Complex64, Evaluate, Expr, Isa, System};
use std::collections::HashMap;

/// The minor of the first rows and the given columns (a bit mask), by expansion along its last row.
fn minor<'a>(matrix: &[Vec<Expr<'a>>], columns: u32, known: &mut HashMap<u32, Expr<'a>>) -> Expr<'a> {
    if let Some(&value) = known.get(&columns) {
        return value;
    }
    let row = columns.count_ones() as usize - 1;
    let mut sum = matrix[0][0].arena().constant(0);
    for (k, column) in (0..matrix.len()).filter(|c| columns >> c & 1 == 1).enumerate() {
        let rest = columns & !(1 << column);
        let cofactor = if rest == 0 { matrix[0][0].arena().constant(1) } else { minor(matrix, rest, known) };
        let term = matrix[row][column] * cofactor;
        sum = if (row + k).is_multiple_of(2) { sum + term } else { sum - term };
    }
    known.insert(columns, sum);
    sum
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let n = 8;
    let system = System::build(|s| {
        let x = s.variable("x");
        let entry = |i: usize, j: usize| {
            let a = s.parameter(&format!("a{i}{j}"));
            if i == j { a + x } else { a }
        };
        let matrix: Vec<Vec<Expr<'_>>> = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
        vec![minor(&matrix, (1 << n) - 1, &mut HashMap::new())]
    })?;
    let f = system.compile()?;
    println!(
        "operations: {} for the value, {} with its derivative",
        f.program().value_operations(),
        f.program().jacobian_operations()
    );
    match system.expand(&Default::default()) {
        Ok(polynomials) => println!("multiplied out: {} terms", polynomials[0].len()),
        Err(error) => println!("multiplied out: {error}"),
    }

    // The matrix of ones plus 2 on the diagonal has determinant 2^(n-1) * (n + 2).
    let (ones, two) = (vec![Complex64::new(1.0, 0.0); n * n], [Complex64::new(2.0, 0.0)]);
    let (mut value, mut slope) = ([Complex64::ZERO], [Complex64::ZERO]);
    f.jacobian(&mut f.memory(Isa::detect()), &two, &ones, &mut value, &mut slope);
    println!("det = {}, expected {}; derivative {}", value[0], (1 << (n - 1)) * (n + 2), slope[0]);
    Ok(())
}
