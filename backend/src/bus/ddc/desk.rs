//! What pages that follow a network get: the newest of each unit, never an old one.

use crate::bus::board::Board;
use crate::config::{BusConfig, DdcConfig, DeviceConfig};
use shared::ddc100::Setup;
use shared::proto::{DdcNews, DdcUnit};
use tokio::sync::watch;

/// The newest news of a network.
pub(super) struct Desk {
    board: Board,
    ports: [usize; 2],
    poll: usize,
    pass: usize,
    units: Vec<usize>,
}

impl Desk {
    /// A desk for so many units; `activity` is told of every change.
    pub fn new(units: usize, activity: watch::Sender<u64>) -> Self {
        let board = Board::new(activity);
        // The network itself comes first: who follows it needs it before anything else.
        let network = board.slot();
        debug_assert_eq!(network, NETWORK);
        Self {
            ports: [board.slot(), board.slot()],
            poll: board.slot(),
            pass: board.slot(),
            units: (0..units).map(|_| board.slot()).collect(),
            board,
        }
    }

    /// Where pages read it.
    pub fn board(&self) -> Board {
        self.board.clone()
    }

    /// Puts up what there is to say; `at` is the place of the unit for news about one.
    pub fn say(&self, news: DdcNews, at: usize) {
        let slot = match &news {
            DdcNews::Network { .. } => Some(NETWORK),
            DdcNews::Unit { .. } => self.units.get(at).copied(),
            DdcNews::Poll { .. } => Some(self.poll),
            DdcNews::Pass { .. } => Some(self.pass),
            DdcNews::Port { port: 1, .. } => self.ports.first().copied(),
            DdcNews::Port { .. } => self.ports.last().copied(),
            // It belongs to the page that asked.
            DdcNews::Read { .. } => None,
        };
        if let Some(slot) = slot {
            self.board.post_text(slot, news.to_text().into());
        }
    }
}

/// The first place on the board.
const NETWORK: usize = 0;

/// How a network is made up, for pages.
pub(super) fn network(
    bus: &BusConfig,
    ddc: &DdcConfig,
    devices: &[DeviceConfig],
    setup: &Setup,
    timeout_ms: u32,
) -> DdcNews {
    let ms = |time: std::time::Duration| u32::try_from(time.as_millis()).unwrap_or(u32::MAX);
    let unit = |device: &DeviceConfig| DdcUnit {
        unit: device.unit,
        kind: device.device.key().into(),
        tag: device.tag.clone(),
        description: device.description.clone(),
        scaling: ddc.scalings.get(&device.unit).map(|s| s.key().into()),
    };
    let port = |path: &str| ddc.serial(path).to_string();
    DdcNews::Network {
        bus: bus.name.clone(),
        shape: ddc.shape,
        framing: ddc.framing.key().into(),
        baud: ddc.baud,
        ports: ddc.paths().into_iter().map(port).collect(),
        start: ddc.start,
        count: ddc.count,
        turn_ms: ms(bus.turnaround),
        timeout_ms,
        retries: bus.retries,
        units: devices.iter().map(unit).collect(),
        hint: setup.hint().map(|hint| hint.to_string()),
    }
}
