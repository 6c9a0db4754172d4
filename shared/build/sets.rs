//! The rules about named codes and bits. See `rules.rs` for the list.

use std::collections::BTreeMap;

use crate::rules::Findings;
use crate::types::{Device, Member, Row};

/// R04, R05, R12, R16.
pub fn check(device: &Device, found: &mut Findings) {
    let mut sets: BTreeMap<&str, Vec<&Member>> = BTreeMap::new();
    for member in &device.members {
        let set = sets.entry(&member.set).or_default();
        let rule = if member.bits { "R12" } else { "R05" };
        let unique = !set
            .iter()
            .any(|m| (m.value <= member.last && member.value <= m.last) || m.key == member.key);
        found.unless(
            unique,
            rule,
            &member.at,
            format!("{} is there twice", member.value),
        );
        let run = member.value < member.last;
        found.unless(
            member.value <= member.last
                && run == member.label.contains("{}")
                && !(run && member.bits),
            rule,
            &member.at,
            "a run of codes, and nothing else, has {} in its label",
        );
        found.unless(
            member.zero.is_empty() == member.one.is_empty(),
            "R16",
            &member.at,
            "one state has no name",
        );
        set.push(member);
    }
    for row in &device.rows {
        let bits = row.kind.key == "bits";
        let needed = bits || row.kind.key == "enum" || row.kind.key == "torque";
        found.unless(
            needed || row.set.is_empty(),
            "R04",
            &row.at,
            format!("{} takes no set", row.kind.key),
        );
        if let Some(members) = sets.get(row.set.as_str()) {
            let suits = members.iter().all(|m| m.bits == bits);
            found.unless(
                suits,
                "R04",
                &row.at,
                format!("set {} is of the other sort", row.set),
            );
            named(row, members, found);
        } else if needed {
            found.add("R04", &row.at, format!("no set {:?}", row.set));
        }
    }
    for (name, members) in &sets {
        let users: Vec<&Row> = device.rows.iter().filter(|r| r.set == *name).collect();
        for member in members {
            let reached = users.iter().any(|row| reaches(row, member));
            let rule = match (users.is_empty(), member.bits) {
                (true, _) => "R04",
                (false, true) => "R12",
                (false, false) => "R05",
            };
            let text = format!("no row can show {} of {name}", member.value);
            found.unless(reached, rule, &member.at, text);
        }
    }
}

/// R05: every code that a row allows has a name.
fn named(row: &Row, members: &[&Member], found: &mut Findings) {
    if row.kind.key != "enum" {
        return;
    }
    let (Some(min), Some(max)) = (row.min, row.max) else {
        let starts = |code: i32| members.iter().any(|m| i32::from(m.value) == code);
        let ends = members.iter().filter(|m| !starts(i32::from(m.last) + 1));
        // One stretch of codes is a range that was forgotten.
        let text = "a row of codes without gaps has a range";
        return found.unless(ends.count() > 1, "R05", &row.at, text);
    };
    for code in min..=max {
        let known = members
            .iter()
            .any(|m| (i32::from(m.value)..=i32::from(m.last)).contains(&code));
        found.unless(
            known,
            "R05",
            &row.at,
            format!("code {code} of {} has no name", row.set),
        );
    }
}

/// True if a value of the row can be this code or have this bit.
fn reaches(row: &Row, member: &Member) -> bool {
    if member.bits {
        return u32::from(member.value) < u32::from(row.words) * 16;
    }
    let value = i32::from(member.value);
    row.min.is_none_or(|min| min <= value) && row.max.is_none_or(|max| value <= max)
}
