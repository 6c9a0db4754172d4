//! A device as a master knows it: how it is found, who it is, and how its commands become requests.

use super::{Answer, Request};
use crate::hart::command;
use crate::hart::frame::Address;
use crate::hart::model::Reach;
use crate::hart::values::pack;

/// Characters of a tag.
pub const TAG: usize = 8;
/// Characters of a long tag.
pub const LONG_TAG: usize = 32;
/// Highest polling address; HART 5 stops at [`LAST_OF_HART_5`].
pub const LAST_POLLING: u8 = 63;
/// Highest polling address of HART 5.
pub const LAST_OF_HART_5: u8 = 15;

/// How a device is found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    /// By its polling address, 0 to 63.
    Polling(u8),
    /// By its unique address: low 14 bits of the device type, and device id.
    Unique(u16, u32),
    /// By its tag, in packed ASCII.
    Tag([u8; 6]),
    /// By its long tag, padded with zeros.
    LongTag([u8; 32]),
}

impl Target {
    /// A unique address as ten hexadecimal digits. The two highest bits are those of a frame,
    /// master and burst, and say nothing about the device.
    #[must_use]
    pub fn unique(digits: &str) -> Option<Self> {
        let good = digits.len() == 10 && digits.bytes().all(|b| b.is_ascii_hexdigit());
        let number = u64::from_str_radix(digits, 16).ok().filter(|_| good)?;
        let [_, _, _, high, low, a, b, c] = number.to_be_bytes();
        let target = Self::Unique(
            u16::from_be_bytes([high & 0x3F, low]),
            u32::from_be_bytes([0, a, b, c]),
        );
        // All zero is what everybody hears.
        (target != Self::Unique(0, 0)).then_some(target)
    }

    /// A tag: 1 to 8 characters of packed ASCII; small letters become capitals.
    #[must_use]
    pub fn tag(text: &str) -> Option<Self> {
        let good = |c: char| (' '..='_').contains(&c.to_ascii_uppercase());
        let fits = !text.is_empty() && text.len() <= TAG && text.chars().all(good);
        let packed = fits.then(|| pack(&format!("{text:TAG$}")))?;
        Some(Self::Tag(packed.try_into().ok()?))
    }

    /// A long tag: 1 to 32 characters of ISO 8859-1.
    #[must_use]
    pub fn long_tag(text: &str) -> Option<Self> {
        let mut bytes = [0; LONG_TAG];
        let characters: Option<Vec<u8>> = text.chars().map(|c| u8::try_from(c).ok()).collect();
        let characters = characters.filter(|c| !c.is_empty())?;
        bytes
            .get_mut(..characters.len())?
            .copy_from_slice(&characters);
        Some(Self::LongTag(bytes))
    }

    /// The request that brings its identity.
    #[must_use]
    pub fn identify(&self) -> Request {
        match self {
            Self::Polling(polling) => Request::new(Address::Short(*polling), 0, &[]),
            Self::Unique(kind, id) => Request::new(Address::Long(*kind, *id), 0, &[]),
            Self::Tag(packed) => Request::new(Address::BROADCAST, 11, packed),
            Self::LongTag(bytes) => Request::new(Address::BROADCAST, 21, bytes),
        }
    }
}

/// Who a device is: its answer to command 0, 11 or 21.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Where its commands go: its long address, or its polling address before HART 5.
    pub address: Address,
    /// Expanded device type: two bytes since HART 7, before that manufacturer and device type.
    pub expanded_type: u16,
    /// Device id, 24 bits.
    pub device_id: u32,
    /// Preambles that it wants in requests.
    pub preambles: u8,
    /// Revision of its universal commands: 5, 6 or 7.
    pub revision: u8,
    /// The reply, from the delimiter to the check byte.
    pub frame: Vec<u8>,
}

impl Identity {
    /// The identity in an answer; `None` if it holds none.
    ///
    /// Source: readings of command 0: by length, not by revision; the first twelve bytes are those of HART 5
    /// in every revision.
    #[must_use]
    pub fn of(answer: &Answer) -> Option<Self> {
        let data = answer.data();
        let &[first, high, low, preambles, revision, _, _, _, _, a, b, c] =
            data.first_chunk::<12>()?;
        let expanded_type = u16::from_be_bytes([high, low]);
        let device_id = u32::from_be_bytes([0, a, b, c]);
        let address = if first == 254 {
            Address::Long(expanded_type & 0x3FFF, device_id)
        } else {
            answer.head.address
        };
        Some(Self {
            address,
            expanded_type,
            device_id,
            preambles,
            revision,
            frame: answer.frame.clone(),
        })
    }

