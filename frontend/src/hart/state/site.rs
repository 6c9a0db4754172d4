//! What the backend has told: buses, devices, reads and searches under way, the state of a line.

use shared::device::{Device, Family};
use shared::frame::Framing;
use shared::hart::frame::{Address, Head, ROTORK, preamble};
use shared::hart::link::{Identity, LAST_POLLING};
use shared::proto::{HartNews, ToPage};
use shared::session::Session;

use crate::state::absorb::bytes_of;
use crate::state::work::Shown;

/// A device of the configuration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Known {
    /// Its tag.
    pub tag: String,
    /// Its family, if it is a HART device.
    pub family: Option<Family>,
    /// Its bus.
    pub bus: String,
    /// Its polling address; `None` if it is found by its tag or its long address.
    pub polling: Option<u8>,
}

/// Buses and devices of the configuration.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Plant {
    /// Name and framing of the buses.
    pub buses: Vec<(String, String)>,
    /// The devices.
    pub devices: Vec<Known>,
}

impl Plant {
    /// From the greeting of the backend; `None` for any other message.
    #[must_use]
    pub fn of(message: &ToPage) -> Option<Self> {
        let ToPage::Hello { buses, devices, .. } = message else {
            return None;
        };
        Some(Self {
            buses: buses
                .iter()
                .map(|b| (b.name.clone(), b.framing.clone()))
                .collect(),
            devices: devices
                .iter()
                .map(|d| Known {
                    tag: d.tag.clone(),
                    family: Device::from_key(&d.kind).and_then(Device::family),
                    bus: d.bus.clone(),
                    polling: Some(d.unit).filter(|unit| *unit <= LAST_POLLING),
                })
                .collect(),
        })
    }

    /// A device by its tag.
    #[must_use]
    pub fn device(&self, tag: &str) -> Option<&Known> {
        self.devices.iter().find(|d| d.tag == tag)
    }

    /// The device of a bus with this polling address.
    #[must_use]
    pub fn polled(&self, bus: &str, polling: u8) -> Option<&Known> {
        let mut devices = self.devices.iter();
        devices.find(|d| d.bus == bus && d.polling == Some(polling))
    }

    /// The framing of a bus.
    #[must_use]
    pub fn framing(&self, bus: &str) -> Framing {
        let found = self.buses.iter().find(|(name, _)| name == bus);
        found
            .and_then(|(_, framing)| Framing::from_key(framing))
            .unwrap_or(Framing::Hart)
    }
}

/// A read, scan or search under way, or just over.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Job {
    /// Its id.
    pub id: u32,
    /// Commands or addresses that are done.
    pub done: u32,
    /// All of them; 0 once it is over.
    pub total: u32,
    /// In words.
    pub text: String,
}

impl Job {
    /// A job that begins.
    #[must_use]
    pub const fn new(id: u32, total: u32) -> Self {
        Self {
            id,
            done: 0,
            total,
            text: String::new(),
        }
    }

    /// True while it goes on.
    #[must_use]
    pub const fn is_running(&self) -> bool {
        self.total > 0
    }

    /// Takes news in that are about this job.
    pub fn hear(&mut self, news: &HartNews) {
        match news {
            HartNews::Progress {
                id,
                done,
                total,
                text,
            } if *id == self.id => {
                (self.done, self.total) = (*done, *total);
                self.text.clone_from(text);
            }
            HartNews::Done {
                id,
                ok,
                failed,
                text,
            } if *id == self.id => {
                self.total = 0;
                self.text = if text.is_empty() {
                    format!("{ok} answered, {failed} not")
                } else {
                    text.clone()
                };
            }
            _ => {}
        }
    }
}

/// A device that a scan or search found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Its polling address, where it was found by one.
    pub polling: Option<u8>,
    /// Its answer, decoded.
    pub shown: Shown,
    /// Who it is.
    pub identity: Option<Identity>,
    /// When it came.
    pub at_us: u64,
}

