//! Programs as Rust source: straight-line code generic over [`Scalar`](crate::Scalar).

mod literal;
mod straight;
mod tables;

use super::straight_line::{Program, Tables};
use crate::exact;
use literal::number;
use proc_macro2::Literal;
use quote::quote;
use straight::{Straight, zero_fill};
use tables::{register_table, taylor_table};

/// Options of [`emit`].
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct EmitOptions {
    /// Name of the unit struct that implements [`Evaluate`](crate::Evaluate). Default `"System"`.
    pub type_name: String,
    /// Path by which the source refers to this crate, such as `hc::poly`. Default `"poly"`.
    pub crate_path: String,
    /// Name of what the program was made from, for the header. Default empty.
    pub source: String,
    /// Largest number of operations in one function. Compile time grows faster than linearly above
    /// a few thousand. Above one or two hundred, the compiler may already stop turning lanes into
    /// vector instructions, which costs a factor of up to ten. Default 100.
    pub operations_per_function: usize,
}

impl Default for EmitOptions {
    fn default() -> EmitOptions {
        EmitOptions {
            type_name: "System".to_owned(),
            crate_path: "poly".to_owned(),
            source: String::new(),
            operations_per_function: 100,
        }
    }
}

/// Why the source cannot be written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EmitError {
    /// A type name that is not a Rust identifier.
    #[error("`{0}` cannot name a Rust type")]
    TypeName(String),
    /// A path to this crate that is not a Rust path.
    #[error("`{0}` is not a Rust path")]
    CratePath(String),
    /// Source that is not valid Rust: a fault of this module.
    #[error("the source does not parse: {0}")]
    Syntax(String),
}

/// Writes a program as a Rust module: a unit struct that implements [`Evaluate`](crate::Evaluate).
///
/// Program and options determine the bytes. The module needs only this crate, at
/// [`EmitOptions::crate_path`]. Over types of double precision its results agree bit for bit with
/// those of the [`Interpreter`](super::Interpreter). Over double-double they agree too, because
/// constants are written to about 32 digits.
///
/// # Errors
/// If an option is not a valid Rust name or path.
pub fn emit(program: &Program, options: &EmitOptions) -> Result<String, EmitError> {
    let name: syn::Ident =
        syn::parse_str(&options.type_name).map_err(|_| EmitError::TypeName(options.type_name.clone()))?;
    let path: syn::Path =
        syn::parse_str(&options.crate_path).map_err(|_| EmitError::CratePath(options.crate_path.clone()))?;
    let most = options.operations_per_function.max(1);

    let values = Straight { program, tape: &program.values, prefix: "Values", with_jacobian: false }.emit(most);
    let jacobian = Straight { program, tape: &program.jacobian, prefix: "Jacobian", with_jacobian: true }.emit(most);
    let tables = Tables::new(program);
    let (value_table, jacobian_table) = (register_table(&tables.values), register_table(&tables.jacobian));
    let taylor = taylor_table(&tables.taylor);

    let (m, n, k) = (program.equations, program.variables, program.parameters);
    let constants = program.constants.iter().map(|c| {
        let parts = [exact::to_parts(&c.re), exact::to_parts(&c.im)].concat().into_iter().map(number);
        quote!([#(#parts),*])
    });
    let live = values.live.max(jacobian.live);
    let (run_values, run_jacobian) = (&values.calls, &jacobian.calls);
    let zeros = zero_fill(&program.jacobian, m, n);
    let kernels = [&values.kernels, &jacobian.kernels];
    let module_doc = format!(" `F(x; p)`: {m} equations, {n} unknowns, {k} parameters, as straight-line code.");
    let type_doc = " The system; inputs and outputs are ordered as [`Evaluate`] says.";
    let constants_doc = " Real part (high, low) and imaginary part (high, low).";
    let tables_doc = " Instructions as tables: for Taylor coefficients, and for numbers whose operations are long.";
    let constant_count = program.constants.len();
    let [m, n, k, entries, live, constant_count] =
        [m, n, k, m * n, live, constant_count].map(Literal::usize_unsuffixed);
    let tokens = quote! {
        #![doc = #module_doc]
        #![cfg_attr(rustfmt, rustfmt_skip)]
        #![allow(unreachable_pub, unused_imports, clippy::all)]

        use #path::evaluate::Evaluate;
        use #path::program::generated::{Memory, Op, RegisterTape, Tables, TaylorTape, code, instruction, narrowest};
        use #path::scalar::Scalar;
        use #path::simd::{Isa, Kernel};
        use std::borrow::Cow;

        #[doc = #type_doc]
        #[derive(Clone, Copy, Debug, Default)]
        pub struct #name;

        #[doc = #constants_doc]
        static CONSTANTS: [[f64; 4]; #constant_count] = [#(#constants),*];

        #[doc = #tables_doc]
        static TABLES: Tables = Tables {
            values: #value_table,
            jacobian: #jacobian_table,
            taylor: #taylor,
        };

        impl Evaluate for #name {
            type Memory<S: Scalar> = Memory<S>;

            fn equations(&self) -> usize {
                #m
            }
            fn variables(&self) -> usize {
                #n
            }
            fn parameters(&self) -> usize {
                #k
            }
            fn memory<S: Scalar>(&self, isa: Isa) -> Memory<S> {
                Memory::new(isa, &CONSTANTS, #live, &TABLES)
            }
            fn values<S: Scalar>(&self, memory: &mut Memory<S>, x: &[S], p: &[S], values: &mut [S]) {
                let (x, p, values) = (&x[..#n], &p[..#k], &mut values[..#m]);
                if const { S::STRAIGHT.is_some() } {
                    if memory.is_straight() {
                        #run_values
                        return;
                    }
                }
                memory.interpret(&TABLES.values, x, p, values, &mut []);
            }
            fn jacobian<S: Scalar>(
                &self,
                memory: &mut Memory<S>,
                x: &[S],
                p: &[S],
                values: &mut [S],
                jacobian: &mut [S],
            ) {
                let (x, p, values, jacobian) = (&x[..#n], &p[..#k], &mut values[..#m], &mut jacobian[..#entries]);
                if const { S::STRAIGHT.is_some() } {
                    if memory.is_straight() {
                        #zeros
                        #run_jacobian
                        return;
                    }
                }
                memory.interpret(&TABLES.jacobian, x, p, values, jacobian);
            }
            fn taylor<S: Scalar>(&self, memory: &mut Memory<S>, order: usize, x: &[S], p: &[S], out: &mut [S]) {
                memory.taylor(&TABLES.taylor, order, x, p, out);
            }
        }

        #(#kernels)*
    };
    let file = syn::parse2(tokens).map_err(|e| EmitError::Syntax(e.to_string()))?;
    Ok(format!("{}{}", header(program, options), prettyplease::unparse(&file)))
}

/// The comment at the top of the file.
fn header(program: &Program, options: &EmitOptions) -> String {
    let source: String = options.source.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    format!(
        "// @generated by poly::program::emit; do not edit.\n// Source: {source}\n// Operations: {} for values, {} for values and Jacobian.\n// Input hash: {:016x}\n\n",
        program.value_operations(),
        program.jacobian_operations(),
        hash(program),
    )
}

/// FNV-1a over everything that the program is made of.
fn hash(program: &Program) -> u64 {
    let Program { equations, variables, parameters, constants, values, jacobian } = program;
    let mut text = format!("{equations} {variables} {parameters}");
    for c in constants {
        text.push_str(&format!(" {} {}", c.re, c.im));
    }
    for tape in [values, jacobian] {
        text.push_str(&format!(" {:?} {:?}", tape.instructions, tape.outputs));
    }
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}
