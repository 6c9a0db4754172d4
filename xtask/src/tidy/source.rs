//! Rules for Rust sources.

use super::Problem;

/// From here on a file is worth a look.
const LONG: usize = 400;

/// Above this a file must be divided.
const TOO_LONG: usize = 500;

/// What must not stay. In two parts, so that this file passes.
const LEFTOVERS: [&str; 5] = [
    concat!("to", "do!("),
    concat!("unimple", "mented!("),
    concat!("#[ig", "nore"),
    concat!("FIX", "ME"),
    concat!("db", "g!("),
];

/// Checks one file.
pub(super) fn check(path: &str, text: &str) -> Vec<Problem> {
    let mut problems = Vec::new();
    for (number, line) in text.lines().enumerate() {
        for leftover in LEFTOVERS
            .iter()
            .filter(|leftover| line.contains(**leftover))
        {
            problems.push(Problem::error(
                path,
                number + 1,
                format!("`{leftover}` must not stay"),
            ));
        }
    }
    problems.extend(unexplained(path, text));
    problems.extend(length(path, text));
    problems
}

/// The code of a file without its module of unit tests, which stands at the end.
pub(super) fn without_tests(text: &str) -> &str {
    text.split_once("\n#[cfg(test)]\nmod tests {")
        .map_or(text, |(code, _)| code)
}

/// Files that are too long to be read at one sitting. Tests are lists, and may be long.
fn length(path: &str, text: &str) -> Option<Problem> {
    if path.starts_with("tests/") || path.contains("/tests/") || path.ends_with("/tests.rs") {
        return None;
    }
    let lines = without_tests(text).lines().count();
    let what = || format!("{lines} lines; divide it (at most {LONG}, never above {TOO_LONG})");
    match lines {
        0..=LONG => None,
        _ if lines <= TOO_LONG => Some(Problem::warning(path, 0, what())),
        _ => Some(Problem::error(path, 0, what())),
    }
}

/// Lints that are switched off without a reason.
fn unexplained(path: &str, text: &str) -> Vec<Problem> {
    let mut problems = Vec::new();
    for attribute in ["allow(", "expect("] {
        for (start, _) in text.match_indices(attribute) {
            let before = text[..start].trim_end();
            let is_attribute = before.ends_with("#[") || before.ends_with("#![");
            let body = text[start..].split_once(")]").map_or("", |(body, _)| body);
            if is_attribute && !body.contains("reason") {
                let line = text[..start].lines().count();
                problems.push(Problem::error(
                    path,
                    line,
                    format!("`{attribute}…)` needs a reason"),
                ));
            }
        }
    }
    problems
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leftovers_are_found() {
        for leftover in LEFTOVERS {
            assert_eq!(
                check("a.rs", &format!("fn a() {{\n{leftover}\n")).len(),
                1,
                "{leftover}"
            );
        }
    }

    #[test]
    fn switched_off_lints_need_a_reason() {
        let bad = concat!("#[all", "ow(dead_code)]\nfn a() {}\n");
        let problems = check("a.rs", bad);
        assert_eq!(problems.len(), 1);
        assert_eq!(problems[0].line, 1);
        let good = "#[expect(\n    dead_code,\n    reason = \"read by a macro\"\n)]\nfn a() {}\n";
        assert!(check("a.rs", good).is_empty());
        assert!(check("a.rs", "value.expect(\"a value\")").is_empty());
    }

    #[test]
    fn length_counts_code_not_tests() {
        let code = "x\n".repeat(450);
        assert!(check("a.rs", &code)[0].warning);
        assert!(!check("a.rs", &code.repeat(2))[0].warning);
        let tested = format!("x\n#[cfg(test)]\nmod tests {{\n{code}}}\n");
        assert!(check("a.rs", &tested).is_empty());
        assert!(check("tests/tests/a.rs", &code).is_empty());
    }
}
