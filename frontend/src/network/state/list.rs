//! The tag list of a network: what was imported, laid over what is known, and what is exported.

use shared::ddc100::scaling::Scaling;
use shared::ddc100::tags::{Data, Tag, TagList};
use shared::device::Device;

use super::net::{Net, Unit};
use super::tags::{Entry, Tags};

/// Lays an imported list over what the browser knows. Units that the list does not name stay as
/// they are.
#[must_use]
pub fn laid_over(tags: &Tags, list: &TagList) -> Tags {
    let mut over = tags.clone();
    for unit in 1..=250 {
        let Some(line) = list.of_unit(unit) else {
            continue;
        };
        let before = tags.get(unit).cloned().unwrap_or_default();
        let scaling = list.scaling(unit, 8).or(line.scaling);
        let entry = Entry {
            tag: line.tag.clone(),
            description: line.description.clone(),
            scaling: scaling.or(before.scaling),
        };
        over.set(unit, entry);
    }
    over
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
        if tag.register == Some(8) {
            let chosen = tags.get(tag.unit).and_then(|entry| entry.scaling);
            tag.scaling = chosen.or(tag.scaling);
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
        let scaling: Scaling = tags.scaling(unit.info.unit);
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
        let tags = laid_over(&Tags::default(), &list);
        assert_eq!(tags.get(1).unwrap().tag, "80-HS-4141A");
        assert_eq!(tags.get(2), None);
        assert_eq!(tags.get(3).unwrap().description, "Initiate \"move-to\"");
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
        assert_eq!(laid.scaling(2), Scaling::TwelveBits);
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
        assert_eq!(tags.scaling(1), Scaling::Byte);
        tags.set_scaling(1, Scaling::Raw);
        let csv = export(&net, &tags, &list).to_csv();
        assert!(csv.contains("40008,,raw"), "{csv}");
        assert_eq!(csv.lines().count(), 3);
    }
}
