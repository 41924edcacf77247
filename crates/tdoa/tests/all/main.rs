//! Tests of `tdoa` through its public items, in one program: each program of tests links the library
//! anew. The one that counts what a process allocates is a program of its own.

mod clean_networks;
mod common;
mod hard_networks;
