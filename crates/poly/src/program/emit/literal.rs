//! Numbers as literals.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

/// A double as a literal that reads back to the same bits.
pub(super) fn number(x: f64) -> TokenStream {
    if x.is_nan() {
        return quote!(f64::NAN);
    }
    if x.is_infinite() {
        return if x > 0.0 { quote!(f64::INFINITY) } else { quote!(f64::NEG_INFINITY) };
    }
    let literal: Literal = format!("{:?}", x.abs()).parse().expect("a float prints as a literal");
    if x.is_sign_negative() { quote!(-#literal) } else { quote!(#literal) }
}

/// An index as a literal without a type.
pub(super) fn index(k: u32) -> Literal {
    Literal::u32_unsuffixed(k)
}
