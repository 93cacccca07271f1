//! Packs the charts' library, which is most of what the program carries along: a third of its bytes.

use miniz_oxide::deflate::compress_to_vec_zlib;
use std::path::Path;
use std::{env, fs, io};

/// In the order in which pages need them.
const PARTS: [&str; 2] = ["page/vendor/bokeh.min.js", "page/vendor/bokeh-api.min.js"];
/// The smallest result.
const LEVEL: u8 = 9;

fn main() -> io::Result<()> {
    let mut script = Vec::new();
    for part in PARTS {
        println!("cargo:rerun-if-changed={part}");
        script.extend(fs::read(part)?);
        script.push(b'\n');
    }
    let folder = env::var_os("OUT_DIR").expect("cargo sets it");
    fs::write(Path::new(&folder).join("bokeh.zlib"), compress_to_vec_zlib(&script, LEVEL))
}
