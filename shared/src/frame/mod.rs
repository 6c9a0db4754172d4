//! Framing: where frames begin and end in a stream of bytes, and what lies between them.
//!
//! **Invariants**
//! - Frames and noise tile the input: no byte is lost, none is used twice.
//! - The result does not depend on how the stream was cut into pieces: a decision is made only
//!   when [`LOOKAHEAD`] bytes or the end of the stream are in view.
//! - Scanning allocates nothing per frame.

pub mod ascii;
pub mod check;
mod detect;
mod look;
mod rtu;
mod tcp;

pub use detect::detect;
pub use look::is_hart;

use crate::capture::Direction;
use crate::transaction::Pairing;

/// How many bytes from a frame's first are looked at before a decision is made: the longest
/// frame, and one behind it that shows whether the first ended where it should.
pub const LOOKAHEAD: usize = 1200;

/// False in a program that shows no registers: all bytes of Modbus are noise to it.
const MODBUS: bool = cfg!(feature = "maps");

/// How frames are marked off on the wire.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Framing {
    /// Modbus RTU: unit, PDU, CRC. Source: Modbus over Serial Line V1.02, section 2.5.1.
    #[default]
    Rtu,
    /// Modbus ASCII: colon, hexadecimal characters, LRC, CR LF. Same document, section 2.5.2.
    Ascii,
    /// Modbus TCP: MBAP header, PDU. Source: Modbus Messaging on TCP/IP V1.0b, section 3.1.3.
    Tcp,
    /// HART: preamble, delimiter, address, command, count, data, check byte.
    #[cfg(feature = "hart")]
    Hart,
    /// HART-IP: a header of eight bytes, then a frame from delimiter to check byte, or commands.
    #[cfg(feature = "hart")]
    HartIp,
}

impl Framing {
    /// The framings of Modbus.
    pub const MODBUS: [Self; 3] = [Self::Rtu, Self::Ascii, Self::Tcp];
    /// All framings.
    #[cfg(feature = "hart")]
    pub const ALL: [Self; 5] = [Self::Rtu, Self::Ascii, Self::Tcp, Self::Hart, Self::HartIp];
    /// All framings.
    #[cfg(not(feature = "hart"))]
    pub const ALL: [Self; 3] = Self::MODBUS;

    /// The word used in JSON and on the command line: `modbus-rtu`.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Rtu => "modbus-rtu",
            Self::Ascii => "modbus-ascii",
            Self::Tcp => "modbus-tcp",
            #[cfg(feature = "hart")]
            Self::Hart => "hart",
            #[cfg(feature = "hart")]
            Self::HartIp => "hart-ip",
        }
    }

    /// The name shown to people.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Rtu => "Modbus RTU",
            Self::Ascii => "Modbus ASCII",
            Self::Tcp => "Modbus TCP",
            #[cfg(feature = "hart")]
            Self::Hart => "HART",
            #[cfg(feature = "hart")]
            Self::HartIp => "HART-IP",
        }
    }

    /// The framing with this [`key`](Self::key).
    #[must_use]
    pub fn from_key(key: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|f| f.key() == key)
    }
}

/// What a run of bytes is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Role {
    /// From the master.
    Request,
    /// A device's answer.
    Response,
    /// A device's refusal.
    Exception,
    /// What a device says unasked (HART).
    Burst,
    /// A frame of which nothing tells whether it is a request or a response.
    Unknown,
    /// Bytes that belong to no frame.
    Noise,
}

impl Role {
    /// The word used in JSON.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Request => "request",
            Self::Response => "response",
            Self::Exception => "exception",
            Self::Burst => "burst",
            Self::Unknown => "unknown",
            Self::Noise => "noise",
        }
    }
}

/// What framing noticed about a frame, as bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Marks(u8);

impl Marks {
    /// The check value does not hold.
    pub const BAD_CHECK: Self = Self(1);
    /// The frame ends too early.
    pub const TRUNCATED: Self = Self(2);
    /// The length is a guess that the check value supports.
    pub const GUESS: Self = Self(4);
    /// Valid in both roles.
    pub const AMBIGUOUS: Self = Self(8);
    /// Not in the form that the framing demands (line end, digits, protocol identifier, length).
    pub const MALFORMED: Self = Self(16);
    /// A response whose request was seen.
    pub const ANSWERED: Self = Self(32);
    /// The same request as directly before: an echo or a repetition (HART).
    pub const AGAIN: Self = Self(64);

