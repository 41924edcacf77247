//! `cargo xtask`, as a target of this package.

fn main() -> anyhow::Result<()> {
    xtask::main()
}
