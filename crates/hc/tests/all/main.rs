//! Tests of `hc` through its public items, in one program: each program of tests links the library
//! anew. Those that count what a process allocates are programs of their own.

mod certifying;
mod chicago;
mod common;
mod components;
mod conics;
mod generators;
mod mixed_volume;
mod orbits;
mod overdetermined;
mod runs;
mod scales;
mod singular;
mod small_systems;
mod solving;
mod stated;
mod symmetry;
mod tracking;
mod written;
