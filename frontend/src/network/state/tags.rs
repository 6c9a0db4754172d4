//! What the browser knows of units besides the configuration: tags, descriptions and scalings.
//!
//! It lies over what the backend tells, bus by bus, and is kept as text:
//!
//! ```text
//! unit TAB tag TAB description TAB scaling TAB register=scaling …
//! ```

use std::collections::BTreeMap;

use shared::ddc100::scaling::Scaling;

use super::net::Unit;

/// What is known of one unit.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Entry {
    /// Its tag; empty to leave that of the configuration.
    pub tag: String,
    /// Its description; empty to leave that of the configuration.
    pub description: String,
    /// How its analog registers count; `None` if nobody chose.
    pub scaling: Option<Scaling>,
    /// How single ones count, by their numbers, if a tag list says it.
    pub registers: BTreeMap<u16, Scaling>,
}

/// What is known of the units of a bus.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tags {
    units: BTreeMap<u8, Entry>,
}

impl Tags {
    /// Reads what was kept. Lines that are none are left out.
    #[must_use]
    pub fn from_text(text: &str) -> Self {
        let mut tags = Self::default();
        for line in text.lines() {
            let mut parts = line.split('\t');
            let Some(unit) = parts.next().and_then(|u| u.parse().ok()) else {
                continue;
            };
            let mut next = || parts.next().unwrap_or_default().to_owned();
            let (tag, description, scaling, registers) = (next(), next(), next(), next());
            let one = |text: &str| {
                let (register, scaling) = text.split_once('=')?;
                Some((register.parse().ok()?, Scaling::from_key(scaling)?))
            };
            let entry = Entry {
                tag,
                description,
                scaling: Scaling::from_key(&scaling),
                registers: registers.split(' ').filter_map(one).collect(),
            };
            tags.set(unit, entry);
        }
        tags
    }

    /// As it is kept.
    #[must_use]
    pub fn to_text(&self) -> String {
        let plain = |text: &str| text.replace(['\t', '\n', '\r'], " ");
        let mut out = String::new();
        for (unit, entry) in &self.units {
            let scaling = entry.scaling.map_or("", Scaling::key);
            out.push_str(&format!(
                "{unit}\t{}\t{}\t{scaling}",
                plain(&entry.tag),
                plain(&entry.description)
            ));
            for (at, (register, scaling)) in entry.registers.iter().enumerate() {
                out.push(if at == 0 { '\t' } else { ' ' });
                out.push_str(&format!("{register}={}", scaling.key()));
            }
            out.push('\n');
        }
        out
    }

    /// What is known of a unit.
    #[must_use]
    pub fn get(&self, unit: u8) -> Option<&Entry> {
        self.units.get(&unit)
    }

    /// Replaces what is known of a unit; an empty entry takes it away.
    pub fn set(&mut self, unit: u8, entry: Entry) {
        if entry == Entry::default() {
            self.units.remove(&unit);
        } else {
            self.units.insert(unit, entry);
        }
    }

    /// Remembers how the analog registers of a unit count, all of them.
    pub fn set_scaling(&mut self, unit: u8, scaling: Scaling) {
        let mut entry = self.units.get(&unit).cloned().unwrap_or_default();
        entry.scaling = Some(scaling);
        entry.registers.clear();
        self.set(unit, entry);
    }

    /// The tag of a unit.
    #[must_use]
    pub fn tag<'a>(&'a self, unit: &'a Unit) -> &'a str {
        let own = self.units.get(&unit.info.unit).map_or("", |e| &e.tag);
        if own.is_empty() { &unit.info.tag } else { own }
    }

    /// The description of a unit.
    #[must_use]
    pub fn description<'a>(&'a self, unit: &'a Unit) -> &'a str {
        let own = self
            .units
            .get(&unit.info.unit)
            .map_or("", |e| &e.description);
        if own.is_empty() {
            &unit.info.description
        } else {
            own
        }
    }

    /// How an analog register of a unit counts, if somebody chose or a list says it.
    #[must_use]
    pub fn chosen(&self, unit: u8, register: u16) -> Option<Scaling> {
        let entry = self.units.get(&unit)?;
        let one = entry.registers.get(&register).copied();
        one.or(entry.scaling)
    }

    /// How an analog register of a unit counts: as chosen here, else as the bridge was told.
    #[must_use]
    pub fn scaling(&self, unit: &Unit, register: u16) -> Scaling {
        unit.scaling(self.chosen(unit.info.unit, register))
    }

    /// All units of which something is known.
    pub fn iter(&self) -> impl Iterator<Item = (u8, &Entry)> {
        self.units.iter().map(|(unit, entry)| (*unit, entry))
    }

    /// Number of units of which something is known.
    #[must_use]
    pub fn len(&self) -> usize {
        self.units.len()
    }

    /// True if nothing is known.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.units.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::super::net::tests::network;
    use super::*;
    use shared::proto::DdcShape;

    #[test]
    fn what_is_kept_comes_back() {
        let mut tags = Tags::default();
        let entry = Entry {
            tag: "80-HS-4141".into(),
            description: "Feed\twater".into(),
            scaling: Some(Scaling::TwelveBits),
            registers: [(3, Scaling::Byte), (8, Scaling::Raw)].into(),
        };
        tags.set(1, entry);
        tags.set_scaling(250, Scaling::Raw);
        let again = Tags::from_text(&tags.to_text());
        assert_eq!(again.get(1).unwrap().description, "Feed water");
        assert_eq!(again.chosen(250, 8), Some(Scaling::Raw));
        assert_eq!(again.chosen(3, 8), None);
        let of = |register| again.chosen(1, register);
        assert_eq!(
            [3, 8, 6].map(of),
            [Scaling::Byte, Scaling::Raw, Scaling::TwelveBits].map(Some)
        );
        // As it was kept before single registers were.
        let before = Tags::from_text("7\tXV-7\t\t0-255\n");
        assert_eq!(before.chosen(7, 8), Some(Scaling::Byte));
        assert_eq!(before.to_text(), "7\tXV-7\t\t0-255\n");
        assert_eq!(Tags::from_text("x\n300\ta\n\n"), Tags::default());
    }

    #[test]
    fn the_configuration_shows_through() {
        let net = network(2, DdcShape::Loop, 2);
        let mut tags = Tags::default();
        assert_eq!(tags.tag(&net.units[0]), "MOV-001");
        tags.set_scaling(1, Scaling::Byte);
        assert_eq!(tags.tag(&net.units[0]), "MOV-001");
        tags.set(
            1,
            Entry {
                tag: "XV-1".into(),
                ..Entry::default()
            },
        );
        assert_eq!(tags.tag(&net.units[0]), "XV-1");
        assert_eq!(tags.scaling(&net.units[0], 8), Scaling::Percent);
        tags.set(1, Entry::default());
        assert!(tags.is_empty());
    }
}
