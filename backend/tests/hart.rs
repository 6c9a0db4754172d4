//! HART lines: what is read from simulated devices, what of it reaches the line, and how a page
//! sees it.

mod common;

use axum::extract::ws::Utf8Bytes;
use backend::bus::board::Board;
use backend::bus::hart::Wish;
use backend::bus::recorder::Recorder;
use backend::bus::{self, ClientId, Command, Handle, Outlet, Plug};
use backend::clock::Clock;
use backend::config::hart::HartWay;
use backend::config::{BusConfig, Config, DeviceConfig, HartConfig};
use backend::sim::hart::Loop;
use shared::device::{Device, Family};
use shared::hart::link::{Target, overview};
use shared::proto::{HartAsk, HartCommand, HartNews, Outcome, ToPage};
use shared::render::hex;
use shared::sim::Programme;
use shared::sim::hart::{HartBurst, HartDevice, HartLine, HartMaster, HartSetup};
use std::time::Duration;
use tokio::io::DuplexStream;
use tokio::sync::{mpsc, watch};
use tokio::time::{Instant, timeout};

/// Simulated time is cheap.
const WAIT: Duration = Duration::from_secs(600);

fn device(tag: &str, family: Family, target: Target) -> DeviceConfig {
    DeviceConfig {
        tag: tag.into(),
        device: Device::Rotork(family),
        bus: 0,
        unit: match target {
            Target::Polling(polling) => polling,
            _ => 0,
        },
        description: String::new(),
        faults: Vec::new(),
        profile: None,
        target: Some(target),
    }
}

fn bus() -> BusConfig {
    HartConfig::of(HartWay::Simulated).bus("h")
}

/// A page without a socket.
struct Client {
    handle: Handle,
    id: ClientId,
    out: Outlet,
    news: mpsc::Receiver<Utf8Bytes>,
}

impl Client {
    fn of(handle: &Handle, id: u64) -> Self {
        let (sender, news) = mpsc::channel(Outlet::SIZE);
        Self {
            handle: handle.clone(),
            id: ClientId(id),
            out: Outlet::new(sender),
            news,
        }
    }

    async fn ask(&self, device: Option<usize>, ask: HartAsk) {
        let wish = Wish {
            client: self.id,
            device,
            ask,
            out: self.out.clone(),
        };
        assert!(self.handle.ask(Command::Hart(wish)).await);
    }

    async fn hear(&mut self) -> HartNews {
        let text = timeout(WAIT, self.news.recv()).await.expect("news");
        HartNews::from_text(&text.unwrap()).unwrap()
    }

    /// Everything up to the end of this id; then answered, failed and the words.
    async fn all(&mut self, id: u32) -> (Vec<HartNews>, u32, u32, String) {
        let mut news = Vec::new();
        loop {
            match self.hear().await {
                HartNews::Done {
                    id: over,
                    ok,
                    failed,
                    text,
                } if over == id => return (news, ok, failed, text),
                HartNews::Progress { .. } => {}
                other => news.push(other),
            }
        }
    }

    async fn read(
        &mut self,
        device: usize,
        commands: Vec<HartCommand>,
    ) -> (Vec<HartNews>, u32, u32, String) {
        let ask = HartAsk::Read {
            id: 1,
            device: String::new(),
            commands,
        };
        self.ask(Some(device), ask).await;
        self.all(1).await
    }
}

fn plain(number: u16) -> HartCommand {
    HartCommand {
        number,
        data: String::new(),
    }
}

fn setup(family: Family, polling: u8) -> HartSetup {
    HartSetup {
        polling,
        device_id: 0x01_2345 + u32::from(polling),
        programme: Programme::Modulating,
        ..HartSetup::of(family)
    }
}

fn line(devices: &[(&str, Family, u8)]) -> HartLine {
    let device = |(tag, family, polling): &(&str, Family, u8)| {
        HartDevice::new(tag, setup(*family, *polling))
    };
    HartLine::new(1200, devices.iter().map(device).collect())
}

