//! The problems of a whole capture, each a way to its bytes.

use std::sync::Arc;

use leptos::prelude::*;
use shared::frame::Frame;
use shared::place::Place;
use shared::problem::Problem;
use shared::text::TextProblem;

use crate::components::drawn::{Act, Draw, Drawn};
use crate::components::windowed::{DrawRow, Windowed};
use crate::decode_store::DecodeStore;
use crate::erased::{effect, memo};
use crate::markup::Markup;
use crate::markup::decode::problem_head;
use crate::markup::frame::{place_words, problem_row};
use crate::state::findings::Item;
use crate::state::selection::Selection;
use crate::state::work::Shown;

/// Rows shown at once.
const ROWS: usize = 4;

/// Height of a row in pixels.
const ROW: i32 = 28;

/// One line of the strip.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Entry {
    Text(TextProblem),
    Frame(Item),
}

/// A strip with all errors and warnings, notes on demand; a click jumps to frame and bytes.
#[component]
pub fn ProblemStrip() -> impl IntoView {
    let store: DecodeStore = expect_context();
    let with_notes = RwSignal::new(false);
    let entries = memo(move || {
        let text = store.work.with(|w| {
            w.as_ref()
                .map_or_else(Vec::new, |w| w.text_problems.clone())
        });
        let mut entries: Vec<_> = text.into_iter().map(Entry::Text).collect();
        store.findings.with(|f| {
            entries.extend(f.items.iter().copied().map(Entry::Frame));
            if with_notes.get() {
                entries.extend(f.notes.iter().copied().map(Entry::Frame));
            }
        });
        Arc::new(entries)
    });
    let total = memo(move || {
        let text = store.work.with(|w| {
            w.as_ref()
                .map_or(0, |w| w.text_problems.len() + w.more_text_problems)
        });
        let text = u64::try_from(text).unwrap_or(u64::MAX);
        let [notes, warnings, errors] = store.findings.with(|f| f.counts.map(u64::from));
        (errors + text, warnings, notes)
    });
    let cursor = RwSignal::new(None);
    effect(move || {
        let entry = cursor
            .get()
            .and_then(|at| entries.with_untracked(|e| e.get(at).copied()));
        if let Some(entry) = entry {
            jump(store, entry);
        }
    });
    let draw: DrawRow = Arc::new(move |at: usize, html: &mut Markup| {
        if let Some(entry) = entries.with(|e| e.get(at).copied()) {
            draw_entry(html, entry);
        }
    });
    let shown = move || i32::try_from(entries.with(|e| e.len().min(ROWS))).unwrap_or(0);
    let head: Draw = Arc::new(move |html: &mut Markup| {
        let listed = entries.with(|e| u64::try_from(e.len()).unwrap_or(u64::MAX));
        problem_head(html, total.get(), listed, with_notes.get());
    });
    let on_act = Callback::new(move |act: Act| with_notes.set(!act.value.is_empty()));
    view! {
        <section
            class="problem-strip"
            aria-label="Problems"
            hidden=move || total.get() == (0, 0, 0)
        >
            <Drawn class="problem-head" draw=head on_act=on_act/>
            <div class="problem-list" style:height=move || format!("{}px", shown() * ROW)>
                <Windowed
                    label="Problems"
                    count=Signal::derive(move || entries.with(|e| e.len()))
                    row_height=Signal::stored(ROW)
                    cursor=cursor
                    draw=draw
                    testid="problem-list"
                />
            </div>
        </section>
    }
}

fn draw_entry(html: &mut Markup, entry: Entry) {
    match entry {
        Entry::Text(text) => {
            let place = format!("line {}, column {}", text.line, text.column);
            problem_row(html, &Problem::new(text.finding, Place::default()), &place);
        }
        Entry::Frame(item) => {
            let place = format!("#{} · {}", item.frame, place_words(&item.problem));
            problem_row(html, &item.problem, &place);
        }
    }
}

fn jump(store: DecodeStore, entry: Entry) {
    match entry {
        Entry::Frame(item) => {
            let device = store.device.get_untracked();
            let shown = store.work.with_untracked(|w| {
                let work = w.as_ref()?;
                Shown::of(&work.session, item.frame, work.device(device))
            });
            if let Some(shown) = shown {
                let selection = Selection::problem(&shown.decoded, item.problem.place);
                store.jump(item.frame, selection);
            }
        }
        Entry::Text(text) => {
            let frame = store.work.with_untracked(|w| {
                let session = &w.as_ref()?.session;
                frame_at(session.len(), text.offset, |i| {
                    session.frame(i).map(Frame::end)
                })
            });
            if let Some(frame) = frame {
                store.cursor.set(usize::try_from(frame).ok());
            }
        }
    }
}

/// The frame that holds a stream offset, or the last one.
fn frame_at(len: u32, offset: u64, end: impl Fn(u32) -> Option<u64>) -> Option<u32> {
    let (mut low, mut high) = (0, len.checked_sub(1)?);
    while low < high {
        let middle = low + (high - low) / 2;
        if end(middle)? <= offset {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    Some(low)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_in_the_text_leads_to_its_frame() {
        let ends = [8_u64, 19, 20];
        let at = |offset| {
            frame_at(3, offset, |i| {
                ends.get(usize::try_from(i).unwrap()).copied()
            })
        };
        assert_eq!(at(0), Some(0));
        assert_eq!(at(8), Some(1));
        assert_eq!(at(99), Some(2));
        assert_eq!(frame_at(0, 0, |_| None), None);
    }
}
