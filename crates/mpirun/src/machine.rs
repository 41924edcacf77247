//! What of the machine a program uses.

use cli::Failure;
use hc::poly::simd::Isa;

/// Options of every command about the machine.
#[derive(clap::Args)]
pub struct Machine {
    /// Widest instruction set for the arithmetic, for measurements; results do not depend on it [default: the
    /// widest of the machine]
    #[arg(long, global = true, value_name = "SET", hide_short_help = true)]
    instructions: Option<InstructionSet>,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum InstructionSet {
    /// What every machine of this kind has.
    Portable,
    /// AVX2 with FMA, four doubles at once.
    Avx2,
    /// AVX-512, eight doubles at once.
    Avx512,
}

impl Machine {
    /// Uses no wider instruction set than was asked for.
    ///
    /// # Errors
    /// If the machine does not have that one.
    pub(crate) fn prepare(&self) -> Result<(), Failure> {
        let (name, isa) = match self.instructions {
            None => return Ok(()),
            Some(InstructionSet::Portable) => ("portable", Isa::Portable),
            Some(InstructionSet::Avx2) => ("avx2", Isa::Avx2),
            Some(InstructionSet::Avx512) => ("avx512", Isa::Avx512),
        };
        if !isa.available() {
            return Err(Failure::Unusable(format!("--instructions {name}: this machine does not have them")));
        }
        Isa::limit(isa);
        Ok(())
    }
}
