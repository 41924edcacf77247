//! Reads a system in PHCpack's format and evaluates it: once in double precision, eight points at
//! once, in double-double, and over intervals.

use poly::{Complex64, ComplexDd, ComplexInterval, Evaluate, Isa, Lane, Lanes8, Scalar, parse};

const TEXT: &str = "2
 x**2 + y**2 - 5;
 (x - y)^3/4 + 2*x*y - 1.5E-1*i;
";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let system = parse::phcpack(TEXT)?;
    print!("{system}");
    let f = system.compile()?;
    println!("{} operations, {} with the Jacobian", f.program().value_operations(), f.program().jacobian_operations());

    let isa = Isa::detect();
    let x = [Complex64::new(1.0, 0.5), Complex64::new(-2.0, 0.25)];
    let (mut values, mut jacobian) = ([Complex64::zero(); 2], [Complex64::zero(); 4]);
    f.jacobian(&mut f.memory(isa), &x, &[], &mut values, &mut jacobian);
    println!("values {values:.6?}");
    // Column-major: entry j*2 + i is the derivative of equation i by unknown j.
    println!("derivatives by x {:.6?}, by y {:.6?}", &jacobian[..2], &jacobian[2..]);

    // Eight points, one a lane: the second unknown differs from lane to lane.
    let mut eight = [Lanes8::from_c64(x[0]), Lanes8::zero()];
    for lane in 0..8 {
        eight[1].set(lane, x[1] * (lane as f64));
    }
    let mut out = [Lanes8::zero(); 2];
    f.values(&mut f.memory(isa), &eight, &[], &mut out);
    for lane in 0..8 {
        println!("lane {lane}: {:.6}", out[0].get(lane));
    }

    // The same program in double-double and over intervals bounds the rounding error.
    let mut precise = [ComplexDd::zero(); 2];
    f.values(&mut f.memory(isa), &x.map(ComplexDd::new), &[], &mut precise);
    let mut enclosed = [ComplexInterval::zero(); 2];
    f.values(&mut f.memory(isa), &x.map(ComplexInterval::point), &[], &mut enclosed);
    for (v, (d, i)) in values.iter().zip(precise.iter().zip(&enclosed)) {
        println!("error {:.1e}, certainly below {:.1e}", (v - d.high()).norm(), 3.0 * i.radius());
    }
    Ok(())
}
