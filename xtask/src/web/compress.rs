//! Compression ahead of time, so that the server only picks a file.

use super::files::Folder;
use crate::Result;
use brotli::enc::BrotliEncoderParams;
use std::path::{Path, PathBuf};

/// Below this a compressed copy does not save a packet.
const WORTH_IT: usize = 1024;

/// The name of the compressed copy: `app.css` → `app.css.br`.
pub fn br_name(file: &Path) -> PathBuf {
    let mut name = file.as_os_str().to_owned();
    name.push(".br");
    PathBuf::from(name)
}

/// Compresses every file of the folder that is worth it, skipping those that did not change.
pub fn all(folder: &mut Folder) -> Result {
    for file in folder.files() {
        let raw = std::fs::read(&file)?;
        if raw.len() < WORTH_IT {
            continue;
        }
        let packed = br_name(&file);
        if folder.is_new(&file) || !packed.exists() {
            folder.write_path(&packed, &brotli(&raw)?)?;
        } else {
            folder.keep(&packed);
        }
    }
    Ok(())
}

/// Brotli at its best quality.
fn brotli(raw: &[u8]) -> Result<Vec<u8>> {
    let params = BrotliEncoderParams {
        quality: 11,
        lgwin: 22,
        size_hint: raw.len(),
        ..Default::default()
    };
    let mut packed = Vec::new();
    brotli::BrotliCompress(&mut &raw[..], &mut packed, &params)?;
    Ok(packed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_bytes_come_back() {
        let raw = b"torque torque torque position torque".repeat(64);
        let packed = brotli(&raw).unwrap();
        assert!(packed.len() < raw.len() / 10);
        let mut back = Vec::new();
        brotli::BrotliDecompress(&mut packed.as_slice(), &mut back).unwrap();
        assert_eq!(back, raw);
    }

    #[test]
    fn the_copy_keeps_the_whole_name() {
        assert_eq!(
            br_name(Path::new("css/app.css")),
            Path::new("css/app.css.br")
        );
    }
}
