//! The file as it is written, with the places of its values.

use serde::Deserialize;
use toml::Spanned;

/// `valvescope.toml`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    #[serde(default)]
    pub server: Server,
    #[serde(default)]
    pub bus: Vec<Spanned<Bus>>,
    #[serde(default)]
    pub device: Vec<Spanned<Device>>,
}

/// `[server]`.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Server {
    pub listen: Option<Spanned<String>>,
    #[serde(default)]
    pub hosts: Vec<Spanned<String>>,
}

/// `[[bus]]`. Which keys belong to which kind is checked later, so that the message can say it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Bus {
    pub name: Spanned<String>,
    pub kind: Spanned<String>,
    pub port: Option<Spanned<String>>,
    pub baud: Option<Spanned<i64>>,
    pub mode: Option<Spanned<String>>,
    pub host: Option<Spanned<String>>,
    pub timeout_ms: Option<Spanned<i64>>,
    pub retries: Option<Spanned<i64>>,
    pub retry_faulty: Option<Spanned<bool>>,
    pub turnaround_ms: Option<Spanned<i64>>,
    pub port2: Option<Spanned<String>>,
    pub shape: Option<Spanned<String>>,
    pub framing: Option<Spanned<String>>,
    pub registers: Option<Spanned<String>>,
    pub turn_ms: Option<Spanned<i64>>,
    pub faults: Option<Vec<Spanned<String>>>,
    pub master: Option<Spanned<String>>,
    pub transport: Option<Spanned<String>>,
    pub preambles: Option<Spanned<i64>>,
    pub gap_ms: Option<Spanned<i64>>,
    pub rts_lead_ms: Option<Spanned<i64>>,
    pub rts_tail_ms: Option<Spanned<i64>>,
    pub tags: Option<Spanned<String>>,
}

/// `[[device]]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Device {
    pub tag: Spanned<String>,
    pub kind: Spanned<String>,
    pub bus: Spanned<String>,
    pub unit: Option<Spanned<i64>>,
    pub poll: Option<Spanned<i64>>,
    pub address: Option<Spanned<String>>,
    pub hart_tag: Option<Spanned<String>>,
    pub long_tag: Option<Spanned<String>>,
    pub profile: Option<Spanned<String>>,
    pub faults: Option<Vec<Spanned<String>>>,
    pub description: Option<Spanned<String>>,
}
