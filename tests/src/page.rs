//! A page without a browser: speaks the WebSocket protocol and decodes what comes.

use std::collections::VecDeque;
use std::net::{SocketAddr, TcpStream};
use std::time::{Duration, Instant};

use shared::capture::{Capture, Direction, Micros};
use shared::frame::{Framing, Role};
use shared::proto::{
    Block, DdcNews, DopAsk, DopNews, IconAsk, IconNews, IconStep, Outcome, ToBackend, ToPage,
    VERSION, Way,
};
use shared::session::Session;
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket};

/// How long an answer may take.
const PATIENCE: Duration = Duration::from_secs(15);

/// A connection to a backend, past its greeting.
#[derive(Debug)]
pub struct Page {
    socket: WebSocket<MaybeTlsStream<TcpStream>>,
    session: Session,
    /// News about diagnostic objects that nobody has looked at yet.
    news: VecDeque<DopNews>,
    /// News about an ICON3000 that nobody has looked at yet.
    icon: VecDeque<IconNews>,
    /// News about DDC-100 networks that nobody has looked at yet.
    networks: VecDeque<DdcNews>,
}

impl Page {
    /// Connects, says hello, and subscribes to a bus.
    ///
    /// # Panics
    ///
    /// If the backend does not take the connection or speaks another version.
    #[must_use]
    pub fn open(address: SocketAddr, bus: &str, framing: Framing) -> Self {
        let (socket, _) = tungstenite::connect(format!("ws://{address}/ws")).expect("a WebSocket");
        if let MaybeTlsStream::Plain(stream) = socket.get_ref() {
            stream
                .set_read_timeout(Some(PATIENCE))
                .expect("a time-out can be set");
        }
        let mut page = Self {
            socket,
            session: Session::new(framing),
            news: VecDeque::new(),
            icon: VecDeque::new(),
            networks: VecDeque::new(),
        };
        page.send(&ToBackend::Hello { version: VERSION });
        page.send(&ToBackend::Subscribe {
            bus: bus.to_owned(),
            after: None,
        });
        page
    }

    /// Sends a message.
    ///
    /// # Panics
    ///
    /// If the connection is gone.
    pub fn send(&mut self, message: &ToBackend) {
        let text = serde_json::to_string(message).expect("messages are JSON");
        self.socket
            .send(Message::text(text))
            .expect("the backend listens");
    }

    /// The next message; captures go into the session first.
    ///
    /// # Panics
    ///
    /// If none comes in time, or if it is not of the protocol.
    pub fn receive(&mut self) -> ToPage {
        loop {
            if let Some(message) = self.receive_any() {
                return message;
            }
        }
    }

    /// The next message; `None` if it was for a program of the page, and is kept.
    fn receive_any(&mut self) -> Option<ToPage> {
        loop {
            let text = match self.socket.read().expect("a message in time") {
                Message::Text(text) => text,
                Message::Ping(_) | Message::Pong(_) => continue,
                other => panic!("unexpected {other:?}"),
            };
            if let Some(news) = DopNews::from_text(&text) {
                self.news.push_back(news);
                return None;
            }
            if let Some(news) = IconNews::from_text(&text) {
                self.icon.push_back(news);
                return None;
            }
            if let Some(news) = DdcNews::from_text(&text) {
                self.networks.push_back(news);
                return None;
            }
            let message: ToPage = serde_json::from_str(&text).expect("a message of the protocol");
            if let ToPage::Capture {
                at_us,
                way,
                ends,
                hex,
                ..
            } = &message
            {
                let bytes = shared::text::read_hex(hex.as_bytes()).0;
                let direction = match way {
                    Way::Tx => Direction::ToDevice,
                    Way::Rx => Direction::FromDevice,
                };
                let at = Some(Micros::new(*at_us));
                self.session.push(&Capture {
                    bytes: &bytes,
                    at,
                    direction,
                    ends: *ends,
                });
            }
            return Some(message);
        }
    }

