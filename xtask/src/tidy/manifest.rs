//! Rules for the root of the workspace.

use super::Problem;
use std::path::Path;

/// What a reader expects to find beside `Cargo.toml`.
const EXPECTED: [&str; 5] = [
    "README.md",
    "CHANGELOG.md",
    "LICENSE-MIT",
    "LICENSE-APACHE",
    ".ci/run",
];

/// The expected files that are not there.
pub(super) fn missing_files(root: &Path) -> Vec<Problem> {
    let missing = EXPECTED.iter().filter(|name| !root.join(name).is_file());
    missing
        .map(|name| Problem::error(name, 0, "is missing"))
        .collect()
}

/// Dependencies out of order in `[workspace.dependencies]`, within each block between blank lines.
pub(super) fn unsorted(path: &str, manifest: &str) -> Vec<Problem> {
    let mut problems = Vec::new();
    let mut inside = false;
    let mut last = "";
    for (number, line) in manifest.lines().enumerate() {
        if line.starts_with('[') {
            inside = line == "[workspace.dependencies]";
        }
        let Some((name, _)) = line
            .split_once(" = ")
            .filter(|_| inside && !line.starts_with('#'))
        else {
            last = "";
            continue;
        };
        // The members of the workspace come first, in the order of the data flow.
        if line.contains("path = ") {
            continue;
        }
        if name < last {
            problems.push(Problem::error(
                path,
                number + 1,
                format!("`{name}` stands after `{last}`"),
            ));
        }
        last = name;
    }
    problems
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_is_checked_in_the_workspace_table_only() {
        let table = |text: &str| unsorted("Cargo.toml", text).len();
        assert_eq!(
            table("[workspace.dependencies]\nshared = { path = \"shared\" }\na = \"1\"\nb = \"1\""),
            0
        );
        assert_eq!(table("[workspace.dependencies]\nb = \"1\"\na = \"1\""), 1);
        assert_eq!(table("[workspace.package]\nb = \"1\"\na = \"1\""), 0);
        assert_eq!(table("[workspace.dependencies]\nb = \"1\"\n\na = \"1\""), 0);
    }
}
