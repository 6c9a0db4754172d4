//! The tag list of a network: what was imported, laid over what is known, and what is exported.

use shared::ddc100::scaling::Scaling;
use shared::ddc100::tags::{Data, Tag, TagList};
use shared::device::Device;

use super::net::{Net, Unit};
use super::tags::Tags;
use super::unit::kind;

/// Registers whose scale a list may say (table 3.5, note 2, and those of other types).
const ANALOG: core::ops::RangeInclusive<u16> = 2..=8;

/// Lays an imported list over what the browser knows. Units that the list does not name stay as
/// they are; a unit has its tag from a line without a register only, others name points of it.
#[must_use]
pub fn laid_over(tags: &Tags, list: &TagList) -> Tags {
    let mut over = tags.clone();
    for unit in 1..=250 {
        if list.of_unit(unit).is_none() {
            continue;
        }
        let mut entry = tags.get(unit).cloned().unwrap_or_default();
        let whole = |t: &&Tag| t.unit == unit && t.register.is_none();
        if let Some(line) = list.tags.iter().find(whole) {
            entry.tag.clone_from(&line.tag);
            entry.description.clone_from(&line.description);
            if line.scaling.is_some() {
                entry.scaling = line.scaling;
                entry.registers.clear();
            }
        }
        let said = ANALOG.filter_map(|register| Some((register, list.scaling(unit, register)?)));
        entry.registers.extend(said);
        over.set(unit, entry);
    }
    over
}

/// Units whose type the list has otherwise than the configuration, in words.
#[must_use]
pub fn contradictions(net: &Net, list: &TagList) -> Vec<String> {
    let units = net.units.iter();
    units
        .filter_map(|unit| {
            let number = unit.info.unit;
            let listed = list.kind(number).filter(|kind| *kind != unit.device)?;
            Some(format!(
                "The list says that unit {number} is {}; the bridge is set up for {}, and that counts.",
                kind(listed),
                kind(unit.device)
            ))
        })
        .collect()
}

/// The list to export: what was imported with the present scalings, then the units that it does not
/// name, with the points of table 6.1.
#[must_use]
pub fn export(net: &Net, tags: &Tags, imported: &TagList) -> TagList {
    let mut list = TagList {
        tags: imported.tags.clone(),
        problems: Vec::new(),
    };
    for tag in &mut list.tags {
        if let Some(register) = tag.register.filter(|r| *r == 8 || tag.scaling.is_some()) {
            tag.scaling = tags.chosen(tag.unit, register).or(tag.scaling);
        }
    }
    for unit in &net.units {
        if imported.of_unit(unit.info.unit).is_none() {
            list.tags.extend(points(unit, tags));
        }
    }
    list
}

/// A unit and its points, as table 6.1 has them.
fn points(unit: &Unit, tags: &Tags) -> Vec<Tag> {
    let base = match tags.tag(unit) {
        "" => format!("UNIT-{}", unit.info.unit),
        tag => tag.to_owned(),
    };
    let point = |suffix: &str, description: &str, register: u16, data: Option<u16>| Tag {
        tag: format!("{base}{suffix}"),
        description: description.to_owned(),
        unit: unit.info.unit,
        register: Some(register),
        data: data.map(Data::Value),
        ..Tag::default()
    };
    let mut all = vec![Tag {
        tag: base.clone(),
        description: tags.description(unit).to_owned(),
        unit: unit.info.unit,
        kind: Some(unit.device),
        ..Tag::default()
    }];
    if unit.device != Device::Ddc100Io {
        let scaling: Scaling = tags.scaling(unit, 8);
        all.push(point("-OPEN", "Open actuator", 1, Some(256)));
        all.push(point("-CLOSE", "Close actuator", 1, Some(768)));
        all.push(Tag {
            scaling: Some(scaling),
            ..point("-POS", "Position feedback", 8, None)
        });
    }
    all.push(point("-STAT", "Status register", 9, None));
    all
}

#[cfg(test)]
mod tests {
    use super::super::net::tests::network;
    use super::*;
    use shared::proto::DdcShape;

    /// Table 6.1 as printed, with its own names of columns.
    const PRINTED: &str = "\
Tag Name,Description,Modbus Slave Address,Comments,Modbus Register,Modbus Command Data
80-HS-4141A,Open actuator,1,Command to open the valve,40001,256
80-HS-4141B,Close actuator,1,Command to close the valve,40001,768
80-POS-4141,Position feedback,1,Valve position in % of Open,40008,n/a
80-STAT-4141,Status register,1,16 bits of status,40009,n/a
80-GO-5253A,Initiate \"move-to\",3,Initiate \"move-to\",40001,6656
80-GO-5253B,\"\"\"move-to\"\" value\",3,% of Open value,40002,0-100
";