    /// Reads a block of a device; how it ended, in a word and in words.
    ///
    /// # Panics
    ///
    /// If no answer comes in time.
    pub fn read(&mut self, device: &str, block: Block) -> (Outcome, String) {
        const ID: u32 = 77;
        self.send(&ToBackend::Read {
            id: ID,
            device: device.to_owned(),
            block,
        });
        let start = Instant::now();
        let before = self.responses();
        let mut done = None;
        while start.elapsed() < PATIENCE {
            // The answer is told and its bytes are shown on two ways; either may be first.
            match done {
                Some((Outcome::Ok, text)) if self.responses() > before => {
                    return (Outcome::Ok, text);
                }
                Some((outcome, text)) if outcome != Outcome::Ok => return (outcome, text),
                other => done = other,
            }
            if let ToPage::Done {
                id: ID,
                outcome,
                text,
            } = self.receive()
            {
                done = Some((outcome, text));
            }
        }
        panic!("no end of the read within {PATIENCE:?}; so far {done:?}");
    }

    /// Reads diagnostic objects of a device; what came of them, in order, without the steps.
    ///
    /// # Panics
    ///
    /// If they are not read in time.
    pub fn objects(&mut self, device: &str, requests: &[u16]) -> Vec<DopNews> {
        const ID: u32 = 78;
        self.send(&ToBackend::Dop(DopAsk::Read {
            id: ID,
            device: device.to_owned(),
            requests: requests.to_vec(),
        }));
        let mut found = Vec::new();
        loop {
            match self.next_news() {
                DopNews::Done { id: ID, .. } => return found,
                DopNews::Progress { .. } | DopNews::Profile { .. } => {}
                news => found.push(news),
            }
        }
    }

    /// Reads files, identity or counters of a device; the response PDU of each request, and how it
    /// ended.
    ///
    /// # Panics
    ///
    /// If they are not read in time.
    pub fn steps(&mut self, device: &str, steps: &[IconStep]) -> Vec<(Outcome, String)> {
        const ID: u32 = 79;
        self.send(&ToBackend::Icon(IconAsk::Read {
            id: ID,
            device: device.to_owned(),
            steps: steps.to_vec(),
        }));
        let (start, mut found) = (Instant::now(), Vec::new());
        loop {
            match self.icon.pop_front() {
                Some(IconNews::Done { id: ID, .. }) => return found,
                Some(IconNews::Exchange {
                    outcome, response, ..
                }) => found.push((outcome, response)),
                Some(_) => {}
                None => {
                    assert!(start.elapsed() < PATIENCE, "no news within {PATIENCE:?}");
                    let _other = self.receive_any();
                }
            }
        }
    }

    /// The next news about diagnostic objects.
    fn next_news(&mut self) -> DopNews {
        let start = Instant::now();
        loop {
            if let Some(news) = self.news.pop_front() {
                return news;
            }
            assert!(start.elapsed() < PATIENCE, "no news within {PATIENCE:?}");
            // Ticks come every two seconds, so this ends.
            let _other = self.receive_any();
        }
    }

    /// Waits for the news about a DDC-100 network that `find` finds.
    ///
    /// # Panics
    ///
    /// If it does not come in time.
    pub fn network<T>(&mut self, mut find: impl FnMut(DdcNews) -> Option<T>) -> T {
        let start = Instant::now();
        loop {
            while let Some(news) = self.networks.pop_front() {
                if let Some(found) = find(news) {
                    return found;
                }
            }
            assert!(start.elapsed() < PATIENCE, "no news within {PATIENCE:?}");
            // Ticks come every two seconds, so this ends.
            let _other = self.receive_any();
        }
    }

    /// Frames of the bus decoded so far.
    #[must_use]
    pub const fn session(&self) -> &Session {
        &self.session
    }

    /// How many sound responses were on the bus so far.
    fn responses(&self) -> usize {
        (self.session.first()..self.session.len())
            .filter(|i| self.is_response(*i))
            .count()
    }

    fn is_response(&self, index: u32) -> bool {
        let frame = self.session.frame(index);
        frame.is_some_and(|f| f.role == Role::Response && !f.marks.is_damaged())
    }

    /// The data bytes of the last sound response on the bus.
    #[must_use]
    pub fn last_data(&self) -> Option<Vec<u8>> {
        let session = &self.session;
        let index = (session.first()..session.len())
            .rev()
            .find(|i| self.is_response(*i))?;
        let pdu = shared::decode::pdu_of(session.bytes(index)?, session.framing())?;
        pdu.get(2..).map(<[u8]>::to_vec)
    }
}
