//! The decode page's state as signals, and the long work on it.

use std::sync::Arc;

use leptos::prelude::*;
use leptos::task::spawn_local;
use shared::device::Device;
use shared::frame::Framing;

use crate::format::within;
use crate::state::findings::Findings;
use crate::state::load::Loader;
use crate::state::samples::Sample;
use crate::state::selection::Selection;
use crate::state::work::Work;
use crate::task::{SLICE_MS, Ticket, Turn, now_ms, pause, promise};

/// Bytes taken in at once.
const PIECE: usize = 128 * 1024;

/// Bytes asked from a file at once.
const READ: f64 = 1024.0 * 1024.0;

/// Framings that a program of its own decodes: key and name.
pub const FOREIGN: &[(&str, &str)] = if cfg!(feature = "hart") {
    &[]
} else {
    &[("hart", "HART"), ("hart-ip", "HART-IP")]
};

/// An input as it came, so that it can be read anew or handed on.
#[derive(Clone, Debug)]
pub enum Input {
    /// Bytes in memory.
    Bytes(Arc<Vec<u8>>),
    /// A file, read piece by piece.
    File(web_sys::File),
    /// A sample that another program has.
    Sample(&'static str),
}

/// Long work under way.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// What is done.
    pub what: &'static str,
    /// How far, in parts of 1.
    pub done: f64,
    /// Frames found so far.
    pub frames: u32,
}

impl Progress {
    /// How far, in percent.
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a part of 1 becomes 0 to 100"
    )]
    pub fn percent(&self) -> u8 {
        (within(self.done, 0.0, 1.0) * 100.0) as u8
    }
}

/// State of the decode page; lives as long as the page, so that leaving and coming back keeps it.
#[derive(Clone, Copy, Debug)]
pub struct DecodeStore {
    /// The input and its frames.
    pub work: RwSignal<Option<Work>>,
    /// Counts up with every new input or index; lists are drawn anew.
    pub epoch: RwSignal<u32>,
    /// Problems of all frames.
    pub findings: RwSignal<Findings>,
    /// Work under way.
    pub progress: RwSignal<Option<Progress>>,
    /// The framing that the user chose.
    pub framing: RwSignal<Option<Framing>>,
    /// The device that the user chose.
    pub device: RwSignal<Option<Device>>,
    /// The frame under the cursor.
    pub cursor: RwSignal<Option<usize>>,
    /// What is selected in which frame.
    pub selected: RwSignal<Option<(u32, Selection)>>,
    /// The text in the input.
    pub text: RwSignal<String>,
    /// True once something was opened, so that the input makes room.
    pub collapsed: RwSignal<bool>,
    /// Key of the open sample.
    pub sample: RwSignal<Option<&'static str>>,
    /// Set while a program of its own decodes: the framing that the user chose, empty for automatic.
    pub hosted: RwSignal<Option<&'static str>>,
    input: StoredValue<Option<(String, Input)>, LocalStorage>,
    turn: StoredValue<Turn, LocalStorage>,
}

impl DecodeStore {
    /// Makes the state available.
    pub fn provide() -> Self {
        let store = Self {
            work: RwSignal::new(None),
            epoch: RwSignal::new(0),
            findings: RwSignal::new(Findings::default()),
            progress: RwSignal::new(None),
            framing: RwSignal::new(None),
            device: RwSignal::new(None),
            cursor: RwSignal::new(None),
            selected: RwSignal::new(None),
            text: RwSignal::new(String::new()),
            collapsed: RwSignal::new(false),
            sample: RwSignal::new(None),
            hosted: RwSignal::new(None),
            input: StoredValue::new_local(None),
            turn: StoredValue::new_local(Turn::default()),
        };
        provide_context(store);
        store
    }

    fn ticket(self) -> Ticket {
        self.turn.with_value(Turn::next)
    }

    /// Ends the work under way; what was read so far stays.
    pub fn cancel(self) {
        let _ended = self.ticket();
        self.progress.set(None);
    }

