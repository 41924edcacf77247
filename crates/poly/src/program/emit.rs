//! Programs as Rust source: straight-line code generic over [`Scalar`](crate::Scalar).

use super::Program;
use super::instruction::{Instruction, Op, Operand, Tape};
use super::taylor::{TaylorCode, TaylorTape};
use crate::exact;
use proc_macro2::{Literal, TokenStream};
use quote::{format_ident, quote};
use std::collections::{BTreeMap, BTreeSet};

/// How source is written.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct EmitOptions {
    /// Name of the unit struct that implements [`Evaluate`](crate::Evaluate). Default `"System"`.
    pub type_name: String,
    /// Path by which the source reaches this crate, such as `hc::poly`. Default `"poly"`.
    pub crate_path: String,
    /// What the program was made from, for the header. Default empty.
    pub source: String,
    /// Most operations in one function. Compile time grows faster than linearly above a few thousand; already
    /// above a hundred or two the compiler may give up turning lanes into vector instructions, which
    /// costs a factor of up to ten. Default 100.
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

/// Why source cannot be written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EmitError {
    /// The name of the type is no Rust identifier.
    #[error("`{0}` cannot name a Rust type")]
    TypeName(String),
    /// The path to this crate is no Rust path.
    #[error("`{0}` is not a Rust path")]
    CratePath(String),
    /// What was written is not Rust: a fault of this module.
    #[error("the source does not parse: {0}")]
    Syntax(String),
}

