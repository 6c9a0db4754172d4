//! Rows, heads and details of the register browser as HTML.

use super::*;
use shared::address::Table;
use shared::map::row::Model;

fn cell() -> Cell {
    Cell {
        text: "45.2".into(),
        unit: "%",
        numeric: true,
        faint: false,
        quality: Quality::Good,
        at: 1_000_000,
        changed: Some(1_000_000),
        words: vec![452],
    }
}

fn position() -> Item {
    let map = Model::Icon3000v2.map();
    Item::Row(map.by_key(Table::Holding, "actuator_position").unwrap())
}

fn around(now: u64, reachable: bool) -> Around {
    Around {
        now,
        period: Some(1_000_000),
        reachable,
        raw: RawForm::Hex,
        open: false,
    }
}

fn html(cell: Option<&Cell>, around: &Around) -> String {
    let mut html = Markup::new();
    row(&mut html, position(), cell, around);
    html.finish()
}

#[test]
fn a_row_shows_both_addresses_and_its_age() {
    let fresh = html(Some(&cell()), &around(1_250_000, true));
    for part in ["3004", "403005", "45.2", "0.2 s", "01C4", "changed fade-2"] {
        assert!(fresh.contains(part), "{part}: {fresh}");
    }
    assert!(!fresh.contains("stale"));
    let later = html(Some(&cell()), &around(9_000_000, true));
    assert!(later.contains("stale") && !later.contains("changed"));
    assert!(html(Some(&cell()), &around(1_250_000, false)).contains("stale"));
    assert!(html(None, &around(0, true)).contains("not read"));
}

#[test]
fn the_head_says_how_the_list_is_sorted() {
    let mut html = Markup::new();
    head(&mut html, RawForm::Hex, Order::parse("-value"));
    let html = html.finish();
    assert_eq!(html.matches("aria-sort=\"none\"").count(), 3);
    assert_eq!(html.matches("aria-sort=\"descending\"").count(), 1);
}

#[test]
fn an_empty_list_says_what_to_do() {
    let words = |query, reserved| {
        let mut html = Markup::new();
        nothing(&mut html, query, reserved);
        html.finish()
    };
    let html = words("<x>", true);
    assert!(html.contains("\u{201c}&lt;x&gt;\u{201d}") && html.contains("tick Reserved"));
    assert!(!words("", false).contains("Reserved"));
    assert!(html.contains("data-act=\"widen\""));
}

#[test]
fn notes_lead_to_their_readings() {
    let note = "Bits 0 to 15 match; see also E41, E5x and EFS.";
    let ids = Model::Icon3000v2.map().mentioned(note).map(|r| r.id);
    assert_eq!(ids.collect::<Vec<_>>(), ["E41"]);
}

#[test]
fn the_detail_has_all_facts() {
    let map = Model::Icon3000v2.map();
    let mut html = Markup::new();
    detail(&mut html, map, position(), Some(&cell()), &[], "");
    let html = html.finish();
    for part in [
        "Holding register",
        "403005",
        "u16",
        "0 to 1000",
        "VCIOM-16345-EN",
        "Copy row",
    ] {
        assert!(html.contains(part), "{part}: {html}");
    }
}