fn start(bus: BusConfig, devices: &[DeviceConfig], plug: impl FnOnce(Clock) -> Plug) -> Handle {
    let (clock, activity) = (Clock::start(), watch::Sender::new(0));
    let board = Board::new(activity.clone());
    let recorder = Recorder::new("h", clock, activity);
    bus::hart::start(bus, devices, plug(clock), clock, board, recorder)
}

fn with(line: HartLine, devices: &[DeviceConfig]) -> Handle {
    start(bus(), devices, |clock| Plug::Loop(Loop::new(line, clock)))
}

/// What came of one command: the words, and the response.
fn exchange(news: &HartNews) -> (u16, Outcome, String, String, u8) {
    match news {
        HartNews::Exchange {
            command,
            outcome,
            text,
            response,
            tries,
            ..
        } => (*command, *outcome, text.clone(), response.clone(), *tries),
        other => panic!("{other:?}"),
    }
}

/// Every command of every family, found in each of the four ways, is sent once and answered.
#[tokio::test(start_paused = true)]
async fn everything_is_read_however_the_device_is_found() {
    for (family, target) in [
        (Family::Iq, Target::Polling(5)),
        (Family::Cva, Target::unique("AEDD01234A").unwrap()),
        (Family::Cma, Target::tag("FV-405").unwrap()),
        (Family::Ck, Target::long_tag("FV-405").unwrap()),
        (Family::Si, Target::Polling(5)),
    ] {
        let devices = [device("FV-405", family, target)];
        let handle = with(line(&[("FV-405", family, 5)]), &devices);
        let mut client = Client::of(&handle, 1);
        let commands: Vec<HartCommand> = overview(Some(family))
            .into_iter()
            .map(|(number, data)| HartCommand {
                number,
                data: hex(&data),
            })
            .collect();
        let count = commands.len();
        assert!(count > 15, "{family:?} {count}");
        let (news, ok, failed, text) = client.read(0, commands.clone()).await;
        assert_eq!(
            (ok as usize, failed),
            (count, 0),
            "{family:?} {text} {news:?}"
        );
        for (asked, news) in commands.iter().zip(&news) {
            let (command, outcome, text, response, tries) = exchange(news);
            assert_eq!(
                (command, outcome, tries),
                (asked.number, Outcome::Ok, 1),
                "{text}"
            );
            assert!(response.starts_with("86AEDD01234A"), "{command} {response}");
        }
    }
}

/// Command 0 by hand: readings/hart.md, section 3.1.
#[tokio::test(start_paused = true)]
async fn the_identity_stands_where_the_standard_says() {
    let devices = [device("FV-400", Family::Iq, Target::Polling(0))];
    let handle = with(line(&[("FV-400", Family::Iq, 0)]), &devices);
    let (news, ..) = Client::of(&handle, 1).read(0, vec![plain(0)]).await;
    let (.., response, _) = exchange(&news[0]);
    // Delimiter, long address, command 0, 24 bytes, response code 0; then FE, type 6EDD, 5, 7.
    assert_eq!(&response[..18], "86AEDD012345001800");
    assert_eq!(&response[20..30], "FE6EDD0507");
}

