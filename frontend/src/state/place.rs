//! Where the page is and what time it is there, as it is told to a program that the page hosts.

use core::fmt::Write as _;

use super::json::{Json, quoted};

/// What a hosted program is told when it opens and whenever something of it changes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Place {
    /// Tag of the device that is shown; `None` for the offline screen.
    pub device: Option<String>,
    /// The open tab as the address has it; empty if it names none.
    pub tab: String,
    /// What is set on the screen, in the order of the address.
    pub query: Vec<(String, String)>,
    /// True while the backend is connected.
    pub online: bool,
    /// Microseconds of the backend's clock at `at_ms`; 0 if it never told.
    pub now_us: u64,
    /// Milliseconds since 1970 at the moment 0 of the backend's clock.
    pub start_wall_ms: u64,
    /// The page's own milliseconds (`performance.now()`) when this was said.
    pub at_ms: u64,
    /// Minutes that local time is ahead of UTC.
    pub offset_minutes: i32,
}

impl Place {
    /// Reads what [`to_json`](Self::to_json) wrote; `None` if page and program are not of the same
    /// build.
    #[must_use]
    pub fn from_json(text: &str) -> Option<Self> {
        let json = Json::parse(text)?;
        let number = |name: &str| json.get(name)?.number();
        let pair = |pair: &Json<'_>| match pair.list()? {
            [key, value] => Some((key.text()?.to_owned(), value.text()?.to_owned())),
            _ => None,
        };
        let query = json.get("query")?.list()?.iter().map(pair);
        Some(Self {
            device: json.get("device")?.text().map(str::to_owned),
            tab: json.get("tab")?.text()?.to_owned(),
            query: query.collect::<Option<_>>()?,
            online: *json.get("online")? == Json::Bool(true),
            now_us: number("now_us")?,
            start_wall_ms: number("start_wall_ms")?,
            at_ms: number("at_ms")?,
            offset_minutes: i32::try_from(json.get("offset_minutes")?.signed()?).ok()?,
        })
    }

    /// As JSON.
    #[must_use]
    pub fn to_json(&self) -> String {
        let mut out = String::from("{\"device\":");
        match &self.device {
            Some(tag) => quoted(&mut out, tag),
            None => out.push_str("null"),
        }
        out.push_str(",\"tab\":");
        quoted(&mut out, &self.tab);
        out.push_str(",\"query\":[");
        for (at, (key, value)) in self.query.iter().enumerate() {
            out.push_str(if at == 0 { "[" } else { ",[" });
            quoted(&mut out, key);
            out.push(',');
            quoted(&mut out, value);
            out.push(']');
        }
        // Writing to a string does not fail.
        let _infallible = write!(
            out,
            "],\"online\":{},\"now_us\":{},\"start_wall_ms\":{},\"at_ms\":{},\"offset_minutes\":{}}}",
            self.online, self.now_us, self.start_wall_ms, self.at_ms, self.offset_minutes
        );
        out
    }

    /// A setting, if it is there.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&str> {
        let (_, value) = self.query.iter().find(|(k, _)| k == key)?;
        Some(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_said_is_understood() {
        let mut place = Place {
            device: Some("MX \"301\"\n\\é".into()),
            tab: "objects".into(),
            query: vec![("q".into(), "a b".into()), ("x".into(), String::new())],
            online: true,
            now_us: 9_007_199_254_740_993,
            start_wall_ms: 1_700_000_000_000,
            at_ms: 12,
            offset_minutes: -330,
        };
        let json: serde_json::Value = serde_json::from_str(&place.to_json()).unwrap();
        assert_eq!(json["device"], "MX \"301\"\n\\é");
        assert_eq!(json["query"][0][1], "a b");
        assert_eq!(json["offset_minutes"], -330);
        assert_eq!(Place::from_json(&place.to_json()).unwrap(), place);
        place = Place::default();
        assert_eq!(Place::from_json(&place.to_json()).unwrap(), place);
        assert_eq!(Place::from_json("{}"), None);
    }

    #[test]
    fn settings_are_found() {
        let place = Place {
            query: vec![("object".into(), "401".into())],
            ..Place::default()
        };
        assert_eq!(place.get("object"), Some("401"));
        assert_eq!(place.get("option"), None);
    }
}
