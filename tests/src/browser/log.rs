//! What the logs of the driver mean.

use serde_json::Value;
use url::{Host, Url};

/// One line of the console.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConsoleLine {
    /// `SEVERE`, `WARNING`, `INFO` or `DEBUG`.
    pub level: String,
    /// Place and text.
    pub message: String,
}

impl ConsoleLine {
    /// True for errors: exceptions, failed loads, refused by policy, `console.error`.
    #[must_use]
    pub fn is_error(&self) -> bool {
        self.level == "SEVERE"
    }
}

/// Reads the log `browser`.
pub(super) fn console(entries: &[Value]) -> Vec<ConsoleLine> {
    let text = |entry: &Value, key: &str| entry[key].as_str().unwrap_or_default().to_owned();
    entries
        .iter()
        .map(|e| ConsoleLine {
            level: text(e, "level"),
            message: text(e, "message"),
        })
        .collect()
}

/// Reads the URLs of requests in the log `performance`, whose messages are DevTools events.
pub(super) fn requests(entries: &[Value]) -> Vec<String> {
    let url = |entry: &Value| {
        let event: Value = serde_json::from_str(entry["message"].as_str()?).ok()?;
        let event = &event["message"];
        let url = match event["method"].as_str()? {
            "Network.requestWillBeSent" => &event["params"]["request"]["url"],
            "Network.webSocketCreated" => &event["params"]["url"],
            _ => return None,
        };
        Some(url.as_str()?.to_owned())
    };
    entries.iter().filter_map(url).collect()
}

/// True when a request for this URL would leave the machine.
#[must_use]
pub fn leaves_loopback(url: &str) -> bool {
    let Ok(url) = Url::parse(url) else {
        return true;
    };
    match (url.scheme(), url.host()) {
        ("data" | "blob" | "file" | "about" | "chrome", _) => false,
        (_, Some(Host::Ipv4(ip))) => !ip.is_loopback(),
        (_, Some(Host::Ipv6(ip))) => !ip.is_loopback(),
        (_, Some(Host::Domain(name))) => name != "localhost",
        (_, None) => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn loopback_is_told_from_the_rest() {
        for url in [
            "http://127.0.0.1:1/a",
            "ws://localhost:2/ws",
            "http://[::1]/",
            "data:,x",
            "blob:null/1",
        ] {
            assert!(!leaves_loopback(url), "{url}");
        }
        for url in [
            "https://example.org/",
            "http://10.0.0.1/",
            "ws://localhost.example.org/",
            "nonsense",
        ] {
            assert!(leaves_loopback(url), "{url}");
        }
    }

    #[test]
    fn requests_and_sockets_are_found() {
        let event = |method: &str, params: Value| json!({ "message": json!({ "message": { "method": method, "params": params } }).to_string() });
        let entries = [
            event(
                "Network.requestWillBeSent",
                json!({ "request": { "url": "http://a/" } }),
            ),
            event("Network.dataReceived", json!({})),
            event("Network.webSocketCreated", json!({ "url": "ws://b/" })),
        ];
        assert_eq!(requests(&entries), ["http://a/", "ws://b/"]);
    }
}
