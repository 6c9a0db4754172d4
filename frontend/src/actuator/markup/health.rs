//! What is wrong with the device, why it counts as that, and what to check.

use shared::icon3000::health::{Finding, Health, health as judge};
use shared::icon3000::model::{Meaning, Ne107};

use super::heading;
use super::tools::read_at;
use crate::actuator::state::dossier::Dossier;
use crate::actuator::state::health::{Past, past, rows};
use crate::actuator::state::saved::model;
use crate::chart::time::stamp;
use crate::dop::markup::sign_of;
use crate::format::count;
use crate::markup::Markup;
use crate::markup::device::sign;

/// Entries of the logs that are shown.
const PAST: usize = 8;

/// The health of a device. `logs` is the address of its logs.
pub fn health(html: &mut Markup, dossier: &Dossier, logs: &str, now: i64) {
    let Some(model) = model(dossier.device) else {
        return;
    };
    let health = judge(model, &dossier.image);
    summary(html, &health);
    read_at(html, dossier, &rows(dossier), now);
    let mut last = None;
    for condition in &health.findings {
        let status = condition.meaning.status;
        if last != Some(status) {
            if last.is_some() {
                html.close("ul");
            }
            last = Some(status);
            heading(html, status.label(), "NAMUR NE 107");
            html.open("ul", &[("class", "icon-conditions")]);
        }
        one(html, dossier, condition);
    }
    if last.is_some() {
        html.close("ul");
    }
    let past = past(dossier, PAST);
    if !past.is_empty() {
        history(html, &past, logs);
    }
}

/// The state of the device in one line.
fn summary(html: &mut Markup, health: &Health) {
    let unread = &health.unread;
    html.open(
        "p",
        &[("class", "icon-verdict"), ("data-testid", "health-sum")],
    );
    match health.worst() {
        Some(status) => {
            sign(html, sign_of(status), "24");
            html.text(" ").node("b", "", status.label());
            let n = u64::try_from(health.findings.len()).unwrap_or(0);
            html.text(&format!(" · {}", count(n, "condition")));
        }
        None if unread.is_empty() => {
            html.text("Good: no alarm, no warning, nothing in the way.");
        }
        None => {
            html.text("Not known.");
        }
    }
    html.close("p");
    if !unread.is_empty() {
        html.open("p", &[("class", "quiet"), ("data-testid", "health-unread")]);
        let names: Vec<_> = unread
            .iter()
            .map(|row| format!("{} ({})", row.label, row.address))
            .collect();
        html.text(&format!("Not read, so not known: {}.", names.join(", ")));
        html.close("p");
    }
    if !health.untold.is_empty() {
        let names: Vec<_> = health.untold.iter().map(|m| m.label).collect();
        let words = format!("This model does not tell: {}.", names.join(", "));
        html.node("p", "quiet", &words);
    }
}

/// One condition with its reason and what to check.
fn one(html: &mut Markup, dossier: &Dossier, condition: &Finding) {
    let meaning = condition.meaning;
    html.open(
        "li",
        &[
            ("data-testid", "health"),
            ("data-key", meaning.key),
            ("data-status", letter(meaning.status)),
        ],
    );
    sign(html, sign_of(meaning.status), "20");
    html.open("div", &[]);
    html.node("b", "", meaning.label);
    told(html, meaning);
    let words = dossier.image.bytes(condition.row).unwrap_or_default();
    let place = format!(
        "{} · raw {} · {}",
        condition.place(),
        shared::render::hex(&words),
        condition.source()
    );
    html.node("p", "quiet proof", &place)
        .close("div")
        .close("li");
}

/// Why it is in its category, and what to check.
fn told(html: &mut Markup, meaning: &Meaning) {
    html.node("p", "", meaning.reason);
    html.open("p", &[]);
    html.node("span", "quiet", "Check: ")
        .text(meaning.check)
        .close("p");
}

/// The letter of a category.
const fn letter(status: Ne107) -> &'static str {
    sign_of(status).letter()
}

/// What the logs tell.
fn history(html: &mut Markup, past: &[Past], logs: &str) {
    heading(html, "Lately", "from the logs of the device, its own clock");
    html.open("ul", &[("class", "icon-conditions past")]);
    for entry in past {
        html.open("li", &[("data-testid", "health-past")]);
        sign(html, sign_of(entry.meaning.status), "18");
        html.open("div", &[]);
        html.node("b", "", entry.meaning.label).text(" ");
        let when = entry.time.map_or_else(|| "no date".to_owned(), stamp);
        html.node("span", "quiet", &when).close("div").close("li");
    }
    html.close("ul");
    html.open("p", &[]);
    html.open("a", &[("href", logs)])
        .text("All logs")
        .close("a");
    html.close("p");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuator::markup::rows::tests::device;
    use crate::actuator::state::logs::tests::put;
    use shared::icon3000::model::HEALTH;

    fn drawn(dossier: &Dossier) -> String {
        let mut html = Markup::new();
        health(&mut html, dossier, "#/x", 60);
        html.finish()
    }

    #[test]
    fn conditions_carry_reason_check_and_proof() {
        let phase = HEALTH.iter().find(|m| m.key == "lost_phase").unwrap();
        let mut dossier = device(&[(3010, &[1 << phase.value])]);
        put(&mut dossier, 2, &[1, 0, 90, 12]);
        let html = drawn(&dossier);
        for part in [
            "sign-f",
            "data-key=\"lost_phase\"",
            "data-status=\"F\"",
            "Check: ",
            "table 5",
            "HR 3010, bit",
            "health-past",
            "Not read, so not known",
            "Read just now",
        ] {
            assert!(html.contains(part), "{part}: {html}");
        }
    }

    #[test]
    fn good_needs_everything_read() {
        assert!(drawn(&device(&[])).contains("Not known."));
        let all = device(&[
            (3001, &[0x20, 0, 0]),
            (3009, &[0, 0, 0]),
            (3016, &[0]),
            (3030, &[0]),
        ]);
        let html = drawn(&all);
        assert!(
            html.contains("Good:") && !html.contains("health-unread"),
            "{html}"
        );
    }
}
