//! Reads kept for later, in a file or in the browser: registers, not meanings, so that a file stays
//! right when a setting changes.
//!
//! ```json
//! {"format":"valvescope-dop-reads","version":1,"device":"MX-301","reads":[
//!  {"request":"0x1001","read_ms":1765000000000,"registers":"0002…"}]}
//! ```

use shared::dop::Request;

use super::kept::{Kept, hex_of, words_of};
use crate::state::json::{Json, quoted};

const FORMAT: &str = "valvescope-dop-reads";
const VERSION: u64 = 1;

/// Reads of a device.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Saved {
    /// Tag of the device.
    pub device: String,
    /// Its objects.
    pub reads: Vec<Kept>,
}

impl Saved {
    /// The read of a request.
    #[must_use]
    pub fn get(&self, request: Request) -> Option<&Kept> {
        self.reads.iter().find(|kept| kept.request == request)
    }

    /// The file.
    #[must_use]
    pub fn to_json(&self) -> String {
        let mut out =
            format!("{{\n  \"format\": \"{FORMAT}\",\n  \"version\": {VERSION},\n  \"device\": ");
        quoted(&mut out, &self.device);
        out.push_str(",\n  \"reads\": [");
        for (at, kept) in self.reads.iter().enumerate() {
            out.push_str(if at == 0 { "\n    {" } else { ",\n    {" });
            out.push_str(&format!("\"request\": \"{}\", \"read_ms\": ", kept.request));
            match kept.wall_ms {
                Some(wall) => out.push_str(&wall.to_string()),
                None => out.push_str("null"),
            }
            if kept.error {
                out.push_str(", \"error\": true");
            }
            out.push_str(&format!(", \"registers\": \"{}\"}}", hex_of(&kept.words)));
        }
        out.push_str("\n  ]\n}\n");
        out
    }

    /// Reads a file.
    ///
    /// # Errors
    ///
    /// What is wrong with it, in words.
    pub fn from_json(text: &str) -> Result<Self, String> {
        let json = Json::parse(text).ok_or("This is no file of saved reads: it is no JSON.")?;
        let format = json.get("format").and_then(Json::text);
        let version = json.get("version").and_then(Json::number);
        let list = json.get("reads").and_then(Json::list);
        let (Some(FORMAT), Some(VERSION), Some(list)) = (format, version, list) else {
            return Err(format!(
                "This is no file of saved reads: format and version must be \"{FORMAT}\" and \
                 {VERSION}, and reads a list."
            ));
        };
        let device = json.get("device").and_then(Json::text).unwrap_or_default();
        Ok(Self {
            reads: list.iter().map(entry).collect::<Result<_, String>>()?,
            device: device.to_owned(),
        })
    }
}

/// One read of a file.
fn entry(json: &Json<'_>) -> Result<Kept, String> {
    let request = json.get("request").and_then(Json::text).unwrap_or_default();
    let digits = request.strip_prefix("0x").unwrap_or(request);
    let word = u16::from_str_radix(digits, 16)
        .map_err(|_| format!("The request \"{request}\" is no word such as 0x1001."))?;
    let registers = json
        .get("registers")
        .and_then(Json::text)
        .unwrap_or_default();
    let words = words_of(registers).ok_or_else(|| {
        format!("The registers of {request} are not four hexadecimal digits each.")
    })?;
    let mut kept = Kept::new(Request::from_word(word), words, "saved file");
    kept.error = matches!(json.get("error"), Some(Json::Bool(true)));
    kept.wall_ms = json.get("read_ms").and_then(Json::number);
    Ok(kept)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_saved_is_read_again() {
        let mut first = Kept::new(Request::from_word(0x1001), vec![2, 0x9ECB], "saved file");
        first.wall_ms = Some(1_765_000_000_000);
        let mut second = Kept::new(Request::from_word(1005), vec![3], "saved file");
        second.error = true;
        let saved = Saved {
            device: "MX-301".into(),
            reads: vec![first, second],
        };
        let text = saved.to_json();
        assert!(text.contains("\"request\": \"0x1001\"") && text.contains("\"00029ECB\""));
        assert_eq!(Saved::from_json(&text), Ok(saved.clone()));
        assert!(saved.get(Request::from_word(1005)).is_some());
    }

    #[test]
    fn other_files_are_refused_in_words() {
        for (text, part) in [
            ("x", "no file of saved reads"),
            (
                r#"{"format":"a","version":1,"reads":[]}"#,
                "format and version",
            ),
            (
                r#"{"format":"valvescope-dop-reads","version":1,"reads":[{"request":"0x1","registers":"12"}]}"#,
                "four hexadecimal digits",
            ),
            (
                r#"{"format":"valvescope-dop-reads","version":1,"reads":[{"request":"z","registers":""}]}"#,
                "no word such as",
            ),
        ] {
            let error = Saved::from_json(text).unwrap_err();
            assert!(error.contains(part), "{error}");
        }
    }
}
