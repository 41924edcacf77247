//! The Taylor program as a table.

use super::literal::index;
use crate::program::taylor::{TaylorCode, TaylorTape};
use proc_macro2::{Literal, TokenStream};
use quote::{format_ident, quote};

/// The Taylor program as a static table: its instructions do so much each that finding them costs
/// little, and as straight-line code they would take minutes to compile.
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
