//! All that can be set: present value, range, level, and what is out of its range.

use shared::icon3000::config::{Group, LoggedIn, Setting, configuration, logged_in as level_of};
use shared::map::row::{Level, Row};

use super::heading;
use super::rows::{Around, level, list};
use crate::actuator::state::dossier::Dossier;
use crate::actuator::state::saved::model;
use crate::format::count;
use crate::markup::Markup;
use crate::markup::control::{Choice, search, tick};

/// What is looked for among the settings.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Filter {
    /// Text in the name, or an address.
    pub text: String,
    /// A group, empty for all.
    pub group: String,
    /// True for those that are out of range, disputed or not valid.
    pub marked: bool,
}

/// Registers of a device that can be written, in the groups of the map.
#[must_use]
pub fn groups(dossier: &Dossier) -> Vec<Group> {
    model(dossier.device).map_or_else(Vec::new, |model| configuration(model, &dossier.image))
}

/// The same as rows, in no order.
#[must_use]
pub fn writable(dossier: &Dossier) -> Vec<&'static Row> {
    let groups = groups(dossier);
    groups
        .iter()
        .flat_map(|g| g.settings.iter().map(|s| s.row))
        .collect()
}

/// True if something speaks against the value of a setting.
const fn is_marked(setting: &Setting) -> bool {
    setting.outside || setting.differs
}

impl Filter {
    fn passes(&self, setting: &Setting) -> bool {
        let text = self.text.trim().to_ascii_lowercase();
        let row = setting.row;
        let named = text.is_empty()
            || row.label.to_ascii_lowercase().contains(&text)
            || row.address.to_string().starts_with(&text);
        let grouped = self.group.is_empty() || row.group == self.group;
        named && grouped && (!self.marked || is_marked(setting))
    }
}

/// The filters.
pub fn filters(html: &mut Markup, dossier: &Dossier, filter: &Filter) {
    search(
        html,
        "text",
        "config-filter",
        "Name or address",
        &filter.text,
    );
    let groups = groups(dossier);
    Choice {
        act: "group",
        testid: "config-group",
        label: "All groups",
        value: &filter.group,
        ..Choice::default()
    }
    .draw(html, groups.iter().map(|g| (g.name, g.name)));
    let settings = groups.iter().flat_map(|g| &g.settings);
    let marked = settings.filter(|s| is_marked(s)).count();
    let words = format!("Out of range, or not as its mirror ({marked})");
    tick(html, "marked", "config-marked", &words, filter.marked);
}

/// Who is logged in, as far as the device tells.
pub fn logged_in(html: &mut Markup, dossier: &Dossier) {
    html.open(
        "p",
        &[("class", "icon-level-now"), ("data-testid", "level")],
    );
    html.text("User level logged in: ");
    let quiet = |html: &mut Markup, words: &str| {
        html.node("span", "quiet", words);
    };
    let level_now = model(dossier.device).map(|model| level_of(model, &dossier.image));
    match level_now {
        Some(LoggedIn::Level(now)) => {
            html.node("b", "", level(now)).text(match now {
                Level::Observer => {
                    " Nothing but a login is accepted; other writes are discarded without an error."
                }
                Level::User => {
                    " The level after power-up. Writes that need Service are discarded without an error."
                }
                Level::Service | Level::Manufacturer => "",
            });
        }
        Some(LoggedIn::Unknown(code)) => {
            html.text(&format!("code {code}, which no level has"));
        }
        Some(LoggedIn::Unread) => quiet(html, "not read"),
        Some(LoggedIn::NoLevels) | None => quiet(
            html,
            "this model has no user levels (section 11: ICON3000v2 only)",
        ),
    }
    quiet(html, " HR 3480, section 11");
    html.close("p");
}

/// The settings in their groups.
pub fn settings(html: &mut Markup, dossier: &Dossier, filter: &Filter, around: &Around) {
    let mut around = around.clone();
    let mut nothing = true;
    for group in groups(dossier) {
        let settings: Vec<_> = group.settings.iter().filter(|s| filter.passes(s)).collect();
        if settings.is_empty() {
            continue;
        }
        nothing = false;
        let differ = settings.iter().filter(|s| s.differs);
        around.differ = differ
            .filter_map(|s| Some((s.row.key, s.mirror_of?)))
            .collect();
        let n = u64::try_from(settings.len()).unwrap_or(0);
        heading(html, group.name, &count(n, "setting"));
        let rows: Vec<_> = settings.iter().map(|s| s.row).collect();
        list(html, dossier, &rows, &around);
    }
    if nothing {
        html.open("p", &[("class", "empty"), ("data-testid", "icon-nothing")]);
        html.text(if dossier.device.map().is_none() {
            "The kind of this device is not known yet."
        } else {
            "No setting passes these filters. Clear the text, or choose another group."
        })
        .close("p");
    }
}

#[cfg(test)]
mod tests {
    use super::super::rows::tests::device;
    use super::*;

    fn drawn(dossier: &Dossier, filter: &Filter) -> String {
        let mut html = Markup::new();
        let around = Around {
            settings: true,
            ..Around::default()
        };
        settings(&mut html, dossier, filter, &around);
        html.finish()
    }

    /// Reading E57: every RW row of table 5 can be written, 471 registers on a v2; as values.
    #[test]
    fn everything_writable_is_there_once() {
        let dossier = device(&[]);
        let rows = writable(&dossier);
        let words: u32 = rows.iter().map(|r| u32::from(r.words)).sum();
        assert_eq!(words, 471);
        let all = drawn(&dossier, &Filter::default());
        assert_eq!(all.matches("data-testid=\"icon-row\"").count(), rows.len());
    }

    #[test]
    fn filters_narrow() {
        let dossier = device(&[(3615, &[50])]);
        let text = Filter {
            text: "pst travel".into(),
            ..Filter::default()
        };
        assert!(drawn(&dossier, &text).contains("data-address=\"3615\""));
        let marked = Filter {
            marked: true,
            ..Filter::default()
        };
        assert_eq!(drawn(&dossier, &marked).matches("icon-line").count(), 1);
        // HR 2 should show HR 3017 once more (reading E44).
        let dossier = device(&[(2, &[20]), (3017, &[10])]);
        let html = drawn(&dossier, &marked);
        assert!(html.contains("HR 3017 says something else"), "{html}");
        assert_eq!(html.matches("icon-line").count(), 1);
        let none = Filter {
            text: "nonsense".into(),
            ..Filter::default()
        };
        assert!(drawn(&dossier, &none).contains("icon-nothing"));
    }

    #[test]
    fn the_level_is_told() {
        let say = |dossier: &Dossier| {
            let mut html = Markup::new();
            logged_in(&mut html, dossier);
            html.finish()
        };
        let html = say(&device(&[(3480, &[1])]));
        assert!(
            html.contains(">User</b>") && html.contains("after power-up"),
            "{html}"
        );
        assert!(say(&device(&[])).contains("not read"));
        let old = Dossier::new("XV", shared::device::Device::Icon3000);
        assert!(say(&old).contains("no user levels"));
    }
}
