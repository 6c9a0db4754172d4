//! The set-up of a device as the menus of a handheld have it, and what no command reads of them.

use shared::device::Family;

use super::values::{facts_of, value};
use crate::hart::state::plan;
use crate::hart::state::unit::{Key, Unit, plain};
use crate::markup::Markup;

/// Values that belong together.
#[derive(Clone, Copy, Debug)]
pub struct Group {
    /// Its title.
    pub title: &'static str,
    /// Command, key of the field, and a label where the field's own does not do.
    pub values: &'static [(u16, &'static str, &'static str)],
}

/// Everything of the set-up, in the order of the handheld's menus.
pub const SETUP: [Group; 6] = [
    Group {
        title: "HART set-up",
        values: &[
            (13, "tag", ""),
            (20, "long_tag", ""),
            (13, "descriptor", ""),
            (12, "message", ""),
            (13, "date", ""),
            (16, "final_assembly", ""),
            (14, "serial", ""),
        ],
    },
    Group {
        title: "Loop configuration",
        values: &[
            (7, "polling_address", ""),
            (7, "loop_current_mode", ""),
            (131, "zero", ""),
            (131, "span", ""),
            (133, "mode", ""),
        ],
    },
    Group {
        title: "Range",
        values: &[
            (15, "upper_range", ""),
            (15, "lower_range", ""),
            (15, "damping", ""),
            (15, "transfer_function", ""),
            (15, "alarm_selection", ""),
            (15, "write_protect", ""),
            (15, "channel_flags", ""),
            (14, "upper_limit", ""),
            (14, "lower_limit", ""),
            (14, "minimum_span", ""),
        ],
    },
    // Section 10.2, in the order of the menu; what it calls model is the device type.
    Group {
        title: "HART review",
        values: &[
            (0, "change_counter", ""),
            (9, "time", "Time stamp"),
            (0, "universal_revision", ""),
            (0, "device_revision", ""),
            (0, "software_revision", ""),
            (0, "hardware_revision", "Hardware revision"),
            (0, "signalling", "Physical layer"),
            (0, "expanded_type", ""),
            (0, "device_type", ""),
            (0, "flags", ""),
            (0, "manufacturer", ""),
            (0, "distributor", ""),
            (0, "last_variable", ""),
            (0, "variables", ""),
            (0, "profile", ""),
            (0, "request_preambles", ""),
            (0, "response_preambles", ""),
            (0, "device_id", ""),
        ],
    },
    Group {
        title: "Versions",
        values: &[
            (128, "version", "HART board software (command 128)"),
            (0, "software_revision", "HART software revision (command 0)"),
        ],
    },
    Group {
        title: "Classification of the variables",
        values: &[
            (8, "pv_class", ""),
            (8, "sv_class", ""),
            (8, "tv_class", ""),
            (8, "qv_class", ""),
        ],
    },
];

/// What only HART 5 and 6 answer to command 0: shown where it is.
const OLDER: [&str; 2] = ["device_type", "variables"];

