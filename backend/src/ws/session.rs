//! One page: what it asks for, and what it gets.
//!
//! A page has no queue here. It remembers how far it has come in the ring of each bus and on the
//! board; when it can take more, it gets what followed. A page that takes nothing is let go.

mod ddc;
mod dop;
mod hart;
mod icon;

use crate::bus::board::Board;
use crate::bus::recorder::{Recorder, encode};
use crate::bus::{ClientId, Command, Outlet};
use crate::plant::Plant;
use axum::extract::ws::{Message, Utf8Bytes};
use futures_util::{Sink, SinkExt, Stream, StreamExt};
use shared::encode::Read;
use shared::proto::{Block, MIN_PERIOD_MS, Outcome, ToBackend, ToPage, VERSION};
use std::time::Duration;
use tokio::sync::mpsc;
use tokio::time::{Instant, MissedTickBehavior, interval, timeout};

/// A page that takes nothing, or is not heard, for so long is let go.
const PATIENCE: Duration = Duration::from_secs(10);
/// How often the clock is sent.
const TICK: Duration = Duration::from_secs(2);
/// Captures that are sent before anything else is looked at.
const BATCH: usize = 64;
/// Reads of one page that may be under way.
const MAX_READS: usize = 256;
/// Blocks that one page may watch on one device.
const MAX_BLOCKS: usize = 64;
/// Slowest period of a watch.
const MAX_PERIOD_MS: u32 = 3_600_000;

/// Why a session is over.
#[derive(Debug, PartialEq, Eq)]
enum End {
    /// The page is gone, or takes nothing any more.
    Gone,
    /// The page said something that it may not say.
    Refused(String),
}

/// Talks to a page until it is gone.
pub(super) async fn run<S, E>(mut socket: S, plant: &Plant)
where
    S: Stream<Item = Result<Message, E>> + Sink<Message, Error = E> + Unpin,
{
    let client = plant.client();
    let end = session(&mut socket, plant, client).await;
    for bus in plant.buses() {
        bus.ask(Command::Leave { client }).await;
    }
    if let End::Refused(text) = end {
        let refused = encode(&ToPage::Refused { text });
        let farewell = async {
            socket.send(Message::Text(refused)).await?;
            socket.close().await
        };
        // It may be gone already.
        let _end = timeout(PATIENCE, farewell).await;
    }
}

async fn session<S, E>(socket: &mut S, plant: &Plant, client: ClientId) -> End
where
    S: Stream<Item = Result<Message, E>> + Sink<Message, Error = E> + Unpin,
{
    let mut activity = plant.activity();
    let (done, mut finished) = mpsc::channel(MAX_READS);
    let (outlet, mut told) = mpsc::channel(Outlet::SIZE);
    let mut page = Page {
        plant,
        client,
        done,
        outlet: Outlet::new(outlet),
        reads: 0,
        subscriptions: Vec::new(),
        networks: Vec::new(),
        seen: 0,
    };
    if let Err(end) = greet(socket, plant).await {
        return end;
    }
    let mut tick = interval(TICK);
    tick.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let mut heard = Instant::now();
    loop {
        activity.mark_unchanged();
        let mut messages = page.news();
        let event = async {
            tokio::select! {
                incoming = socket.next() => Event::Heard(incoming.and_then(Result::ok)),
                // The sender is part of the page: there always is one.
                message = finished.recv() => Event::Done(message),
                text = told.recv() => Event::Told(text),
                changed = activity.changed() => Event::News(changed.is_ok()),
                _ = tick.tick() => Event::Tick,
            }
        };
        // A page that has much to take is listened to all the same.
        let event = if messages.is_empty() {
            Some(event.await)
        } else {
            now(event).await
        };
        match event {
            None | Some(Event::News(true)) => {}
            Some(Event::News(false) | Event::Heard(None)) => return End::Gone,
            Some(Event::Heard(Some(message))) => {
                heard = Instant::now();
                match page.hear(message).await {
                    Ok(answer) => messages.extend(answer),
                    Err(end) => return end,
                }
            }
            Some(Event::Done(message)) => {
                page.reads = page.reads.saturating_sub(1);
                messages.extend(message);
            }
            Some(Event::Told(text)) => messages.extend(text),
            Some(Event::Tick) => {
                let now_us = plant.clock().now().get();
                messages.push(encode(&ToPage::Tick { now_us }));
                // The browser answers by itself, so that a page that is gone is noticed.
                let ping = Message::Ping(Vec::new().into());
                if heard.elapsed() > PATIENCE || send(socket, ping).await.is_err() {
                    return End::Gone;
                }
            }
        }
        for text in messages {
            if send(socket, Message::Text(text)).await.is_err() {
                return End::Gone;
            }
        }
    }
}

