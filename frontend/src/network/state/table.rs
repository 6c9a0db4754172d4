//! The table of all units: which are shown, and in which order.

use shared::ddc100::scaling::Scaled;
use shared::ddc100::view::Own;

use super::net::{Net, Unit};
use super::tags::Tags;
use super::unit::{Health, Judged, kind};
use crate::state::sorted::{self, Columns, Key, places};

/// A column that the table can be sorted by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Column {
    /// The worst first, then in the order of the cable.
    #[default]
    Worst,
    /// The order of the cable.
    Place,
    /// The address.
    Unit,
    /// The tag.
    Tag,
    /// The position of the valve.
    Position,
    /// The state in words.
    Status,
    /// The number of faults, the most first.
    Faults,
    /// The age of the last good answer, the youngest first.
    Age,
    /// How long the last answer took, the quickest first.
    Response,
}

impl Columns for Column {
    const ALL: &'static [Self] = &[
        Self::Worst,
        Self::Place,
        Self::Unit,
        Self::Tag,
        Self::Position,
        Self::Status,
        Self::Faults,
        Self::Age,
        Self::Response,
    ];

    fn key(self) -> &'static str {
        match self {
            Self::Worst => "worst",
            Self::Place => "place",
            Self::Unit => "unit",
            Self::Tag => "tag",
            Self::Position => "position",
            Self::Status => "status",
            Self::Faults => "faults",
            Self::Age => "age",
            Self::Response => "response",
        }
    }
}

impl Column {
    /// The word over the column.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Worst => "Worst",
            Self::Place => "Order",
            Self::Unit => "Unit",
            Self::Tag => "Tag",
            Self::Position => "Position",
            Self::Status => "Status",
            Self::Faults => "Faults",
            Self::Age => "Age",
            Self::Response => "Response",
        }
    }
}

/// By which column the table is sorted, and which way.
pub type Order = sorted::Order<Column>;

fn key(unit: &Unit, judged: &Judged, tags: &Tags, column: Column) -> Key {
    let maybe = |n: Option<u64>| n.map_or(Key::None, Key::Count);
    match column {
        Column::Worst => Key::Count(u64::from(u8::MAX - judged.health as u8)),
        // Rows come in the order of the cable, and equal ones stay in it.
        Column::Place => Key::Count(0),
        Column::Unit => Key::Count(u64::from(unit.info.unit)),
        Column::Tag => match tags.tag(unit) {
            "" => Key::None,
            tag => Key::Text(tag.to_ascii_lowercase()),
        },
        // What is on no scale follows what is.
        Column::Position => maybe(judged.view.position.as_ref().map(|analog| {
            let tenths = analog.scaled.and_then(Scaled::tenths);
            tenths.map_or_else(|| 10_000 + u64::from(analog.raw), u64::from)
        })),
        Column::Status => match judged.known {
            true => Key::Text(judged.view.state.clone()),
            false => Key::None,
        },
        Column::Faults => match judged.known {
            true => Key::Count(u64::MAX - judged.view.faults.len() as u64),
            false => Key::None,
        },
        Column::Age => maybe(unit.at.map(|at| u64::MAX - at)),
        Column::Response => maybe(unit.took),
    }
}

/// True if a unit is wanted: by its address, tag, description, kind, state or a fault, whatever of
/// it has all words of the query.
fn wanted(unit: &Unit, judged: &Judged, tags: &Tags, query: &str) -> bool {
    let mut text = format!(
        "{} {} {} {} {} {} {}",
        unit.info.unit,
        tags.tag(unit),
        tags.description(unit),
        kind(unit.device),
        judged.view.state,
        judged.local(),
        if judged.health == Health::Lost {
            "off-line"
        } else {
            ""
        },
    );
    for bit in &judged.view.faults {
        text.push(' ');
        text.push_str(bit.member.label);
    }
    let text = text.to_ascii_lowercase();
    query
        .to_ascii_lowercase()
        .split_whitespace()
        .all(|word| text.contains(word))
}

/// What the table shows of which units.
#[derive(Clone, Copy, Debug, Default)]
pub struct Filter<'a> {
    /// By which column it is sorted.
    pub order: Order,
    /// Words that all must be in what a unit says.
    pub query: &'a str,
    /// True for what is wrong only.
    pub only_faults: bool,
}

/// The places of the units that are shown, in the order in which they are. `judged` are all units
/// of the network.
#[must_use]
pub fn rows(net: &Net, judged: &[Judged], tags: &Tags, filter: Filter<'_>) -> Vec<usize> {
    let order = filter.order;
    let (mut keys, mut found) = (Vec::new(), Vec::new());
    for (at, (unit, judged)) in net.units.iter().zip(judged).enumerate() {
        let good = judged.health <= Health::Unknown;
        if (filter.only_faults && good) || !wanted(unit, judged, tags, filter.query) {
            continue;
        }
        keys.push(key(unit, judged, tags, order.column));
        found.push(at);
    }
    let places = places(&keys, order.down);
    let mut rows: Vec<usize> = places.into_iter().map(|at| found[at]).collect();
    if order.column == Column::Place && order.down {
        rows.reverse();
    }
    rows
}

/// The columns of a file of units.
const COLUMNS: &str = "order,unit,tag,description,type,state,position,scale,host fault A,\
                       host fault B,unit fault A,unit fault B,faults,age s,response ms\n";