    /// A request for one of its commands.
    #[must_use]
    pub fn request(&self, number: u16, data: &[u8]) -> Request {
        let reach = command(number).map_or(Reach::Long, |c| c.reach);
        let address = match reach {
            Reach::Long | Reach::Any => self.address,
            Reach::Broadcast => Address::BROADCAST,
        };
        let request = Request::new(address, number, data);
        match reach {
            // Everybody has to hear it.
            Reach::Broadcast => request,
            Reach::Long | Reach::Any => request.with_preambles(self.preambles),
        }
    }
}

/// A device on a line, found once and remembered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Device {
    target: Target,
    identity: Option<Identity>,
}

impl Device {
    /// A device that was not found yet.
    #[must_use]
    pub const fn new(target: Target) -> Self {
        Self {
            target,
            identity: None,
        }
    }

    /// How it is found.
    #[must_use]
    pub const fn target(&self) -> &Target {
        &self.target
    }

    /// Who it is, once it was found.
    #[must_use]
    pub const fn identity(&self) -> Option<&Identity> {
        self.identity.as_ref()
    }

    /// It may be another one by now.
    pub fn forget(&mut self) {
        self.identity = None;
    }

    /// The request for a command, or first the one that finds the device.
    #[must_use]
    pub fn request(&self, number: u16, data: &[u8]) -> Step {
        match &self.identity {
            Some(identity) => Step::Ask(identity.request(number, data)),
            None => Step::Find(self.target.identify()),
        }
    }

    /// The answer to the request that finds it. False if it is not the answer of this device.
    pub fn found(&mut self, answer: &Answer) -> bool {
        let identity = Identity::of(answer);
        let right = |i: &Identity| match self.target {
            Target::Unique(kind, id) => i.address == Address::Long(kind, id),
            _ => true,
        };
        self.identity = identity.filter(right);
        self.identity.is_some()
    }
}

/// What to send for a command.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    /// The device has to be found first.
    Find(Request),
    /// The command itself.
    Ask(Request),
}

/// Looks for devices at polling addresses.
#[derive(Clone, Debug)]
pub struct Scan {
    first: u8,
    last: u8,
    next: Option<u8>,
    found: Vec<(u8, Identity)>,
    silent: u32,
}

/// What stands at a polling address.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Sighting {
    /// Nobody.
    Nobody,
    /// A device.
    Device(Identity),
    /// A device that was found at a lower address already: one of HART 5 that looks at four bits of the
    /// address only.
    Again(u8),
    /// Something answers, and does not say who it is.
    Unknown,
}

impl Scan {
    /// A scan from one address to another, at most to 63.
    #[must_use]
    pub fn new(first: u8, last: u8) -> Self {
        let last = last.min(LAST_POLLING);
        Self {
            first,
            last,
            next: (first <= last).then_some(first),
            found: Vec::new(),
            silent: 0,
        }
    }

    /// The address that is looked at, and the request for it; `None` when all were.
    #[must_use]
    pub fn next(&self) -> Option<(u8, Request)> {
        let polling = self.next?;
        Some((polling, Target::Polling(polling).identify()))
    }

    /// What came of the request; goes on to the next address.
    pub fn take(&mut self, answer: Option<&Answer>) -> Sighting {
        let Some(polling) = self.next else {
            return Sighting::Nobody;
        };
        self.next = polling.checked_add(1).filter(|n| *n <= self.last);
        let Some(answer) = answer else {
            self.silent = self.silent.saturating_add(1);
            return Sighting::Nobody;
        };
        let Some(identity) = Identity::of(answer) else {
            return Sighting::Unknown;
        };
        let same = |(p, i): &&(u8, Identity)| {
            polling > LAST_OF_HART_5
                && *p == polling & LAST_OF_HART_5
                && i.address == identity.address
        };
        if let Some((before, _)) = self.found.iter().find(same) {
            return Sighting::Again(*before);
        }
        self.found.push((polling, identity.clone()));
        Sighting::Device(identity)
    }

    /// Nothing more is looked for.
    pub fn stop(&mut self) {
        self.next = None;
    }

    /// What was found: polling address and device.
    #[must_use]
    pub fn found(&self) -> &[(u8, Identity)] {
        &self.found
    }

