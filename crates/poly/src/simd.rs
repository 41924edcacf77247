//! The instruction set of lane kernels, chosen at run time.
//!
//! A kernel is plain inlined code over [`Lanes8`](crate::Lanes8) or another number. [`Isa::run`]
//! compiles the kernel for the instruction sets that are of use, and calls the version for the
//! machine. The compiler never fuses a product and a sum by itself, so that all versions agree bit
//! for bit. The fused instruction is enabled along with AVX2 only for explicit calls of
//! `f64::mul_add` (double-double), whose result is the same everywhere.

use std::sync::atomic::{AtomicU8, Ordering};

/// An instruction set for which kernels are compiled, narrower ones first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Isa {
    /// The set that every machine of the target has (SSE2 on x86-64).
    Portable,
    /// AVX2 with FMA, four doubles per register.
    Avx2,
    /// AVX-512 (F, VL, DQ), eight doubles per register.
    Avx512,
}

/// The widest instruction set that may be detected, as a number.
static LIMIT: AtomicU8 = AtomicU8::new(Isa::Avx512 as u8);

/// Code to be compiled for several instruction sets: `run` must be `#[inline(always)]`.
pub trait Kernel {
    /// What the kernel returns.
    type Output;
    /// The widest instruction set for which the kernel is compiled.
    const WIDEST: Isa;
    /// The narrowest one; the kernel must not run on a narrower one. Default: the portable one.
    const NARROWEST: Isa = Isa::Portable;
    /// Does the work.
    fn run(self) -> Self::Output;
}

impl Isa {
    /// The widest instruction set of this machine, within the [limit](Self::limit).
    pub fn detect() -> Isa {
        Isa::up_to(LIMIT.load(Ordering::Relaxed))
    }

    /// From now on [`detect`](Self::detect) gives no wider instruction set than this, in the whole process:
    /// for programs that measure, or check that results do not depend on the machine.
    pub fn limit(widest: Isa) {
        LIMIT.store(widest as u8, Ordering::Relaxed);
    }

    /// Whether this machine has the instruction set.
    #[inline]
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

    /// The widest instruction set of this machine that is not wider than this one.
    #[inline]
    pub fn within_machine(self) -> Isa {
        Isa::up_to(self as u8)
    }

    #[inline]
    fn up_to(limit: u8) -> Isa {
        let sets = [Isa::Avx512, Isa::Avx2];
        sets.into_iter().find(|&isa| isa as u8 <= limit && isa.available()).unwrap_or(Isa::Portable)
    }

    /// Runs a kernel, compiled for the widest instruction set of this machine that is not wider
    /// than this one or [`Kernel::WIDEST`].
    ///
    /// # Panics
    /// If that set is narrower than [`Kernel::NARROWEST`].
    #[inline]
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        // Constants first: a version that is never called is not compiled.
        #[cfg(target_arch = "x86_64")]
        if const { K::WIDEST as u8 >= Isa::Avx512 as u8 } && self >= Isa::Avx512 && Isa::Avx512.available() {
            // SAFETY: the machine has just been asked for every feature that the function enables
            // (the answer is cached by the standard library; asking costs one load).
            return unsafe { run_avx512(kernel) };
        }
        #[cfg(target_arch = "x86_64")]
        if const { K::WIDEST as u8 >= Isa::Avx2 as u8 } && self >= Isa::Avx2 && Isa::Avx2.available() {
            // SAFETY: as above.
            return unsafe { run_avx2(kernel) };
        }
        if const { K::NARROWEST as u8 > Isa::Portable as u8 } {
            panic!("a kernel for {:?} is run on {self:?}", K::NARROWEST);
        }
        kernel.run()
    }
}

/// Keeps the compiler from vectorising a loop over its iterations, with gathers and scatters,
/// instead of over lanes. Costs nothing.
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
