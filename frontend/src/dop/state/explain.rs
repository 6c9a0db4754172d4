//! Which object says more about an indicator, alarm or warning, judged by its name.
//!
//! The names come from the site, because the manual has them in figures only; section 3 to 7 tell
//! in words which object holds the details of which kind of indicator.

use shared::dop::LogRecord;

/// An object that says more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Explained {
    /// The object.
    pub object: u16,
    /// Its option.
    pub option: u8,
}

/// Words of a name, the object and its option. The first line of which all words are in the name
/// decides.
const RULES: [(&[&str], u16, u8); 20] = [
    (&["vib", "dev"], 7, 2),
    (&["vib", "hi"], 7, 1),
    (&["vib"], 7, 0),
    (&["final", "pos"], 206, 0),
    (&["position", "dev"], 206, 0),
    (&["total", "start"], 208, 0),
    (&["start"], 207, 0),
    (&["drive sleeve"], 208, 0),
    (&["dst"], 208, 0),
    (&["turns"], 208, 0),
    (&["service"], 208, 0),
    (&["hunting"], 208, 0),
    (&["partial stroke"], 209, 0),
    (&["pst"], 209, 0),
    (&["torque", "dev"], 403, 0),
    (&["torque", "hi"], 404, 0),
    (&["torque"], 405, 0),
    (&["temp"], 602, 0),
    (&["battery"], 1007, 0),
    (&["voltage"], 1003, 0),
];

/// The object that says more about what is called so.
#[must_use]
pub fn explained(name: &str) -> Option<Explained> {
    let name = name.to_ascii_lowercase();
    let rule = RULES
        .iter()
        .find(|rule| rule.0.iter().all(|word| name.contains(word)))?;
    Some(Explained {
        object: rule.1,
        option: rule.2,
    })
}

/// The newest event whose text has the name in it: since when it is so, as far as the log tells.
#[must_use]
pub fn since<'a>(name: &str, events: &'a [LogRecord]) -> Option<&'a LogRecord> {
    let name = name.to_ascii_lowercase();
    let told = events.iter().filter(|e| {
        let text = e.text.to_ascii_lowercase();
        !text.is_empty() && (text.contains(&name) || name.contains(&text))
    });
    told.max_by_key(|e| e.time.seconds())
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::dop::Stamp;

    #[test]
    fn names_lead_to_their_object() {
        let object = |name| explained(name).map(|e| (e.object, e.option));
        assert_eq!(object("Vibration HI"), Some((7, 1)));
        assert_eq!(object("Vibration deviation"), Some((7, 2)));
        assert_eq!(object("Rated vibration"), Some((7, 0)));
        assert_eq!(object("Open Final Position Deviation"), Some((206, 0)));
        assert_eq!(object("Starts/Hr HI"), Some((207, 0)));
        assert_eq!(object("Total Open Starts"), Some((208, 0)));
        assert_eq!(object("Modulation Hunting"), Some((208, 0)));
        assert_eq!(object("Open Torque HI HI"), Some((404, 0)));
        assert_eq!(object("Torque Reference Deviation"), Some((403, 0)));
        assert_eq!(object("Motor Temperature HI"), Some((602, 0)));
        assert_eq!(object("User indicator bit 12"), None);
    }

    #[test]
    fn the_log_tells_since_when() {
        let event = |id, seconds, text: &str| LogRecord {
            index: 0,
            id,
            time: Stamp::At(seconds),
            category: Some(0),
            text: text.into(),
            numbers: Vec::new(),
        };
        let events = [
            event(3, 300, "Door opened"),
            event(2, 200, "VIBRATION HI active"),
            event(1, 100, "Vibration HI"),
        ];
        assert_eq!(since("Vibration HI", &events).map(|e| e.id), Some(2));
        assert_eq!(since("Battery low", &events), None);
    }
}
