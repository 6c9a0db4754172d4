//! Torque signatures, partial strokes and trends.

use std::sync::Arc;

use leptos::prelude::*;

use super::registers::{fill_once, on_tool, toolbar};
use super::{charts, part};
use crate::actuator::markup::{curves, signature, tools};
use crate::actuator::state::curves::{FILES, Preset, chart, rows, traces};
use crate::actuator::state::dossier::{Dossier, Subject};
use crate::actuator::state::strokes::{self, Kind};
use crate::actuator::state::trends::{self, RECORDERS};
use crate::actuator::state::wanted::Wanted;
use crate::actuator::store::Store;
use crate::components::drawn::{Act, Draw, Drawn};
use crate::erased::memo;
use crate::markup::Markup;

/// How many curves the device has stored: HR 3511 to 3514.
const STORED: (u16, u16) = (3511, 4);

/// The curves in the registers, and the reference and latest of the files.
fn first(dossier: &Dossier) -> Wanted {
    Wanted {
        what: "curves".to_owned(),
        files: FILES.iter().flat_map(|f| [f.0, f.0 + 1]).collect(),
        ..Wanted::default()
    }
    .rows(&rows(dossier))
    .registers(dossier, &[STORED, signature::SETTINGS])
}

/// The same, and every file that is stored.
fn all(dossier: &Dossier) -> Wanted {
    Wanted {
        files: Vec::new(),
        runs: FILES.map(|f| f.0).to_vec(),
        ..first(dossier)
    }
}

fn all_strokes(dossier: &Dossier) -> Wanted {
    Wanted {
        what: "partial strokes".to_owned(),
        runs: [Kind::Pst, Kind::Efs].map(Kind::first).to_vec(),
        ..Wanted::default()
    }
    .registers(dossier, &[STORED, strokes::LIMITS, (3023, 4)])
}

fn recorders(_: &Dossier) -> Wanted {
    Wanted {
        what: "recorders".to_owned(),
        files: RECORDERS.map(|r| r.0).to_vec(),
        ..Wanted::default()
    }
}

/// The curves of a device.
#[component]
pub(super) fn CurvesPage() -> impl IntoView {
    let store = Store::get();
    let show = memo(move || store.query("show").unwrap_or_default());
    let choose: Draw = Arc::new(move |html: &mut Markup| {
        let open = show.get();
        curves::choose(html, &open, |query| store.address("curves", query));
    });
    let body = part(move || match show.get().as_str() {
        "pst" => view! { <StrokesPage kind=Kind::Pst/> }.into_any(),
        "efs" => view! { <StrokesPage kind=Kind::Efs/> }.into_any(),
        "trends" => view! { <TrendsPage/> }.into_any(),
        _ => view! { <TorquePage/> }.into_any(),
    });
    view! {
        <div class="icon-page" data-testid="page-curves">
            <Drawn class="toolbar" draw=choose/>
            {body}
        </div>
    }
}

/// Torque over position.
#[component]
fn TorquePage() -> impl IntoView {
    let store = Store::get();
    fill_once(store, first);
    let found = memo(move || store.with(traces));
    let chosen = RwSignal::new(None::<Vec<String>>);
    // Until somebody chooses, the latest strokes against their references.
    let shown = memo(move || {
        chosen.get().unwrap_or_else(|| {
            found.with(|found| {
                let mut keys = Preset::Opening.of(found);
                if keys.is_empty() {
                    keys = Preset::Closing.of(found);
                }
                keys
            })
        })
    });
    let pictures = memo(move || {
        found.with(|found| {
            let shown = shown.get();
            let traces: Vec<_> = found.iter().filter(|t| shown.contains(&t.key)).collect();
            if traces.is_empty() {
                Vec::new()
            } else {
                vec![chart(&traces)]
            }
        })
    });
    let list: Draw = Arc::new(move |html: &mut Markup| {
        found.with(|found| shown.with(|shown| curves::list(html, found, shown)));
    });
    let about: Draw = Arc::new(move |html: &mut Markup| {
        store.with(|d| {
            curves::stored_line(html, d);
            tools::failures(html, d, |s| match s {
                Subject::File(file) => (1000..3000).contains(&file),
                Subject::Block(..) => true,
                _ => false,
            });
            if found.with(Vec::is_empty) {
                curves::nothing(html, d, store.is_live());
            }
        });
    });
    let numbers: Draw = Arc::new(move |html: &mut Markup| {
        found.with(|found| {
            let shown = shown.get();
            let traces: Vec<_> = found.iter().filter(|t| shown.contains(&t.key)).collect();
            store.with(|d| signature::signatures(html, d, &traces, found));
            curves::numbers(html, &traces);
        });
    });
    let on_act = Callback::new(move |act: Act| {
        if on_tool(store, &act, first) {
            return;
        }
        let attribute = |name| act.element.get_attribute(name).unwrap_or_default();
        match act.name.as_str() {
            "read-all" => {
                let wanted = store.site.with_untracked(|s| all(&s.dossier));
                store.read(wanted);
            }
            "preset" => {
                let key = attribute("data-key");
                let preset = Preset::ALL.into_iter().find(|(_, k, _)| *k == key);
                if let Some((preset, ..)) = preset {
                    chosen.set(Some(found.with_untracked(|found| preset.of(found))));
                }
            }
            _ => {
                let key = attribute("data-key");
                let mut keys = shown.get_untracked();
                match keys.iter().position(|k| *k == key) {
                    Some(at) => {
                        keys.remove(at);
                    }
                    None => keys.push(key),
                }
                chosen.set(Some(keys));
            }
        }
    });
    view! {
        <Drawn
            class="toolbar"
            draw=toolbar(store, &[("read", "Read curves"), ("read-all", "Read all stored")])
            on_act=on_act
        />
        <Drawn class="icon-intro" draw=about/>
        <div class="icon-curves">
            <Drawn class="icon-curve-list" draw=list on_act=on_act/>
            <div class="icon-curve-view">
                {charts(pictures)}
                <Drawn class="icon-numbers" draw=numbers/>
            </div>
        </div>
    }
}