    #[test]
    fn the_printed_table_is_laid_over() {
        let list = TagList::read(PRINTED);
        assert_eq!(list.tags.len(), 6, "{:?}", list.problems);
        // Its lines name points of units, not the units: none is renamed after its open command.
        let net = network(3, DdcShape::Loop, 2);
        let tags = laid_over(&Tags::default(), &list);
        for unit in &net.units {
            let number = unit.info.unit;
            assert_eq!(tags.tag(unit), format!("MOV-{number:03}"));
            assert_eq!(tags.description(unit), "");
        }
        assert_eq!(tags, Tags::default());
        // With a line for the unit itself, wherever it stands.
        let list = TagList::read(&format!("{PRINTED}MOV-4141,Inlet,1,,,\n"));
        let tags = laid_over(&Tags::default(), &list);
        assert_eq!(tags.tag(&net.units[0]), "MOV-4141");
        assert_eq!(tags.description(&net.units[0]), "Inlet");
    }

    /// Each register has the scale that its line says; choosing one on the page is for all.
    #[test]
    fn registers_have_their_own_scales() {
        let list = TagList::read(
            "Tag name,Unit,Register,Scaling\nXV-1-POS,1,40008,0-4095\nXV-1-AI1,1,40006,0-255\nXV-1-AI2,1,40007,\n",
        );
        let mut tags = laid_over(&Tags::default(), &list);
        let of =
            |tags: &Tags| [8, 6, 7].map(|register| tags.chosen(1, register).unwrap_or_default());
        assert_eq!(
            of(&tags),
            [Scaling::TwelveBits, Scaling::Byte, Scaling::Percent]
        );
        let net = network(1, DdcShape::Loop, 2);
        let csv = export(&net, &tags, &list).to_csv();
        assert!(
            csv.contains("40006,,0-255") && csv.contains("40008,,0-4095"),
            "{csv}"
        );
        tags.set_scaling(1, Scaling::Raw);
        assert_eq!(of(&tags), [Scaling::Raw; 3]);
        let csv = export(&net, &tags, &list).to_csv();
        assert!(
            csv.contains("40006,,raw") && csv.contains("40008,,raw"),
            "{csv}"
        );
    }

    #[test]
    fn a_type_that_contradicts_is_said() {
        let net = network(2, DdcShape::Loop, 2);
        let list = TagList::read("Tag name,Unit,Type\nXV-1,1,ddc100-mx\nXV-2,2,ddc100-uec\n");
        let said = contradictions(&net, &list);
        assert_eq!(said.len(), 1);
        assert!(
            said[0].starts_with("The list says that unit 1 is MX") && said[0].contains("UEC"),
            "{said:?}"
        );
    }

    #[test]
    fn what_is_exported_is_imported_again() {
        let net = network(3, DdcShape::Loop, 2);
        let mut tags = Tags::default();
        tags.set_scaling(2, Scaling::TwelveBits);
        let out = export(&net, &tags, &TagList::default());
        assert_eq!(out.tags.len(), 15);
        let again = TagList::read(&out.to_csv());
        assert!(again.problems.is_empty(), "{:?}", again.problems);
        assert_eq!(again.tags, out.tags);
        let laid = laid_over(&Tags::default(), &again);
        assert_eq!(laid.chosen(2, 8), Some(Scaling::TwelveBits));
        assert_eq!(laid.tag(&net.units[0]), "MOV-001");
        // Nothing is said twice.
        assert_eq!(export(&net, &laid, &again).to_csv(), out.to_csv());
    }

    #[test]
    fn a_scaling_that_was_changed_goes_out() {
        let net = network(1, DdcShape::Loop, 2);
        let list =
            TagList::read("Tag name,Unit,Register,Scaling\nXV-1,1,,\nXV-1-POS,1,40008,0-255\n");
        let mut tags = laid_over(&Tags::default(), &list);
        assert_eq!(tags.chosen(1, 8), Some(Scaling::Byte));
        tags.set_scaling(1, Scaling::Raw);
        let csv = export(&net, &tags, &list).to_csv();
        assert!(csv.contains("40008,,raw"), "{csv}");
        assert_eq!(csv.lines().count(), 3);
    }
}