    /// Addresses at which nobody answered.
    #[must_use]
    pub const fn silent(&self) -> u32 {
        self.silent
    }

    /// Addresses done, and all of them.
    #[must_use]
    pub fn progress(&self) -> (u32, u32) {
        let total = u32::from(self.last.saturating_sub(self.first)).saturating_add(1);
        let done = self
            .next
            .map_or(total, |next| u32::from(next.saturating_sub(self.first)));
        (done, total)
    }
}

/// Commands that together show what a device says of itself, with the data of their requests: the
/// universal ones, and those of its family (PUB092-003-00, tables 12 to 14).
#[must_use]
pub fn overview(family: Option<crate::device::Family>) -> Vec<(u16, Vec<u8>)> {
    let listed = |c: &&crate::hart::model::Command| {
        let universal = c.group == crate::hart::model::Group::Universal;
        family.map_or(universal, |f| c.families.contains(&f))
    };
    crate::hart::COMMANDS
        .iter()
        .filter(listed)
        .filter(|c| c.reach != Reach::Broadcast)
        .filter_map(|c| Some((c.number, usual_data(c.number)?)))
        .filter(|(number, data)| reads(*number, data))
        .collect()
}

/// The data with which a command is usually read; `None` if there is no usual way.
#[must_use]
pub fn usual_data(number: u16) -> Option<Vec<u8>> {
    match number {
        // Rotork's device variables (PUB092-003-00, table 3).
        9 => Some(vec![0, 1, 2, 3, 4]),
        33 => Some(vec![0, 1, 2, 3]),
        54 => Some(vec![0]),
        // Block 0200h, index 0 (section 9).
        129 => Some(vec![0x02, 0x00, 0x00]),
        // From index 0, 64 entries.
        523 => Some(vec![0, 64]),
        _ => {
            let empty = command(number)?
                .request
                .iter()
                .any(|f| f.lengths.contains(&0));
            empty.then(Vec::new)
        }
    }
}

