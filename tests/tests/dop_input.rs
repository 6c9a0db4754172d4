//! Pasted registers: what a text is taken for, and what in it is told.

use shared::dop::input::{Form, Input, read};

fn auto(text: &str) -> Input {
    read(text, None)
}

/// Read as this form, to these registers, without a problem.
fn check(text: &str, form: Form, words: &[u16]) {
    let input = auto(text);
    assert_eq!(
        (input.form, input.words.as_slice()),
        (form, words),
        "{}\n{text}",
        input.said
    );
    assert_eq!(input.problems, [], "{text}");
    assert!(input.said.contains(form.label()) || form == Form::Table || form == Form::Frames);
}

#[test]
fn hexadecimal_is_told_by_its_writing() {
    check("0x0018 0x12 0XfFfF", Form::Hex, &[0x18, 0x12, 0xFFFF]);
    check("0018h, 12h; $FFFF", Form::Hex, &[0x18, 0x12, 0xFFFF]);
    check("0018 0012 FFFF", Form::Hex, &[0x18, 0x12, 0xFFFF]);
    // Four digits everywhere, although all are decimal ones.
    check("1234 5678", Form::Hex, &[0x1234, 0x5678]);
    // A letter decides for all.
    check("0 12 A0 7", Form::Hex, &[0, 0x12, 0xA0, 7]);
    check("00180012FFFF", Form::Hex, &[0x18, 0x12, 0xFFFF]);
    check("{ 0x3492, 0x4501 } // turns", Form::Hex, &[0x3492, 0x4501]);
    check(
        "# response\n9ECB 6026\n0001 0000",
        Form::Hex,
        &[0x9ECB, 0x6026, 1, 0],
    );
}

#[test]
fn decimal_is_told_by_its_digits() {
    check("24 18 65535", Form::Decimal, &[24, 18, 65_535]);
    check("0, -1, -32768", Form::Decimal, &[0, 0xFFFF, 0x8000]);
    check("7", Form::Decimal, &[7]);
    check("[1]: \t24\n[2]: \t65535 (-1)", Form::Decimal, &[24, 65_535]);
    check("40001: 24\n40002: 300", Form::Decimal, &[24, 300]);
    check("R1 = 24\nR2 = 300", Form::Decimal, &[24, 300]);
}

#[test]
fn bytes_are_pairs_of_digits() {
    check("00 18 FF fe", Form::Bytes, &[0x0018, 0xFFFE]);
    // The fifth byte has no partner.
    let input = auto("0018FFFE01");
    assert_eq!(
        (input.form, input.words),
        (Form::Bytes, vec![0x0018, 0xFFFE])
    );
    assert_eq!(input.problems.len(), 1);
}

#[test]
fn tables_have_a_column_of_values() {
    check(
        "address,value\n40001,24\n40002,65535\n",
        Form::Table,
        &[24, 65_535],
    );
    check("register;hex\n1;0018\n2;00FF\n", Form::Table, &[0x18, 0xFF]);
    check(
        "\"Address\",\"Raw (hex)\",\"Note\"\n1,0010,a\n2,0011,b",
        Form::Table,
        &[0x10, 0x11],
    );
    check("40001\t24\n40002\t-1", Form::Table, &[24, 0xFFFF]);
    check("Value\n24\n300\n", Form::Table, &[24, 300]);
    // Two columns that count nothing are registers.
    check("24, 18\n7, 9", Form::Decimal, &[24, 18, 7, 9]);
}

/// The frames are examples of the Modbus standards with a check value of their own.
#[test]
fn responses_are_taken_with_their_data() {
    // Unit 1, FC 03, four bytes: 0006 0005; CRC DA 31.
    check("01 03 04 00 06 00 05 DA 31", Form::Frames, &[6, 5]);
    check("0103040006 0005DA31", Form::Frames, &[6, 5]);
    // Request and response, twice.
    let pair = "01 03 00 00 00 02 C4 0B 01 03 04 00 06 00 05 DA 31 ";
    check(&pair.repeat(2), Form::Frames, &[6, 5, 6, 5]);
    // The same over TCP.
    check(
        "00 01 00 00 00 07 01 03 04 00 06 00 05",
        Form::Frames,
        &[6, 5],
    );
    // A damaged check value: bytes, whose last has no partner.
    let input = auto("01 03 04 00 06 00 05 DA 30");
    assert_eq!(input.form, Form::Bytes);
    assert_eq!(input.words, [0x0103, 0x0400, 0x0600, 0x05DA]);
    assert_eq!(input.problems.len(), 1);
}

#[test]
fn what_is_no_register_is_told() {
    let told = |text: &str, form| -> Vec<(u32, u32, usize)> {
        let problems = read(text, form).problems;
        problems.iter().map(|p| (p.line, p.column, p.at)).collect()
    };
    assert_eq!(told("0x0018 0x12345\n0xZZ 7", None), [(1, 8, 1), (2, 1, 1)]);
    assert_eq!(told("24 1.5\n70000 3", None), [(1, 4, 1), (2, 1, 1)]);
    assert_eq!(told("address,value\n1,24\n2,x\n3,7", None), [(3, 3, 1)]);
    assert_eq!(told("", None), [(1, 1, 0)]);
    assert_eq!(told("# nothing", None), [(1, 1, 0)]);
    assert_eq!(told("address,value", None), [(1, 1, 0)]);
    assert_eq!(told("1 2", Some(Form::Frames)), []);
    let input = read("0x0018 wort 0x0012", None);
    assert_eq!(input.words, [0x18, 0x12]);
    assert_eq!(
        input.problems[0].text,
        "\"wort\" is no register of up to four hexadecimal digits; it is left out."
    );
}

/// Long texts that are no registers are told in short, and in no time.
#[test]
fn many_mistakes_are_told_in_short() {
    let input = auto(&"zz\n".repeat(100_000));
    assert_eq!(input.problems.len(), 100);
    assert!(input.problems[99].text.ends_with("And 99900 more."));
}

#[test]
fn a_choice_is_kept() {
    assert_eq!(read("1234 5678", Some(Form::Decimal)).words, [1234, 5678]);
    assert_eq!(read("10 20", Some(Form::Hex)).words, [0x10, 0x20]);
    assert_eq!(read("10 20", Some(Form::Decimal)).words, [10, 20]);
    assert_eq!(read("10 20", None).words, [0x1020]);
    assert_eq!(read("1;7\n3;9", Some(Form::Table)).words, [7, 9]);
    for form in Form::ALL {
        assert!(!form.key().is_empty() && !form.label().is_empty());
    }
}