/// Something that the menus of a handheld show and no documented command reads: what it is, and the
/// sections of PUB092-003-00 with the menus that have it.
type Unavailable = (&'static str, &'static [&'static str]);

/// All of them. Menus that the manual calls not applicable for SI3 and SI4 are not theirs.
pub const UNAVAILABLE: [Unavailable; 15] = [
    ("Valve label", &["10.2"]),
    ("Main board software version", &["10.2"]),
    (
        "Type of the actuator",
        &["11.1", "12.1", "13.1", "14.1", "15.1"],
    ),
    (
        "Stroke set-up: align coupling, quick set-up, manual set-up",
        &["11.2"],
    ),
    (
        "Valve actions: torque or thrust limits, closing direction, seating at limit or torque",
        &["11.3", "12.2", "14.2"],
    ),
    ("Deadband", &["11.3", "12.2", "13.2", "14.2", "15.2"]),
    ("Hysteresis", &["12.2", "14.2", "15.2"]),
    ("Feedback current, its end points and its source", &["11.3"]),
    (
        "Action, position and time-out on loss of signal or communication",
        &["11.3", "12.2", "13.2", "14.2"],
    ),
    (
        "Option cards that are fitted, control source: primary and secondary option",
        &["12.2", "14.2", "15.2"],
    ),
    (
        "Motion inhibit time, function of the ESD input",
        &["12.2", "14.2"],
    ),
    (
        "Partial stroke: enabled, travel, limit, time-outs",
        &["12.2", "14.2", "15.2"],
    ),
    (
        "Auxiliary inputs: function and contact type",
        &["12.2", "14.2", "15.2"],
    ),
    (
        "Number of operations towards open and close",
        &["12.3", "15.3"],
    ),
    ("Historic torque over position", &["12.3", "15.3"]),
];

/// The section that shows something for a family: that of its own chapter, or of all.
#[must_use]
pub fn section(sections: &'static [&'static str], family: Family) -> Option<&'static str> {
    let chapter = match family {
        Family::Cva => "11.",
        Family::Iq => "12.",
        Family::Cma => "13.",
        Family::Ck => "14.",
        Family::Si => "15.",
    };
    let mut all = sections.iter().copied();
    all.find(|s| s.starts_with(chapter) || s.starts_with("10."))
}

/// The command as this program asks for it.
fn asked(command: u16) -> Key {
    match command {
        9 => plan::variables(),
        other => plain(other),
    }
}

