//! Keys to actions.

/// What a key asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// The list of keys.
    Help,
    /// Into the search of this screen.
    Find,
    /// Next entry of the list of this screen.
    Next,
    /// Previous entry.
    Previous,
    /// To the decode screen.
    Decode,
    /// To the diagnostic objects.
    Dop,
    /// To the devices.
    Devices,
    /// To the traffic.
    Traffic,
    /// To the snapshots.
    Snapshots,
    /// To the settings.
    Settings,
    /// Close what lies over the page.
    Close,
}

/// All keys with what they do, for the help.
pub const KEYS: [(&str, &str); 14] = [
    ("?", "this list"),
    ("/", "search, or the input"),
    ("j  k", "next and previous entry"),
    (
        "↑ ↓ ← →",
        "move in lists, tree and bytes; open and close fields",
    ),
    ("Home  End", "first and last entry"),
    ("Enter", "open the entry"),
    ("g d", "Decode"),
    ("g o", "DOP objects"),
    ("g l", "Devices"),
    ("g t", "Traffic"),
    ("g n", "Snapshots"),
    ("g s", "Settings"),
    ("Ctrl V", "decode what was copied (Decode)"),
    ("Esc", "close, clear the selection"),
];

/// Remembers the first key of a pair.
#[derive(Clone, Copy, Debug, Default)]
pub struct Keys {
    go: bool,
}

impl Keys {
    /// The action of a key that was pressed without Ctrl, Alt or Meta. `typing` is true while the
    /// focus is in a field that takes text; only Escape counts there.
    pub fn press(&mut self, key: &str, typing: bool) -> Option<Action> {
        let go = core::mem::take(&mut self.go);
        if key == "Escape" {
            return Some(Action::Close);
        }
        if typing {
            return None;
        }
        match (go, key) {
            (true, "d") => Some(Action::Decode),
            (true, "o") => Some(Action::Dop),
            (true, "l") => Some(Action::Devices),
            (true, "t") => Some(Action::Traffic),
            (true, "n") => Some(Action::Snapshots),
            (true, "s") => Some(Action::Settings),
            (_, "g") => {
                self.go = true;
                None
            }
            (_, "?") => Some(Action::Help),
            (_, "/") => Some(Action::Find),
            (_, "j") => Some(Action::Next),
            (_, "k") => Some(Action::Previous),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_and_single_keys() {
        let mut keys = Keys::default();
        let mut press = |key| keys.press(key, false);
        assert_eq!(press("g"), None);
        assert_eq!(press("d"), Some(Action::Decode));
        assert_eq!(press("d"), None);
        assert_eq!(press("g"), None);
        assert_eq!(press("j"), Some(Action::Next));
        assert_eq!(press("l"), None);
        assert_eq!(press("?"), Some(Action::Help));
    }

    #[test]
    fn typing_is_left_alone() {
        let mut keys = Keys::default();
        assert_eq!(keys.press("/", true), None);
        assert_eq!(keys.press("Escape", true), Some(Action::Close));
    }
}
