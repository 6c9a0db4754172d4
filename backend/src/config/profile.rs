//! The profile of a DOP device: a file beside the configuration.

use super::check::Wrong;
use shared::dop::Profile;
use std::path::Path;
use toml::Spanned;

/// Larger files are no profiles.
const MAX_BYTES: u64 = 1024 * 1024;
/// Mistakes that are named at once.
const SHOWN: usize = 5;

/// Reads the profile that a device names.
pub(super) fn read(name: &Spanned<String>, beside: &Path) -> Result<Profile, Wrong> {
    let wrong = |text: String| Wrong {
        at: name.span().start,
        text: format!("`profile`: {text}"),
    };
    let path = beside.join(name.get_ref());
    let shown = path.display();
    let size = std::fs::metadata(&path).map(|m| m.len());
    let text = match size {
        Ok(size) if size > MAX_BYTES => {
            return Err(wrong(format!("{shown} is too large for a profile")));
        }
        _ => std::fs::read_to_string(&path)
            .map_err(|error| wrong(format!("can't read {shown}: {error}")))?,
    };
    Profile::from_json(&text).map_err(|problems| {
        let more = problems.len().saturating_sub(SHOWN);
        let mut lines: Vec<String> = problems
            .iter()
            .take(SHOWN)
            .map(ToString::to_string)
            .collect();
        if more > 0 {
            lines.push(format!("and {more} more"));
        }
        wrong(format!("{shown}, {}", lines.join("; ")))
    })
}
