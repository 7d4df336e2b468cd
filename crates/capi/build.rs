//! The name by which the dynamic linker knows the library: it changes when the interface does.

fn main() {
    if std::env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("linux") {
        println!("cargo:rustc-cdylib-link-arg=-Wl,-soname,libmoldloft.so.1");
    }
}