/// The groups of the set-up, and what can't be read.
pub fn setup(html: &mut Markup, unit: &Unit, open: &[String], now_us: u64) {
    for group in &SETUP {
        html.open("section", &[("class", "hart-group")]);
        html.node("h2", "", group.title);
        for (command, field, label) in group.values {
            let key = asked(*command);
            if OLDER.contains(field) && facts_of(unit.reading(&key), field).is_none() {
                continue;
            }
            value(html, unit, &key, field, label, (open, now_us));
        }
        html.close("section");
    }
    html.open(
        "section",
        &[("class", "hart-group"), ("data-testid", "hart-unavailable")],
    );
    html.node("h2", "", "Not available over documented commands");
    html.node(
        "p",
        "quiet",
        "The menus of a handheld show these too. PUB092-003 documents no command that reads them, so \
         they are not shown here, and their absence says nothing about their value.",
    );
    html.open("ul", &[("class", "plain-list")]);
    for (what, sections) in UNAVAILABLE {
        let own = unit.family.map(|family| section(sections, family));
        if own == Some(None) {
            continue;
        }
        html.open("li", &[]).text(what);
        if let Some(section) = own.flatten() {
            let source = format!(" PUB092-003-00, section {section}");
            html.node("span", "quiet", &source);
        }
        html.close("li");
    }
    html.close("ul").close("section");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hart::state::unit::tests::{hear, identity_of, unit};

    fn drawn(unit: &Unit) -> String {
        let mut html = Markup::new();
        setup(&mut html, unit, &[], 0);
        html.finish()
    }

    #[test]
    fn not_read_is_not_zero() {
        let html = drawn(&unit(&[]));
        let values = html.matches("data-testid=\"hart-value\"").count();
        assert_eq!(html.matches("not read<").count(), values);
        assert!(values > 40, "{values}");
        // Every value has a label of the tables.
        assert!(html.contains("Loop current mode") && html.contains("Final assembly number"));
        assert!(html.contains("Deadband"), "what can't be read is listed");
    }

    /// By hand from chapters 10 to 15 of PUB092-003-00.
    #[test]
    fn what_no_command_reads_is_listed_by_family() {
        let listed = |family| {
            let all = UNAVAILABLE.iter();
            let own = all.filter_map(|(what, s)| Some((*what, section(s, family)?)));
            own.map(|(what, section)| {
                let end = what.find([':', ',']).unwrap_or(what.len());
                format!("{section} {}", &what[..end])
            })
            .collect::<Vec<_>>()
        };
        let common = ["10.2 Valve label", "10.2 Main board software version"];
        let own: [(Family, &[&str]); 5] = [
            (
                Family::Cva,
                &[
                    "11.1 Type of the actuator",
                    "11.2 Stroke set-up",
                    "11.3 Valve actions",
                    "11.3 Deadband",
                    "11.3 Feedback current",
                    "11.3 Action",
                ],
            ),
            (
                Family::Iq,
                &[
                    "12.1 Type of the actuator",
                    "12.2 Valve actions",
                    "12.2 Deadband",
                    "12.2 Hysteresis",
                    "12.2 Action",
                    "12.2 Option cards that are fitted",
                    "12.2 Motion inhibit time",
                    "12.2 Partial stroke",
                    "12.2 Auxiliary inputs",
                    "12.3 Number of operations towards open and close",
                    "12.3 Historic torque over position",
                ],
            ),
            (
                Family::Cma,
                &["13.1 Type of the actuator", "13.2 Deadband", "13.2 Action"],
            ),
            (
                Family::Ck,
                &[
                    "14.1 Type of the actuator",
                    "14.2 Valve actions",
                    "14.2 Deadband",
                    "14.2 Hysteresis",
                    "14.2 Action",
                    "14.2 Option cards that are fitted",
                    "14.2 Motion inhibit time",
                    "14.2 Partial stroke",
                    "14.2 Auxiliary inputs",
                ],
            ),
            (
                Family::Si,
                &[
                    "15.1 Type of the actuator",
                    "15.2 Deadband",
                    "15.2 Hysteresis",
                    "15.2 Option cards that are fitted",
                    "15.2 Partial stroke",
                    "15.2 Auxiliary inputs",
                    "15.3 Number of operations towards open and close",
                    "15.3 Historic torque over position",
                ],
            ),
        ];
        for (family, own) in own {
            assert_eq!(listed(family), [&common, own].concat(), "{family:?}");
        }
    }

    /// Section 10.2: items 1 and 2 of the review are the counter and the time stamp, 3 to 7
    /// revisions, 8 the physical layer, 16 and 17 preambles; section 9.1: command 128 tells of the
    /// HART board.
    #[test]
    fn the_review_is_in_the_order_of_its_menu() {
        let html = drawn(&unit(&[]));
        let review = html.split(">HART review<").nth(1).unwrap();
        let at = |key: &str| review.find(&format!("data-key=\"{key}\"")).unwrap();
        let keys = [
            "0.change_counter",
            "9.time",
            "0.universal_revision",
            "0.device_revision",
            "0.software_revision",
            "0.hardware_revision",
            "0.signalling",
            "0.expanded_type",
            "0.flags",
            "0.manufacturer",
            "0.distributor",
            "0.last_variable",
            "0.profile",
            "0.request_preambles",
            "0.response_preambles",
        ];
        assert!(keys.windows(2).all(|pair| at(pair[0]) < at(pair[1])));
        assert!(html.contains("HART board software (command 128)"));
        assert!(!html.contains("Actuator software"));
    }

    /// HART 5 and 6 have a byte of device type and no expanded one.
    #[test]
    fn older_revisions_show_their_type() {
        for (revision, has, variables) in [(5, true, false), (6, true, true), (7, false, false)] {
            let mut unit = unit(&[]);
            hear(&mut unit, 0, 0, &identity_of(revision, 1), 1);
            let html = drawn(&unit);
            assert_eq!(html.contains("\"0.device_type\""), has, "{revision}");
            assert_eq!(html.contains("\"0.variables\""), variables, "{revision}");
            assert!(html.contains("Rotork"));
            // 08h: hardware revision 1, Bell 202.
            assert!(html.contains("Bell 202"), "{html}");
        }
    }
}