    /// Both.
    #[must_use]
    pub const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// True if all bits of `other` are set.
    #[must_use]
    pub const fn has(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// True if the frame's bytes can't be trusted.
    #[must_use]
    pub const fn is_damaged(self) -> bool {
        self.0 & (Self::BAD_CHECK.0 | Self::TRUNCATED.0 | Self::MALFORMED.0) != 0
    }
}

/// Stands for "no other frame" in [`Frame::pair`].
const UNPAIRED: u32 = u32::MAX;

/// One entry of the index that [`scan`] builds: 24 bytes, no allocation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Place of the first byte in the stream.
    pub offset: u64,
    /// Number of bytes.
    pub len: u32,
    pair: u32,
    /// Unit address; 0 for noise.
    pub unit: u8,
    /// Function code, with the exception bit where it is set; 0 for noise.
    pub function: u8,
    /// What it is.
    pub role: Role,
    /// What framing noticed.
    pub marks: Marks,
}

impl Frame {
    /// One past the last byte.
    #[must_use]
    pub const fn end(&self) -> u64 {
        self.offset.saturating_add(u64_of(self.len))
    }

    /// Index of the request of this response, or of the response to this request.
    #[must_use]
    pub const fn pair(&self) -> Option<u32> {
        if self.pair == UNPAIRED {
            None
        } else {
            Some(self.pair)
        }
    }

    pub(crate) const fn set_pair(&mut self, index: u32) {
        self.pair = index;
    }

    /// True for bytes that belong to no frame.
    #[must_use]
    pub const fn is_noise(&self) -> bool {
        matches!(self.role, Role::Noise)
    }
}

/// Widens in const context, where `From` is not available.
#[expect(
    clippy::as_conversions,
    reason = "lossless, and `u64::from` is not const"
)]
const fn u64_of(value: u32) -> u64 {
    value as u64
}

/// What a framer found at the start of the bytes in view.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Found {
    pub len: usize,
    pub unit: u8,
    pub function: u8,
    pub role: Role,
    pub marks: Marks,
    /// Transaction identifier (TCP), else 0.
    pub transaction: u16,
}

impl Found {
    pub(crate) const fn noise(len: usize) -> Self {
        Self {
            len,
            unit: 0,
            function: 0,
            role: Role::Noise,
            marks: Marks(0),
            transaction: 0,
        }
    }
}

/// What a framer may know besides the bytes in view.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View<'a> {
    /// At most [`LOOKAHEAD`] bytes from the current position.
    pub bytes: &'a [u8],
    /// True if the stream ends with these bytes.
    pub at_end: bool,
    /// Which way they went.
    pub direction: Direction,
    /// Unit of the last good frame.
    pub last_unit: Option<u8>,
    /// The bytes follow a good frame, or a silence, directly.
    pub aligned: bool,
    /// So many bytes from here are known not to start a good frame.
    pub barren: usize,
}

/// Finds frames in a stream, one after the other.
#[derive(Clone, Debug)]
pub struct Scanner {
    framing: Framing,
    pairing: Pairing,
    last_unit: Option<u8>,
    aligned: bool,
    barren: usize,
    count: u32,
    #[cfg(feature = "hart")]
    hart: crate::hart::stream::Line,
    #[cfg(feature = "hart")]
    ip: crate::hart::ip::Sequence,
}

impl Scanner {
    /// A scanner at the start of a stream.
    #[must_use]
    pub const fn new(framing: Framing) -> Self {
        Self {
            framing,
            pairing: Pairing::new(),
            last_unit: None,
            aligned: true,
            barren: 0,
            count: 0,
            #[cfg(feature = "hart")]
            hart: crate::hart::stream::Line::new(),
            #[cfg(feature = "hart")]
            ip: crate::hart::ip::Sequence::new(),
        }
    }

    /// The framing that is looked for.
    #[must_use]
    pub const fn framing(&self) -> Framing {
        self.framing
    }