/// What a session waits for.
enum Event {
    /// The page said something; `None`: it is gone.
    Heard(Option<Message>),
    /// A read is over.
    Done(Option<Utf8Bytes>),
    /// News for a program that the page has loaded.
    Told(Option<Utf8Bytes>),
    /// There is something new; false: there never will be.
    News(bool),
    /// The clock is due.
    Tick,
}

/// The value of a future if it is there already.
async fn now<T>(future: impl Future<Output = T>) -> Option<T> {
    tokio::select! {
        biased;
        value = future => Some(value),
        () = std::future::ready(()) => None,
    }
}

/// Sends one message; an error means that the page is gone or takes nothing.
async fn send<S, E>(socket: &mut S, message: Message) -> Result<(), End>
where
    S: Sink<Message, Error = E> + Unpin,
{
    match timeout(PATIENCE, socket.send(message)).await {
        Ok(Ok(())) => Ok(()),
        _ => Err(End::Gone),
    }
}

/// Both sides say who they are.
async fn greet<S, E>(socket: &mut S, plant: &Plant) -> Result<(), End>
where
    S: Stream<Item = Result<Message, E>> + Sink<Message, Error = E> + Unpin,
{
    send(socket, Message::Text(encode(&plant.hello()))).await?;
    let first = async {
        loop {
            match socket.next().await {
                Some(Ok(Message::Ping(_) | Message::Pong(_))) => {}
                other => return other,
            }
        }
    };
    let Ok(Some(Ok(message))) = timeout(PATIENCE, first).await else {
        return Err(End::Gone);
    };
    let refuse = |text: String| Err(End::Refused(text));
    let Message::Text(text) = message else {
        return refuse("The first message must be `hello`.".into());
    };
    match serde_json::from_str(&text) {
        Ok(ToBackend::Hello { version: VERSION }) => Ok(()),
        Ok(ToBackend::Hello { version }) => refuse(format!(
            "The page speaks version {version} of the protocol, this program version {VERSION}; \
             reload the page."
        )),
        _ => refuse("The first message must be `hello`.".into()),
    }
}

/// What a page wants and has.
struct Page<'a> {
    plant: &'a Plant,
    client: ClientId,
    done: mpsc::Sender<Utf8Bytes>,
    /// Takes what the programs that this page may have loaded wait for.
    outlet: Outlet,
    /// Reads under way.
    reads: usize,
    subscriptions: Vec<Subscription>,
    /// DDC-100 networks that the page follows.
    networks: Vec<Followed>,
    /// Version of the board that it has seen.
    seen: u64,
}

/// A DDC-100 network of which the page gets the newest.
struct Followed {
    bus: String,
    news: Board,
    /// Version of the news that it has seen.
    seen: u64,
}

/// A bus whose captures the page gets.
struct Subscription {
    bus: String,
    recorder: Recorder,
    /// The last capture that it got.
    last: u64,
}

