//! The size of the page on the wire.

use crate::Result;
use crate::web::{Bundle, Program};

/// The bar: what a browser must load before it can show anything, compressed. A program that is
/// loaded later is waited for as well, so it has the same bar.
const BAR: u64 = 250_000;

/// Programs that are above the bar, and what they may not exceed until they are below it again. To
/// be emptied, not to be added to.
const DEBTS: [(&str, u64); 2] = [("actuator", 263_000), ("hart", 256_000)];

/// Prints what each part of the bundle weighs, and fails above the bar.
pub fn size(bundle: &Bundle) -> Result {
    let mut said = Vec::new();
    let page = (&bundle.page, "first load");
    let later = bundle.later.iter().map(|program| (program, "on demand"));
    for (program, when) in [page].into_iter().chain(later) {
        let debt = DEBTS.iter().find(|(name, _)| *name == program.name);
        let bar = debt.map_or(BAR, |(_, most)| *most);
        let total = measure(program, when, bar)?;
        if total > bar {
            said.push(format!(
                "{} is {:.1} kB too large; look for large dependencies with `cargo tree -p \
                 frontend` and for long texts in shared/data",
                program.name,
                kilo(total - bar)
            ));
        }
    }
    if said.is_empty() {
        Ok(())
    } else {
        Err(said.join("\n").into())
    }
}

/// Prints what each part of a program weighs, and returns the sum.
fn measure(program: &Program, when: &str, bar: u64) -> Result<u64> {
    let mut total = 0;
    for file in [&program.wasm, &program.js] {
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
        "{when:<20} {:>18.1} kB of {:.0} kB allowed",
        kilo(total),
        kilo(bar)
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
