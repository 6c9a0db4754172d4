//! The place in the page that the address bar names: `#/device/XV-101/values?q=torque`.

use core::fmt;

use crate::format::{decode, encode};

/// Tabs of a device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Tab {
    /// What the valve does, and whether it is healthy.
    #[default]
    Overview,
    /// All registers.
    Values,
    /// Torque signatures, partial strokes, trends.
    Curves,
    /// Alarms, warnings, connections, events.
    Logs,
    /// What is wrong, the worst first.
    Health,
    /// Who it is.
    Identity,
    /// Counters and channels of its Modbus interface.
    Communication,
    /// All that can be set.
    Configuration,
    /// The frames of this device on its bus.
    Traffic,
}

impl Tab {
    /// All tabs in their order.
    pub const ALL: [Self; 9] = [
        Self::Overview,
        Self::Values,
        Self::Curves,
        Self::Logs,
        Self::Health,
        Self::Identity,
        Self::Communication,
        Self::Configuration,
        Self::Traffic,
    ];

    /// True for a tab that a program of its own shows.
    #[must_use]
    pub const fn is_deep(self) -> bool {
        !matches!(self, Self::Overview | Self::Values | Self::Traffic)
    }

    /// The word in the address.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Overview => "overview",
            Self::Values => "values",
            Self::Curves => "curves",
            Self::Logs => "logs",
            Self::Health => "health",
            Self::Identity => "identity",
            Self::Communication => "communication",
            Self::Configuration => "configuration",
            Self::Traffic => "traffic",
        }
    }

    /// The word on the tab.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Overview => "Overview",
            Self::Values => "Values",
            Self::Curves => "Curves",
            Self::Logs => "Logs",
            Self::Health => "Health",
            Self::Identity => "Identity",
            Self::Communication => "Communication",
            Self::Configuration => "Configuration",
            Self::Traffic => "Traffic",
        }
    }

    /// The tab with this [`key`](Self::key), or the first one.
    #[must_use]
    pub fn from_key(key: &str) -> Self {
        Self::ALL
            .into_iter()
            .find(|t| t.key() == key)
            .unwrap_or_default()
    }
}

/// One screen.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Screen {
    /// Bytes to meaning, offline.
    #[default]
    Decode,
    /// All devices.
    Devices,
    /// One device, by its tag, and the word of the open tab. Which tabs there are depends on the
    /// device, so any word is kept.
    Device(String, String),
    /// Diagnostic objects, offline, and the word of the open tab.
    Dop(String),
    /// Saved devices, and the word of the open tab.
    Snapshots(String),
    /// DDC-100 networks: the rest of the address, as it stands there. The program that shows them
    /// takes it apart; empty for the offline side.
    Network(String),
    /// The frames on a bus; the first one if none is named.
    Traffic(Option<String>),
    /// Settings, sources, help.
    Settings,
}

/// A screen with its settings, as the address bar has it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Route {
    /// Which screen.
    pub screen: Screen,
    /// What is set on it, in the order of the address.
    pub query: Vec<(String, String)>,
}

impl Screen {
    /// The first tab of a device.
    #[must_use]
    pub fn device(tag: &str) -> Self {
        Self::Device(tag.to_owned(), String::new())
    }
}

impl Route {
    /// A screen with nothing set.
    #[must_use]
    pub const fn to(screen: Screen) -> Self {
        Self {
            screen,
            query: Vec::new(),
        }
    }

