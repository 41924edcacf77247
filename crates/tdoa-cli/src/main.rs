//! The program `tdoa`.

fn main() -> std::process::ExitCode {
    tdoa_cli::main()
}
