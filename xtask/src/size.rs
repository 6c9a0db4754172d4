//! The size of the page on the wire.

use crate::Result;
use crate::web::Bundle;

/// The bar: what a browser must load before it can show anything, compressed.
const BAR: u64 = 250_000;

/// Prints what each part of the bundle weighs, and fails above the bar.
pub fn size(bundle: &Bundle) -> Result {
    let total = measure(bundle)?;
    if total > BAR {
        let over = kilo(total - BAR);
        return Err(format!(
            "the page is {over:.1} kB too large; look for large dependencies with \
             `cargo tree -p frontend` and for long texts in shared/data"
        )
        .into());
    }
    Ok(())
}

/// Prints what each part of the bundle weighs, and returns the sum.
fn measure(bundle: &Bundle) -> Result<u64> {
    let mut total = 0;
    for file in [&bundle.wasm, &bundle.js] {
        let raw = std::fs::metadata(file)?.len();
        let packed = std::fs::metadata(crate::web::br_name(file))?.len();
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        println!(
            "{name:<20} {:>7.1} kB, {:>6.1} kB as brotli",
            kilo(raw),
            kilo(packed)
        );
        total += packed;
    }
    println!(
        "{:<20} {:>18.1} kB of {:.0} kB allowed",
        "on the wire",
        kilo(total),
        kilo(BAR)
    );
    Ok(total)
}

#[expect(
    clippy::cast_precision_loss,
    reason = "sizes of files, rounded for print"
)]
fn kilo(bytes: u64) -> f64 {
    bytes as f64 / 1000.0
}
