//! Captures to try, part of the page so that they are there without a network.

use shared::device::{Device, Family};

/// A capture to try.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// Name in the address bar.
    pub key: &'static str,
    /// What people read.
    pub title: &'static str,
    /// What is to be seen in it.
    pub about: &'static str,
    /// The file as it is; empty if the program of HART has it.
    pub content: &'static [u8],
    /// Device to decode with, where it can't be told from the bytes.
    pub device: Option<Device>,
}

/// A sample that only the program of HART carries.
#[cfg(feature = "hart")]
macro_rules! hart {
    ($name:literal) => {
        include_bytes!(concat!("../../../static/samples/", $name))
    };
}
#[cfg(not(feature = "hart"))]
macro_rules! hart {
    ($name:literal) => {
        b""
    };
}

/// A sample of Modbus, which a program without maps does not carry.
#[cfg(feature = "maps")]
macro_rules! modbus {
    ($name:literal) => {
        include_bytes!(concat!("../../../static/samples/", $name))
    };
}
#[cfg(not(feature = "maps"))]
macro_rules! modbus {
    ($name:literal) => {
        b""
    };
}

/// All samples.
pub const SAMPLES: [Sample; 10] = [
    Sample {
        key: "icon3000-poll",
        title: "ICON3000 poll",
        about: "Status, identity, log and torque curve of an actuator, over four tables",
        content: modbus!("icon3000-poll.hex"),
        device: None,
    },
    Sample {
        key: "damaged",
        title: "Damaged capture",
        about: "Noise, a flipped bit, swapped CRC bytes, an answer cut short",
        content: modbus!("damaged.hex"),
        device: None,
    },
    Sample {
        key: "icon3000-manual",
        title: "ICON3000 manual",
        about: "The worked frames of VCIOM-16345-EN, tables 7 to 29",
        content: modbus!("icon3000-manual.hex"),
        device: Some(Device::Icon3000v2),
    },
    Sample {
        key: "modbus-ascii",
        title: "Modbus ASCII",
        about: "Lines with a colon, one with a wrong LRC",
        content: modbus!("modbus-ascii.txt"),
        device: None,
    },
    Sample {
        key: "modbus-tcp",
        title: "Modbus TCP",
        about: "Two requests under way at once, an exception",
        content: modbus!("modbus-tcp.hex"),
        device: None,
    },
    Sample {
        key: "array",
        title: "C array",
        about: "Bytes as a program has them",
        content: modbus!("array.c"),
        device: None,
    },
    Sample {
        key: "hart-handheld",
        title: "HART handheld",
        about: "Identity, set-up, variables and status of a Rotork actuator",
        content: hart!("hart-handheld.txt"),
        device: Some(Device::Rotork(Family::Iq)),
    },
    Sample {
        key: "hart-damaged",
        title: "HART, damaged",
        about: "Echo, eaten preamble, noise, cut and changed bytes, a burst",
        content: hart!("hart-damaged.hex"),
        device: Some(Device::Rotork(Family::Iq)),
    },
    Sample {
        key: "hart-ip",
        title: "HART-IP",
        about: "A gateway's session, a burst, a direct PDU",
        content: hart!("hart-ip.hex"),
        device: Some(Device::Rotork(Family::Iq)),
    },
    Sample {
        key: "ddc100",
        title: "DDC-100 poll",
        about: "The printed example of LMAIM4019-00, section 3.2",
        content: modbus!("ddc100.hex"),
        device: Some(Device::Ddc100Uec),
    },
];

/// The sample with this key.
#[must_use]
pub fn by_key(key: &str) -> Option<&'static Sample> {
    SAMPLES.iter().find(|s| s.key == key)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::findings::Findings;
    use crate::state::load::load;
    use crate::state::work::Work;
    use shared::frame::Framing;

    /// Framing, frames, errors and device of a sample.
    fn seen(key: &str) -> (Framing, u32, u32, Device) {
        let sample = by_key(key).unwrap();
        let work = Work::new(String::new(), load(sample.content, None), false);
        let mut findings = Findings::default();
        let context = work.context(sample.device);
        while !findings.step(&work.session, &context, 100) {}
        (
            work.session.framing(),
            work.session.len(),
            findings.counts[2],
            context.device,
        )
    }

    #[test]
    fn every_sample_shows_what_it_promises() {
        let v2 = Device::Icon3000v2;
        assert_eq!(seen("icon3000-poll"), (Framing::Rtu, 22, 0, v2));
        assert_eq!(seen("icon3000-manual"), (Framing::Rtu, 20, 0, v2));
        assert_eq!(seen("modbus-ascii"), (Framing::Ascii, 9, 1, v2));
        assert_eq!(seen("modbus-tcp"), (Framing::Tcp, 8, 0, v2));
        assert_eq!(seen("array"), (Framing::Rtu, 4, 0, v2));
        assert_eq!(seen("ddc100"), (Framing::Rtu, 2, 0, Device::Ddc100Uec));
        let (framing, frames, errors, device) = seen("damaged");
        assert_eq!((framing, device), (Framing::Rtu, v2));
        assert!(frames > 12 && errors > 4, "{frames} {errors}");
    }
}
