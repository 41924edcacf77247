//! The program `hc`.

fn main() -> std::process::ExitCode {
    hc_cli::main()
}
