//! Values and Jacobian as straight-line code, in functions of limited length.

use super::literal::{index, number};
use crate::exact;
use crate::program::instruction::{Instruction, Op, Operand, Tape};
use crate::program::straight_line::Program;
use proc_macro2::{Literal, TokenStream};
use quote::{format_ident, quote};
use std::collections::{BTreeMap, BTreeSet};

/// Kernels and the statements that run them.
pub(super) struct Emitted {
    pub(super) kernels: TokenStream,
    pub(super) calls: TokenStream,
    pub(super) live: usize,
}

/// Values or Jacobian as straight-line code.
pub(super) struct Straight<'a> {
    pub(super) program: &'a Program,
    pub(super) tape: &'a Tape,
    pub(super) prefix: &'a str,
    pub(super) with_jacobian: bool,
}

impl Straight<'_> {
    pub(super) fn emit(&self, most: usize) -> Emitted {
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
                for &operand in instruction.operands() {
                    note_constant(operand, &mut constants);
                }
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
                const WIDEST: Isa = S::WIDEST;
                const NARROWEST: Isa = narrowest::<S>();

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

/// Writes of the structural zeros of the Jacobian.
pub(super) fn zero_fill(tape: &Tape, m: usize, n: usize) -> TokenStream {
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
