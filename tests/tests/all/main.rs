//! The end-to-end tests, in one program: each program of tests links all libraries anew.

mod guide;
mod hc_certify;
#[cfg(unix)]
mod hc_checkpoint;
mod hc_decompose;
mod hc_families;
#[cfg(unix)]
mod hc_interrupt;
#[cfg(unix)]
mod hc_mpi;
mod hc_solve;
mod hc_standard_input;
mod hc_sweep;
mod links;
#[cfg(unix)]
mod mpi;
mod one_build;
mod outputs;
mod rooms;
mod tdoa_bad_input;
mod tdoa_calibrate;
mod tdoa_candidates;
mod tdoa_experiments;
mod tdoa_faults;
mod tdoa_input;
#[cfg(unix)]
mod tdoa_interrupt;
mod tdoa_known;
mod tdoa_listen;
mod tdoa_locate;
mod tdoa_mat;
mod tdoa_mirror;
#[cfg(unix)]
mod tdoa_mpi;
mod tdoa_real;
mod tdoa_report;
mod tdoa_simulate;
mod tdoa_solve;
mod tdoa_solve_space;
mod tdoa_space;
mod tdoa_space_input;
mod tdoa_tables;