impl Page<'_> {
    /// What is new for this page, and not too much of it at a time.
    fn news(&mut self) -> Vec<Utf8Bytes> {
        let (mut messages, seen) = self.plant.board().news(self.seen);
        self.seen = seen;
        for network in &mut self.networks {
            let (news, seen) = network.news.news(network.seen);
            network.seen = seen;
            messages.extend(news);
        }
        for subscription in &mut self.subscriptions {
            let pulled = subscription.recorder.after(subscription.last, BATCH);
            if pulled.missed > 0 {
                messages.push(encode(&ToPage::Lagged {
                    bus: subscription.bus.clone(),
                    missed: pulled.missed,
                }));
            }
            subscription.last = pulled.last;
            messages.extend(pulled.messages);
        }
        messages
    }

    /// Does what a message says; gives the answer to it, if there is one at once.
    async fn hear(&mut self, message: Message) -> Result<Option<Utf8Bytes>, End> {
        let text = match message {
            Message::Text(text) => text,
            Message::Close(_) => return Err(End::Gone),
            Message::Ping(_) | Message::Pong(_) => return Ok(None),
            Message::Binary(_) => return Err(End::Refused("Messages are JSON text.".into())),
        };
        let message = match serde_json::from_str(&text) {
            Ok(message) => message,
            Err(error) => {
                return Ok(Some(refused(format!(
                    "The message is not understood: {error}"
                ))));
            }
        };
        Ok(self.obey(message).await)
    }

    async fn obey(&mut self, message: ToBackend) -> Option<Utf8Bytes> {
        let answer = match message {
            ToBackend::Hello { .. } => None,
            ToBackend::Subscribe { bus, after } => self.subscribe(bus, after),
            ToBackend::Unsubscribe { bus } => {
                self.subscriptions.retain(|s| s.bus != bus);
                None
            }
            ToBackend::Read { id, device, block } => self.read(id, &device, block).await,
            ToBackend::Watch {
                device,
                blocks,
                period_ms,
            } => self.watch(&device, &blocks, period_ms).await,
            ToBackend::Dop(ask) => self.dop(ask).await,
            ToBackend::Ddc(ask) => return self.ddc(ask).await,
            ToBackend::Icon(ask) => self.icon(ask).await,
            ToBackend::Hart(ask) => self.hart(ask).await,
        };
        answer.as_ref().map(encode)
    }

    fn subscribe(&mut self, bus: String, after: Option<u64>) -> Option<ToPage> {
        let Some(handle) = self.plant.bus(&bus) else {
            return Some(unknown("bus", &bus));
        };
        self.subscriptions.retain(|s| s.bus != bus);
        let recorder = handle.recorder().clone();
        let newest = recorder.last();
        // A number from before a restart says nothing here.
        let last = match after {
            Some(after) if after <= newest => after,
            // Whoever has nothing gets what is kept, and missed nothing.
            _ => recorder.after(0, 0).missed,
        };
        self.subscriptions.push(Subscription {
            bus,
            recorder,
            last,
        });
        None
    }

    async fn read(&mut self, id: u32, tag: &str, block: Block) -> Option<ToPage> {
        let done = |text: String| {
            Some(ToPage::Done {
                id,
                outcome: Outcome::Refused,
                text,
            })
        };
        let Some((bus, device)) = self.plant.device(tag) else {
            return done(format!("There is no device \"{tag}\"."));
        };
        let Some(read) = block.read() else {
            return done(not_allowed(block));
        };
        if self.reads >= MAX_READS {
            return done(format!(
                "{MAX_READS} reads are under way already; wait for them."
            ));
        }
        self.reads += 1;
        let sender = self.done.clone();
        let reply = Box::new(move |report: crate::bus::Report| {
            // There is room: no more reads are under way than the channel holds. The page may be
            // gone, though.
            let _gone = sender.try_send(encode(&ToPage::Done {
                id,
                outcome: report.outcome,
                text: report.text,
            }));
        });
        let command = Command::Read {
            device,
            query: read.into(),
            reply,
        };
        bus.ask(command).await;
        None
    }

    async fn watch(&mut self, tag: &str, blocks: &[Block], period_ms: u32) -> Option<ToPage> {
        let refuse = |text: String| Some(ToPage::Refused { text });
        let Some((bus, device)) = self.plant.device(tag) else {
            return Some(unknown("device", tag));
        };
        if blocks.len() > MAX_BLOCKS {
            return refuse(format!(
                "{} blocks are too many; watch at most {MAX_BLOCKS} on a device.",
                blocks.len()
            ));
        }
        if let Some(bad) = blocks.iter().find(|b| b.read().is_none()) {
            return refuse(not_allowed(*bad));
        }
        let reads: Vec<Read> = blocks.iter().filter_map(|b| b.read()).collect();
        let period = period_ms.clamp(MIN_PERIOD_MS, MAX_PERIOD_MS);
        let command = Command::Watch {
            client: self.client,
            device,
            reads,
            period: Duration::from_millis(period.into()),
        };
        bus.ask(command).await;
        None
    }
}

fn refused(text: String) -> Utf8Bytes {
    encode(&ToPage::Refused { text })
}

fn unknown(what: &str, name: &str) -> ToPage {
    ToPage::Refused {
        text: format!("There is no {what} \"{name}\"; reload the page."),
    }
}

fn not_allowed(block: Block) -> String {
    format!(
        "{} values from address {} can't be read at once; one request reads 1 to 125 registers or \
         1 to 2000 bits, up to address 65535.",
        block.count, block.start
    )
}

#[cfg(test)]
mod tests;
