//! Every usual writing gives the same bytes.

use super::*;

/// The request of Modbus over Serial Line, as eight bytes.
const FRAME: [u8; 8] = [0x01, 0x03, 0x00, 0x6B, 0x00, 0x03, 0x74, 0x17];

fn check(text: &str) {
    let (bytes, problems) = read_hex(text.as_bytes());
    assert_eq!(bytes, FRAME, "{text}");
    assert_eq!(problems, [], "{text}");
}

#[test]
fn usual_writings() {
    check("01 03 00 6B 00 03 74 17");
    check("0103006b00037417");
    check("0103 006B 0003 7417");
    check("01,03,00,6B,00,03,74,17");
    check("01;03;00;6b;00;03;74;17\r\n");
    check("0x01, 0x03, 0x00, 0x6B,\n0x00, 0x03, 0x74, 0x17");
    check("0x1, 0x3, 0x0, 0x6B, 0x0, 0x3, 0x74, 0x17");
    check("0x0103 0x006B 0x0003 0x7417");
    check("01h 03h 00h 6Bh 00h 03h 74h 17h");
    check("$01 $03 $00 $6B $00 $03 $74 $17");
    check(r"\x01\x03\x00\x6b\x00\x03\x74\x17");
    check("01-03-00-6B-00-03-74-17");
    check("01:03:00:6B:00:03:74:17");
    check("[01][03][00][6B][00][03][74][17]");
    check("<01><03><00><6B><00><03><74><17>");
    check("1 3 0 6B 0 3 74 17");
}

#[test]
fn writings_of_programs() {
    check("const unsigned char frame[8] = {0x01, 0x03, 0x00, 0x6B, 0x00, 0x03, 0x74, 0x17};");
    check(
        "uint8_t f[] = { /* read 3 */\n 0x01, 0x03, // unit 1\n 0x00, 0x6B, 0x00, 0x03, 0x74, 0x17 };",
    );
    check("12:00:01.250 TX: 01 03 00 6B 00 03 74 17");
    check("2026-11-22 12:00:01 Tx 01 03 00 6B 00 03 74 17");
    check("Request: 01 03 00 6B\n00 03 74 17");
    check("00000000  01 03 00 6b 00 03 74 17                           |...k..t.|\n00000008");
    check("00000000: 0103 006b 0003 7417                      ...k..t.\n");
    check("0000: 01 03 00 6B\n0004: 00 03 74 17\n");
}

#[test]
fn mistakes_are_said_and_the_rest_is_read() {
    let (bytes, problems) = read_hex(b"01 03 00 6B\n00 03 741");
    assert_eq!(bytes, FRAME[..7]);
    let odd = TextProblem {
        finding: Finding::OddDigits,
        line: 2,
        column: 9,
        offset: 7,
    };
    assert_eq!(problems, [odd]);

    let (bytes, problems) = read_hex(b"01 03 00 6B 0 03 74 17");
    assert_eq!(bytes, FRAME);
    assert_eq!(problems[0].finding, Finding::LoneDigit);

    let (bytes, problems) = read_hex(b"01 03 hello 00 6B world 00 03 74 17");
    assert_eq!(bytes, FRAME);
    let words = TextProblem {
        finding: Finding::NotHex { words: 2 },
        line: 1,
        column: 7,
        offset: 2,
    };
    assert_eq!(problems, [words]);

    let (bytes, problems) = read_hex(b"This is no frame.");
    assert!(bytes.is_empty());
    assert_eq!(problems[0].finding, Finding::NotHex { words: 4 });
}

#[test]
fn long_lines_are_read_in_pieces() {
    let long = "0103".repeat(100_000);
    let (bytes, problems) = read_hex(long.as_bytes());
    assert_eq!(bytes.len(), 200_000);
    assert!(bytes.chunks(2).all(|c| c == [1, 3]));
    assert_eq!(problems, []);
}

#[test]
fn pieces_do_not_matter() {
    let text = b"TX: 01 03 00 6B\n/* two\nlines */ 00 03 74 17 zz";
    let whole = read_hex(text);
    for size in 1..text.len() {
        let (mut out, mut problems) = (Vec::new(), Vec::new());
        let mut reader = HexReader::new();
        for piece in text.chunks(size) {
            reader.push(piece, &mut out, &mut problems);
        }
        reader.finish(&mut out, &mut problems);
        assert_eq!((out, problems), whole, "pieces of {size}");
    }
}

#[test]
fn forms() {
    assert_eq!(form(b"01 03 00 6B"), Form::Hex);
    assert_eq!(form(b"\n  :0103006B000391\r\n"), Form::AsciiLines);
    assert_eq!(form(&FRAME), Form::Binary);
    assert_eq!(form(b"12:00:01 01 03"), Form::Hex);
    assert_eq!(form(b"01:03:00:6B"), Form::Hex);
    assert_eq!(form(b""), Form::Hex);
}