/// Writes a program as a Rust module: a unit struct that implements [`Evaluate`](crate::Evaluate).
///
/// The same program and options give the same bytes. The module needs nothing but this crate, reached by
/// [`EmitOptions::crate_path`]; results agree bit for bit with the [`Interpreter`](super::Interpreter) over types
/// of double precision, and over double-double as constants are written to about 32 digits.
///
/// # Errors
/// If an option is not what Rust admits as a name or a path.
pub fn emit(program: &Program, options: &EmitOptions) -> Result<String, EmitError> {
    let name: syn::Ident =
        syn::parse_str(&options.type_name).map_err(|_| EmitError::TypeName(options.type_name.clone()))?;
    let path: syn::Path =
        syn::parse_str(&options.crate_path).map_err(|_| EmitError::CratePath(options.crate_path.clone()))?;
    let most = options.operations_per_function.max(1);

    let values = Straight { program, tape: &program.values, prefix: "Values", with_jacobian: false }.emit(most);
    let jacobian = Straight { program, tape: &program.jacobian, prefix: "Jacobian", with_jacobian: true }.emit(most);
    let taylor = taylor_table(&TaylorTape::new(&program.values, program.layout()));

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
    let taylor_doc = " Instructions for Taylor coefficients.";
    let constant_count = program.constants.len();
    let [m, n, k, entries, live, constant_count] =
        [m, n, k, m * n, live, constant_count].map(Literal::usize_unsuffixed);
    let tokens = quote! {
        #![doc = #module_doc]
        #![cfg_attr(rustfmt, rustfmt_skip)]
        #![allow(unreachable_pub, unused_imports, clippy::all)]

        use #path::evaluate::Evaluate;
        use #path::program::generated::{Memory, Op, TaylorTape, code};
        use #path::scalar::Scalar;
        use #path::simd::{Isa, Kernel};
        use std::borrow::Cow;

        #[doc = #type_doc]
        #[derive(Clone, Copy, Debug, Default)]
        pub struct #name;

        #[doc = #constants_doc]
        static CONSTANTS: [[f64; 4]; #constant_count] = [#(#constants),*];

        #[doc = #taylor_doc]
        static TAYLOR: TaylorTape = #taylor;

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
                Memory::new(isa, &CONSTANTS, #live, &TAYLOR)
            }
            fn values<S: Scalar>(&self, memory: &mut Memory<S>, x: &[S], p: &[S], values: &mut [S]) {
                let (x, p, values) = (&x[..#n], &p[..#k], &mut values[..#m]);
                #run_values
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
                #zeros
                #run_jacobian
            }
            fn taylor<S: Scalar>(&self, memory: &mut Memory<S>, order: usize, x: &[S], p: &[S], out: &mut [S]) {
                memory.taylor(&TAYLOR, order, x, p, out);
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

/// A double as a literal that reads back to the same bits.
fn number(x: f64) -> TokenStream {
    if x.is_nan() {
        return quote!(f64::NAN);
    }
    if x.is_infinite() {
        return if x > 0.0 { quote!(f64::INFINITY) } else { quote!(f64::NEG_INFINITY) };
    }
    let literal: Literal = format!("{:?}", x.abs()).parse().expect("a float prints as a literal");
    if x.is_sign_negative() { quote!(-#literal) } else { quote!(#literal) }
}

fn index(k: u32) -> Literal {
    Literal::u32_unsuffixed(k)
}

/// Writes of the structural zeros of the Jacobian.
fn zero_fill(tape: &Tape, m: usize, n: usize) -> TokenStream {
    let zeros: Vec<Literal> = tape.zeros(m * (n + 1)).into_iter().map(|slot| index(slot - m as u32)).collect();
    if zeros.is_empty() {
        return TokenStream::new();
    }
    quote! {
        for zero in [#(#zeros),*] {
            jacobian[zero] = S::zero();
        }
    }
}

/// The name of the scalar's method for an operation.
fn method(op: Op) -> proc_macro2::Ident {
    format_ident!(
        "{}",
        match op {
            Op::Add => "add",
            Op::Sub => "sub",
            Op::Neg => "neg",
            Op::Mul => "mul",
            Op::MulReal => "mul_real",
            Op::Sqr => "sqr",
            Op::Inv => "inv",
            Op::MulAdd => "mul_add",
            Op::MulSub => "mul_sub",
            Op::SubMul => "sub_mul",
            Op::MulRealAdd => "mul_real_add",
            Op::MulMulAdd => "mul_mul_add",
            Op::MulMulSub => "mul_mul_sub",
        }
    )
}

/// Kernels and the statements that run them.
struct Emitted {
    kernels: TokenStream,
    calls: TokenStream,
    live: usize,
}

/// Values or Jacobian as straight-line code.
struct Straight<'a> {
    program: &'a Program,
    tape: &'a Tape,
    prefix: &'a str,
    with_jacobian: bool,
}

impl Straight<'_> {
    fn emit(&self, most: usize) -> Emitted {
        let count = self.tape.instructions.len();
        let parts = count.div_ceil(most).max(1);
        let size = count.div_ceil(parts).max(1);
        let part_of = |k: u32| k as usize / size;

        // Results that a later function needs get a place in `live`.
        let mut live: BTreeMap<u32, u32> = BTreeMap::new();
        let mut used = vec![false; count];
        for (k, instruction) in self.tape.instructions.iter().enumerate() {
            for operand in instruction.operands() {
                if let Operand::Temporary(j) = *operand {
                    used[j as usize] = true;
                    if part_of(j) != part_of(k as u32) {
                        let next = live.len() as u32;
                        live.entry(j).or_insert(next);
                    }
                }
            }
        }
        let mut stores: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        let mut direct = Vec::new();
        for &(slot, operand) in &self.tape.outputs {
            match operand {
                Operand::Temporary(k) => stores.entry(k).or_default().push(slot),
                other => direct.push((slot, other)),
            }
        }

        let (mut kernels, mut calls) = (TokenStream::new(), TokenStream::new());
        for part in 0..parts {
            let range = part * size..count.min((part + 1) * size);
            let mut body = Vec::new();
            let mut constants = BTreeSet::new();
            if part == 0 {
                for &(slot, operand) in &direct {
                    note_constant(operand, &mut constants);
                    let (target, value) = (self.output(slot), value_of(operand));
                    body.push(quote!(#target = #value.clone();));
                }
            }
            for k in range.clone() {
                let instruction = &self.tape.instructions[k];
                let k = k as u32;
                instruction.operands().iter().for_each(|&operand| note_constant(operand, &mut constants));
                let value = self.expression(instruction, |j| {
                    if range.contains(&(j as usize)) {
                        let name = format_ident!("t{j}");
                        quote!(&#name)
                    } else {
                        let place = index(live[&j]);
                        quote!(&live[#place])
                    }
                });
                let slots = stores.get(&k).map_or(&[][..], Vec::as_slice);
                if let ([slot], false) = (slots, used[k as usize]) {
                    let target = self.output(*slot);
                    body.push(quote!(#target = #value;));
                    continue;
                }
                let name = format_ident!("t{k}");
                body.push(quote!(let #name = #value;));
                for &slot in slots {
                    let target = self.output(slot);
                    body.push(quote!(#target = #name.clone();));
                }
                if let Some(&place) = live.get(&k) {
                    let place = index(place);
                    body.push(quote!(live[#place] = #name.clone();));
                }
            }
            let constants = constants.into_iter().map(|k| self.constant(k));
            let (kernel, call) = self.kernel(part, live.len(), &quote!(#(#constants)* #(#body)*));
            kernels.extend(kernel);
            calls.extend(call);
        }
        Emitted { kernels, calls, live: live.len() }
    }

    fn output(&self, slot: u32) -> TokenStream {
        match slot.checked_sub(self.program.equations as u32) {
            None => {
                let slot = index(slot);
                quote!(values[#slot])
            }
            Some(entry) => {
                let entry = index(entry);
                quote!(jacobian[#entry])
            }
        }
    }

    fn expression(&self, instruction: &Instruction, temporary: impl Fn(u32) -> TokenStream) -> TokenStream {
        let method = method(instruction.op);
        let operands = instruction.operands().iter().map(|&operand| match operand {
            Operand::Temporary(k) => temporary(k),
            other => {
                let value = value_of(other);
                quote!(&#value)
            }
        });
        quote!(S::#method(#(#operands),*))
    }

    fn constant(&self, k: u32) -> TokenStream {
        let name = format_ident!("c{k}");
        let c = &self.program.constants[k as usize];
        let re = exact::to_parts(&c.re).map(number);
        let im = exact::to_parts(&c.im).map(number);
        quote!(let #name = S::from_parts([#(#re),*], [#(#im),*]);)
    }

    /// One kernel type and its call.
    fn kernel(&self, part: usize, live: usize, body: &TokenStream) -> (TokenStream, TokenStream) {
        let name = format_ident!("{}{part}", self.prefix);
        let (m, n, k) = (self.program.equations, self.program.variables, self.program.parameters);
        let [m, n, k, entries] = [m, n, k, m * n].map(Literal::usize_unsuffixed);
        let (mut fields, mut names, mut given) = (
            quote!(x: &'a [S; #n], p: &'a [S; #k], values: &'a mut [S; #m]),
            quote!(x, p, values),
            quote! {
                x: x.first_chunk().expect("as long as cut"),
                p: p.first_chunk().expect("as long as cut"),
                values: values.first_chunk_mut().expect("as long as cut"),
            },
        );
        if self.with_jacobian {
            fields.extend(quote!(, jacobian: &'a mut [S; #entries]));
            names.extend(quote!(, jacobian));
            given.extend(quote!(jacobian: jacobian.first_chunk_mut().expect("as long as cut"),));
        }
        if live > 0 {
            let live = Literal::usize_unsuffixed(live);
            fields.extend(quote!(, live: &'a mut [S; #live]));
            names.extend(quote!(, live));
            given.extend(quote!(live: memory.live.first_chunk_mut().expect("made by Memory::new"),));
        }
        let kernel = quote! {
            struct #name<'a, S> { #fields }

            impl<S: Scalar> Kernel for #name<'_, S> {
                type Output = ();

                #[inline(always)]
                #[allow(unused_variables)]
                fn run(self) {
                    let Self { #names } = self;
                    #body
                }
            }
        };
        (kernel, quote!(memory.isa.run(#name { #given });))
    }
}

fn note_constant(operand: Operand, constants: &mut BTreeSet<u32>) {
    if let Operand::Constant(k) = operand {
        constants.insert(k);
    }
}

/// An input as an expression.
fn value_of(operand: Operand) -> TokenStream {
    match operand {
        Operand::Constant(k) => {
            let name = format_ident!("c{k}");
            quote!(#name)
        }
        Operand::Parameter(k) => {
            let k = index(k);
            quote!(p[#k])
        }
        Operand::Variable(k) => {
            let k = index(k);
            quote!(x[#k])
        }
        Operand::Temporary(k) => {
            let name = format_ident!("t{k}");
            quote!(#name)
        }
    }
}

/// The Taylor program as a static table: its instructions do so much each that finding them costs little,
/// and as straight-line code they would take minutes to compile.
fn taylor_table(tape: &TaylorTape) -> TokenStream {
    let codes = |group: &[TaylorCode]| {
        let codes = group.iter().map(|code| {
            let op = format_ident!("{}", format!("{:?}", code.op));
            let (kind, target) = (Literal::u8_unsuffixed(code.kind), index(code.target));
            let operands = code.operands.map(index);
            quote!(code(Op::#op, #kind, #target, [#(#operands),*]))
        });
        quote!(Cow::Borrowed(&[#(#codes),*]))
    };
    let (parameters_only, variables_only) = (codes(&tape.parameters_only), codes(&tape.variables_only));
    let mixed = codes(&tape.mixed);
    let outputs = tape.outputs.iter().map(|&place| index(place));
    let inputs = tape.inputs.map(Literal::usize_unsuffixed);
    let size = Literal::usize_unsuffixed(tape.size);
    quote! {
        TaylorTape {
            parameters_only: #parameters_only,
            variables_only: #variables_only,
            mixed: #mixed,
            outputs: Cow::Borrowed(&[#(#outputs),*]),
            inputs: [#(#inputs),*],
            size: #size,
        }
    }
}
