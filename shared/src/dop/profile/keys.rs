//! The keys of a profile: what may stand there, and what to tell who wrote something else.

/// What a value must be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rule {
    /// An object whose keys are in the table too.
    Section,
    /// This text.
    Exactly(&'static str),
    /// Any text.
    Text,
    /// True or false.
    Bool,
    /// One of these texts.
    OneOf(&'static [&'static str]),
    /// A whole number in this range.
    Int(i64, i64),
    /// The same, or null for not configured.
    IntOrNull(i64, i64),
    /// One of these numbers.
    OneNumber(&'static [i64]),
    /// 1, 10, 100 and so on, to a million.
    Power,
    /// A list of named bits, so many of them.
    Bits(i64),
}

use Rule as R;

const OPTION: Rule = R::Int(0, 15);
const ADDRESS: Rule = R::IntOrNull(0, 65_535);

/// All keys with the keys around them.
pub(super) static KEYS: [(&str, Rule); 45] = [
    ("format", R::Exactly(super::FORMAT)),
    ("version", R::OneNumber(&[1])),
    ("name", R::Text),
    ("registers", R::Section),
    ("registers.request", ADDRESS),
    ("registers.indicators", R::IntOrNull(0, 65_532)),
    ("registers.status", ADDRESS),
    ("registers.count", ADDRESS),
    ("registers.response", R::IntOrNull(0, 65_024)),
    ("table", R::OneOf(&["holding", "input"])),
    ("request_function", R::OneNumber(&[6, 16])),
    ("status", R::Section),
    ("status.shift", R::IntOrNull(11, 13)),
    ("words", R::Section),
    ("words.low_word_first", R::Bool),
    ("words.text_low_byte_first", R::Bool),
    ("words.byte_swap", R::Bool),
    ("time", R::Section),
    ("time.epoch", R::Int(-62_135_596_800, 253_402_300_799)),
    ("time.unit", R::OneOf(&["s", "ms"])),
    ("temperature", R::OneOf(&["degC", "degF"])),
    ("scales", R::Section),
    ("scales.dst_trend", R::Power),
    ("scales.dst_statistics", R::Power),
    ("scales.movement_position", R::Power),
    ("scales.movement_speed", R::Power),
    ("scales.movement_torque", R::Power),
    ("log", R::Section),
    ("log.newest", OPTION),
    ("log.oldest", OPTION),
    ("log.older", OPTION),
    ("log.newer", OPTION),
    ("log.present", OPTION),
    ("reading", R::Section),
    ("reading.max_registers", R::Int(1, 125)),
    ("reading.poll_ms", R::Int(10, 60_000)),
    ("reading.timeout_ms", R::Int(100, 600_000)),
    ("reading.retries", R::Int(0, 10)),
    ("reading.log_limit", R::Int(1, 1_000_000)),
    ("indicators", R::Bits(64)),
    ("alarms", R::Bits(32)),
    ("warnings", R::Bits(32)),
    ("[].bit", R::Int(0, 63)),
    ("[].name", R::Text),
    ("[].ne107", R::OneOf(&["F", "C", "S", "M"])),
];

/// The rule for a key; `[]` stands for the elements of a list.
pub(super) fn rule(path: &str) -> Option<Rule> {
    KEYS.iter()
        .find(|(key, _)| *key == path)
        .map(|(_, rule)| *rule)
}

/// The keys that may stand beside each other within `section`.
pub(super) fn beside(section: &str) -> Vec<&'static str> {
    KEYS.iter()
        .filter_map(|(key, _)| match section {
            "" => (!key.contains('.')).then_some(*key),
            _ => key.strip_prefix(section)?.strip_prefix('.'),
        })
        .collect()
}

impl Rule {
    /// What to write.
    pub(super) fn wanted(self) -> String {
        let quoted = |words: &[&str]| {
            let words: Vec<String> = words.iter().map(|word| format!("{word:?}")).collect();
            words.join(" or ")
        };
        match self {
            R::Section => "an object in braces".to_owned(),
            R::Exactly(text) => format!("{text:?}"),
            R::Text => "a text in quotes".to_owned(),
            R::Bool => "true or false".to_owned(),
            R::OneOf(words) => quoted(words),
            R::Int(min, max) => format!("a whole number from {min} to {max}"),
            R::IntOrNull(min, max) => format!("a whole number from {min} to {max}, or null"),
            R::OneNumber(numbers) => {
                let numbers: Vec<String> = numbers.iter().map(i64::to_string).collect();
                numbers.join(" or ")
            }
            R::Power => "1, 10, 100, 1000 and so on to 1000000: counts of one unit".to_owned(),
            R::Bits(count) => format!(
                "a list of objects with bit (0 to {}), name, and ne107 if it has a category",
                count.saturating_sub(1)
            ),
        }
    }
}
