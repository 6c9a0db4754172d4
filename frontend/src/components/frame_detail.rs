//! One frame: its bytes and its meaning as one picture.

use leptos::prelude::*;
use leptos::task::spawn_local;
use shared::place::Place;
use shared::problem::{Problem, Severity};
use shared::tree::FieldId;

use crate::components::facts::FieldFacts;
use crate::components::hex::HexView;
use crate::components::icon::{Glyph, Icon};
use crate::components::tree::FieldTree;
use crate::format::{count, thousands};
use crate::state::selection::Selection;
use crate::state::summary::{function, role};
use crate::state::work::Shown;

/// The field under the pointer, in the tree or through its bytes.
#[derive(Clone, Copy, Debug)]
pub struct Hovered(pub RwSignal<Option<FieldId>>);

/// The bytes of the field under the pointer.
#[derive(Clone, Copy, Debug)]
pub struct Marked(pub Memo<Option<Place>>);

/// What is selected in the frame that is shown.
#[derive(Clone, Copy, Debug)]
pub struct Selected {
    all: RwSignal<Option<(u32, Selection)>>,
    frame: u32,
}

impl Selected {
    /// Follows the selection.
    #[must_use]
    pub fn get(self) -> Option<Selection> {
        self.all.get().filter(|(f, _)| *f == self.frame).map(|s| s.1)
    }

    /// Looks at the selection.
    #[must_use]
    pub fn get_untracked(self) -> Option<Selection> {
        untrack(|| self.get())
    }

    /// Selects.
    pub fn set(self, selection: Option<Selection>) {
        self.all.set(selection.map(|s| (self.frame, s)));
    }
}

/// The frame that is shown, with bytes, fields, problems and facts; says what to do if there is
/// none.
#[component]
pub fn FrameDetail(
    /// The frame.
    #[prop(into)]
    shown: Signal<Option<Shown>>,
    /// What is selected, with the number of its frame.
    selected: RwSignal<Option<(u32, Selection)>>,
    /// More about the frame, such as its time.
    #[prop(optional, into)]
    aside: Option<Signal<String>>,
    /// Called to go to the other frame of a pair.
    on_pair: Callback<u32>,
) -> impl IntoView {
    let shown = Memo::new(move |_| shown.get());
    move || {
        shown.get().map_or_else(
            || {
                view! { <p class="empty">"Select a frame to see its bytes and fields."</p> }
                    .into_any()
            },
            |shown| {
                view! { <FrameBody shown=shown selected=selected aside=aside on_pair=on_pair/> }
                    .into_any()
            },
        )
    }
}

#[component]
fn FrameBody(
    /// The frame.
    shown: Shown,
    /// What is selected.
    selected: RwSignal<Option<(u32, Selection)>>,
    /// More about the frame.
    aside: Option<Signal<String>>,
    /// Called to go to the other frame of a pair.
    on_pair: Callback<u32>,
) -> impl IntoView {
    let hovered = RwSignal::new(None);
    let decoded = shown.decoded.clone();
    let marked = Memo::new(move |_| {
        let id = hovered.get()?;
        decoded.field(id).map(|f| f.place)
    });
    provide_context(Hovered(hovered));
    provide_context(Marked(marked));
    provide_context(Selected {
        all: selected,
        frame: shown.index,
    });
    view! {
        <article class="detail" data-testid="frame-detail" aria-label="Frame">
            <FrameHead shown=shown.clone() aside=aside on_pair=on_pair/>
            <FrameProblems shown=shown.clone()/>
            <HexView shown=shown.clone()/>
            <FieldTree shown=shown.clone()/>
            <FieldFacts shown=shown/>
        </article>
    }
}