impl Found {
    /// From the answer to command 0, 11 or 21.
    #[must_use]
    pub fn new(polling: Option<u8>, response: &str, at_us: u64) -> Option<Self> {
        use shared::capture::Capture;
        let mut session = Session::new(Framing::Hart);
        session.push(&Capture::of(&bytes_of(response)));
        session.finish();
        let shown = Shown::of(&session, 0, Device::None)?;
        Some(Self {
            polling,
            identity: super::unit::identity(&shown),
            shown,
            at_us,
        })
    }

    /// Where its commands go: the ten digits of its long address, of whatever revision it is.
    #[must_use]
    pub fn address(&self) -> Option<String> {
        Some(self.identity.as_ref()?.address.to_string())
    }

    /// What it is, and the digits that say so: manufacturer and device type.
    ///
    /// Source: PUB092-003-00, appendix 3: manufacturer 6Eh and device type DDh.
    #[must_use]
    pub fn kind(&self) -> Option<(String, String)> {
        let identity = self.identity.as_ref()?;
        let digits = format!("type {:04X}", identity.expanded_type);
        let name = if identity.expanded_type == ROTORK {
            "Rotork actuator".to_owned()
        } else {
            let maker = super::unit::find(&self.shown, "manufacturer");
            maker.map_or_else(String::new, |(_, f)| self.shown.decoded.bare_text(f))
        };
        Some((name, digits))
    }

    /// The device of the configuration that it is: the one at its polling address, or at that of
    /// another answer of the same device.
    #[must_use]
    pub fn known<'p>(&self, all: &[Self], plant: &'p Plant, bus: &str) -> Option<&'p Known> {
        let same = all
            .iter()
            .filter(|one| self.identity.is_some() && one.address() == self.address());
        let mut polling = same.chain([self]).filter_map(|one| one.polling);
        polling.find_map(|polling| plant.polled(bus, polling))
    }
}

/// What is known of a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Link {
    /// True if we are the primary master; `None` behind a gateway.
    pub primary: Option<bool>,
    /// True while another master is heard.
    pub other_master: bool,
    /// True while a device sends bursts.
    pub burst: bool,
    /// Requests sent, answered and repeated, and damaged frames heard.
    pub counts: [u64; 4],
    /// In words.
    pub text: String,
}

impl Link {
    /// From news about a line.
    #[must_use]
    pub fn of(news: &HartNews) -> Option<Self> {
        match news {
            HartNews::Link {
                primary,
                other_master,
                burst,
                sent,
                answered,
                retried,
                damaged,
                text,
                ..
            } => Some(Self {
                primary: *primary,
                other_master: *other_master,
                burst: *burst,
                counts: [*sent, *answered, *retried, *damaged],
                text: text.clone(),
            }),
            _ => None,
        }
    }
}

/// A frame from its delimiter on: behind the preamble, or behind the header of HART-IP.
#[must_use]
pub fn body(framing: Framing, frame: &[u8]) -> &[u8] {
    let skip = match framing {
        Framing::HartIp => shared::hart::ip::HEADER,
        _ => preamble(frame),
    };
    frame.get(skip..).unwrap_or(&[])
}

