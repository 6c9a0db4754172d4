//! What a device says about its state, in words: forced and simulated modes, NE 107, travel.

use shared::device::Family;
use shared::hart::model::Bit;
use shared::hart::ne107::ALARM_BYTES;
use shared::hart::{DEVICE_STATUS, additional};
use shared::tree::Name;
use shared::value::Value;

use super::plan;
use super::unit::Unit;
use crate::components::ne107::Sign;
use crate::state::overview::Travel;

/// Bits of the device status.
pub const MALFUNCTION: u8 = 0x80;
/// More status available.
pub const MORE_STATUS: u8 = 0x10;
/// Loop current fixed.
const FIXED: u8 = 0x08;

/// Bits of byte 4 of command 48 that all families have alike.
const CLOSE_LIMIT: u32 = 0x02;
const OPEN_LIMIT: u32 = 0x04;
const CLOSING: u32 = 0x08;
const OPENING: u32 = 0x10;

/// Modes in which the valve does not simply follow the loop current, or values are not measured.
#[must_use]
pub fn forced(unit: &Unit) -> Vec<String> {
    let mut all = Vec::new();
    if let Some(mode) = unit.raw(133, "mode").filter(|mode| *mode != 0) {
        let words = unit.text(133, "mode").unwrap_or_else(|| mode.to_string());
        all.push(format!(
            "Control mode: {}. The valve does not follow the loop current.",
            words.to_ascii_lowercase()
        ));
    }
    if unit.status.is_some_and(|(status, _)| status & FIXED != 0) {
        all.push(
            "The loop current is fixed: the actuator works with a simulated input.".to_owned(),
        );
    }
    if unit.raw(7, "loop_current_mode") == Some(0) {
        all.push("Loop current mode is disabled: the loop current sets no demand.".to_owned());
    }
    for (key, bit, words) in [
        ("standardized_0", 1, "A device variable is simulated."),
        (
            "standardized_1",
            1,
            "Status simulation is active: status bits are not measured.",
        ),
        ("standardized_1", 2, "A discrete variable is simulated."),
    ] {
        if unit.raw(48, key).is_some_and(|raw| raw & bit != 0) {
            all.push(words.to_owned());
        }
    }
    let variables = unit.reading(&plan::variables());
    if let Some(good) = variables.and_then(|r| r.good.as_ref()) {
        let decoded = &good.shown.decoded;
        let mut name = String::new();
        for (id, field) in decoded.iter() {
            let path = decoded.path(id);
            if path.ends_with(".code") {
                name = decoded.bare_text(field);
            }
            let is_manual =
                matches!(field.value, Value::Code { raw: 2, set } if set.name == "dv_process_data");
            if is_manual {
                all.push(format!("{name} is set by hand or fixed."));
            }
        }
    }
    all
}

/// The categories of NE 107 that a device reports.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ne107 {
    /// Nothing was read yet.
    Unread,
    /// The family does not report any; what its device status says.
    None(Option<Sign>),
    /// These, the worst first; none is good.
    Signs(Vec<Sign>),
}

/// What the device reports: the extended device status of its latest answer that has one, and
/// device malfunction.
///
/// Reading R11: CVA, CK and SI are expected to leave the extended device status 0.
#[must_use]
pub fn ne107(unit: &Unit) -> Ne107 {
    let malfunction = unit.status.map(|(status, _)| status & MALFUNCTION != 0);
    let latest = [
        unit.reading(&super::unit::plain(48)),
        unit.reading(&super::unit::plain(0)),
        unit.reading(&plan::variables()),
    ];
    let latest = latest
        .into_iter()
        .filter_map(|r| r?.good.as_ref())
        .max_by_key(|good| good.at_us);
    let extended = latest.and_then(|good| super::unit::raw_of(&good.shown, "extended_status"));
    let (Some(malfunction), Some(extended)) = (malfunction, extended) else {
        return Ne107::Unread;
    };
    let failure = malfunction || extended & 0x08 != 0;
    let signs: Vec<_> = [
        (failure, Sign::Failure),
        (extended & 0x20 != 0, Sign::FunctionCheck),
        (extended & 0x10 != 0, Sign::OutOfSpecification),
        (extended & 0x01 != 0, Sign::Maintenance),
    ]
    .into_iter()
    .filter_map(|(is, sign)| is.then_some(sign))
    .collect();
    let reports = matches!(unit.family, None | Some(Family::Iq | Family::Cma));
    if !reports && extended == 0 {
        return Ne107::None(malfunction.then_some(Sign::Failure));
    }
    Ne107::Signs(signs)
}

/// Bytes 0 to 3 of command 48, which hold the alarms.
#[must_use]
pub fn alarm_bytes(unit: &Unit) -> Option<Vec<u8>> {
    let bytes = (0..ALARM_BYTES).map(|at| unit.raw(48, &format!("byte_{at}")));
    bytes.map(|b| u8::try_from(b?).ok()).collect()
}

