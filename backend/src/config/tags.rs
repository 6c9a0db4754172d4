//! The tag list of a DDC-100 network: a file beside the configuration that names its units.

use super::check::{Wrong, wrong};
use super::{Config, DeviceConfig};
use shared::ddc100::scaling::Scaling;
use shared::ddc100::tags::TagList;
use shared::ddc100::words::POSITION;
use std::collections::BTreeMap;
use std::path::Path;
use toml::Spanned;

/// Larger files are no tag lists.
const MAX_BYTES: u64 = 4 * 1024 * 1024;
/// Mistakes that are named at once.
const SHOWN: usize = 5;

/// What a list says of a network.
pub(super) struct Named {
    /// The units, in the order in which they come up.
    pub units: Vec<DeviceConfig>,
    /// How their analog values are scaled, where it says so.
    pub scalings: BTreeMap<u8, Scaling>,
}

/// What the list of a bus says.
pub(super) fn read(
    name: &Spanned<String>,
    beside: &Path,
    bus: usize,
    config: &Config,
) -> Result<Named, Wrong> {
    let path = beside.join(name.get_ref());
    let shown = path.display();
    let refuse = |text: String| wrong(name, format!("`tags`: {text}"));
    let text = match std::fs::metadata(&path).map(|m| m.len()) {
        Ok(size) if size > MAX_BYTES => {
            return refuse(format!("{shown} is too large for a tag list"));
        }
        _ => match std::fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) => return refuse(format!("can't read {shown}: {error}")),
        },
    };
    let list = TagList::read(&text);
    if !list.problems.is_empty() {
        let mut lines: Vec<String> = list
            .problems
            .iter()
            .take(SHOWN)
            .map(|problem| problem.to_string().replacen("Line", "line", 1))
            .collect();
        if let Some(more @ 1..) = list.problems.len().checked_sub(SHOWN) {
            lines.push(format!("and {more} more"));
        }
        return refuse(format!("{shown}, {}", lines.join("; ")));
    }
    let mut found: Vec<DeviceConfig> = Vec::new();
    let mut scalings = BTreeMap::new();
    for tag in &list.tags {
        if found.iter().any(|d| d.unit == tag.unit) {
            continue;
        }
        let unit = tag.unit;
        let Some(device) = list.kind(unit) else {
            return refuse(format!(
                "{shown} does not say what unit {unit} is; write its type, as ddc100-mx or \
                 ddc100-uec, into a line of it"
            ));
        };
        // The line without a register names the unit itself.
        let named = list.of_unit(unit).unwrap_or(tag);
        let others = config.devices.iter().chain(&found);
        if let Some(other) = others.into_iter().find(|d| d.tag == named.tag) {
            return refuse(format!(
                "{shown} calls unit {unit} \"{}\", as another device (unit {}) is called already; \
                 tags must differ",
                named.tag, other.unit
            ));
        }
        // A unit has one scaling for all (note 2 of table 3.5); the line of its position knows best.
        let of_unit = || list.tags.iter().filter(|t| t.unit == unit);
        let scaling = list.scaling(unit, POSITION);
        if let Some(scaling) = scaling.or_else(|| of_unit().find_map(|t| t.scaling)) {
            scalings.insert(unit, scaling);
        }
        found.push(DeviceConfig {
            tag: named.tag.clone(),
            device,
            bus,
            unit,
            description: named.description.clone(),
            faults: Vec::new(),
            profile: None,
            target: None,
        });
    }
    if found.is_empty() {
        return refuse(format!("{shown} names no unit"));
    }
    Ok(Named {
        units: found,
        scalings,
    })
}
