//! What is different between two reads of the same object.

use shared::dop::ObjectRead;
use shared::tree::{Decoded, Field};
use shared::value::Value;

/// A value that both reads have, or one of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Its path.
    pub path: String,
    /// What it is.
    pub label: String,
    /// Its unit.
    pub unit: &'static str,
    /// What it says now.
    pub now: Option<String>,
    /// What it said then.
    pub then: Option<String>,
    /// By how much a number grew; empty if it is none.
    pub change: String,
}

impl Difference {
    /// True if both say the same.
    #[must_use]
    pub fn is_same(&self) -> bool {
        self.now == self.then
    }
}

/// All values of both reads, in the order of the registers.
#[must_use]
pub fn differences(now: &ObjectRead, then: &ObjectRead) -> Vec<Difference> {
    let old = leaves(&then.decoded);
    let new = leaves(&now.decoded);
    let mut all: Vec<Difference> = new
        .iter()
        .map(|(path, field)| {
            let before = old.iter().find(|(p, _)| p == path).map(|(_, f)| *f);
            Difference {
                path: path.clone(),
                label: field.name.label(),
                unit: unit(field),
                now: Some(now.decoded.bare_text(field)),
                then: before.map(|f| then.decoded.bare_text(f)),
                change: before.map_or_else(String::new, |b| change(field, b)),
            }
        })
        .collect();
    let gone = old
        .iter()
        .filter(|(path, _)| new.iter().all(|(p, _)| p != path));
    all.extend(gone.map(|(path, field)| Difference {
        path: path.clone(),
        label: field.name.label(),
        unit: unit(field),
        now: None,
        then: Some(then.decoded.bare_text(field)),
        change: String::new(),
    }));
    all
}

fn leaves(decoded: &Decoded) -> Vec<(String, &Field)> {
    let leaves = decoded.iter().filter(|(id, _)| decoded.is_leaf(*id));
    leaves
        .map(|(id, field)| (decoded.path(id), field))
        .collect()
}

fn unit(field: &Field) -> &'static str {
    match field.value {
        Value::Number { .. } => field.name.unit(),
        _ => "",
    }
}

/// The difference of two numbers of one scale, with its sign.
fn change(now: &Field, then: &Field) -> String {
    let (
        Value::Number { raw: a, scale },
        Value::Number {
            raw: b,
            scale: other,
        },
    ) = (now.value, then.value)
    else {
        return String::new();
    };
    let Some(grown) = a.checked_sub(b).filter(|g| *g != 0 && scale == other) else {
        return String::new();
    };
    let sign = if grown > 0 { "+" } else { "" };
    format!("{sign}{}", scale.apply(grown))
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::dop::{Profile, Request};

    /// Object 405: when and how large the largest open and close torque were.
    fn torque(open: u16, close: u16) -> ObjectRead {
        let words = [0x9ECB, 0x6026, 0, 0, open, 0, 0, 0, 0, close];
        ObjectRead::read(Request::from_word(405), &words, &Profile::default())
    }

    #[test]
    fn differences_have_their_sign_and_unit() {
        let all = differences(&torque(425, 310), &torque(400, 310));
        assert_eq!(all.len(), 4);
        let changed: Vec<_> = all.iter().filter(|d| !d.is_same()).collect();
        assert_eq!(changed.len(), 1);
        assert_eq!(changed[0].now.as_deref(), Some("42.5"));
        assert_eq!(changed[0].then.as_deref(), Some("40.0"));
        assert_eq!((changed[0].change.as_str(), changed[0].unit), ("+2.5", "%"));
    }

    #[test]
    fn what_only_one_has_is_shown() {
        let short = ObjectRead::read(Request::from_word(405), &[0; 5], &Profile::default());
        let all = differences(&torque(1, 2), &short);
        assert!(all.iter().any(|d| d.then.is_none() && d.now.is_some()));
        let back = differences(&short, &torque(1, 2));
        assert!(back.iter().any(|d| d.now.is_none() && d.then.is_some()));
    }
}