/// Partial strokes or emergency strokes.
#[component]
fn StrokesPage(
    /// Which of them.
    kind: Kind,
) -> impl IntoView {
    let store = Store::get();
    fill_once(store, all_strokes);
    let found = memo(move || store.with(|d| strokes::strokes(d, kind)));
    let chosen = RwSignal::new(None::<u16>);
    let at = memo(move || {
        let wanted = chosen.get();
        found.with(|found| {
            let latest = || found.iter().find(|s| s.number > 0).or(found.first());
            let chosen = found.iter().find(|s| Some(s.number) == wanted);
            chosen.or_else(latest).map(|s| s.number)
        })
    });
    let pictures = memo(move || {
        let at = at.get();
        found.with(|found| {
            let stroke = found.iter().find(|s| Some(s.number) == at);
            let reference = found.iter().find(|s| s.number == 0);
            let limits = store.with(|d| strokes::limits(d, reference));
            stroke
                .map(|s| strokes::chart(s, reference, &limits))
                .into_iter()
                .collect::<Vec<_>>()
        })
    });
    let list: Draw = Arc::new(move |html: &mut Markup| {
        found.with(|found| curves::stroke_list(html, found, at.get()));
    });
    let about: Draw = Arc::new(move |html: &mut Markup| {
        store.with(|d| {
            curves::stored_line(html, d);
            tools::failures(html, d, |s| match s {
                Subject::File(file) => (kind.first()..=kind.first() + 16).contains(&file),
                Subject::Block(..) => true,
                _ => false,
            });
            if found.with(Vec::is_empty) {
                curves::nothing(html, d, store.is_live());
            }
        });
    });
    let words: Draw = Arc::new(move |html: &mut Markup| {
        let at = at.get();
        found.with(|found| {
            let reference = found.iter().find(|s| s.number == 0);
            if let Some(stroke) = found.iter().find(|s| Some(s.number) == at) {
                let limits = store.with(|d| strokes::limits(d, reference));
                curves::stroke(html, stroke, &limits);
            }
        });
    });
    let on_act = Callback::new(move |act: Act| {
        if on_tool(store, &act, all_strokes) {
            return;
        }
        let key = act.element.get_attribute("data-key").unwrap_or_default();
        chosen.set(key.parse().ok());
    });
    view! {
        <Drawn class="toolbar" draw=toolbar(store, &[("read", "Read strokes")]) on_act=on_act/>
        <Drawn class="icon-intro" draw=about/>
        <div class="icon-curves">
            <Drawn class="icon-curve-list" draw=list on_act=on_act/>
            <div class="icon-curve-view">
                <Drawn class="icon-stroke" draw=words/>
                {charts(pictures)}
            </div>
        </div>
    }
}

/// What the recorders wrote down.
#[component]
fn TrendsPage() -> impl IntoView {
    let store = Store::get();
    fill_once(store, recorders);
    let pictures = memo(move || {
        store.with(|d| {
            let files = RECORDERS.iter();
            files
                .flat_map(|(file, _)| trends::charts(d, *file))
                .collect::<Vec<_>>()
        })
    });
    let about: Draw = Arc::new(move |html: &mut Markup| {
        store.with(|d| {
            curves::recorders(html, d);
            tools::failures(html, d, |s| matches!(s, Subject::File(5100 | 5200)));
            if pictures.with(Vec::is_empty) {
                curves::nothing(html, d, store.is_live());
            }
        });
    });
    let on_act = Callback::new(move |act: Act| {
        on_tool(store, &act, recorders);
    });
    view! {
        <Drawn class="toolbar" draw=toolbar(store, &[("read", "Read recorders")]) on_act=on_act/>
        <Drawn class="icon-intro" draw=about/>
        <div class="icon-body">{charts(pictures)}</div>
    }
}
