//! The rule that `shared` does no I/O, reads no clock, and uses no randomness.
//!
//! The compiler cannot hold this: `std::time::Instant` compiles for the browser, and panics there.

use super::{Problem, source};

/// What `shared` must not name.
const IMPURE: [&str; 9] = [
    "std::time",
    "std::fs",
    "std::net",
    "std::env",
    "std::process",
    "std::thread",
    "rand",
    "Instant",
    "SystemTime",
];

/// Checks one file, if it is part of `shared`. Unit tests may do what they like.
pub(super) fn check(path: &str, text: &str) -> Vec<Problem> {
    if !path.starts_with("shared/src/") {
        return Vec::new();
    }
    let mut problems = Vec::new();
    for (number, line) in source::without_tests(text).lines().enumerate() {
        let code = line.split_once("//").map_or(line, |(code, _)| code);
        for word in IMPURE.iter().filter(|word| has_word(code, word)) {
            let what = format!("`{word}` in shared, which is pure; let the caller pass it in");
            problems.push(Problem::error(path, number + 1, what));
        }
    }
    problems
}

/// True when `word` stands in `code` with no letter, digit or underscore beside it.
fn has_word(code: &str, word: &str) -> bool {
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    code.match_indices(word).any(|(start, _)| {
        let before = code[..start].chars().next_back();
        let after = code[start + word.len()..].chars().next();
        !before.is_some_and(is_part) && !after.is_some_and(is_part)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clocks_and_files_are_refused_in_shared() {
        assert_eq!(
            check("shared/src/a.rs", "use std::time::Duration;").len(),
            1
        );
        assert_eq!(
            check("shared/src/a.rs", "let now = Instant::now();").len(),
            1
        );
        assert!(check("backend/src/a.rs", "use std::time::Duration;").is_empty());
    }

    #[test]
    fn only_whole_words_of_code_count() {
        assert!(check("shared/src/a.rs", "/// `Instant` panics in a browser").is_empty());
        assert!(check("shared/src/a.rs", "let operand = Instantly;").is_empty());
        assert!(
            check(
                "shared/src/a.rs",
                "a\n#[cfg(test)]\nmod tests {\nuse std::fs;"
            )
            .is_empty()
        );
    }
}