    /// Forgets everything.
    pub fn clear(self) {
        self.cancel();
        self.text.set(String::new());
        self.sample.set(None);
        self.collapsed.set(false);
        self.input.set_value(None);
        self.hosted.set(None);
        self.drop_work();
    }

    fn drop_work(self) {
        self.work.set(None);
        self.findings.set(Findings::default());
        self.cursor.set(None);
        self.selected.set(None);
        self.bump();
    }

    fn bump(self) {
        self.epoch.update(|e| *e = e.wrapping_add(1));
    }

    /// Decodes a sample.
    pub fn open_sample(self, sample: &'static Sample) {
        self.framing.set(None);
        self.hosted.set(None);
        self.device.set(sample.device);
        self.text
            .set(String::from_utf8_lossy(sample.content).into_owned());
        self.sample.set(Some(sample.key));
        self.collapsed.set(true);
        let input = if sample.content.is_empty() {
            Input::Sample(sample.key)
        } else {
            Input::Bytes(Arc::new(sample.content.to_vec()))
        };
        self.open(sample.title.to_owned(), input);
    }

    /// Decodes pasted or typed text.
    pub fn open_text(self, text: &str) {
        self.sample.set(None);
        let input = Input::Bytes(Arc::new(text.as_bytes().to_vec()));
        self.open("pasted text".to_owned(), input);
    }

    /// Decodes a file, piece by piece.
    pub fn open_file(self, file: web_sys::File) {
        self.text.set(String::new());
        self.sample.set(None);
        self.collapsed.set(true);
        self.open(file.name(), Input::File(file));
    }

    /// Decodes an input.
    pub fn open(self, name: String, input: Input) {
        self.input.set_value(Some((name, input)));
        self.read();
    }

    /// The input that is open.
    #[must_use]
    pub fn input(self) -> Option<(String, Input)> {
        self.input.get_value()
    }

    fn read(self) {
        let ticket = self.ticket();
        if let Some(framing) = self.hosted.get_untracked().filter(|f| !f.is_empty()) {
            self.host(framing);
            return;
        }
        let Some((name, input)) = self.input.get_value() else {
            return;
        };
        let mut loader = Loader::new(self.framing.get_untracked());
        match input {
            Input::Bytes(bytes) if bytes.len() <= PIECE => {
                loader.push(&bytes);
                self.accept(name, loader, false, &ticket);
            }
            Input::Bytes(bytes) => spawn_local(self.read_bytes(name, bytes, loader, ticket)),
            Input::File(file) => {
                self.report("Reading", 0.0, 0);
                spawn_local(self.read_file(name, file, loader, ticket));
            }
            Input::Sample(_) => self.host(""),
        }
    }

    async fn read_bytes(
        self,
        name: String,
        input: Arc<Vec<u8>>,
        mut loader: Loader,
        ticket: Ticket,
    ) {
        let mut slice = now_ms();
        for (at, piece) in input.chunks(PIECE).enumerate() {
            loader.push(piece);
            if now_ms() - slice > SLICE_MS {
                self.report("Reading", part(at * PIECE, input.len()), loader.frames());
                pause().await;
                slice = now_ms();
            }
            if !ticket.is_valid() {
                self.stopped(name, loader);
                return;
            }
        }
        self.accept(name, loader, false, &ticket);
    }

    async fn read_file(
        self,
        name: String,
        file: web_sys::File,
        mut loader: Loader,
        ticket: Ticket,
    ) {
        let size = file.size();
        let mut at = 0.0;
        while at < size && !loader.is_foreign() {
            let Some(piece) = piece(&file, at, (at + READ).min(size)).await else {
                // The file went away or may not be read: what came so far is shown.
                self.accept(name, loader, true, &ticket);
                return;
            };
            for part in piece.chunks(PIECE) {
                loader.push(part);
                if !ticket.is_valid() {
                    self.stopped(name, loader);
                    return;
                }
                self.report("Reading", at / size.max(1.0), loader.frames());
                pause().await;
            }
            at += READ;
        }
        self.accept(name, loader, false, &ticket);
    }

