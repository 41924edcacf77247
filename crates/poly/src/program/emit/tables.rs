//! Programs as tables.

use super::literal::index;
use crate::program::tape::RegisterTape;
use crate::program::taylor::{TaylorCode, TaylorTape};
use proc_macro2::{Literal, TokenStream};
use quote::{format_ident, quote};

/// Values, or values and Jacobian.
pub(super) fn register_table(tape: &RegisterTape) -> TokenStream {
    let codes = tape.code.iter().map(|code| {
        let (op, target) = (format_ident!("{}", format!("{:?}", code.op)), index(code.target));
        let operands = code.operands.map(index);
        quote!(instruction(Op::#op, #target, [#(#operands),*]))
    });
    let outputs = tape.outputs.iter().map(|&(slot, place)| {
        let (slot, place) = (index(slot), index(place));
        quote!((#slot, #place))
    });
    let zeros = tape.zeros.iter().map(|&slot| index(slot));
    let inputs = tape.inputs.map(Literal::usize_unsuffixed);
    let size = Literal::usize_unsuffixed(tape.size);
    quote! {
        RegisterTape {
            code: Cow::Borrowed(&[#(#codes),*]),
            outputs: Cow::Borrowed(&[#(#outputs),*]),
            zeros: Cow::Borrowed(&[#(#zeros),*]),
            inputs: [#(#inputs),*],
            size: #size,
        }
    }
}

/// Taylor coefficients.
pub(super) fn taylor_table(tape: &TaylorTape) -> TokenStream {
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
