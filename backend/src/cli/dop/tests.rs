use super::*;
use clap::Parser;

/// The arguments as a shell gives them.
#[derive(Debug, Parser)]
struct Line {
    #[command(flatten)]
    args: Args,
}

/// Decodes a text; what was printed, and whether nothing is wrong.
fn decoded(text: &str, line: &[&str]) -> (String, bool) {
    let line = Line::parse_from([&["dop"], line].concat());
    let profile = Profile::default();
    let mut out = String::new();
    let sound = decode(&line.args, text, &profile, false, &mut out).unwrap();
    (out, sound)
}

fn json(text: &str, line: &[&str]) -> (Vec<serde_json::Value>, bool) {
    let (out, sound) = decoded(text, &[&["--format", "json"], line].concat());
    let lines = out.lines().map(|l| serde_json::from_str(l).unwrap());
    (lines.collect(), sound)
}

/// Object 1007: 2021-02-12T15:29:15Z, 3.012 V, the clock was set.
const CLOCK: &str = "9ECB 6026 0000 0000 0BC4 0002";

#[test]
fn a_request_decodes() {
    let (lines, sound) = json(CLOCK, &["--request", "0x03EF"]);
    assert!(sound);
    assert_eq!(lines.len(), 1);
    let object = &lines[0];
    assert_eq!(
        (&object["kind"], &object["request"]),
        (&"object".into(), &"0x03EF".into())
    );
    assert_eq!(
        (&object["object"], &object["option"]),
        (&1007.into(), &0.into())
    );
    assert_eq!(
        (&object["words"], &object["layout"]),
        (&6.into(), &"clock".into())
    );
    assert_eq!(object["problems"], serde_json::json!([]));
    assert_eq!(
        object["assumed"],
        serde_json::json!(["words.low_word_first", "time.epoch", "time.unit"])
    );
    assert_eq!(object["readings"][0]["id"], "A10");
    let field = &object["fields"][0];
    assert_eq!(field["path"], "dop.1007.now");
    assert_eq!(field["value"], "2021-02-12T15:29:15Z");
    assert_eq!(field["raw"], "9ECB602600000000");
    assert_eq!((&field["offset"], &field["length"]), (&0.into(), &8.into()));
    assert_eq!(object["fields"][1]["value"], 3.012);
    let bits = object["fields"].as_array().unwrap();
    let set = bits
        .iter()
        .find(|f| f["path"] == "dop.1007.indicators.clock_set");
    assert_eq!(set.unwrap()["value"], true);
}

#[test]
fn text_says_what_is_assumed() {
    let (text, sound) = decoded(CLOCK, &["--request", "1007"]);
    assert!(sound);
    let expected = "0x03EF  object 1007, option 0  Real-time clock\n";
    assert!(text.contains(expected), "{text}");
    assert!(
        text.contains("assumed, not in a profile: words.low_word_first, time.epoch, time.unit"),
        "{text}"
    );
    assert!(text.contains("  reading A10: "), "{text}");
    assert!(text.contains("    0  9ECB 6026 0000 0000    Date and time                                   2021-02-12 15:29:15 UTC  [C16]\n"), "{text}");
}

#[test]
fn one_candidate_is_enough() {
    let (lines, sound) = json(CLOCK, &[]);
    assert!(sound);
    assert_eq!(lines.len(), 2);
    assert_eq!(lines[0]["candidates"].as_array().unwrap().len(), 1);
    assert_eq!(lines[1]["request"], "0x03EF");
}

#[test]
fn several_candidates_are_listed_and_none_is_taken() {
    let zeros = "0000 ".repeat(26);
    let (lines, sound) = json(&zeros, &[]);
    assert!(!sound);
    assert_eq!(lines.len(), 1);
    let requests: Vec<&str> = lines[0]["candidates"]
        .as_array()
        .unwrap()
        .iter()
        .map(|c| c["request"].as_str().unwrap())
        .collect();
    // Objects 207 and 209 have 26 registers each.
    assert_eq!(requests, ["0x00CF", "0x00D1"]);
    assert_eq!(lines[0]["raw"].as_str().unwrap().len(), 26 * 4);
    let (text, _) = decoded(&zeros, &[]);
    assert!(text.ends_with("Choose one with --request.\n"), "{text}");
    let (text, sound) = decoded("0000 0000", &[]);
    assert!(
        !sound && text.contains("No object has 2 registers."),
        "{text}"
    );
}

#[test]
fn errors_of_the_unit_are_told() {
    let (lines, sound) = json("3", &["--request", "0x10CD"]);
    // The answer is sound: it says that the request was not.
    assert!(sound);
    assert_eq!(lines[0]["error"], 3);
    assert_eq!(lines[0]["problems"][0]["code"], "dop-error");
    let (text, _) = decoded("11 0", &["--request", "0x0191", "--error"]);
    assert!(
        text.contains("error 11: DOP board response timeout"),
        "{text}"
    );
}

#[test]
fn what_does_not_fit_is_an_error() {
    assert!(!json("9ECB 6026", &["--request", "0x03EF"]).1);
    assert!(!json("0001 0002", &["--request", "0x07FF"]).1);
    let (lines, sound) = json("9ECB 6026 zz 0000 0000 0BC4 0002", &["--request", "0x03EF"]);
    assert!(!sound);
    assert_eq!(
        (&lines[0]["kind"], &lines[0]["column"]),
        (&"input".into(), &11.into())
    );
    assert_eq!(lines[1]["words"], 6);
    assert!(!json("", &["--request", "0x03EF"]).1);
}

#[test]
fn request_words_are_hexadecimal_or_decimal() {
    let word = |text| request(text).map(Request::word);
    assert_eq!(word("0x1001"), Ok(0x1001));
    assert_eq!(word("0X04b2"), Ok(0x04B2));
    assert_eq!(word("1202"), Ok(1202));
    assert!(word("1001h").is_err() && word("0x10000").is_err() && word("").is_err());
}

#[test]
fn the_writing_can_be_chosen() {
    let (text, _) = decoded("1234 5678", &["--as", "decimal"]);
    assert!(
        text.starts_with("Read as decimal registers (as chosen). 2 registers.\n"),
        "{text}"
    );
}

/// Every mistake of a profile is told with its file, line and key.
#[test]
fn a_profile_with_mistakes_is_refused() {
    let path = std::env::temp_dir().join(format!("valvescope-dop-{}.json", std::process::id()));
    fs::write(&path, "{\n\"temperature\": \"C\",\n\"wrods\": {}}").unwrap();
    let told = profile(&path).unwrap_err();
    fs::write(&path, "{\"temperature\": \"degF\"}").unwrap();
    let sound = profile(&path);
    fs::remove_file(&path).unwrap();
    let name = path.display();
    assert!(
        told.contains(&format!("{name}: line 2: temperature: ")),
        "{told}"
    );
    assert!(told.contains(&format!("{name}: line 3: wrods: ")), "{told}");
    assert!(sound.is_ok());
    assert!(profile(&path).unwrap_err().contains("can't read"));
}
