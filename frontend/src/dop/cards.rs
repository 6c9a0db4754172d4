//! Single values in groups that belong together: a count beside the time it last grew, a torque
//! beside the position it was at.

use shared::dop::object::{Field, FieldKind};
use shared::dop::profile::Profile;
use shared::dop::{ObjectRead, Stamp};
use shared::map::row::{Reading, Trust};
use shared::tree::{FieldId, Name};
use shared::value::{Quality, Value};

/// First register and title of a group.
type Group = (u16, &'static str);

/// Where the groups of a layout begin. The registers are those of the tables of AIIOM000698-01; a
/// layout that is not here is one group.
const GROUPS: [(&str, &[Group]); 13] = [
    (
        "vibration_maximum",
        &[
            (0, "Rated vibration exceeded"),
            (14, "Vibration HI exceeded"),
        ],
    ),
    (
        "last_seat",
        &[
            (0, "Last open seat"),
            (12, "Open seats since reset"),
            (20, "Last close seat"),
            (32, "Close seats since reset"),
        ],
    ),
    (
        "final_deviation",
        &[(0, "Open position"), (8, "Close position")],
    ),
    (
        "starts_indicators",
        &[
            (0, "Above the HI level"),
            (8, "Most above the HI level"),
            (13, "Above the rating"),
            (21, "Most above the rating"),
        ],
    ),
    (
        "service_indicators",
        &[
            (0, "Total turns"),
            (6, "Total open starts"),
            (12, "Total close starts"),
            (18, "Service interval"),
            (25, "Hunting while modulating"),
        ],
    ),
    (
        "partial_stroke",
        &[
            (0, "Open, passed"),
            (6, "Open, failed"),
            (13, "Close, passed"),
            (19, "Close, failed"),
        ],
    ),
    (
        "torque_summary",
        &[
            (0, "Open, recent"),
            (22, "Open, reference"),
            (44, "Close, recent"),
            (66, "Close, reference"),
        ],
    ),
    (
        "torque_deviation",
        &[
            (0, "Open, against the reference"),
            (9, "Open, against the average"),
            (18, "Close, against the reference"),
            (27, "Close, against the average"),
        ],
    ),
    (
        "torque_hi",
        &[
            (0, "Open torque HI"),
            (6, "Open torque HI HI"),
            (12, "Close torque HI"),
            (18, "Close torque HI HI"),
        ],
    ),
    (
        "torque_maximum",
        &[(0, "Largest open torque"), (5, "Largest close torque")],
    ),
    (
        "motor_temperature_statistics",
        &[
            (0, "Average"),
            (1, "Highest"),
            (6, "Lowest"),
            (11, "Overtemperature fault"),
            (17, "Motor temperature HI"),
        ],
    ),
    (
        "internal_temperature_statistics",
        &[(0, "Highest"), (5, "Lowest")],
    ),
    (
        "power",
        &[
            (0, "Highest voltage"),
            (5, "Lowest voltage"),
            (10, "Highest frequency"),
            (15, "Lowest frequency"),
            (20, "At the time of the request"),
        ],
    ),
];

/// A value of a card.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Its field in the tree.
    pub id: FieldId,
    /// Its path, for hooks.
    pub path: String,
    /// What it is.
    pub label: String,
    /// What it says, without unit.
    pub text: String,
    /// Its unit.
    pub unit: &'static str,
    /// Its time, if it is one.
    pub stamp: Option<Stamp>,
    /// True for numbers.
    pub numeric: bool,
    /// How far to rely on it.
    pub quality: Quality,
    /// How far the description can be trusted, and why it differs from the print.
    pub trust: Trust,
    /// The reading that decides.
    pub reading: Option<&'static Reading>,
    /// True if a setting decides about it that the profile does not have.
    pub assumed: bool,
}

/// Values that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Card {
    /// What they are about, empty if the object says it already.
    pub title: &'static str,
    /// The values, in the order of the registers.
    pub lines: Vec<Line>,
}

/// The single values of a read. Arrays and records are not single.
#[must_use]
pub fn cards(read: &ObjectRead, profile: &Profile) -> Vec<Card> {
    let layout = read.layout.map_or("", |layout| layout.key);
    let groups = GROUPS
        .iter()
        .find(|g| g.0 == layout)
        .map_or(&[][..], |g| g.1);
    let mut cards: Vec<Card> = Vec::new();
    let mut group = usize::MAX;
    for (id, field) in read.decoded.iter() {
        let Name::Dop(def, _) = field.name else {
            continue;
        };
        if def.count > 1 || def.record {
            continue;
        }
        let now = groups.iter().rposition(|g| g.0 <= def.at).unwrap_or(0);
        if now != group {
            group = now;
            cards.push(Card {
                title: groups.get(now).map_or("", |g| g.1),
                lines: Vec::new(),
            });
        }
        if let Some(card) = cards.last_mut() {
            let mut line = line(read, profile, id, def, field);
            line.label = without(&line.label, card.title);
            card.lines.push(line);
        }
    }
    cards
}

/// A label without what the title above it says already: `Open, recent, start` below
/// `Open, recent` is `Start`, and `Open, tests passed` below `Open, passed` is `Tests passed`.
fn without(label: &str, title: &str) -> String {
    let mut rest = label;
    for part in title.split(", ").filter(|part| !part.is_empty()) {
        let Some(less) = rest.strip_prefix(part).and_then(|r| r.strip_prefix(", ")) else {
            break;
        };
        rest = less;
    }
    let mut text = rest.to_owned();
    if let Some(first) = text.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    text
}

/// Readings of all times, texts, arrays and temperatures: told once for the whole object, as what
/// is assumed.
const GENERAL: [&str; 5] = ["C4", "C16", "C17", "C19", "C24"];

fn line(
    read: &ObjectRead,
    profile: &Profile,
    id: FieldId,
    def: &'static Field,
    field: &shared::tree::Field,
) -> Line {
    let stamp = match (def.kind, field.value) {
        (FieldKind::Time, Value::Stamp(_) | Value::Unavailable(_)) => read.time(def.key),
        _ => None,
    };
    Line {
        id,
        path: read.decoded.path(id),
        label: def.label.to_owned(),
        text: read.decoded.bare_text(field),
        unit: match field.value {
            Value::Number { .. } => field.name.unit(),
            _ => "",
        },
        stamp,
        numeric: matches!(field.value, Value::Number { .. }),
        quality: field.quality,
        trust: field.name.trust(),
        reading: field.name.reading().filter(|r| !GENERAL.contains(&r.id)),
        assumed: def.setting.is_some_and(|s| profile.is_assumed(s)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn titles_are_not_said_twice() {
        assert_eq!(without("Open, recent, start", "Open, recent"), "Start");
        assert_eq!(
            without("Open, tests passed", "Open, passed"),
            "Tests passed"
        );
        assert_eq!(without("Open deviation", "Open position"), "Open deviation");
        assert_eq!(without("serial number", ""), "Serial number");
    }
}
