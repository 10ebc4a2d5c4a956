//! The committed header is the one that the source makes; `UNDRIFT_BLESS=1` writes it.

use std::path::Path;

#[test]
fn the_header_is_made_from_the_source() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(root.join("cbindgen.toml")).unwrap();
    let mut builder = cbindgen::Builder::new().with_config(config);
    for file in [
        "types.rs",
        "status.rs",
        "sensor.rs",
        "filter.rs",
        "update.rs",
        "read.rs",
        "allocator.rs",
        "navigator.rs",
    ] {
        builder = builder.with_src(root.join("src").join(file));
    }
    let mut made = Vec::new();
    builder.generate().unwrap().write(&mut made);
    // Rustdoc needs the brackets of units escaped, C does not.
    let made = String::from_utf8(made).unwrap();
    let made = made.replace(r"\[", "[").replace(r"\]", "]");
    let path = root.join("include/undrift.h");
    if std::env::var_os("UNDRIFT_BLESS").is_some() {
        std::fs::write(&path, &made).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        committed == made,
        "include/undrift.h is not what the source makes: run this test with UNDRIFT_BLESS=1"
    );
}
