//! Families as input of the computer algebra system Singular.

use super::known::Known;
use std::fmt::Write;

/// The primes modulo which solutions are counted.
const PRIMES: [u64; 2] = [2_147_483_629, 1_000_000_007];

/// Input of Singular that counts the solutions of named families at random parameters modulo two primes, without
/// anything of ours: those at which the Jacobian has full rank, and the number and multiplicities in all of the others,
/// if these are isolated. It prints a line for each family and prime.
pub fn singular(families: &[(String, Known)]) -> String {
    let mut text =
        String::from("LIB \"primdec.lib\"; LIB \"elim.lib\"; int regular, times, points; system(\"random\", 71);\n");
    for prime in PRIMES {
        for (name, known) in families {
            let _ = write!(text, "ring r = {prime}, ({}), dp;", known.unknowns().join(", "));
            for parameter in known.parameters() {
                let _ = write!(text, " poly {parameter} = random(1, 1000000000);");
            }
            let _ = write!(text, "\nideal I = {};\n", known.equations.join(",\n"));
            for factor in &known.nonzero {
                let _ = writeln!(text, "I = sat(I, ideal({factor}))[1];");
            }
            let unknowns = known.unknowns;
            let _ = writeln!(text, "regular = vdim(std(sat(I, minor(jacob(I), {unknowns}))[1]));");
            let multiplicities: usize = known.multiplicities.iter().sum();
            let (expected, count) = (known.regular, known.multiplicities.len());
            if known.has_components {
                text += "times = 0; points = 0;\n";
            } else {
                text += "times = vdim(std(I)) - regular; points = vdim(std(radical(I))) - regular;\n";
            }
            let _ = writeln!(
                text,
                "print(\"{name}, modulo {prime}: \" + string(regular) + \" regular, \" + string(points) + \" others with \" + string(times) \
                 + \" paths: \" + string(list(\"WRONG\", \"right\")[1 + (regular == {expected} and points == {count} and times == {multiplicities})])); kill r;"
            );
        }
    }
    text
}
