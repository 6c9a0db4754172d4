//! Under which names this program may be opened, and from which pages.

use axum::http::HeaderMap;
use axum::http::header::{HOST, HeaderName, ORIGIN};
use std::net::{IpAddr, SocketAddr};

/// The names that are ours.
#[derive(Clone, Debug)]
pub struct Hosts {
    listen: IpAddr,
    names: Vec<String>,
}

const NO_HOST: &str = "The request names no host.\n";
const BAD_HOST: &str = "This is not a name of this computer that Valvescope knows. Open the page \
     by its address, or add the name to `hosts` in valvescope.toml.\n";
const BAD_ORIGIN: &str = "Pages of other origins may not connect.\n";

impl Hosts {
    /// The names for an address that is listened on, besides those of loopback; `names` are those
    /// of the configuration.
    #[must_use]
    pub fn new(listen: SocketAddr, names: &[String]) -> Self {
        Self {
            listen: listen.ip(),
            names: names.iter().map(|n| n.to_ascii_lowercase()).collect(),
        }
    }

    /// Checks who asks.
    ///
    /// A page of another origin is told by `Origin`, a name that an attacker points at this
    /// computer (DNS rebinding) by `Host`. Programs that are no browsers send no `Origin`; they
    /// could send any, so nothing is lost by letting them in.
    ///
    /// # Errors
    /// If the host is not ours or the page is not.
    pub fn admit(&self, headers: &HeaderMap) -> Result<(), &'static str> {
        let host = one(headers, HOST).ok_or(NO_HOST)?;
        if !self.is_ours(host) {
            return Err(BAD_HOST);
        }
        if !headers.contains_key(ORIGIN) {
            return Ok(());
        }
        let origin = one(headers, ORIGIN).ok_or(BAD_ORIGIN)?;
        let same = ["http://", "https://"]
            .iter()
            .filter_map(|scheme| origin.strip_prefix(scheme))
            .any(|rest| rest.eq_ignore_ascii_case(host));
        if same { Ok(()) } else { Err(BAD_ORIGIN) }
    }

    fn is_ours(&self, host: &str) -> bool {
        let name = without_port(host).to_ascii_lowercase();
        if name == "localhost" || self.names.contains(&name) {
            return true;
        }
        let bare = name.strip_prefix('[').and_then(|n| n.strip_suffix(']'));
        let Ok(address) = bare.unwrap_or(&name).parse::<IpAddr>() else {
            return false;
        };
        // An address can't be rebound; where all are listened on, any may be this computer's.
        address.is_loopback() || address == self.listen || self.listen.is_unspecified()
    }
}

/// The value of a header that stands there once.
fn one(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
    let mut values = headers.get_all(name).iter();
    let value = values.next()?.to_str().ok()?;
    values.next().is_none().then_some(value)
}

/// The host without its port: `[::1]:80` is `[::1]`.
fn without_port(host: &str) -> &str {
    match host.rsplit_once(':') {
        Some((name, port)) if !port.ends_with(']') && !name.is_empty() => name,
        _ => host,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::HeaderValue;

    fn admits(listen: &str, host: Option<&str>, origin: Option<&str>) -> bool {
        let names = ["valves.example.org".to_owned()];
        let hosts = Hosts::new(listen.parse().unwrap(), &names);
        let mut headers = HeaderMap::new();
        if let Some(host) = host {
            headers.insert(HOST, HeaderValue::from_str(host).unwrap());
        }
        if let Some(origin) = origin {
            headers.insert(ORIGIN, HeaderValue::from_str(origin).unwrap());
        }
        hosts.admit(&headers).is_ok()
    }

    const LOOPBACK: &str = "127.0.0.1:8080";

    #[test]
    fn our_own_page_is_let_in() {
        for host in [
            "localhost:8080",
            "LOCALHOST:8080",
            "127.0.0.1:8080",
            "127.9.9.9",
            "[::1]:8080",
            "valves.example.org",
            "Valves.Example.org:8443",
        ] {
            for scheme in ["http", "https"] {
                let origin = format!("{scheme}://{host}");
                assert!(admits(LOOPBACK, Some(host), Some(&origin)), "{host}");
            }
            assert!(admits(LOOPBACK, Some(host), None), "{host}");
        }
    }

    #[test]
    fn others_are_not() {
        let host = Some("127.0.0.1:8080");
        for origin in [
            "null",
            "",
            "http://127.0.0.1:8081",
            "http://127.0.0.1",
            "http://evil.example",
            "http://127.0.0.1:8080.evil.example",
            "http://evil.example/127.0.0.1:8080",
            "file://127.0.0.1:8080",
            "http://localhost:8080",
        ] {
            assert!(!admits(LOOPBACK, host, Some(origin)), "{origin}");
        }
    }

    #[test]
    fn names_that_were_pointed_at_us_are_not_ours() {
        for host in [
            "evil.example",
            "evil.example:8080",
            "localhost.evil.example:8080",
            "127.0.0.1.evil.example",
            "192.0.2.7:8080",
            "",
        ] {
            let origin = format!("http://{host}");
            assert!(!admits(LOOPBACK, Some(host), Some(&origin)), "{host}");
        }
        assert!(!admits(LOOPBACK, None, None));
    }

    #[test]
    fn on_all_addresses_any_address_is_ours_but_no_name() {
        assert!(admits(
            "0.0.0.0:80",
            Some("192.0.2.7"),
            Some("http://192.0.2.7")
        ));
        assert!(!admits(
            "0.0.0.0:80",
            Some("evil.example"),
            Some("http://evil.example")
        ));
        assert!(admits("192.0.2.7:80", Some("192.0.2.7:80"), None));
        assert!(!admits("192.0.2.7:80", Some("192.0.2.8:80"), None));
    }

    #[test]
    fn two_origins_are_none() {
        let hosts = Hosts::new(LOOPBACK.parse().unwrap(), &[]);
        let mut headers = HeaderMap::new();
        headers.append(HOST, HeaderValue::from_static("localhost"));
        headers.append(ORIGIN, HeaderValue::from_static("http://localhost"));
        headers.append(ORIGIN, HeaderValue::from_static("http://evil.example"));
        assert!(hosts.admit(&headers).is_err());
    }
}