/// The bits that are set: those of the device status as it came last, then those of command 48.
#[must_use]
pub fn set_bits(unit: &Unit) -> Vec<&'static Bit> {
    let status = unit.status.map_or(0, |(status, _)| status);
    let own = DEVICE_STATUS.bits.iter();
    let mut all: Vec<&Bit> = own.filter(|b| status >> b.bit & 1 != 0).collect();
    if let Some(good) = unit.good(48) {
        let fields = good.shown.decoded.fields().iter();
        let set = fields.filter_map(|f| match (f.name, f.value) {
            (Name::HartBit(bit), Value::Bit { on: true, .. }) => Some(bit),
            _ => None,
        });
        // The device status of that answer may be old by now.
        all.extend(set.filter(|b| !DEVICE_STATUS.bits.iter().any(|own| core::ptr::eq(own, *b))));
    }
    all
}

/// True if one of the bits is an alarm that a status map can give a category.
#[must_use]
pub fn can_have_category(family: Option<Family>, bits: &[&'static Bit]) -> bool {
    let own = (0..ALARM_BYTES).filter_map(|byte| additional(family?, byte));
    let mut own = own.flat_map(|byte| byte.bits);
    own.any(|own| own.alarm && bits.iter().any(|bit| core::ptr::eq(own, *bit)))
}

/// Which way the valve goes, and whether it stands at its limits: close, open.
#[must_use]
pub fn travel(unit: &Unit) -> (Travel, bool, bool) {
    let raw = unit.raw(48, "byte_4").unwrap_or(0);
    let travel = match (raw & OPENING != 0, raw & CLOSING != 0) {
        (true, false) => Travel::Opening,
        (false, true) => Travel::Closing,
        _ => Travel::Stopped,
    };
    (travel, raw & CLOSE_LIMIT != 0, raw & OPEN_LIMIT != 0)
}

/// What the third variable of a family is.
#[must_use]
pub const fn third(family: Option<Family>) -> &'static str {
    match family {
        Some(Family::Si) => "Pressure",
        Some(Family::Iq | Family::Ck) => "Torque",
        _ => "Thrust or torque",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hart::state::unit::tests::{STATUS, hear, poll, unit};

    /// The bits that the picture needs are the same in tables 7 to 11.
    #[test]
    fn all_families_have_travel_and_limits_in_the_same_bits() {
        for family in Family::ALL {
            let bits = additional(family, 4).unwrap();
            let label = |bit: u8| {
                let bit = bits.bits.iter().find(|b| b.bit == bit).unwrap();
                bit.label.to_ascii_lowercase()
            };
            assert!(label(1).contains("close") && label(1).contains("limit"));
            assert!(label(2).contains("open") && label(2).contains("limit"));
            assert!(label(3).contains("clos"), "{}", label(3));
            assert!(label(4).contains("open"), "{}", label(4));
        }
    }

    /// The worked answer R10: failure, open limit reached.
    #[test]
    fn ne_107_follows_the_extended_status() {
        let mut known = unit(&[(48, STATUS.0, STATUS.1)]);
        assert_eq!(ne107(&known), Ne107::Signs(vec![Sign::Failure]));
        assert_eq!(travel(&known), (Travel::Stopped, false, true));
        known.family = Some(Family::Cva);
        assert_eq!(ne107(&unit(&[])), Ne107::Unread);
        assert_eq!(forced(&known), Vec::<String>::new());
    }

    /// Device status 90 came with command 48, and 08 later: table 4, bits 7 and 4, then 3.
    #[test]
    fn the_latest_device_status_counts() {
        let mut known = unit(&[(48, STATUS.0, STATUS.1)]);
        let keys = |unit: &Unit| set_bits(unit).iter().map(|b| b.key).collect::<Vec<_>>();
        assert!(keys(&known).contains(&"malfunction"));
        assert!(can_have_category(known.family, &set_bits(&known)));
        hear(&mut known, 3, 0x08, &poll(50.0), 1);
        let keys = keys(&known);
        assert!(!keys.contains(&"malfunction") && !keys.contains(&"more_status_available"));
        assert!(keys.contains(&"loop_current_fixed") && keys.contains(&"local_control_fault"));
        assert_eq!(alarm_bytes(&known), Some(vec![2, 0, 2, 0]));
        let mut unread = unit(&[]);
        hear(&mut unread, 3, 0x80, &poll(50.0), 1);
        let bits = set_bits(&unread);
        assert_eq!(bits.len(), 1);
        assert!(!can_have_category(unread.family, &bits));
    }

    /// Control mode 1 by the worked frame of command 133.
    #[test]
    fn a_forced_mode_is_said() {
        let known = unit(&[(133, "82AEDD01234585 0013", "86AEDD012345850300000115")]);
        let forced = forced(&known);
        assert!(forced[0].contains("digital position"), "{forced:?}");
    }
}