/// True for a frame, from its delimiter on, about a device: by its polling address, if it has one,
/// or by the address that its answers to command 0 have shown.
#[must_use]
pub fn is_about(body: &[u8], polling: Option<u8>, own: Option<Address>) -> bool {
    let address = Head::of(body).map(|head| head.address);
    let short = polling.map(Address::Short);
    address.is_some_and(|address| [short, own].contains(&Some(address)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hart::state::unit::tests::identity_of;

    /// The worked answer R2 to command 0.
    const IDENTITY: &str = "068000180020FE6EDD05070201080001234505050007 00006E006E019B";

    #[test]
    fn a_found_device_has_its_address() {
        let found = Found::new(Some(0), &IDENTITY.replace(' ', ""), 1).unwrap();
        assert_eq!(found.address().as_deref(), Some("2EDD012345"));
        let (name, digits) = found.kind().unwrap();
        assert_eq!(
            (name.as_str(), digits.as_str()),
            ("Rotork actuator", "type 6EDD")
        );
        assert_eq!(Found::new(None, "", 1), None);
    }

    /// What answers command 0 at a short address.
    fn found(polling: Option<u8>, revision: u8, maker: u8) -> Found {
        let mut data = identity_of(revision, 1);
        data[1] = maker;
        let data = [&[0, 0], &data[..]].concat();
        let frame = shared::hart::frame::seal(0x06, &[0x80], 0, &data);
        Found::new(polling, &shared::render::hex(&frame), 1).unwrap()
    }

    #[test]
    fn older_revisions_have_address_and_type() {
        for revision in [5, 6] {
            let one = found(Some(0), revision, 0x6E);
            assert_eq!(one.address().as_deref(), Some("2EDD012345"));
            assert_eq!(one.kind().unwrap().0, "Rotork actuator");
            // 26 (1Ah) is ABB; six bits of it stand in the address.
            let other = found(Some(0), revision, 0x1A);
            assert_eq!(other.address().as_deref(), Some("1ADD012345"));
            let (name, digits) = other.kind().unwrap();
            assert!(name.contains("ABB"), "{name}");
            assert_eq!(digits, "type 1ADD");
        }
    }

    /// Three devices on a line: at address 0, found by a tag, and on another line.
    fn plant() -> Plant {
        let device = |tag: &str, bus: &str, polling| Known {
            tag: tag.into(),
            family: Some(Family::Iq),
            bus: bus.into(),
            polling,
        };
        Plant {
            buses: Vec::new(),
            devices: vec![
                device("FV-3", "other", Some(0)),
                device("FV-2", "loop", None),
                device("FV-1", "loop", Some(0)),
            ],
        }
    }

    #[test]
    fn found_devices_are_those_of_the_configuration() {
        let plant = plant();
        let tag = |one: &Found, all: &[Found]| {
            one.known(all, &plant, "loop")
                .map(|known| known.tag.clone())
        };
        let (first, second) = (found(Some(0), 7, 0x6E), found(Some(1), 7, 0x1A));
        assert_eq!(tag(&first, &[]).as_deref(), Some("FV-1"));
        assert_eq!(tag(&second, &[]), None);
        // Found by its tag: the same device answered at 0 before.
        let named = found(None, 7, 0x6E);
        assert_eq!(tag(&named, &[]), None);
        assert_eq!(tag(&named, &[second, first]).as_deref(), Some("FV-1"));
    }

    #[test]
    fn jobs_follow_their_news() {
        let mut job = Job::new(7, 64);
        let progress = |id| HartNews::Progress {
            id,
            done: 3,
            total: 64,
            text: "address 3".into(),
        };
        job.hear(&progress(8));
        assert_eq!(job.done, 0);
        job.hear(&progress(7));
        assert!(job.is_running() && job.done == 3);
        job.hear(&HartNews::Done {
            id: 7,
            ok: 2,
            failed: 62,
            text: String::new(),
        });
        assert!(!job.is_running());
        assert_eq!(job.text, "2 answered, 62 not");
    }

    #[test]
    fn frames_are_told_by_either_address() {
        let poll = [0x82, 0xAE, 0xDD, 1, 0x23, 0x45, 3, 0, 0x95];
        let own = Some(Address::Long(0x2EDD, 0x01_2345));
        assert!(is_about(&poll, Some(0), own));
        assert!(!is_about(&poll, Some(0), None));
        let short = [0xFF, 0xFF, 0x02, 0x80, 0, 0, 0x82];
        let short = body(Framing::Hart, &short);
        assert!(is_about(short, Some(0), None));
        // A device that is found by its tag has no polling address that we know.
        assert!(!is_about(short, None, own));
        // Eight bytes of HART-IP: version, type, id, status, sequence, length of all.
        let header = [1, 0, 3, 0, 0, 2, 0, 17];
        let wrapped = [&header, &poll[..]].concat();
        assert!(is_about(body(Framing::HartIp, &wrapped), Some(0), own));
        assert!(!is_about(&[], Some(0), None) && !is_about(&[], None, None));
    }
}
