//! The instruction set of lane kernels, chosen at run time.
//!
//! A kernel is plain inlined code over [`Lanes8`](crate::Lanes8); [`Isa::run`] compiles it once for
//! each instruction set and calls the version that the machine has. The compiler never fuses a
//! product and a sum by itself, so all versions agree bit for bit; the instruction is enabled
//! beside AVX2 only for `f64::mul_add` asked for by name (double-double), whose result is the same
//! everywhere.

/// An instruction set that kernels are compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Isa {
    /// The set that every machine of the target has (SSE2 on x86-64).
    Portable,
    /// AVX2 with FMA, four doubles a register.
    Avx2,
    /// AVX-512 (F, VL, DQ), eight doubles a register.
    Avx512,
}

/// Code to be compiled for several instruction sets: `run` must be `#[inline(always)]`.
pub trait Kernel {
    /// What the kernel returns.
    type Output;
    /// Does the work.
    fn run(self) -> Self::Output;
}

impl Isa {
    /// The widest instruction set of this machine.
    pub fn detect() -> Isa {
        #[cfg(target_arch = "x86_64")]
        {
            if Isa::Avx512.available() {
                return Isa::Avx512;
            }
            if Isa::Avx2.available() {
                return Isa::Avx2;
            }
        }
        Isa::Portable
    }

    /// Whether this machine has the instruction set.
    pub fn available(self) -> bool {
        match self {
            Isa::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2 => std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma"),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512 => {
                std::arch::is_x86_feature_detected!("fma")
                    && std::arch::is_x86_feature_detected!("avx512f")
                    && std::arch::is_x86_feature_detected!("avx512vl")
                    && std::arch::is_x86_feature_detected!("avx512dq")
            }
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }

    /// Runs a kernel, compiled for this instruction set or, where the machine lacks it, for
    /// [`Isa::Portable`].
    #[inline]
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: the guard has just asked the machine for every feature that the function
            // enables (the answer is cached by the standard library; asking costs one load).
            Isa::Avx512 if self.available() => unsafe { run_avx512(kernel) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Isa::Avx2 if self.available() => unsafe { run_avx2(kernel) },
            _ => kernel.run(),
        }
    }
}

/// Keeps the compiler from vectorising a loop across its turns, with gathers and scatters, instead
/// of across lanes. Costs nothing.
#[inline(always)]
pub fn across_lanes() {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: there is no instruction; neither memory, stack nor flags are touched.
    unsafe {
        std::arch::asm!("", options(nomem, nostack, preserves_flags));
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,fma")]
fn run_avx512<K: Kernel>(kernel: K) -> K::Output {
    kernel.run()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn run_avx2<K: Kernel>(kernel: K) -> K::Output {
    kernel.run()
}
