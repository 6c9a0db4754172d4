//! One object with everything that is known of it.

use std::sync::Arc;

use leptos::prelude::*;
use leptos::task::spawn_local;

use super::fields::FieldsView;
use super::{part, save};
use crate::chart::view::ChartView;
use crate::chart::{Axis, Chart};
use crate::components::drawn::{Act, Draw, Drawn};
use crate::components::icon::Glyph;
use crate::dop::markup::{compare, object};
use crate::dop::picture::{QUANTITIES, charts, compared};
use crate::dop::state::compare::differences;
use crate::dop::state::kept::Decoded;
use crate::dop::state::saved::Saved;
use crate::dop::store::Store;
use crate::erased::{effect, memo};
use crate::markup::Markup;
use crate::markup::control::Button;

/// An object: how it was read, its pictures, its values, its fields and registers.
#[component]
pub fn ObjectView(
    /// The registers and what they mean.
    decoded: Memo<Option<Decoded>>,
    /// Strokes over each other.
    strokes: Memo<Vec<Chart>>,
    /// An earlier read of the same request.
    earlier: Memo<Option<Decoded>>,
) -> impl IntoView {
    let store = Store::get();
    let quantity = store.quantity;
    let with_same = RwSignal::new(false);
    let pictures =
        memo(move || decoded.with(|d| d.as_ref().map_or_else(Vec::new, |d| charts(&d.read))));
    let before = memo(move || {
        decoded.with(|now| {
            earlier.with(|then| match (now, then) {
                (Some(now), Some(then)) => compared(&now.read, &then.read),
                _ => Vec::new(),
            })
        })
    });
    let draw = move |make: fn(&mut Markup, &Decoded, i64)| -> Draw {
        Arc::new(move |html: &mut Markup| {
            let now = store.now.get();
            decoded.with(|d| {
                if let Some(d) = d {
                    make(html, d, now);
                }
            });
        })
    };
    let remarks: Draw = Arc::new(move |html: &mut Markup| {
        decoded.with(|d| {
            if let Some(d) = d {
                object::remarks(html, d);
            }
        });
    });
    let quantities: Draw = Arc::new(move |html: &mut Markup| {
        if strokes.with(Vec::is_empty) {
            return;
        }
        let now = quantity.get();
        for (key, label, _) in QUANTITIES {
            html.open(
                "button",
                &[
                    ("class", "option"),
                    ("data-act", key),
                    ("data-testid", "quantity"),
                    ("data-key", key),
                    ("aria-pressed", if now == key { "true" } else { "false" }),
                ],
            );
            html.text(label).close("button");
        }
    });
    let changes: Draw = Arc::new(move |html: &mut Markup| {
        decoded.with(|now| {
            earlier.with(|then| {
                if let (Some(now), Some(then)) = (now, then) {
                    draw_changes(html, now, then, with_same.get());
                }
            });
        });
    });
    let tools: Draw = Arc::new(move |html: &mut Markup| {
        let is_device = store.tag.with(|tag| !tag.is_empty());
        let busy = store.site.with(|s| s.reading().is_some());
        let online = store.online.get();
        draw_tools(
            html,
            is_device,
            online && !busy,
            decoded.with(Option::is_some),
        );
    });
    let on_act = Callback::new(move |act: Act| {
        let Some(now) = decoded.get_untracked() else {
            return;
        };
        match act.name.as_str() {
            "save" => {
                let name = format!("dop-{}", now.kept.request);
                let saved = Saved {
                    device: store.tag.get_untracked(),
                    reads: vec![now.kept],
                };
                save(&name, "json", &saved.to_json());
            }
            "copy" => {
                let words: Vec<_> = now.kept.words.iter().map(|w| format!("{w:04X}")).collect();
                spawn_local(async move {
                    let _said = crate::browser::copy(words.join(" ")).await;
                });
            }
            _ => store.read(vec![now.kept.request]),
        }
    });
    effect(move || {
        let request = decoded.with(|d| d.as_ref().map(|d| d.kept.request.to_string()));
        request_animation_frame(move || {
            let view = document().query_selector(".object-view").ok().flatten();
            if let (Some(view), Some(request)) = (view, request) {
                // Fails only for names that are none.
                let _infallible = view.set_attribute("data-request", &request);
            }
        });
    });
    view! {
        <article class="object-view" data-testid="object-view">
            <header class="object-head">
                <Drawn class="object-about" draw=draw(object::head)/>
                <Drawn class="actions" draw=tools on_act=on_act/>
            </header>
            <Drawn class="object-remarks" draw=remarks/>
            <Charts charts=pictures/>
            <Drawn class="quantities" draw=quantities on_act=Callback::new(move |act: Act| quantity.set(act.name))/>
            <Charts charts=strokes/>
            <Charts charts=before/>
            <Drawn
                class="object-changes"
                draw=changes
                on_act=Callback::new(move |_| with_same.update(|all| *all = !*all))
            />
            <Drawn class="object-values" draw=draw(object::values)/>
            <FieldsView decoded=decoded/>
        </article>
    }
}

fn draw_changes(html: &mut Markup, now: &Decoded, then: &Decoded, with_same: bool) {
    let when = then
        .kept
        .wall_ms
        .and_then(|ms| i64::try_from(ms / 1000).ok());
    let when = when.map_or_else(
        || "an earlier read".to_owned(),
        |s| format!("the read of {} UTC", crate::chart::time::stamp(s)),
    );
    html.open("h3", &[]);
    html.text(&format!("Changes since {when} ")).open(
        "button",
        &[
            ("class", "quiet-button"),
            ("data-act", "same"),
            ("data-testid", "with-same"),
        ],
    );
    html.text(if with_same {
        "Only changes"
    } else {
        "All values"
    });
    html.close("button").close("h3");
    compare::differences(html, &differences(&now.read, &then.read), with_same);
}

fn draw_tools(html: &mut Markup, is_device: bool, idle: bool, has: bool) {
    Button {
        act: "read",
        testid: "read-object",
        words: "Read again",
        glyph: Some(Glyph::Poll),
        disabled: !idle,
        hidden: !is_device || !has,
        ..Button::default()
    }
    .draw(html);
    for (act, testid, words, glyph) in [
        ("save", "save-read", "Save read", Glyph::Save),
        ("copy", "copy-registers", "Copy registers", Glyph::Copy),
    ] {
        Button {
            act,
            testid,
            words,
            glyph: Some(glyph),
            hidden: !has,
            ..Button::default()
        }
        .draw(html);
    }
}

/// Charts below each other.
#[component]
fn Charts(
    /// The charts.
    charts: Memo<Vec<Chart>>,
) -> impl IntoView {
    // As text, for which there are memos already.
    let count = memo(move || charts.with(Vec::len).to_string());
    part(move || {
        let all: Vec<AnyView> = (0..count.get().parse::<usize>().unwrap_or(0))
            .map(|at| {
                let chart = Signal::derive(move || {
                    charts.with(|all| all.get(at).cloned().unwrap_or_else(none))
                });
                view! { <ChartView chart=chart/> }.into_any()
            })
            .collect();
        all.into_any()
    })
}

/// What stands where a chart was, until the list is drawn anew.
fn none() -> Chart {
    Chart {
        key: String::new(),
        title: String::new(),
        x: Axis::number("", ""),
        y: Axis::number("", ""),
        series: Vec::new(),
        bands: Vec::new(),
        notes: Vec::new(),
    }
}
