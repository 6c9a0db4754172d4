//! What the backend has told: buses, devices, reads and searches under way, the state of a line.

use shared::device::{Device, Family};
use shared::frame::Framing;
use shared::hart::frame::{Head, preamble};
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
    /// Its polling address.
    pub polling: u8,
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
                    polling: d.unit,
                })
                .collect(),
        })
    }

    /// A device by its tag.
    #[must_use]
    pub fn device(&self, tag: &str) -> Option<&Known> {
        self.devices.iter().find(|d| d.tag == tag)
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
        Some(Self {
            polling,
            shown: Shown::of(&session, 0, Device::None)?,
            at_us,
        })
    }

    /// Type and device id as ten digits, as they stand in a long address.
    #[must_use]
    pub fn address(&self) -> Option<String> {
        let raw = |key| super::unit::raw_of(&self.shown, key);
        let id = raw("device_id")?;
        let kind = raw("expanded_type")? & 0x3FFF;
        Some(format!("{kind:04X}{id:06X}"))
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

/// The device that a frame is about: by its polling address, or by the long one that its answers to
/// command 0 have shown.
#[must_use]
pub fn is_about(frame: &[u8], polling: u8, long: Option<&str>) -> bool {
    use shared::hart::frame::Address;
    let body = frame.get(preamble(frame)..).unwrap_or(&[]);
    Head::of(body).is_some_and(|head| match head.address {
        Address::Short(short) => short == polling,
        address => long == Some(address.to_string().as_str()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The worked answer R2 to command 0.
    const IDENTITY: &str = "068000180020FE6EDD05070201080001234505050007 00006E006E019B";

    #[test]
    fn a_found_device_has_its_address() {
        let found = Found::new(Some(0), &IDENTITY.replace(' ', ""), 1).unwrap();
        assert_eq!(found.address().as_deref(), Some("2EDD012345"));
        assert_eq!(Found::new(None, "", 1), None);
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
        assert!(is_about(&poll, 0, Some("2EDD012345")));
        assert!(!is_about(&poll, 0, None));
        assert!(is_about(&[0xFF, 0xFF, 0x02, 0x80, 0, 0, 0x82], 0, None));
        assert!(!is_about(&[], 0, None));
    }
}