/// Those rows as text for spreadsheets, with commas between the columns for files and tabs for the
/// clipboard.
#[must_use]
pub fn as_text(
    net: &Net,
    tags: &Tags,
    (judged, rows): (&[Judged], &[usize]),
    now_us: u64,
    comma: char,
) -> String {
    let mut out = COLUMNS.replace(',', &comma.to_string());
    let bit = |bit: Option<bool>| match bit {
        Some(true) => "1",
        Some(false) => "0",
        None => "",
    };
    for at in rows {
        let Some((unit, judged)) = net.units.get(*at).zip(judged.get(*at)) else {
            continue;
        };
        let own = [judged.view.own.one, judged.view.own.two].map(|own| match own {
            Own::Unknown => None,
            Own::Good => Some(false),
            Own::Fault | Own::NotFitted => Some(true),
        });
        let number = |n: Option<u64>| n.map_or_else(String::new, |n| n.to_string());
        let names: Vec<&str> = judged.view.faults.iter().map(|b| b.member.label).collect();
        let age = unit.at.map(|at| now_us.saturating_sub(at) / 1_000_000);
        let took = unit
            .took
            .map(|took| format!("{}.{}", took / 1000, took % 1000 / 100));
        let cells = [
            (at + 1).to_string(),
            unit.info.unit.to_string(),
            tags.tag(unit).to_owned(),
            tags.description(unit).to_owned(),
            unit.info.kind.clone(),
            judged.view.state.clone(),
            number(judged.view.position.map(|p| u64::from(p.raw))),
            tags.scaling(unit, 8).key().to_owned(),
            bit(unit.fault[0]).to_owned(),
            bit(unit.fault[1]).to_owned(),
            bit(own[0]).to_owned(),
            bit(own[1]).to_owned(),
            names.join("; "),
            number(age),
            took.unwrap_or_default(),
        ];
        for (at, cell) in cells.iter().enumerate() {
            if at > 0 {
                out.push(comma);
            }
            quoted(&mut out, cell, comma);
        }
        out.push('\n');
    }
    out
}

/// A cell of a CSV file. One that a spreadsheet would take for a formula is kept from it.
pub fn quoted(out: &mut String, cell: &str, comma: char) {
    let formula = cell.starts_with(['=', '+', '-', '@']);
    if formula || cell.contains([comma, '"', '\n', '\r']) {
        out.push('"');
        if formula {
            out.push('\'');
        }
        out.push_str(&cell.replace('"', "\"\""));
        out.push('"');
    } else {
        out.push_str(cell);
    }
}

#[cfg(test)]
mod tests {
    use super::super::net::tests::{network, poll};
    use super::*;
    use shared::proto::DdcShape;

    const GOOD: [Option<bool>; 2] = [Some(false), Some(false)];

    fn net() -> Net {
        let mut net = network(4, DdcShape::Loop, 2);
        poll(&mut net, 1, GOOD, &[10, 0x0802, 0, 0, 1, 0, 0, 0, 0]);
        poll(&mut net, 2, GOOD, &[90, 0x1004, 0, 0, 1, 0, 0, 0, 0]);
        poll(&mut net, 3, [Some(true), Some(true)], &[]);
        net.units[1].at = Some(1_000_000);
        net.units[1].took = Some(162_400);
        net
    }

    fn shown(order: &str, query: &str, only_faults: bool) -> Vec<usize> {
        let (net, tags) = (net(), Tags::default());
        let filter = Filter {
            order: Order::parse(order),
            query,
            only_faults,
        };
        rows(&net, &Judged::all(&net, &tags), &tags, filter)
    }

    fn sorted(text: &str) -> Vec<usize> {
        shown(text, "", false)
    }

    #[test]
    fn the_worst_comes_first() {
        assert_eq!(sorted(""), [2, 1, 3, 0]);
        assert_eq!(sorted("-worst"), [0, 3, 1, 2]);
        assert_eq!(sorted("place"), [0, 1, 2, 3]);
        assert_eq!(sorted("-unit"), [3, 2, 1, 0]);
        assert_eq!(
            sorted("-position"),
            [1, 0, 2, 3],
            "what is not known is last"
        );
        assert_eq!(sorted("age"), [0, 1, 2, 3]);
        assert_eq!(sorted("-age"), [1, 0, 2, 3]);
        assert_eq!(sorted("-response"), [1, 0, 2, 3]);
        assert_eq!(sorted("-status"), [1, 0, 2, 3]);
        assert_eq!(sorted("-tag"), [3, 2, 1, 0]);
        assert_eq!(sorted("-place"), [3, 2, 1, 0]);
        // Unit 2 has a fault bit, unit 1 none; nothing was read of the others.
        assert_eq!(sorted("faults"), [1, 0, 2, 3]);
        assert_eq!(sorted("-faults"), [0, 1, 2, 3]);
    }

    #[test]
    fn units_are_found_by_their_words() {
        let find = |query, faults| shown("place", query, faults);
        assert_eq!(find("torque", false), [1]);
        assert_eq!(find("mov-003", false), [2]);
        assert_eq!(find("off-line", false), [2]);
        assert_eq!(find("uec closed", false), [0]);
        assert_eq!(find("", true), [1, 2]);
        assert_eq!(find("nonsense", false), [0_usize; 0]);
    }

    #[test]
    fn a_row_as_csv() {
        let mut net = net();
        net.units[1].info.tag = "=MOV \"2\", x".into();
        let tags = Tags::default();
        let judged = Judged::all(&net, &tags);
        let csv = as_text(&net, &tags, (&judged, &[1, 2]), 3_000_000, ',');
        let lines: Vec<_> = csv.lines().collect();
        assert_eq!(
            lines[1],
            "2,2,\"'=MOV \"\"2\"\", x\",,ddc100-uec,Stopped between the ends,90,0-100,0,0,0,0,Open torque switch fault,2,162.4"
        );
        assert_eq!(
            lines[2],
            "3,3,MOV-003,,ddc100-uec,Not read yet,,0-100,1,1,,,,,"
        );
    }
}
