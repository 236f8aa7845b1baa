//! Links `hypot` by its oldest version in glibc: see `src/oldest_hypot.rs`; and the same function once.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let of = |name: &str| std::env::var(name).unwrap_or_default();
    let target = ["OS", "ARCH", "ENV"].map(|part| of(&format!("CARGO_CFG_TARGET_{part}")));
    if target == ["linux", "x86_64", "gnu"] {
        println!("cargo:rustc-link-arg-cdylib=-Wl,--wrap=hypot");
        // Of functions that are the same machine code, one is kept; the linker of this platform, lld, can. No pointers of functions
        // are compared.
        println!("cargo:rustc-link-arg-cdylib=-Wl,--icf=all");
    }
}