/// True if a command is known, may have these data and then changes nothing.
#[must_use]
pub fn reads(number: u16, data: &[u8]) -> bool {
    command(number).is_some_and(|c| c.reads_with(data.len()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hart::frame::seal;

    fn answer(address: &[u8], command: u8, data: &[u8]) -> Answer {
        let delimiter = if address.len() == 5 { 0x86 } else { 0x06 };
        let data = [&[0, 0], data].concat();
        Answer::of(&seal(delimiter, address, command, &data)).unwrap()
    }

    /// Source: readings/hart.md, 3.1: HART 5 answers 12 bytes, HART 6 17, HART 7 22.
    fn identity(revision: u8) -> Vec<u8> {
        let mut data = vec![254, 0x6E, 0xDD, 7, revision, 2, 1, 8, 0, 1, 0x23, 0x45];
        match revision {
            6 => data.extend([5, 5, 0, 7, 0]),
            7 => data.extend([5, 4, 0, 7, 0, 0, 0x6E, 0, 0x6E, 1]),
            _ => {}
        }
        data
    }

    #[test]
    fn a_device_of_every_revision_is_found_once_and_asked_by_its_long_address() {
        for revision in 5..=7 {
            let mut device = Device::new(Target::Polling(3));
            let Step::Find(request) = device.request(3, &[]) else {
                panic!("it is not known yet");
            };
            assert_eq!(request.frame(true), [0x02, 0x83, 0, 0, 0x81]);
            assert_eq!(request.preambles, 20);
            assert!(device.found(&answer(&[0x83], 0, &identity(revision))));
            let found = device.identity().unwrap();
            assert_eq!((found.revision, found.expanded_type), (revision, 0x6EDD));
            let Step::Ask(request) = device.request(3, &[]) else {
                panic!("it is known");
            };
            // Six bits of the type: 6E becomes 2E, with the master bit AE.
            let frame = [0x82, 0xAE, 0xDD, 1, 0x23, 0x45, 3, 0, 0x95];
            assert_eq!(
                (request.frame(true), request.preambles),
                (frame.to_vec(), 7)
            );
            device.forget();
            assert!(matches!(device.request(3, &[]), Step::Find(_)));
        }
    }

    #[test]
    fn whoever_is_older_than_hart_5_keeps_its_short_address() {
        let mut data = identity(5);
        data[0] = 0x0B;
        let found = Identity::of(&answer(&[0x02], 0, &data)).unwrap();
        assert_eq!(found.address, Address::Short(2));
        assert_eq!(found.request(3, &[]).frame(false)[..2], [0x02, 0x02]);
        assert_eq!(Identity::of(&answer(&[0x02], 0, &data[..11])), None);
    }

    #[test]
    fn targets_are_what_people_write() {
        for text in ["AEDD012345", "2edd012345", "EEDD012345"] {
            assert_eq!(
                Target::unique(text),
                Some(Target::Unique(0x2EDD, 0x01_2345))
            );
        }
        for bad in [
            "",
            "AEDD01234",
            "AEDD0123456",
            "+EDD012345",
            "0000000000",
            "80000000 0",
        ] {
            assert_eq!(Target::unique(bad), None, "{bad}");
        }
        // Readings, section 4.1: VALVE-01.
        let packed = [0x58, 0x13, 0x16, 0x16, 0xDC, 0x31];
        assert_eq!(Target::tag("valve-01"), Some(Target::Tag(packed)));
        let request = Target::tag("VALVE-01").unwrap().identify();
        assert_eq!(request.frame(true)[..8], [0x82, 0x80, 0, 0, 0, 0, 11, 6]);
        for bad in ["", "NINE SIGN", "Ä", "a\u{7f}"] {
            assert_eq!(Target::tag(bad), None, "{bad}");
        }
        let request = Target::long_tag("Kühlung").unwrap().identify();
        assert_eq!((request.command, request.data.len()), (21, 32));
        assert_eq!(request.data[..8], *b"K\xFChlung\0");
        assert_eq!(Target::long_tag(&"x".repeat(33)), None);
        assert_eq!(Target::long_tag("€"), None);
    }

    /// Another device at the address that was meant is not taken for it.
    #[test]
    fn a_unique_address_is_looked_at() {
        let mut device = Device::new(Target::unique("AEDD012346").unwrap());
        let own = [0xAE, 0xDD, 1, 0x23, 0x46];
        assert!(!device.found(&answer(&own, 0, &identity(7))));
        let mut data = identity(7);
        data[11] = 0x46;
        assert!(device.found(&answer(&own, 0, &data)));
    }

    /// A device of HART 5 that looks at four bits of the address answers at 3, 19, 35 and 51.
    #[test]
    fn a_scan_counts_a_device_once() {
        let mut scan = Scan::new(0, 200);
        let (mut devices, mut again) = (0, Vec::new());
        while let Some((polling, request)) = scan.next() {
            assert_eq!(request.address, Address::Short(polling));
            let hears = polling & 15 == 3;
            let reply = hears.then(|| answer(&[0x80 | polling], 0, &identity(5)));
            match scan.take(reply.as_ref()) {
                Sighting::Device(_) => devices += 1,
                Sighting::Again(before) => again.push((polling, before)),
                Sighting::Nobody => {}
                Sighting::Unknown => panic!("{polling}"),
            }
        }
        assert_eq!((devices, again), (1, vec![(19, 3), (35, 3), (51, 3)]));
        assert_eq!((scan.progress(), scan.silent()), ((64, 64), 60));
        // Two devices at addresses of their own are two.
        let mut scan = Scan::new(0, 1);
        assert!(matches!(
            scan.take(Some(&answer(&[0x80], 0, &identity(7)))),
            Sighting::Device(_)
        ));
        assert!(matches!(
            scan.take(Some(&answer(&[0x81], 0, &[1, 2]))),
            Sighting::Unknown
        ));
        assert_eq!(scan.next(), None);
        assert_eq!(Scan::new(5, 4).next(), None);
    }

    /// What is read together reads only, by the manual's own tables.
    #[test]
    fn an_overview_only_reads() {
        use crate::device::Family;
        for family in [None, Some(Family::Cva), Some(Family::Iq), Some(Family::Si)] {
            let all = overview(family);
            assert!(all.len() > 10 && all.iter().all(|(n, d)| reads(*n, d)));
            assert!(all.contains(&(3, Vec::new())) && all.contains(&(48, Vec::new())));
            assert_eq!(all.contains(&(523, vec![0, 64])), family.is_some());
            assert_eq!(
                all.iter().any(|(n, _)| *n == 129),
                family == Some(Family::Cva)
            );
        }
        for (number, data) in [
            (48, vec![0]),
            (35, vec![0; 9]),
            (132, vec![1]),
            (130, vec![]),
            (9999, vec![]),
        ] {
            assert!(!reads(number, &data), "{number}");
        }
    }
}