    /// Leaves the input to the program that decodes it; an empty framing is automatic.
    fn host(self, framing: &'static str) {
        self.progress.set(None);
        let device = self.device.get_untracked();
        self.device.set(device.filter(|d| d.family().is_some()));
        self.hosted.set(Some(framing));
        self.drop_work();
    }

    fn report(self, what: &'static str, done: f64, frames: u32) {
        self.progress.set(Some(Progress { what, done, frames }));
    }

    /// Work that was stopped: shows what was read, unless something else was opened meanwhile.
    fn stopped(self, name: String, loader: Loader) {
        if self.progress.with_untracked(Option::is_none) {
            let ticket = self.ticket();
            self.accept(name, loader, true, &ticket);
        }
    }

    fn accept(self, name: String, mut loader: Loader, partial: bool, ticket: &Ticket) {
        loader.end();
        if loader.is_foreign() {
            self.host("");
            return;
        }
        self.hosted.set(None);
        let work = Work::new(name, loader.finish(), partial);
        let first = (!work.session.is_empty()).then_some(0);
        let keep = self
            .cursor
            .get_untracked()
            .filter(|at| u32::try_from(*at).is_ok_and(|at| at < work.session.len()));
        self.work.set(Some(work));
        self.cursor.set(keep.or(first));
        self.selected.set(None);
        self.bump();
        self.look_for_problems(ticket.clone());
    }

    /// Another framing, by its key: the input is read anew.
    pub fn choose_framing(self, key: &str) {
        self.framing.set(Framing::from_key(key));
        let foreign = FOREIGN.iter().find(|(k, _)| *k == key);
        self.hosted.set(foreign.map(|(k, _)| *k));
        self.cursor.set(None);
        self.read();
    }

    /// Another device: the frames stay, their meaning changes.
    pub fn choose_device(self, device: Option<Device>) {
        self.device.set(device);
        self.bump();
        self.look_for_problems(self.ticket());
    }

    fn look_for_problems(self, ticket: Ticket) {
        self.findings.set(Findings::default());
        let device = self.device.get_untracked();
        let step = move |findings: &mut Findings| {
            self.work.with_untracked(|w| {
                let Some(work) = w else { return (true, 0.0, 0) };
                let context = work.context(device);
                let start = now_ms();
                loop {
                    let done = findings.step(&work.session, &context, 256);
                    if done || now_ms() - start > SLICE_MS {
                        let progress = findings.progress(&work.session);
                        return (done, progress, work.session.len());
                    }
                }
            })
        };
        let mut findings = Findings::default();
        let (done, ..) = step(&mut findings);
        if done {
            self.progress.set(None);
            self.findings.set(findings);
            return;
        }
        spawn_local(async move {
            loop {
                let (done, progress, frames) = step(&mut findings);
                if done {
                    break;
                }
                self.report("Looking for problems", progress, frames);
                pause().await;
                if !ticket.is_valid() {
                    return;
                }
            }
            self.progress.set(None);
            self.findings.set(findings);
        });
    }

    /// Goes to a frame and selects bytes in it.
    pub fn jump(self, frame: u32, selection: Selection) {
        self.cursor.set(usize::try_from(frame).ok());
        self.selected.set(Some((frame, selection)));
    }
}

#[expect(clippy::cast_precision_loss, reason = "a part of 1 for a progress bar")]
fn part(done: usize, all: usize) -> f64 {
    done as f64 / all.max(1) as f64
}

/// Bytes of a file.
async fn piece(file: &web_sys::File, from: f64, to: f64) -> Option<Vec<u8>> {
    let blob = file.slice_with_f64_and_f64(from, to).ok()?;
    let buffer = promise(blob.array_buffer()).await?;
    Some(js_sys::Uint8Array::new(&buffer).to_vec())
}
