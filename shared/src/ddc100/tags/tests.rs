use super::*;
use proptest::prelude::*;

/// Table 6.1 as printed, with the columns in the order of the print.
const TABLE_6_1: &str = "\
Tag Name,Description,Modbus Slave Address,Comments,Modbus Register,Modbus Command Data
80-HS-4141A,Open actuator,1,Command to open the valve,40001,256 (Dec)
80-HS-4141B,Close actuator,1,Command to close the valve,40001,768 (Dec)
80-POS-4141,Position feedback,1,Valve position in % of Open,40008,n/a
80-STAT-4141,Status register,1,16 bits of status,40009,n/a
80-HS-4142A,Open actuator,2,Command to open the valve,40001,256 (Dec)
80-HS-4142B,Close actuator,2,Command to close the valve,40001,768 (Dec)
80-POS-4142,Position feedback,2,Valve position in % of Open,40008,n/a
80-STAT-4142,Status register,2,16 bits of status,40009,n/a
80-GO-5253A,\"Initiate \"\"move-to\"\"\",3,\"Initiate \"\"move-to\"\"\",40001,6656 (Dec)
80-GO-5253B,\"\"\"move-to\"\" value\",3,% of Open value,40002,0-100 (Dec)
80-POS-5253,Position feedback,3,Valve position in % of Open,40008,n/a
80-STAT-5253,Status register,3,16 bits of status,40009,n/a
";

#[test]
fn the_printed_table() {
    let list = TagList::read(TABLE_6_1);
    assert_eq!(list.problems, []);
    assert_eq!(list.tags.len(), 12);
    let tag = |name: &str| list.tags.iter().find(|t| t.tag == name).unwrap();
    assert_eq!(tag("80-HS-4141A").data, Some(Data::Value(256)));
    assert_eq!(tag("80-GO-5253B").data, Some(Data::Range(0, 100)));
    assert_eq!(tag("80-GO-5253A").description, "Initiate \"move-to\"");
    assert_eq!(
        (tag("80-POS-5253").unit, tag("80-POS-5253").register),
        (3, Some(8))
    );
    assert_eq!(tag("80-POS-4141").data, None);
    assert_eq!(TagList::read(&list.to_csv()).tags, list.tags);
}

#[test]
fn units_types_and_scales() {
    let list = TagList::read(
        "\u{FEFF}tag;unit;type;scaling;register;description\r\n\
         MOV-1;7;DDC100-UEC;;;\"Inlet; north\"\r\n\
         POS-1;7;;0-4095;8;\r\n\r\n\
         MOV-2;250;ddc100-mx;;;\r\n",
    );
    assert_eq!(list.problems, []);
    assert_eq!(list.kind(7), Some(Device::Ddc100Uec));
    assert_eq!(list.scaling(7, 8), Some(Scaling::TwelveBits));
    assert_eq!(list.scaling(7, 7), None);
    assert_eq!(list.of_unit(7).unwrap().description, "Inlet; north");
    assert_eq!(list.of_unit(250).unwrap().tag, "MOV-2");
    assert_eq!(list.of_unit(1), None);
}

