//! Rules for every text file.

use super::Problem;

/// What betrays the machine on which a file was written. In two parts, so that this file passes.
const PLACES: [&str; 10] = [
    concat!("/ro", "ot/"),
    concat!("/wo", "rk/"),
    concat!("/ho", "me/"),
    concat!("/Us", "ers/"),
    concat!("C:\\Us", "ers"),
    concat!("index.", "crates.io"),
    concat!("static.", "crates.io"),
    concat!("registry.", "npmjs.org"),
    concat!("pypi", ".org"),
    concat!("deb.", "debian.org"),
];

/// Where the lock file may take packages from.
const INDEX: &str = "source = \"registry+https://github.com/rust-lang/crates.io-index\"";

/// Checks one file.
pub(super) fn check(path: &str, text: &str) -> Vec<Problem> {
    let is_csv = path.ends_with(".csv");
    let is_lock = path.ends_with("Cargo.lock");
    let mut problems = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let mut report = |what: String| problems.push(Problem::error(path, number + 1, what));
        for place in PLACES {
            if line.contains(place) {
                report(format!("`{place}` is true on one machine only"));
            }
        }
        if is_csv && line != line.trim_end() {
            report("blanks at the end of the line".into());
        }
        if is_lock && line.starts_with("source = ") && line != INDEX {
            report("a package that is not from the public index".into());
        }
    }
    problems
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_found_with_their_line() {
        let text = format!("fine\nsee {}x\n", PLACES[0]);
        let problems = check("README.md", &text);
        assert_eq!(problems.len(), 1);
        assert_eq!(problems[0].line, 2);
    }

    #[test]
    fn blanks_matter_in_tables_only() {
        assert_eq!(check("a.csv", "key,label\na,b \nc,d\t\n").len(), 2);
        assert_eq!(check("a.csv", "key,label\na,\n").len(), 0);
        assert_eq!(check("a.md", "two blanks break a line  \n").len(), 0);
    }

    #[test]
    fn the_lock_file_names_the_public_index() {
        assert!(check("Cargo.lock", INDEX).is_empty());
        assert_eq!(
            check("Cargo.lock", "source = \"registry+https://example.org/\"").len(),
            1
        );
    }
}