/// A scan finds what is there, says so at once, and goes on to the end.
#[tokio::test(start_paused = true)]
async fn a_scan_finds_all_devices() {
    let handle = with(
        line(&[
            ("A", Family::Iq, 0),
            ("B", Family::Cva, 7),
            ("C", Family::Si, 63),
        ]),
        &[],
    );
    let mut client = Client::of(&handle, 1);
    let scan = HartAsk::Scan {
        id: 4,
        bus: "h".into(),
        first: 0,
        last: 63,
    };
    client.ask(None, scan).await;
    let (news, ok, failed, text) = client.all(4).await;
    let found: Vec<Option<u8>> = news
        .iter()
        .map(|n| match n {
            HartNews::Found { polling, .. } => *polling,
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(found, [Some(0), Some(7), Some(63)]);
    assert_eq!((ok, failed, text.as_str()), (3, 61, "3 devices found"));
}

#[tokio::test(start_paused = true)]
async fn a_search_by_tag_finds_the_device_that_has_it() {
    let handle = with(
        line(&[("FV-401", Family::Iq, 0), ("FV-402", Family::Cva, 1)]),
        &[],
    );
    let mut client = Client::of(&handle, 1);
    for (id, tag, found) in [
        (1, "FV-402", true),
        (2, "fv-401", true),
        (3, "FV-403", false),
    ] {
        let find = HartAsk::Find {
            id,
            bus: "h".into(),
            tag: tag.into(),
            long: false,
        };
        client.ask(None, find).await;
        let (news, ok, _, text) = client.all(id).await;
        assert_eq!((ok == 1, news.len() == 1), (found, found), "{tag} {text}");
        if let Some(HartNews::Found {
            response, polling, ..
        }) = news.first()
        {
            let own = if tag == "FV-402" {
                "86AEDD012346"
            } else {
                "86AEDD012345"
            };
            assert!(response.starts_with(own) && polling.is_none());
        }
    }
}

/// A device that is not there: four tries, then the rest is not asked for, and it is said.
#[tokio::test(start_paused = true)]
async fn a_silent_device_is_given_up() {
    let devices = [device("X", Family::Iq, Target::Polling(9))];
    let handle = with(line(&[("A", Family::Iq, 0)]), &devices);
    let mut client = Client::of(&handle, 1);
    let begun = Instant::now();
    let (news, ok, failed, text) = client.read(0, vec![plain(3), plain(2), plain(1)]).await;
    assert_eq!((news.len(), ok, failed), (1, 0, 3));
    let (command, outcome, words, _, tries) = exchange(&news[0]);
    assert_eq!((command, outcome, tries), (3, Outcome::Silence, 4));
    assert!(words.contains("polling address 9"), "{words}");
    assert!(text.contains("does not answer"), "{text}");
    // Four times 26 characters with 20 preambles, and RT1: about 2.2 s.
    let took = begun.elapsed();
    assert!((1900..3000).contains(&took.as_millis()), "{took:?}");
}

/// A watch reads its list over and over at the rate of the line; of a slow page only the newest
/// waits.
#[tokio::test(start_paused = true)]
async fn a_watch_goes_at_the_rate_of_the_line() {
    let devices = [device("A", Family::Iq, Target::Polling(0))];
    let handle = with(line(&[("A", Family::Iq, 0)]), &devices);
    let mut client = Client::of(&handle, 1);
    let watch = |commands| HartAsk::Watch {
        device: "A".into(),
        commands,
        period_ms: 100,
    };
    client.ask(Some(0), watch(vec![plain(3)])).await;
    let (first, ..) = (client.hear().await, ());
    let HartNews::Exchange { at_us: from, .. } = first else {
        panic!("{first:?}");
    };
    let count = 100;
    let mut last = 0;
    for _ in 0..count {
        if let HartNews::Exchange {
            at_us, outcome, id, ..
        } = client.hear().await
        {
            assert_eq!((outcome, id), (Outcome::Ok, None));
            last = at_us;
        }
    }
    let actual = (last - from) / count;
    // RT2, 14 characters of request, 4 of the device's turn, 40 of reply.
    let ideal = (8 + 14 + 4 + 40) * 11 * 1_000_000 / 1200;
    println!("command 3: ideal {ideal} us, actual {actual} us");
    assert!(ideal * 100 >= actual * 95, "ideal {ideal}, actual {actual}");
    // A page that takes nothing for a minute finds what was there first, and then the newest.
    tokio::time::sleep(Duration::from_secs(120)).await;
    let mut waiting = 0;
    let mut newest = 0;
    while let Ok(Some(text)) = timeout(Duration::from_millis(1), client.news.recv()).await {
        if let Some(HartNews::Exchange { at_us, .. }) = HartNews::from_text(&text) {
            newest = at_us;
            waiting += 1;
        }
    }
    assert!(waiting < Outlet::SIZE, "{waiting}");
    let HartNews::Exchange { at_us, .. } = client.hear().await else {
        panic!();
    };
    assert!(at_us >= newest + 110_000_000 || waiting > 0);
    // An empty list ends it.
    client.ask(Some(0), watch(Vec::new())).await;
    tokio::time::sleep(Duration::from_secs(5)).await;
    while client.news.try_recv().is_ok() {}
    tokio::time::sleep(Duration::from_secs(5)).await;
    assert!(client.news.try_recv().is_err());
}

/// The loop of the built-in plant: one device of each family, two of which have something to report,
/// and each of them is read as often as the list of all devices asks for it.
#[tokio::test(start_paused = true)]
async fn the_built_in_loop_has_one_of_each_family() {
    let config = Config::simulated();
    let at = config.buses.iter().position(|b| b.line.hart().is_some());
    let bus = config.buses[at.unwrap()].clone();
    let devices: Vec<DeviceConfig> = config.on(&bus).cloned().collect();
    let found: Vec<_> = devices
        .iter()
        .map(|d| (d.unit, d.tag.as_str(), d.device.family().unwrap()))
        .collect();
    let by_hand = [
        (0, "FV-401", Family::Iq),
        (1, "FV-402", Family::Cva),
        (2, "FV-403", Family::Cma),
        (3, "FV-404", Family::Ck),
        (4, "FV-405", Family::Si),
    ];
    assert_eq!(found, by_hand);
    assert!(devices.iter().all(|d| d.description.contains("valve")));
    assert!(bus.line.hart().unwrap().faulty);
    let handle = start(bus, &devices, |clock| {
        let made = Loop::of(&devices, clock);
        made.spoil();
        Plug::Loop(made)
    });
    let mut client = Client::of(&handle, 1);
    for (at, (_, _, family)) in by_hand.into_iter().enumerate() {
        let (news, ok, ..) = client.read(at, vec![plain(48)]).await;
        assert_eq!(ok, 1, "{family:?}");
        let (.., response, _) = exchange(&news[0]);
        let byte = |at: usize| u8::from_str_radix(&response[2 * at..2 * at + 2], 16).unwrap();
        // Delimiter, address, command, count; then code, device status, and the nine bytes.
        let (status, own): (u8, Vec<u8>) = (byte(9), (10..19).map(byte).collect());
        match family {
            // Over-temperature is byte 0 bit 7 (table 9); out of specification is 10h (table 5).
            Family::Cma => {
                assert_eq!((own[0] & 0x80, own[6]), (0x80, 0x10));
                assert_eq!(status & 0x90, 0x10, "more status, and no malfunction");
            }
            // Digital input 1 is byte 5 bit 4 (table 11), a plain state.
            Family::Si => assert_eq!((own[5], own[6], status & 0x90), (0x10, 0, 0)),
            _ => assert_eq!((&own[..4], own[6], status & 0x90), (&[0; 4][..], 0, 0)),
        }
    }
    // The list polls each every 5 s.
    for (at, device) in devices.iter().enumerate() {
        let watch = HartAsk::Watch {
            device: device.tag.clone(),
            commands: vec![plain(3)],
            period_ms: 5000,
        };
        client.ask(Some(at), watch).await;
    }
    let mut counts = [0; 5];
    let until = Instant::now() + Duration::from_secs(300);
    while Instant::now() < until {
        if let HartNews::Exchange {
            device, outcome, ..
        } = client.hear().await
        {
            assert_eq!(outcome, Outcome::Ok);
            let at = devices.iter().position(|d| d.tag == device);
            counts[at.unwrap()] += 1;
        }
    }
    println!("reads of the five in 300 s: {counts:?}");
    assert!(counts.iter().all(|c| (58..=61).contains(c)), "{counts:?}");
    // One that is watched alone beside them, as fast as it goes, gets most of what they leave: the
    // five need 3 s of 5.
    let watch = HartAsk::Watch {
        device: devices[0].tag.clone(),
        commands: vec![plain(3)],
        period_ms: 100,
    };
    client.ask(Some(0), watch).await;
    let mut counts = [0; 5];
    let until = Instant::now() + Duration::from_secs(300);
    while Instant::now() < until {
        if let HartNews::Exchange { device, .. } = client.hear().await {
            let at = devices.iter().position(|d| d.tag == device);
            counts[at.unwrap()] += 1;
        }
    }
    println!("with the first as fast as it goes: {counts:?}");
    assert!(counts[0] > 200, "{counts:?}");
    assert!(
        counts[1..].iter().all(|c| (58..=61).contains(c)),
        "{counts:?}"
    );
}

/// Beside a control system and a bursting neighbour: all of them come to speak, none is hit by us,
/// and the page is told of them.
#[tokio::test(start_paused = true)]
async fn others_on_the_line_are_heard_and_left_alone() {
    for primary in [true, false] {
        let mut line = line(&[("A", Family::Iq, 1)]);
        let mut master = HartMaster::new(1200, !primary, 0);
        master.ask(&[0x2E, 0xDD, 0x01, 0x23, 0x46], 3, &[]);
        line.set_master(Some(master));
        line.add_burst(HartBurst::new(1200, 5, 0));
        let devices = [device("A", Family::Iq, Target::Polling(1))];
        let config = HartConfig {
            primary,
            ..HartConfig::of(HartWay::Simulated)
        };
        let mut simulated = None;
        let handle = start(config.bus("h"), &devices, |clock| {
            let made = Loop::new(line, clock);
            simulated = Some(made.clone());
            Plug::Loop(made)
        });
        let mut client = Client::of(&handle, 1);
        client.ask(None, HartAsk::Link { bus: "h".into() }).await;
        let mut told = None;
        for _ in 0..50 {
            let (news, ok, ..) = client.read(0, vec![plain(3)]).await;
            assert_eq!(ok, 1, "{news:?}");
            let link = |n: &HartNews| matches!(n, HartNews::Link { .. });
            told = news.into_iter().rfind(link).or(told);
        }
        let Some(HartNews::Link {
            primary: kind,
            other_master: true,
            burst: true,
            sent,
            answered,
            ..
        }) = told
        else {
            panic!("{told:?}");
        };
        assert_eq!(kind, Some(primary));
        // Nothing had to be said twice.
        assert!(sent > 45 && sent - answered <= 1, "{sent} {answered}");
        let collisions = simulated.unwrap().collisions();
        // Party 0 is our end.
        let ours = collisions.iter().filter(|c| c.second == 0).count();
        assert_eq!(ours, 0, "{collisions:?}");
    }
}

/// A line that is lost and comes back: those who wait are told, and reading goes on.
#[tokio::test(start_paused = true)]
async fn a_lost_line_is_opened_again() {
    let (ends, mut made) = mpsc::unbounded_channel();
    let devices = [device("A", Family::Iq, Target::Polling(0))];
    let handle = start(bus(), &devices, |_| {
        Plug::Stream(Box::new(move || {
            let (near, far) = tokio::io::duplex(4096);
            let _gone = ends.send(far);
            Ok(Box::new(near))
        }))
    });
    let mut client = Client::of(&handle, 1);
    let far = made.recv().await.unwrap();
    let gone = async {
        tokio::time::sleep(Duration::from_millis(100)).await;
        drop(far);
    };
    let (read, ()) = tokio::join!(client.read(0, vec![plain(3)]), gone);
    assert_eq!((read.1, read.2), (0, 1));
    assert!(read.3.contains("simulator ended"), "{}", read.3);
    let far: DuplexStream = made.recv().await.unwrap();
    let again = Loop::new(line(&[("A", Family::Iq, 0)]), Clock::start());
    tokio::spawn(async move { backend::sim::hart::serve(far, &again).await });
    let (_, ok, failed, text) = client.read(0, vec![plain(3)]).await;
    assert_eq!((ok, failed), (1, 0), "{text}");
}

/// Through the page's socket: what is not a read is refused there, and the line stays silent.
#[tokio::test]
async fn a_page_can_ask_for_reads_only() {
    let address = common::serve(&Config::simulated()).await;
    let (mut page, hello) = common::Page::greet(address).await;
    let ToPage::Hello { buses, devices, .. } = hello else {
        panic!("{hello:?}");
    };
    let bus = buses.iter().find(|b| b.framing == "hart").unwrap();
    let valve = devices.iter().find(|d| d.kind == "rotork-iq").unwrap();
    assert_eq!(
        (&valve.bus, valve.unit, valve.tag.as_str()),
        (&bus.name, 0, "FV-401")
    );
    let read = |number, data: &str| HartAsk::Read {
        id: 7,
        device: "FV-401".into(),
        commands: vec![HartCommand {
            number,
            data: data.into(),
        }],
    };
    for (ask, words) in [
        (read(132, "22"), "may move the valve"),
        (read(48, "00"), "no read"),
        (read(35, "3900000000"), "changes the configuration"),
        (read(130, ""), "unknown effect"),
        (read(999, ""), "not known"),
        (read(11, "820820820820"), "search for the tag"),
        (read(3, "0"), "two hexadecimal digits"),
        (read(42, ""), "end communication"),
    ] {
        page.say(&shared::proto::ToBackend::Hart(ask)).await;
        let refused = page.hart().await;
        let (_, outcome, text, _, _) = exchange(&refused);
        assert_eq!(outcome, Outcome::Refused);
        assert!(text.contains(words), "{text}");
        assert!(matches!(
            page.hart().await,
            HartNews::Done { id: 7, ok: 0, .. }
        ));
    }
    let many = HartAsk::Watch {
        device: "FV-401".into(),
        commands: vec![plain(3); 65],
        period_ms: 100,
    };
    page.say(&shared::proto::ToBackend::Hart(many)).await;
    let refusal = |m| match m {
        ToPage::Refused { text } => Some(text),
        _ => None,
    };
    assert!(page.until(refusal).await.contains("too many"));
    for ask in [
        HartAsk::Link {
            bus: "nowhere".into(),
        },
        HartAsk::Link {
            bus: "Simulated plant".into(),
        },
        HartAsk::Watch {
            device: "XV-101".into(),
            commands: vec![plain(3)],
            period_ms: 100,
        },
    ] {
        page.say(&shared::proto::ToBackend::Hart(ask)).await;
        page.until(refusal).await;
    }
    for ask in [
        HartAsk::Scan {
            id: 8,
            bus: bus.name.clone(),
            first: 5,
            last: 64,
        },
        HartAsk::Find {
            id: 8,
            bus: bus.name.clone(),
            tag: "TOO LONG A TAG".into(),
            long: false,
        },
        HartAsk::Scan {
            id: 8,
            bus: "nowhere".into(),
            first: 0,
            last: 1,
        },
    ] {
        page.say(&shared::proto::ToBackend::Hart(ask)).await;
        assert!(matches!(
            page.hart().await,
            HartNews::Done {
                id: 8,
                ok: 0,
                failed: 1,
                ..
            }
        ));
    }
    // And a read is answered.
    page.say(&shared::proto::ToBackend::Hart(read(3, ""))).await;
    let (command, outcome, text, response, _) = exchange(&page.hart().await);
    assert_eq!((command, outcome), (3, Outcome::Ok), "{text}");
    assert!(response.starts_with("86AEDD012345031A"), "{response}");
}