/// Each problem with its place; the rest is read.
#[test]
fn problems_have_a_place() {
    let check = |text: &str, expected: &[(u32, u32, &str)], tags: usize| {
        let list = TagList::read(text);
        let found: Vec<_> = list.problems.iter().map(|p| (p.line, p.column)).collect();
        let wanted: Vec<_> = expected.iter().map(|(l, c, _)| (*l, *c)).collect();
        assert_eq!(found, wanted, "{:?}", list.problems);
        for (problem, (_, _, part)) in list.problems.iter().zip(expected) {
            assert!(problem.text.contains(part), "{problem}");
        }
        assert_eq!(list.tags.len(), tags);
    };
    check("", &[(1, 1, "empty")], 0);
    check(
        "Tag,Description\na,b\n",
        &[(1, 1, "\"Unit\" is missing")],
        0,
    );
    check(
        "Tag,Unit,Colour\na,1,red\n",
        &[(1, 10, "\"Colour\" is not known")],
        1,
    );
    check("Tag,Unit,unit\na,1,2\n", &[(1, 10, "twice")], 1);
    check(
        "Tag,Unit\na,0\nb,251\nc,x\nd,250\n",
        &[(2, 3, "1 to 250"), (3, 3, "1 to 250"), (4, 3, "1 to 250")],
        1,
    );
    check(
        "Tag,Unit\n,1\na,\n",
        &[(2, 1, "no tag"), (3, 1, "no unit")],
        0,
    );
    check(
        "Tag,Unit\na,1\na,2\n",
        &[(3, 1, "there already, at unit 1")],
        1,
    );
    check("Tag,Unit,Type\na,1,icon3000\n", &[(2, 5, "ddc100-uec")], 1);
    check(
        "Tag,Unit,Type\na,1,ddc100-mx\nb,1,ddc100-io\n",
        &[(1, 1, "unit 1 is ddc100-io")],
        2,
    );
    check(
        "Tag,Unit,Register\na,1,30001\nb,1,40000\n",
        &[(2, 5, "40001"), (3, 5, "40001")],
        2,
    );
    check(
        "Tag,Unit,Data\na,1,70000\nb,1,9-3\nc,1,0x1G\n",
        &[(2, 5, "16 bits"), (3, 5, "16 bits"), (4, 5, "16 bits")],
        3,
    );
    check("Tag,Unit,Scaling\na,1,2-255\n", &[(2, 5, "0-255")], 1);
    check("Tag,Unit\na,1,x\n", &[(2, 5, "more cells")], 1);
    check(
        "Tag,Unit\n\"a,1\n",
        &[(2, 1, "never closed"), (2, 1, "no unit")],
        0,
    );
    check("Tag,Unit\n\"a\"b,1\n", &[(2, 4, "closing quote")], 1);
    let long = format!("Tag,Unit\n{},1\n", "x".repeat(201));
    check(&long, &[(2, 1, "200 characters")], 0);
}

#[test]
fn no_more_than_so_many_lines() {
    let mut text = String::from("Tag,Unit\n");
    for n in 0..=MOST_LINES {
        text.push_str(&format!("t{n},1\n"));
    }
    let list = TagList::read(&text);
    assert_eq!(list.tags.len(), MOST_LINES);
    assert_eq!(list.problems.len(), 1);
}

fn any_tag() -> impl Strategy<Value = Tag> {
    let words = "[ -~äß€\n\"]{0,20}";
    (
        ("[!-~]{1,12}", words, words),
        (1..=250_u8, proptest::option::of(1..=112_u16)),
        proptest::option::of(any::<(u16, u16)>()),
        proptest::option::of(0..4_usize),
    )
        .prop_map(
            |((tag, description, comments), (unit, register), data, scaling)| Tag {
                tag,
                description: description.trim().to_owned(),
                comments: comments.trim().to_owned(),
                unit,
                kind: None,
                register,
                data: data.map(|(a, b)| {
                    if a < b {
                        Data::Range(a, b)
                    } else {
                        Data::Value(a)
                    }
                }),
                scaling: scaling.map(|n| Scaling::ALL[n]),
            },
        )
}

proptest! {
    /// What is written is read again.
    #[test]
    fn lists_come_back(mut tags in proptest::collection::vec(any_tag(), 0..12)) {
        let mut known = std::collections::BTreeSet::new();
        tags.retain(|t| known.insert(t.tag.clone()));
        let list = TagList { tags, problems: vec![] };
        prop_assert_eq!(TagList::read(&list.to_csv()), list);
    }

    /// Any text gives something.
    #[test]
    fn any_text(text in "\\PC*|[a-zA-Z0-9,;\t\"\r\n]{0,200}") {
        let _ = TagList::read(&text);
        let list = TagList::read(&format!("Tag,Unit,Register,Data\n{text}"));
        prop_assert_eq!(TagList::read(&list.to_csv()).problems, []);
    }
}
