//! The rule that every dependency may be used in a program under MIT or Apache-2.0.

use super::Problem;
use crate::{Result, shell};
use serde_json::Value;

/// Licences that ask for nothing but their notice.
const PERMISSIVE: [&str; 14] = [
    "0BSD",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "CC0-1.0",
    "CDLA-Permissive-2.0",
    "ISC",
    "MIT",
    "MIT-0",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
];

/// Packages under MPL-2.0, used unchanged: it asks for the source of the package itself only.
/// The first opens serial ports in the bridge, the second drives the browser in the tests.
const MPL: [&str; 2] = ["serialport", "webdriver"];

/// Checks every package in the lock file.
pub(super) fn check() -> Result<Vec<Problem>> {
    let args = [
        "metadata",
        "--format-version",
        "1",
        "--all-features",
        "--quiet",
    ];
    let metadata = shell::capture(&mut shell::cargo(args))?;
    let metadata: Value = serde_json::from_str(&metadata)?;
    let packages = metadata["packages"]
        .as_array()
        .ok_or("cargo metadata lists no packages")?;
    Ok(packages.iter().filter_map(refused).collect())
}

/// The problem of one package of `cargo metadata`.
fn refused(package: &Value) -> Option<Problem> {
    let name = package["name"].as_str().unwrap_or_default();
    let licence = package["license"].as_str().unwrap_or("no licence");
    let is_known = |id: &str| PERMISSIVE.contains(&id) || (id == "MPL-2.0" && MPL.contains(&name));
    let what =
        || format!("{name} is under `{licence}`; choose another package, or list it with a reason");
    (!holds(licence, &is_known)).then(|| Problem::error("Cargo.lock", 0, what()))
}

/// True when an SPDX expression can be met by known licences alone: all of an `AND`, one of an
/// `OR`. The slash of older manifests means `OR`.
fn holds(expression: &str, is_known: &dyn Fn(&str) -> bool) -> bool {
    let expression = expression.trim();
    if let Some(parts) = split(expression, &[" OR ", "/"]) {
        return parts.iter().any(|part| holds(part, is_known));
    }
    if let Some(parts) = split(expression, &[" AND "]) {
        return parts.iter().all(|part| holds(part, is_known));
    }
    let inner = expression
        .strip_prefix('(')
        .and_then(|rest| rest.strip_suffix(')'));
    inner.map_or_else(|| is_known(expression), |inner| holds(inner, is_known))
}

/// Splits at an operator outside parentheses; `None` if there is none.
fn split<'a>(expression: &'a str, operators: &[&str]) -> Option<Vec<&'a str>> {
    let mut parts = Vec::new();
    let mut depth = 0_i32;
    let mut start = 0;
    for (at, letter) in expression.char_indices() {
        depth += i32::from(letter == '(') - i32::from(letter == ')');
        let found = operators
            .iter()
            .find(|operator| depth == 0 && expression[at..].starts_with(**operator));
        if let Some(operator) = found {
            parts.push(&expression[start..at]);
            start = at + operator.len();
        }
    }
    parts.push(&expression[start..]);
    (parts.len() > 1).then_some(parts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn expressions_are_understood() {
        let holds = |expression| holds(expression, &|id| PERMISSIVE.contains(&id));
        assert!(holds("MIT"));
        assert!(holds("MIT/Apache-2.0"));
        assert!(holds("GPL-3.0 OR MIT"));
        assert!(holds("(MIT OR Apache-2.0) AND Unicode-3.0"));
        assert!(holds("Apache-2.0 WITH LLVM-exception OR GPL-2.0"));
        assert!(!holds("MIT AND GPL-3.0"));
        assert!(!holds("(MIT OR GPL-3.0) AND LGPL-2.1"));
        assert!(!holds("no licence"));
    }

    #[test]
    fn a_refused_package_is_named() {
        let package = |licence: Value| refused(&json!({ "name": "p", "license": licence }));
        assert!(package(json!("ISC")).is_none());
        assert!(package(json!("MPL-2.0")).is_some());
        assert!(
            package(Value::Null)
                .unwrap()
                .what
                .contains("p is under `no licence`")
        );
    }
}
