//! The program `tdoa`, as a target of this package: cargo builds it before the tests and tells them
//! where it is.

fn main() -> std::process::ExitCode {
    tdoa_cli::main()
}
