//! The diagnosis in words.

use shared::ddc100::diagnosis::Diagnosis;

use crate::markup::Markup;
use crate::markup::device::sign;
use crate::network::state::findings::sign as sign_of;
use crate::network::state::names::named;

/// Findings that are told at once; the rest is counted.
const MOST: usize = 6;

/// What the pattern of faults means, with what else it could be, and why. `name` gives the tag of a
/// unit, empty if it has none.
pub fn findings(html: &mut Markup, diagnosis: &Diagnosis, name: &dyn Fn(u8) -> String) {
    html.open("ul", &[("class", "findings")]);
    for finding in diagnosis.findings.iter().take(MOST) {
        let certain = diagnosis.is_certain(finding);
        html.open(
            "li",
            &[
                ("data-testid", "finding"),
                ("data-key", finding.key()),
                ("data-certain", if certain { "true" } else { "false" }),
            ],
        );
        if let Some(mark) = sign_of(diagnosis, finding) {
            sign(html, mark, "18");
        }
        html.open("span", &[]);
        html.text(&named(&finding.to_string(), name));
        let why = finding.why();
        if !why.is_empty() {
            html.text(" ").node("span", "quiet", &named(&why, name));
        }
        html.close("span").close("li");
    }
    let more = diagnosis.findings.len().saturating_sub(MOST);
    if more > 0 {
        html.node(
            "li",
            "quiet",
            &format!("and {more} more; the table below has all units"),
        );
    }
    html.close("ul");
    let caution = diagnosis.caution();
    if !caution.is_empty() {
        // It counts down with every poll: to be seen, not to be read out each time.
        html.open(
            "p",
            &[
                ("class", "quiet net-small"),
                ("data-testid", "caution"),
                ("aria-live", "off"),
            ],
        );
        html.text(&caution).close("p");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::state::findings::{findings as diagnose, table};
    use shared::proto::DdcShape;

    #[test]
    fn a_break_is_told_and_doubt_has_its_reason() {
        let drawn = |units: &[(u8, [Option<bool>; 2])], shape, ports| {
            let mut html = Markup::new();
            let name = |unit: u8| {
                if unit == 9 {
                    "MOV-9".to_owned()
                } else {
                    String::new()
                }
            };
            let diagnosis = diagnose(shape, &table(units, ports)).unwrap();
            findings(&mut html, &diagnosis, &name);
            html.finish()
        };
        let (no, yes) = (Some(false), Some(true));
        let html = drawn(
            &[(7, [no, yes]), (3, [no, yes]), (9, [yes, no])],
            DdcShape::Loop,
            2,
        );
        assert!(
            html.contains("data-key=\"break\" data-certain=\"true\""),
            "{html}"
        );
        assert!(html.contains("between unit 3 and unit 9 (MOV-9)") && html.contains("sign-f"));
        let html = drawn(
            &[(1, [no, None]), (2, [yes, None])],
            DdcShape::SingleEnded,
            1,
        );
        assert!(html.contains("data-certain=\"false\"") && html.contains("sign-s"));
        let html = drawn(&[(1, [no, no])], DdcShape::Loop, 2);
        assert!(html.contains("no_fault") && !html.contains("sign"));
    }
}
