//! Everything that is known about the selected field.

use leptos::prelude::*;
use shared::map::row::{Reading, Trust};
use shared::value::Quality;

use crate::components::frame_detail::Selected;
use crate::state::tree::{Facts, binary};
use crate::state::work::Shown;

/// Path, raw value in three notations, place, source, and why a reading differs from the print.
#[component]
pub fn FieldFacts(
    /// The frame.
    shown: Shown,
) -> impl IntoView {
    let selected: Selected = expect_context();
    let facts = Memo::new(move |_| {
        let field = selected.get()?.field?;
        Facts::of(&shown.decoded, field)
    });
    move || {
        facts.get().map_or_else(
            || {
                view! {
                    <p class="facts quiet" data-testid="field-facts">
                        "Select a field or a byte to see where it is described."
                    </p>
                }
                .into_any()
            },
            |facts| view! { <FactsList facts=facts/> }.into_any(),
        )
    }
}

#[component]
fn FactsList(
    /// What is known.
    facts: Facts,
) -> impl IntoView {
    let (first, last) = facts.bytes;
    let bytes = if first >= last {
        format!("byte {first}")
    } else {
        format!("bytes {first} to {last}")
    };
    let number = facts.number.map(|(value, len)| {
        let width = len * 2;
        view! {
            <dt>"Raw"</dt>
            <dd class="mono">
                {format!("0x{value:0width$X}")} " · " {value.to_string()} " · " {binary(value, len)}
            </dd>
        }
    });
    let raw = facts.number.is_none().then(|| {
        view! {
            <dt>"Raw"</dt>
            <dd class="mono wrap">{facts.raw.clone()}</dd>
        }
    });
    let quality = (facts.quality != Quality::Good).then(|| {
        view! {
            <dt>"Quality"</dt>
            <dd>{facts.quality.label()}</dd>
        }
    });
    view! {
        <div class="facts" data-testid="field-facts">
            <p class="facts-title">
                <b>{facts.label}</b>
                <code>{facts.path}</code>
                <span class="quiet">{bytes}</span>
            </p>
            <dl>
                {number} {raw} {quality} <dt>"Source"</dt>
                <dd>
                    {facts.source.map_or_else(
                        || "no map describes it".to_owned(),
                        |s| s.to_string(),
                    )} ", " {trust(facts.trust)}
                </dd>
                {facts.reading.map(|reading| view! { <ReadingFacts reading=reading/> })}
            </dl>
        </div>
    }
}

/// Why a description differs from the print.
#[component]
pub fn ReadingFacts(
    /// The reading.
    reading: &'static Reading,
) -> impl IntoView {
    let settled = match reading.settled {
        shared::map::row::Settled::Yes => "settled by the text",
        shared::map::row::Settled::Likely => "likely",
        shared::map::row::Settled::No => "open, the raw value decides",
    };
    view! {
        <dt>"Reading"</dt>
        <dd>
            <code>{reading.id}</code>
            " "
            {reading.text}
            <span class="quiet">" (" {settled} ")"</span>
        </dd>
    }
}

/// The words for a trust.
#[must_use]
pub const fn trust(trust: Trust) -> &'static str {
    match trust {
        Trust::Manual => "as printed",
        Trust::Reading => "read differently from the print",
        Trust::Inferred => "concluded, not printed",
    }
}