    /// Reads the part of an address from `#` on. What is not known leads to the first screen.
    #[must_use]
    pub fn parse(hash: &str) -> Self {
        let hash = hash.trim_start_matches('#').trim_start_matches('/');
        let (path, query) = hash.split_once('?').unwrap_or((hash, ""));
        let mut parts = path.split('/').map(decode);
        let first = parts.next().unwrap_or_default();
        let second = parts.next().filter(|s| !s.is_empty());
        let third = parts.next().unwrap_or_default();
        let screen = match (first.as_str(), second) {
            ("devices", _) | ("device", None) => Screen::Devices,
            ("device", Some(tag)) => Screen::Device(tag, third),
            ("dop", tab) => Screen::Dop(tab.unwrap_or_default()),
            ("snapshots", tab) => Screen::Snapshots(tab.unwrap_or_default()),
            ("network", _) => {
                Screen::Network(path.split_once('/').map_or("", |(_, rest)| rest).to_owned())
            }
            ("traffic", bus) => Screen::Traffic(bus),
            ("settings", _) => Screen::Settings,
            _ => Screen::Decode,
        };
        let query = query
            .split('&')
            .filter_map(|pair| pair.split_once('='))
            .map(|(key, value)| (decode(key), decode(value)))
            .collect();
        Self { screen, query }
    }

    /// A setting, if it is there.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&str> {
        let (_, value) = self.query.iter().find(|(k, _)| k == key)?;
        Some(value)
    }

    /// The same route with a setting changed; an empty one is left out.
    #[must_use]
    pub fn with(mut self, key: &str, value: &str) -> Self {
        self.query.retain(|(k, _)| k != key);
        if !value.is_empty() {
            self.query.push((key.to_owned(), value.to_owned()));
        }
        self
    }

    /// True for screens that show what a backend sends.
    #[must_use]
    pub const fn is_live(&self) -> bool {
        matches!(
            self.screen,
            Screen::Devices | Screen::Device(..) | Screen::Traffic(_)
        )
    }
}

impl fmt::Display for Route {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.screen {
            Screen::Decode => f.write_str("#/decode")?,
            Screen::Devices => f.write_str("#/devices")?,
            Screen::Device(tag, tab) => {
                write!(f, "#/device/{}", encode(tag))?;
                if !tab.is_empty() {
                    write!(f, "/{}", encode(tab))?;
                }
            }
            Screen::Dop(tab) if tab.is_empty() => f.write_str("#/dop")?,
            Screen::Dop(tab) => write!(f, "#/dop/{}", encode(tab))?,
            Screen::Snapshots(tab) if tab.is_empty() => f.write_str("#/snapshots")?,
            Screen::Snapshots(tab) => write!(f, "#/snapshots/{}", encode(tab))?,
            Screen::Network(rest) if rest.is_empty() => f.write_str("#/network")?,
            Screen::Network(rest) => write!(f, "#/network/{rest}")?,
            Screen::Traffic(None) => f.write_str("#/traffic")?,
            Screen::Traffic(Some(bus)) => write!(f, "#/traffic/{}", encode(bus))?,
            Screen::Settings => f.write_str("#/settings")?,
        }
        for (at, (key, value)) in self.query.iter().enumerate() {
            let lead = if at == 0 { '?' } else { '&' };
            write!(f, "{lead}{}={}", encode(key), encode(value))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_come_back() {
        for text in [
            "#/decode",
            "#/devices",
            "#/device/XV-101/values?q=torque%20limit&table=holding",
            "#/device/a%2Fb/overview",
            "#/device/MX-301/objects?object=401",
            "#/device/MX-301",
            "#/dop",
            "#/dop/profile?q=1",
            "#/snapshots",
            "#/snapshots/logs?of=1",
            "#/network",
            "#/network/Loop%201/tags?sort=-age",
            "#/traffic",
            "#/traffic/bus%201",
            "#/settings",
        ] {
            assert_eq!(Route::parse(text).to_string(), text);
        }
    }

    #[test]
    fn anything_else_is_the_first_screen() {
        for text in ["", "#", "#/", "#/nowhere/at/all"] {
            assert_eq!(Route::parse(text).screen, Screen::Decode, "{text}");
        }
        assert_eq!(Route::parse("#/device").screen, Screen::Devices);
        assert_eq!(Tab::from_key("nonsense"), Tab::Overview);
    }

    #[test]
    fn settings_replace_and_vanish() {
        let route = Route::to(Screen::Devices).with("q", "a").with("q", "b");
        assert_eq!(route.get("q"), Some("b"));
        assert_eq!(route.with("q", "").to_string(), "#/devices");
    }
}
