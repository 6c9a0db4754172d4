//! Tags beside the numbers of units in a sentence.

/// Puts the tags of units behind their numbers: `between unit 3 and unit 4 (MOV-003, MOV-004)`; of a
/// single one at the end of its clause: `Unit 3 is off-line (MOV-003): …`. `name` gives the tag of a
/// unit, empty if it has none.
#[must_use]
pub fn named(text: &str, name: &dyn Fn(u8) -> String) -> String {
    let (mut out, mut rest) = (String::new(), text);
    let mut said: Vec<u8> = Vec::new();
    while let Some(at) = rest.find("nit") {
        let (head, tail) = rest.split_at(at + 3);
        out.push_str(head);
        let list = tail.strip_prefix("s ").or_else(|| tail.strip_prefix(' '));
        let units = list.filter(|_| head.ends_with("unit") || head.ends_with("Unit"));
        let (units, mut after) = units.map_or((Vec::new(), tail), numbers);
        if units.iter().all(|unit| said.contains(unit)) {
            out.push_str(&tail[..tail.len() - after.len()]);
            rest = after;
            continue;
        }
        if units.len() == 1 {
            // Up to the end of the clause, unless another unit is named before.
            let end = after.find([':', ';', ',', '.']).unwrap_or(after.len());
            let end = after.find("nit").map_or(end, |next| end.min(next));
            if !after[end..].starts_with("nit") {
                after = &after[end..];
            }
        }
        out.push_str(&tail[..tail.len() - after.len()]);
        let tags = units.iter().map(|unit| name(*unit));
        let tags: Vec<String> = tags.filter(|tag| !tag.is_empty()).collect();
        if !tags.is_empty() {
            out.push_str(&format!(" ({})", tags.join(", ")));
        }
        said.extend(units);
        rest = after;
    }
    out.push_str(rest);
    out
}

/// The units that a text begins with, `4, 5 and 6` or `3 and unit 4`, and what follows. A number
/// before `more` counts units and names none.
fn numbers(text: &str) -> (Vec<u8>, &str) {
    let (mut units, mut here, mut after) = (Vec::new(), text, text);
    loop {
        let past = here.trim_start_matches(|c: char| c.is_ascii_digit());
        let digits = &here[..here.len() - past.len()];
        if digits.is_empty() {
            return (units, after);
        }
        after = past;
        match past.strip_prefix(" more") {
            Some(past) => after = past,
            None => units.extend(digits.parse::<u8>()),
        }
        let next = [" and unit ", " and ", ", "];
        match next.iter().find_map(|between| after.strip_prefix(between)) {
            Some(next) => here = next,
            None => return (units, after),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_get_their_tags() {
        let name = |unit: u8| match unit {
            9 => String::new(),
            n => format!("MOV-{n:03}"),
        };
        for (text, expected) in [
            (
                "Break between unit 3 and unit 4: look there; not at unit 3.",
                "Break between unit 3 and unit 4 (MOV-003, MOV-004): look there; not at unit 3.",
            ),
            (
                "Unit 7 is off-line: the signal passes it.",
                "Unit 7 is off-line (MOV-007): the signal passes it.",
            ),
            ("unit 9 is nameless", "unit 9 is nameless"),
            (
                "units 4, 5 and 6 do not answer",
                "units 4, 5 and 6 (MOV-004, MOV-005, MOV-006) do not answer",
            ),
            (
                "units 1, 2, 30 more and 40 stand between",
                "units 1, 2, 30 more and 40 (MOV-001, MOV-002, MOV-040) stand between",
            ),
            (
                "between host port 1 and unit 1, or 2 of it",
                "between host port 1 and unit 1 (MOV-001), or 2 of it",
            ),
            (
                "Unit 5, the last one, does not answer: the cable between unit 4 and unit 5 is broken.",
                "Unit 5 (MOV-005), the last one, does not answer: the cable between unit 4 and unit 5 (MOV-004, MOV-005) is broken.",
            ),
            (
                "unit 3 does not answer, but units beyond it do",
                "unit 3 does not answer (MOV-003), but units beyond it do",
            ),
            ("No unit answers; united", "No unit answers; united"),
        ] {
            assert_eq!(named(text, &name), expected);
        }
    }
}