    /// Takes the next frame or run of noise from the start of `rest`, which begins `offset` bytes
    /// into the stream. `None` if more bytes are needed to decide.
    ///
    /// The frame found is entry number [`count`](Self::count) before the call. If it answers an
    /// earlier one, its [`pair`](Frame::pair) says which; the caller links the other direction.
    #[inline]
    pub fn next(
        &mut self,
        rest: &[u8],
        offset: u64,
        at_end: bool,
        direction: Direction,
    ) -> Option<Frame> {
        let (bytes, at_end) = match rest.get(..LOOKAHEAD) {
            Some(view) => (view, false),
            None if at_end => (rest, true),
            None => return None,
        };
        if bytes.is_empty() {
            return None;
        }
        let view = View {
            bytes,
            at_end,
            direction,
            last_unit: self.last_unit,
            aligned: self.aligned,
            barren: self.barren,
        };
        let (found, barren) = match self.framing {
            Framing::Rtu if MODBUS => rtu::next(&view, &self.pairing),
            Framing::Ascii if MODBUS => (ascii::next(&view, &self.pairing), 0),
            Framing::Tcp if MODBUS => (tcp::next(&view, &self.pairing), 0),
            Framing::Rtu | Framing::Ascii | Framing::Tcp => (Found::noise(bytes.len()), 0),
            #[cfg(feature = "hart")]
            Framing::Hart => crate::hart::stream::next(&view),
            #[cfg(feature = "hart")]
            Framing::HartIp => (crate::hart::ip::next(&view), 0),
        };
        // A framer that took nothing would never end.
        let len = found.len.clamp(1, bytes.len());
        self.barren = barren.saturating_sub(len);
        self.aligned = found.role != Role::Noise && !found.marks.is_damaged();
        let mut frame = Frame {
            offset,
            len: u32::try_from(len).unwrap_or(u32::MAX),
            pair: UNPAIRED,
            unit: found.unit,
            function: found.function,
            role: found.role,
            marks: found.marks,
        };
        if self.aligned {
            self.last_unit = Some(found.unit);
            if let Some(request) = self.settle(&found, bytes, &mut frame) {
                frame.pair = request;
                frame.marks = frame.marks.with(Marks::ANSWERED);
            }
        }
        self.count = self.count.saturating_add(1);
        Some(frame)
    }

    /// The request that a sound frame answers.
    #[inline]
    #[cfg_attr(
        not(feature = "hart"),
        expect(unused_variables, reason = "HART needs the bytes")
    )]
    fn settle(&mut self, found: &Found, bytes: &[u8], frame: &mut Frame) -> Option<u32> {
        #[cfg(feature = "hart")]
        if self.framing == Framing::Hart {
            let own = bytes.get(..found.len).unwrap_or(bytes);
            let (request, again) = self.hart.settle(own, self.count);
            if again {
                frame.marks = frame.marks.with(Marks::AGAIN);
            }
            return request;
        }
        #[cfg(feature = "hart")]
        if self.framing == Framing::HartIp {
            return self.ip.settle(found, self.count);
        }
        self.pairing.settle(found, self.framing, self.count)
    }

    /// Number of entries found so far.
    #[must_use]
    pub const fn count(&self) -> u32 {
        self.count
    }

    /// The last entry was joined to the one before it; it does not count.
    pub(crate) const fn uncount(&mut self) {
        self.count = self.count.saturating_sub(1);
    }

    /// The line was silent here: whatever comes next starts afresh.
    pub(crate) const fn silence(&mut self) {
        self.aligned = true;
        self.barren = 0;
    }
}

/// Builds the index of a whole stream that is in memory: frames and noise in order, paired.
#[must_use]
pub fn scan(bytes: &[u8], framing: Framing) -> Vec<Frame> {
    let mut index = Vec::with_capacity(bytes.len().checked_div(24).unwrap_or(0));
    scan_into(bytes, framing, &mut index);
    index
}

/// Like [`scan`], into a vector that is cleared first and whose memory is used again.
pub fn scan_into(bytes: &[u8], framing: Framing, index: &mut Vec<Frame>) {
    index.clear();
    let mut scanner = Scanner::new(framing);
    let mut rest = bytes;
    let mut offset = 0_u64;
    while let Some(frame) = scanner.next(rest, offset, true, Direction::Unknown) {
        let len = usize::try_from(frame.len).unwrap_or(usize::MAX);
        rest = rest.get(len..).unwrap_or(&[]);
        offset = frame.end();
        append(index, frame, &mut scanner);
    }
}

/// Adds an entry: joins noise to noise, links a response and its request both ways.
fn append(index: &mut Vec<Frame>, frame: Frame, scanner: &mut Scanner) {
    if let (true, Some(last)) = (frame.is_noise(), index.last_mut())
        && last.is_noise()
    {
        last.len = last.len.saturating_add(frame.len);
        scanner.uncount();
        return;
    }
    let here = u32::try_from(index.len()).unwrap_or(UNPAIRED);
    if let Some(request) = frame.pair()
        && let Some(entry) = usize::try_from(request)
            .ok()
            .and_then(|at| index.get_mut(at))
    {
        entry.pair = here;
    }
    index.push(frame);
}

/// Length of the MBAP header, unit address included.
pub(crate) const fn tcp_header() -> usize {
    tcp::HEADER
}
