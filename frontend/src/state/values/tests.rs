//! What lines and values of the register browser say.

use super::*;
use shared::capture::Micros;
use shared::map::row::Model;

fn row(key: &str) -> &'static Row {
    Model::Icon3000v2.map().by_key(Table::Holding, key).unwrap()
}

fn image(start: u16, words: &[u16]) -> Image {
    let count = u16::try_from(words.len()).unwrap();
    let [s0, s1] = start.to_be_bytes();
    let [c0, c1] = count.to_be_bytes();
    let mut response = vec![3, u8::try_from(words.len() * 2).unwrap()];
    response.extend(words.iter().flat_map(|w| w.to_be_bytes()));
    let mut image = Image::new();
    image
        .absorb(&[3, s0, s1, c0, c1], &response, Micros::new(5))
        .unwrap();
    image
}

#[test]
fn values_are_shown_with_their_unit() {
    let image = image(3001, &[0x0021, 0, 0, 452]);
    let position = cell(Item::Row(row("actuator_position")), &image).unwrap();
    assert_eq!((position.text.as_str(), position.unit), ("45.2", "%"));
    assert_eq!((position.at, position.numeric), (5, true));
    let status = row("actuator_status_1");
    let status_cell = cell(Item::Row(status), &image).unwrap();
    assert_eq!(status_cell.text, "Close Limit, Selector in REMOTE");
    let member = status.set.unwrap().get(1).unwrap();
    let bit = cell(Item::Bit(status, member), &image).unwrap();
    assert!(bit.faint);
    assert_eq!(cell(Item::Row(row("output_torque")), &image), None);
}

#[test]
fn texts_are_decoded_as_their_answer() {
    let image = image(
        3056,
        &[0x5856, 0x2D31, 0x3031, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0],
    );
    let tag = cell(Item::Row(row("valve_tag_name")), &image).unwrap();
    assert_eq!(tag.text, "XV-101");
    let curve: Vec<u16> = (0..64).collect();
    let image = self::image(3200, &curve);
    let curve = cell(Item::Row(row("last_close_torque_curve")), &image).unwrap();
    assert!(curve.text.contains("samples"), "{}", curve.text);
}

#[test]
fn lines_follow_filter_and_opened_bits() {
    let map = Model::Icon3000v2.map();
    let lines = |filter: &Filter, opened: &Opened| {
        items(map, filter, opened, Order::default(), &Image::new())
    };
    let all = lines(&Filter::default(), &Opened::new());
    assert_eq!(all.len(), map.rows.len());
    let settings = [("q", "status"), ("table", "holding"), ("access", "r")];
    let filter = filter(|key| {
        settings
            .iter()
            .find(|(k, _)| *k == key)
            .map(|(_, v)| (*v).to_owned())
    });
    let found = lines(&filter, &Opened::new());
    assert!(!found.is_empty() && found.len() < 40);
    let mut opened = Opened::new();
    toggle(&mut opened, place(row("actuator_status_1")));
    assert_eq!(lines(&filter, &opened).len(), found.len() + 16);
}

#[test]
fn a_line_is_copied_with_tabs() {
    let image = image(3001, &[0x0021, 0, 0, 452]);
    let item = Item::Row(row("actuator_position"));
    assert_eq!(
        as_text(item, cell(item, &image).as_ref()),
        "holding\t3004\t403005\tActuator Position\t45.2\t%\tgood\t01C4\tVCIOM-16345-EN, table 5, p. 23"
    );
    let unread = as_text(Item::Row(row("output_torque")), None);
    assert!(unread.starts_with("holding\t3005\t403006\tOutput Torque\t\t\tnot read\t\t"));
    let status = row("actuator_status_1");
    let bit = Item::Bit(status, status.set.unwrap().get(0).unwrap());
    let text = as_text(bit, cell(bit, &image).as_ref());
    assert!(
        text.contains("\tActuator Status 1, bit 0: Close Limit\t"),
        "{text}"
    );
}

#[test]
fn raw_words_in_three_forms() {
    assert_eq!(
        RawForm::Hex.write(&[1, 2, 3, 4, 5], false),
        "0001 0002 0003 0004 …"
    );
    assert_eq!(RawForm::Decimal.write(&[452], false), "452");
    assert_eq!(RawForm::Binary.write(&[5], false), "0000 0000 0000 0101");
    assert_eq!(RawForm::Hex.write(&[1], true), "1");
}
