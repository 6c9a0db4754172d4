//! Captures to frames, and answers to the values of a device.

use shared::decode::pdu_of;
use shared::frame::Role;

use super::plant::{BusState, DeviceState};

/// Takes the values of an answer into the image of its device.
pub(super) fn absorb(bus: &BusState, index: u32, devices: &mut [DeviceState]) {
    let Some(frame) = bus.session.frame(index) else {
        return;
    };
    if frame.role != Role::Response || frame.marks.is_damaged() {
        return;
    }
    let pdu = |index| pdu_of(bus.session.bytes(index)?, bus.session.framing());
    let Some((request, response)) = frame
        .pair()
        .filter(|pair| *pair < index)
        .and_then(|pair| Some((pdu(pair)?, pdu(index)?)))
    else {
        return;
    };
    let at = bus.session.at(index).unwrap_or_default();
    for device in devices {
        if device.info.bus == bus.info.name && device.info.unit == frame.unit {
            device.image.absorb(&request, &response, at);
        }
    }
}

/// The bytes of a capture.
pub(crate) fn bytes_of(hex: &str) -> Vec<u8> {
    hex.as_bytes()
        .chunks_exact(2)
        .filter_map(|pair| {
            let text = core::str::from_utf8(pair).ok()?;
            u8::from_str_radix(text, 16).ok()
        })
        .collect()
}
