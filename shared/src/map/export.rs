//! The rows of a map as text: JSON lines and CSV for tools, aligned lines for people.

use core::fmt::Write;

use serde::Serialize;

use super::row::{Access, DeviceMap, Function, Level, Member, Model, Row};
use crate::address::RegisterNumber;

/// One row in JSON. Names and order of the fields are a documented contract of the program.
#[derive(Serialize)]
struct JsonRow<'a> {
    device: &'a str,
    table: &'a str,
    address: u16,
    words: u16,
    key: &'a str,
    label: &'a str,
    r#type: &'a str,
    /// Exact text, because a float would round `0.1`.
    scale: String,
    unit: &'a str,
    access: &'a str,
    level: Option<&'a str>,
    min: Option<i32>,
    max: Option<i32>,
    set: Option<JsonSet<'a>>,
    source: String,
    trust: &'a str,
    number: u32,
    group: &'a str,
    since: Option<&'a str>,
    note: &'a str,
    moves: bool,
    reading: Option<JsonReading<'a>>,
}

#[derive(Serialize)]
struct JsonSet<'a> {
    kind: &'a str,
    values: Vec<JsonMember<'a>>,
}

/// A code or bit and its label; a run of codes has its last code as well.
#[derive(Serialize)]
#[serde(untagged)]
enum JsonMember<'a> {
    One(u16, &'a str),
    Run(u16, &'a str, u16),
}

#[derive(Serialize)]
struct JsonReading<'a> {
    id: &'a str,
    settled: &'a str,
    text: &'a str,
}

/// One row as a JSON object on one line, without a line end.
#[must_use]
pub fn json_line(map: &DeviceMap, row: &Row) -> String {
    let line = JsonRow {
        device: map.model.key(),
        table: row.table.key(),
        address: row.address.get(),
        words: row.words,
        key: row.key,
        label: row.label,
        r#type: row.kind.key(),
        scale: row.scale.to_string(),
        unit: row.unit,
        access: access(row.access),
        level: row.level.map(Level::key),
        min: row.range.map(|range| range.0),
        max: row.range.map(|range| range.1),
        set: row.set.map(|set| JsonSet {
            kind: if set.bits { "bits" } else { "enum" },
            values: set.members.iter().map(json_member).collect(),
        }),
        source: row.source.to_string(),
        trust: row.trust.key(),
        number: RegisterNumber::of(row.table, row.address).get(),
        group: row.group,
        since: row.since.map(Model::key),
        note: row.note,
        moves: moves(row),
        reading: row.reading.map(|reading| JsonReading {
            id: reading.id,
            settled: reading.settled.key(),
            text: reading.text,
        }),
    };
    // Texts and numbers only: this cannot fail.
    serde_json::to_string(&line).unwrap_or_default()
}

fn json_member(m: &Member) -> JsonMember<'_> {
    if m.value == m.last {
        JsonMember::One(m.value, m.label)
    } else {
        JsonMember::Run(m.value, m.label, m.last)
    }
}

/// `5`, or `19200-19300` for a run of codes.
fn codes(m: &Member) -> String {
    if m.value == m.last {
        m.value.to_string()
    } else {
        format!("{}-{}", m.value, m.last)
    }
}

/// The access of a row without its weight, which is [`moves`].
const fn access(access: Access) -> &'static str {
    match access {
        Access::Read => "r",
        Access::Write | Access::WriteGuarded => "rw",
        Access::WriteOnly => "w",
        Access::Absent => "none",
    }
}

/// True if a write moves or reconfigures equipment.
fn moves(row: &Row) -> bool {
    row.access.is_guarded()
}

/// The first line of a CSV file of [`csv_line`]s, without a line end.
pub const CSV_HEADER: &str = "device,table,address,number,words,key,label,type,scale,unit,access,\
moves,level,min,max,set,group,since,note,source,trust,reading";

/// One row as a CSV line (RFC 4180), without a line end.
///
/// The columns are those of [`CSV_HEADER`]; a set is written `0=Off; 1=On`, a reading by its id.
#[must_use]
pub fn csv_line(map: &DeviceMap, row: &Row) -> String {
    let number = |n: Option<i32>| n.map(|n| n.to_string()).unwrap_or_default();
    let set = row.set.map_or_else(String::new, |set| {
        let members: Vec<_> = set
            .members
            .iter()
            .map(|m| format!("{}={}", codes(m), m.label))
            .collect();
        members.join("; ")
    });
    let cells = [
        map.model.key(),
        row.table.key(),
        &row.address.to_string(),
        &RegisterNumber::of(row.table, row.address).to_string(),
        &row.words.to_string(),
        row.key,
        row.label,
        row.kind.key(),
        &row.scale.to_string(),
        row.unit,
        access(row.access),
        if moves(row) { "true" } else { "false" },
        row.level.map_or("", Level::key),
        &number(row.range.map(|range| range.0)),
        &number(row.range.map(|range| range.1)),
        &set,
        row.group,
        row.since.map_or("", Model::key),
        row.note,
        &row.source.to_string(),
        row.trust.key(),
        row.reading.map_or("", |reading| reading.id),
    ];
    cells.map(csv_cell).join(",")
}

