use super::*;
use crate::config::Config;
use shared::proto::ToBackend;
use std::convert::Infallible;
use std::pin::Pin;
use std::task::{Context, Poll};

/// The backend's end of a socket in memory; the page takes so many messages and no more.
struct Socket {
    incoming: mpsc::UnboundedReceiver<Message>,
    outgoing: mpsc::UnboundedSender<Message>,
    takes: usize,
}

impl Stream for Socket {
    type Item = Result<Message, Infallible>;

    fn poll_next(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<Option<Self::Item>> {
        self.incoming.poll_recv(cx).map(|m| m.map(Ok))
    }
}

impl Sink<Message> for Socket {
    type Error = Infallible;

    fn poll_ready(self: Pin<&mut Self>, _: &mut Context<'_>) -> Poll<Result<(), Infallible>> {
        if self.takes == 0 {
            Poll::Pending
        } else {
            Poll::Ready(Ok(()))
        }
    }

    fn start_send(mut self: Pin<&mut Self>, message: Message) -> Result<(), Infallible> {
        self.takes -= 1;
        // A page that is gone hears nothing.
        let _gone = self.outgoing.send(message);
        Ok(())
    }

    fn poll_flush(self: Pin<&mut Self>, _: &mut Context<'_>) -> Poll<Result<(), Infallible>> {
        Poll::Ready(Ok(()))
    }

    fn poll_close(self: Pin<&mut Self>, _: &mut Context<'_>) -> Poll<Result<(), Infallible>> {
        Poll::Ready(Ok(()))
    }
}

/// A page that takes so many messages, and a session with it.
fn page(
    takes: usize,
) -> (
    mpsc::UnboundedSender<Message>,
    mpsc::UnboundedReceiver<Message>,
    Socket,
) {
    let (say, incoming) = mpsc::unbounded_channel();
    let (outgoing, hear) = mpsc::unbounded_channel();
    let socket = Socket {
        incoming,
        outgoing,
        takes,
    };
    (say, hear, socket)
}

fn text(message: &ToBackend) -> Message {
    Message::text(serde_json::to_string(message).unwrap())
}

fn subscribe() -> Message {
    text(&ToBackend::Subscribe {
        bus: "Simulated plant".into(),
        after: None,
    })
}

fn watch() -> Message {
    let block = Block {
        table: shared::proto::TableName::Holding,
        start: 3000,
        count: 30,
    };
    text(&ToBackend::Watch {
        device: "XV-101".into(),
        blocks: vec![block],
        period_ms: 100,
    })
}

const HELLO: ToBackend = ToBackend::Hello { version: VERSION };

/// A page that is not heard any more is let go, and its watch ends with it.
#[tokio::test(start_paused = true)]
async fn a_page_that_is_gone_is_let_go() {
    let plant = Plant::start(&Config::simulated());
    let (say, mut hear, socket) = page(usize::MAX);
    for message in [text(&HELLO), subscribe(), watch()] {
        say.send(message).unwrap();
    }
    let began = Instant::now();
    run(socket, &plant).await;
    let took = began.elapsed();
    assert!(took >= PATIENCE && took <= PATIENCE + 2 * TICK, "{took:?}");
    let mut ticks = 0;
    let mut captures = 0;
    while let Ok(message) = hear.try_recv() {
        if let Message::Text(text) = message {
            match serde_json::from_str(&text).unwrap() {
                ToPage::Tick { .. } => ticks += 1,
                ToPage::Capture { .. } => captures += 1,
                _ => {}
            }
        }
    }
    assert!(
        ticks >= 5 && captures > 100,
        "{ticks} ticks, {captures} captures"
    );
    // What nobody watches is not read.
    tokio::time::sleep(Duration::from_secs(1)).await;
    let recorder = plant.buses().next().unwrap().recorder().clone();
    let before = recorder.last();
    tokio::time::sleep(Duration::from_secs(5)).await;
    assert_eq!(recorder.last(), before);
}

/// A page that takes nothing is dropped after ten seconds, however much there would be to say.
#[tokio::test(start_paused = true)]
async fn a_page_that_takes_nothing_is_dropped() {
    let plant = Plant::start(&Config::simulated());
    for takes in [0, 1, 20] {
        let (say, _hear, socket) = page(takes);
        for message in [text(&HELLO), subscribe(), watch()] {
            say.send(message).unwrap();
        }
        let alive = {
            let say = say.clone();
            tokio::spawn(async move {
                while say.send(Message::Pong(Vec::new().into())).is_ok() {
                    tokio::time::sleep(TICK).await;
                }
            })
        };
        let began = Instant::now();
        run(socket, &plant).await;
        let took = began.elapsed();
        assert!(took >= PATIENCE, "{took:?}");
        assert!(took <= PATIENCE + Duration::from_secs(8), "{took:?}");
        alive.abort();
    }
}

/// A page that lives gets everything in order and without holes, for hours.
#[tokio::test(start_paused = true)]
async fn a_page_that_lives_stays() {
    let plant = Plant::start(&Config::simulated());
    let (say, mut hear, socket) = page(usize::MAX);
    for message in [text(&HELLO), subscribe(), watch()] {
        say.send(message).unwrap();
    }
    let reader = tokio::spawn(async move {
        let mut seq = 0;
        let until = Instant::now() + Duration::from_secs(600);
        while let Some(message) = hear.recv().await {
            match message {
                Message::Ping(data) => say.send(Message::Pong(data)).unwrap(),
                Message::Text(text) => match serde_json::from_str(&text).unwrap() {
                    ToPage::Capture { seq: number, .. } => {
                        seq += 1;
                        assert_eq!(number, seq);
                    }
                    ToPage::Lagged { missed, .. } => panic!("missed {missed}"),
                    _ => {}
                },
                _ => {}
            }
            if Instant::now() > until {
                break;
            }
        }
        seq
    });
    run(socket, &plant).await;
    let seen = reader.await.unwrap();
    assert!(seen > 10_000, "{seen}");
}

#[tokio::test(start_paused = true)]
async fn a_page_that_says_nothing_is_not_waited_for() {
    let plant = Plant::start(&Config::simulated());
    let (_say, _hear, socket) = page(usize::MAX);
    let began = Instant::now();
    run(socket, &plant).await;
    assert_eq!(began.elapsed().as_secs(), PATIENCE.as_secs());
}

/// More reads than may be under way are refused, one by one, and the others are done.
#[tokio::test(start_paused = true)]
async fn reads_of_a_page_are_limited() {
    let plant = Plant::start(&Config::simulated());
    let (say, mut hear, socket) = page(usize::MAX);
    say.send(text(&HELLO)).unwrap();
    let block = Block {
        table: shared::proto::TableName::Holding,
        start: 3000,
        count: 1,
    };
    for id in 0..400 {
        let device = "XV-101".into();
        say.send(text(&ToBackend::Read { id, device, block }))
            .unwrap();
    }
    run(socket, &plant).await;
    let (mut ok, mut refused) = (0, 0);
    while let Ok(message) = hear.try_recv() {
        let Message::Text(text) = message else {
            continue;
        };
        if let Ok(ToPage::Done { outcome, .. }) = serde_json::from_str(&text) {
            ok += u32::from(outcome == Outcome::Ok);
            refused += u32::from(outcome == Outcome::Refused);
        }
    }
    assert_eq!(ok + refused, 400);
    assert!(refused > 0 && ok >= 256, "{ok} done, {refused} refused");
}