#[component]
fn FrameHead(
    /// The frame.
    shown: Shown,
    /// More about the frame.
    aside: Option<Signal<String>>,
    /// Called to go to the other frame of a pair.
    on_pair: Callback<u32>,
) -> impl IntoView {
    let frame = shown.frame;
    let title = if frame.is_noise() {
        "Noise".to_owned()
    } else {
        format!("{} · {}", function(&frame), role(frame.role))
    };
    let code = (!frame.is_noise())
        .then(|| format!("unit {} · function {:02X}", frame.unit, frame.function));
    let place = format!(
        "offset {} · {}",
        thousands(frame.offset),
        count(u64::from(frame.len), "byte")
    );
    let pair = frame.pair().map(|pair| {
        let words = if pair < shown.index {
            format!("answers frame {pair}")
        } else {
            format!("answered by frame {pair}")
        };
        view! {
            <button class="link" data-testid="frame-pair" on:click=move |_| on_pair.run(pair)>
                {words}
            </button>
        }
    });
    let (as_text, as_json) = (shown.clone(), shown.clone());
    let as_hex = shown.clone();
    view! {
        <header class="detail-head">
            <div>
                <h2>
                    <span class="quiet">{format!("#{} ", shown.index)}</span>
                    {title}
                </h2>
                <p class="quiet">
                    {code} " · " {place} " " {pair} {aside.map(|a| view! { " " {a} })}
                </p>
            </div>
            <div class="actions">
                <CopyButton
                    label="Hex"
                    text=Callback::new(move |()| {
                        shared::render::Spaced(as_hex.decoded.bytes()).to_string()
                    })
                />
                <CopyButton label="Text" text=Callback::new(move |()| as_text.text())/>
                <CopyButton label="JSON" text=Callback::new(move |()| as_json.json())/>
            </div>
        </header>
    }
}

/// A button that copies, and says whether it worked.
#[component]
pub fn CopyButton(
    /// What is copied.
    label: &'static str,
    /// Makes the text.
    text: Callback<(), String>,
) -> impl IntoView {
    let (said, say) = signal(label);
    let copy = move |_| {
        let text = text.run(());
        spawn_local(async move {
            let done = crate::browser::copy(text).await;
            // The button may be gone by now.
            let _gone = say.try_set(if done { "Copied" } else { "No clipboard here" });
            crate::task::sleep(1500).await;
            let _gone = say.try_set(label);
        });
    };
    view! {
        <button
            class="button"
            aria-label=format!("Copy as {label}")
            data-testid=format!("copy-{}", label.to_ascii_lowercase())
            on:click=copy
        >
            <Icon glyph=Glyph::Copy/>
            <span aria-live="polite">{said}</span>
        </button>
    }
}

/// The problems of this frame in words; a click shows the bytes.
#[component]
fn FrameProblems(
    /// The frame.
    shown: Shown,
) -> impl IntoView {
    let selected: Selected = expect_context();
    let items: Vec<_> = shown
        .decoded
        .problems()
        .iter()
        .map(|problem| {
            let decoded = shown.decoded.clone();
            let place = problem.place;
            let jump = move |_| selected.set(Some(Selection::problem(&decoded, place)));
            view! {
                <li>
                    <button class="problem" data-testid="frame-problem" on:click=jump>
                        <SeverityMark severity=problem.severity()/>
                        <span>{problem.to_string()}</span>
                        <span class="quiet where">{place_words(problem)}</span>
                    </button>
                </li>
            }
        })
        .collect();
    (!items.is_empty()).then(|| view! { <ul class="frame-problems">{items}</ul> })
}

/// Where a problem is, within its frame.
#[must_use]
pub fn place_words(problem: &Problem) -> String {
    let Place { start, len } = problem.place;
    match len {
        0 => format!("after byte {}", start.saturating_sub(1)),
        1 => format!("byte {start}"),
        _ => format!("bytes {start}–{}", problem.place.end().saturating_sub(1)),
    }
}

/// The mark of a severity: shape and letter besides colour.
#[component]
pub fn SeverityMark(
    /// How bad.
    severity: Severity,
) -> impl IntoView {
    let (class, path) = match severity {
        Severity::Error => ("severity error", "M6.5 6.5l7 7M13.5 6.5l-7 7M10 2a8 8 0 1 0 .01 0z"),
        Severity::Warning => ("severity warning", "M10 2.5l8.5 15h-17zM10 8v4.5M10 15v.2"),
        Severity::Note => ("severity note", "M10 3a7 7 0 1 0 .01 0M10 9v4.5M10 6.3v.2"),
    };
    view! {
        <svg
            class=class
            width="16"
            height="16"
            viewBox="0 0 20 20"
            fill="none"
            stroke="currentColor"
            stroke-width="1.8"
            stroke-linecap="round"
            stroke-linejoin="round"
            role="img"
            aria-label=severity.key()
        >
            <path d=path></path>
        </svg>
    }
}
