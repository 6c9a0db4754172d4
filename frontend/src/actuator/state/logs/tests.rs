use super::*;
use shared::device::Device;

/// 2024-02-29 12:34:56 is second 762 525 296 since 2000: 8825 days and 45 296 s.
const THEN: u32 = 8825 * 86_400 + 45_296;

/// Records of a file as if they had been read at once.
pub(crate) fn put(dossier: &mut Dossier, file: u16, words: &[u16]) {
    for (start, words) in (0_u16..).step_by(100).zip(words.chunks(100)) {
        let count = u16::try_from(words.len()).unwrap();
        let mut request = vec![0x14, 7, 6];
        for word in [file, start, count] {
            request.extend(word.to_be_bytes());
        }
        let bytes = u8::try_from(words.len() * 2).unwrap();
        let mut response = vec![0x14, bytes + 2, bytes + 1, 6];
        response.extend(words.iter().flat_map(|w| w.to_be_bytes()));
        assert!(dossier.absorb(&request, &response, 1));
    }
}

fn time(seconds: u32) -> [u16; 2] {
    [(seconds >> 16) as u16, seconds as u16]
}

/// Three alarms: 6 hi-hi torque in open, 12 lost phase, 6 again; the latest first.
fn alarms() -> Table {
    let mut dossier = Dossier::new("XV", Device::Icon3000v2);
    let mut words = vec![3];
    for (ago, code) in [(0, 6), (60, 12), (86_400, 6)] {
        words.extend(time(THEN - ago));
        words.push(code);
    }
    put(&mut dossier, 2, &words);
    Table::of(&dossier, 2)
}

#[test]
fn entries_are_rows() {
    let table = alarms();
    assert_eq!(table.stored, Some(3));
    assert_eq!(table.rows.len(), 3);
    let first = &table.rows[0];
    assert_eq!(stamp(first.time.unwrap()), "2024-02-29 12:34:56");
    let cell = first.cells[0].as_ref().unwrap();
    assert!(cell.text.contains("open"), "{cell:?}");
    assert_eq!((cell.number, cell.raw.as_str()), (Some(6), "0006"));
    assert_eq!(table.names().len(), 1);
}

#[test]
fn rows_are_filtered_and_sorted() {
    let table = alarms();
    let mut filter = Filter::default();
    assert_eq!(table.matching(&filter), [0, 1, 2]);
    filter.sort(Column::Number);
    assert_eq!(table.matching(&filter), [2, 1, 0]);
    filter.sort(Column::Time);
    assert_eq!(table.matching(&filter), [2, 1, 0]);
    filter.sort(Column::Value(0));
    assert_eq!(
        table.matching(&filter),
        [0, 2, 1],
        "by code, then by number"
    );
    filter.sort(Column::Value(0));
    assert_eq!(table.matching(&filter), [1, 2, 0]);
    filter.text = "2024-02-28".into();
    assert_eq!(table.matching(&filter), [2]);
    filter.text = "lost".into();
    assert_eq!(table.matching(&filter), [1]);
    filter.code = Some(6);
    assert!(table.matching(&filter).is_empty());
}

#[test]
fn exports_carry_both_clocks() {
    let table = alarms();
    let csv = csv(&table, &[0, 1], Some(3600));
    let lines: Vec<_> = csv.lines().collect();
    assert_eq!(lines.len(), 3);
    assert!(lines[0].starts_with("number,device_time,utc,"), "{csv}");
    assert!(
        lines[1].starts_with("1,2024-02-29T12:34:56,2024-02-29T11:34:56Z,"),
        "{csv}"
    );
    assert!(lines[1].ends_with(",0006"));
    let json = json(&table, &[1], None);
    let read = crate::state::json::Json::parse(json.trim()).unwrap();
    let first = &read.list().unwrap()[0];
    assert_eq!(first.get("number").unwrap().number(), Some(2));
    assert_eq!(
        first.get("device_time").unwrap().text(),
        Some("2024-02-29T12:33:56")
    );
    assert_eq!(first.get("utc"), Some(&crate::state::json::Json::Null));
}

/// Reading E69: file 5 is not described.
#[test]
fn file_5_is_raw() {
    let mut dossier = Dossier::new("XV", Device::Icon3000v2);
    put(&mut dossier, 5, &[0x4142, 0xFFFF]);
    let table = Table::of(&dossier, 5);
    let texts =
        |row: &Row| -> Vec<String> { row.cells.iter().flatten().map(|c| c.text.clone()).collect() };
    assert_eq!(texts(&table.rows[0]), ["4142", "16706", "16706", "AB"]);
    assert_eq!(texts(&table.rows[1]), ["FFFF", "65535", "-1", "··"]);
    assert_eq!(
        table.rows[1].cells[0].as_ref().unwrap().quality,
        Quality::Disputed
    );
    assert_eq!(
        csv(&table, &[0], None),
        "record,Hexadecimal,Unsigned,Signed,Characters,raw\n0,4142,16706,16706,AB,4142\n"
    );
}

/// Nothing read is an empty table with its columns, and an entry beyond the count is left out.
#[test]
fn what_the_head_does_not_announce_is_left_out() {
    let mut dossier = Dossier::new("XV", Device::Icon3000v2);
    assert!(Table::of(&dossier, 2).rows.is_empty());
    assert_eq!(Table::of(&dossier, 2).columns.len(), 1);
    put(&mut dossier, 2, &[1, 0, 5, 6, 0, 4, 7]);
    let table = Table::of(&dossier, 2);
    assert_eq!(table.rows.len(), 1);
    assert_eq!(table.problems.len(), 1, "{:?}", table.problems);
}

/// Before the ICON3000v2 the five latest alarms stand in registers: on an ICON3000 in HR 3090 and
/// on, code, date and time of each (notes 2 and 3 of table 5). Code 0 is no entry.
#[test]
fn registers_make_a_table_without_files() {
    let mut dossier = Dossier::new("XV", Device::Icon3000);
    let table = Table::of(&dossier, 2);
    assert_eq!((table.rows.len(), table.columns.len()), (0, 1));
    let words = [
        6, 0x2902, 0x2024, 0x0012, 0x3456, 12, 0x2802, 0x2024, 0x0003, 0x0405, 0, 0, 0, 0, 0,
    ];
    crate::actuator::markup::rows::tests::put(&mut dossier, 3090, &words, 1);
    let table = Table::of(&dossier, 2);
    assert_eq!(table.place, "HR 3090 to 3114");
    let rows: Vec<_> = table.rows.iter().collect();
    let [latest, before] = rows[..] else {
        panic!("{rows:?}");
    };
    assert_eq!(stamp(latest.time.unwrap()), "2024-02-29 12:34:56");
    assert_eq!(stamp(before.time.unwrap()), "2024-02-28 03:04:05");
    assert_eq!(latest.cells[0].as_ref().unwrap().number, Some(6));
    let text = &before.cells[0].as_ref().unwrap().text;
    assert!(text.contains("Lost"), "{text}");
    assert_eq!(table.matching(&Filter::default()), [0, 1]);
    assert_eq!(logs_of(&dossier), [2, 3]);
    let wanted = rows_of(&dossier);
    assert_eq!((wanted.first(), wanted.last()), (Some(&3090), Some(&3138)));
    dossier.device = Device::Icon3000v2;
    assert_eq!((logs_of(&dossier).len(), rows_of(&dossier).len()), (5, 0));
}

fn rows_of(dossier: &Dossier) -> Vec<u16> {
    let rows = rows(dossier).into_iter();
    rows.map(|row| row.address.get()).collect()
}