/// A cell, in quotes if it needs them.
pub(crate) fn csv_cell(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// One row as aligned columns for people: number, address, label, type, unit, access, level,
/// source. Without a line end.
#[must_use]
pub fn text_line(row: &Row) -> String {
    let mut line = String::new();
    // Writing to a String cannot fail.
    let _ = write!(
        line,
        "{} {:>5}  {:<50} {:<8} {:<4} {:<4} {:<8} {}",
        RegisterNumber::of(row.table, row.address),
        row.address.get(),
        row.label,
        row.kind.key(),
        row.unit,
        row.access.key(),
        row.level.map_or("", Level::key),
        row.source,
    );
    line
}

/// The bits or codes of a row as lines below its [`text_line`], each with a line end.
#[must_use]
pub fn text_members(row: &Row) -> String {
    let mut lines = String::new();
    for m in row.set.map_or(&[][..], |set| set.members) {
        // Writing to a String cannot fail.
        let _ = write!(lines, "{:>13}  {}", codes(m), m.label.replace("{}", "n"));
        if let Some((zero, one)) = m.states {
            let _ = write!(lines, " (0: {zero}; 1: {one})");
        }
        lines.push('\n');
    }
    lines
}

/// One function of a device for people: code, sub-function, name, source. Without a line end.
#[must_use]
pub fn text_function(function: &Function) -> String {
    let sub = function
        .sub
        .map_or_else(String::new, |sub| format!("/ {sub}"));
    let mut text = format!(
        "FC {:02} {sub:<6}   {:<50} {}",
        function.code, function.label, function.source
    );
    if !function.note.is_empty() {
        text.push_str("; ");
        text.push_str(function.note);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::address::{Address, Table};

    fn holding(model: Model, address: u16) -> (&'static DeviceMap, &'static Row) {
        let map = model.map();
        let row = map.row_at(Table::Holding, Address::new(address));
        (map, row.expect("the map covers the address"))
    }

    #[test]
    fn json_keeps_its_contract() {
        let (map, row) = holding(Model::Icon3000v2, 3004);
        assert_eq!(
            json_line(map, row),
            "{\"device\":\"icon3000v2\",\"table\":\"holding\",\"address\":3004,\"words\":1,\
             \"key\":\"actuator_position\",\"label\":\"Actuator Position\",\"type\":\"u16\",\
             \"scale\":\"0.1\",\"unit\":\"%\",\"access\":\"r\",\"level\":\"observer\",\
             \"min\":0,\"max\":1000,\"set\":null,\
             \"source\":\"VCIOM-16345-EN, table 5, p. 23\",\"trust\":\"manual\",\
             \"number\":403005,\"group\":\"Status\",\"since\":\"icon3000\",\
             \"note\":\"1000 is fully open.\",\"moves\":false,\"reading\":null}"
        );
    }

    #[test]
    fn json_names_sets_and_readings() {
        let (map, row) = holding(Model::Icon3000v2, 3784);
        let line = json_line(map, row);
        assert!(line.contains("\"access\":\"rw\",\"level\":\"service\",\"min\":0,\"max\":3"));
        assert!(line.contains(
            "\"set\":{\"kind\":\"enum\",\
             \"values\":[[0,\"lbf\"],[1,\"Nm\"],[2,\"lb\"],[3,\"kN\"]]}"
        ));
        assert!(line.contains("\"moves\":true,\"reading\":{\"id\":\"E04\",\"settled\":\"likely\""));
    }

    #[test]
    fn json_of_what_a_model_lacks() {
        let (map, row) = holding(Model::Icon3000, 3988);
        let line = json_line(map, row);
        assert!(line.contains("\"address\":3474,\"words\":515,\"key\":\"absent_3474\""));
        assert!(line.contains("\"access\":\"none\",\"level\":null,\"min\":null"));
    }

    #[test]
    fn csv_has_as_many_cells_as_its_header_and_quotes_commas() {
        let (map, row) = holding(Model::Icon3000v2, 3504);
        assert_eq!(
            csv_line(map, row),
            "icon3000v2,holding,3504,403505,1,current,Current,u16,0.1,A,r,false,observer,0,1200,,\
             Power supply,icon3000v2,,\"VCIOM-16345-EN, table 5, p. 31\",reading,E87"
        );
        assert_eq!(CSV_HEADER.split(',').count(), 22);
        assert_eq!(csv_cell("a \"b\""), "\"a \"\"b\"\"\"");
        let (map, row) = holding(Model::Icon3000v2, 3613);
        assert!(csv_line(map, row).contains(",d,rw,true,user,1,1000,,PST,"));
    }

    /// FCD LMAIM4019-00, tables 3.7 and 3.8.
    #[test]
    fn runs_of_codes_and_functions() {
        let (map, row) = holding(Model::Ddc100Mx, 0);
        let line = json_line(map, row);
        assert!(line.contains("\"access\":\"w\",\"level\":null,\"min\":null"));
        assert!(line.contains("[6656,\"Move to the argument\"],[19200,\"Move to {} %\",19300]]"));
        assert!(line.contains("\"since\":null") && line.contains("\"moves\":true"));
        assert!(csv_line(map, row).contains("; 19200-19300=Move to {} %,Commands,,"));
        let lines = text_members(row);
        assert!(lines.starts_with("            0  Null command\n          256  Open\n"));
        assert!(lines.ends_with("\n  19200-19300  Move to n %\n"));
        let (_, status) = holding(Model::Ddc100Mx, 8);
        assert!(text_members(status).contains(
            "            6  Actuator switched to local mode (0: in REMOTE (before 1999-Q2: or STOP); \
             1: in LOCAL (after 1999-Q2: or STOP))\n"
        ));
        let clear = map.functions.iter().find(|f| f.sub == Some(10));
        assert_eq!(
            clear.map(|f| text_function(f)).unwrap_or_default(),
            "FC 08 / 10     Clear counters and diagnostics register            \
             FCD LMAIM4019-00, table 3.8, p. 23"
        );
    }

    #[test]
    fn text_is_aligned() {
        let (_, row) = holding(Model::Icon3000v2, 3004);
        assert_eq!(
            text_line(row),
            "403005  3004  Actuator Position                                  u16      %    r    \
             observer VCIOM-16345-EN, table 5, p. 23"
        );
    }
}
