//! Buses and devices, with what is kept of each.

use shared::device::Device;
use shared::frame::Framing;
use shared::image::Image;
use shared::proto::{Bus, DeviceInfo, LineState, Outcome};
use shared::session::Session;

use crate::state::job::Job;
use crate::state::overview::{Figure, Overview};

/// A bus as the page knows it.
#[derive(Clone, Debug)]
pub struct BusState {
    /// Its configuration.
    pub info: Bus,
    /// State of its line.
    pub line: LineState,
    /// What happened to the line, in words.
    pub line_text: String,
    /// Its frames.
    pub session: Session,
    /// Sequence number of the last capture.
    pub last_seq: Option<u64>,
    /// Captures that were lost on the way to the page.
    pub missed: u64,
}

impl BusState {
    /// False for a bus whose frames only a program of its own can decode.
    #[must_use]
    pub fn is_known(&self) -> bool {
        Framing::from_key(&self.info.framing).is_some()
    }

    pub(super) fn new(info: Bus) -> Self {
        let framing = Framing::from_key(&info.framing).unwrap_or_default();
        Self {
            info,
            line: LineState::Starting,
            line_text: String::new(),
            session: Session::new(framing),
            last_seq: None,
            missed: 0,
        }
    }
}

/// A device as the page knows it.
#[derive(Clone, Debug)]
pub struct DeviceState {
    /// Its configuration.
    pub info: DeviceInfo,
    /// Its kind.
    pub device: Device,
    /// Its values.
    pub image: Image,
    /// The position of a HART device, as it was polled for the list last.
    pub position: Option<Figure>,
    /// How its last read ended.
    pub outcome: Option<Outcome>,
    /// The same in words.
    pub text: String,
    /// When it last answered well, in microseconds since the start of the backend.
    pub last_ok: Option<u64>,
    /// How long its last answer took.
    pub latency: Option<u64>,
    /// Reading under way or just over.
    pub job: Option<Job>,
}

impl DeviceState {
    pub(super) fn new(info: DeviceInfo) -> Self {
        Self {
            device: Device::from_key(&info.kind).unwrap_or_default(),
            info,
            image: Image::new(),
            position: None,
            outcome: None,
            text: String::new(),
            last_ok: None,
            latency: None,
            job: None,
        }
    }

    /// What it says about itself.
    #[must_use]
    pub fn overview(&self) -> Overview {
        let seen = Overview::of(self.device, &self.image);
        let position = seen.position.or_else(|| self.position.clone());
        Overview { position, ..seen }
    }

    /// True for a unit of a DDC-100 network.
    #[must_use]
    pub fn is_ddc(&self) -> bool {
        self.info.kind.starts_with("ddc100")
    }

    /// True for a device on a HART line, which has a program of its own.
    #[must_use]
    pub const fn is_hart(&self) -> bool {
        self.device.family().is_some()
    }

    /// True for a device whose page is drawn by the program of diagnostic objects.
    #[must_use]
    pub fn is_dop(&self) -> bool {
        self.info.kind == "dop"
    }
}
