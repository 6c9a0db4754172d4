//! A fault table filled in by hand: what does the pattern mean?

use std::sync::Arc;

use leptos::prelude::*;

use crate::browser::{Narrow, value_of};
use crate::components::drawn::{Act, Draw, Drawn};
use crate::erased::memo;
use crate::markup::Markup;
use crate::network::markup::{drawing, findings, line, typed};
use crate::network::state::findings::{findings as diagnose, marks, table};
use crate::network::state::net::Net;
use crate::network::state::picture::Picture;
use crate::network::state::typed::{SHAPES, Typed};
use crate::network::store::Store;

/// The table, its diagnosis and its drawing.
#[component]
pub(super) fn FaultTablePage() -> impl IntoView {
    let store = Store::get();
    let Narrow(narrow) = expect_context();
    let of_net = move || store.net.with_untracked(taken).unwrap_or_default();
    let typed_table = RwSignal::new(of_net());
    let trouble = RwSignal::new(String::new());
    let diagnosis =
        memo(move || typed_table.with(|t| diagnose(t.shape, &table(&t.units, t.ports))));
    let controls: Draw = Arc::new(move |html: &mut Markup| {
        let live = !store.bus.with(String::is_empty);
        typed_table.with(|t| typed::controls(html, t, live));
    });
    let grid: Draw = Arc::new(move |html: &mut Markup| typed_table.with(|t| typed::grid(html, t)));
    let problem: Draw = Arc::new(move |html: &mut Markup| {
        trouble.with(|words| {
            if !words.is_empty() {
                html.open(
                    "p",
                    &[("class", "notice"), ("data-testid", "typed-problem")],
                );
                html.text(words).close("p");
            }
        });
    });
    let said: Draw = Arc::new(move |html: &mut Markup| {
        diagnosis.with(|d| {
            if let Some(d) = d {
                findings::findings(html, d, &|_| String::new());
            }
        });
    });
    let drawn: Draw = Arc::new(move |html: &mut Markup| {
        typed_table.with(|t| {
            let marks = diagnosis.with(|d| {
                d.as_ref()
                    .map(|d| marks(d, t.units.len()))
                    .unwrap_or_default()
            });
            let picture = Picture::of_faults(&t.units, t.shape, t.ports, marks);
            match narrow.get() {
                true => line::line(html, &picture, None),
                false => drawing::drawing(html, &picture, None),
            }
        });
    });
    let on_act = Callback::new(move |act: Act| {
        let number = |name| act.element.get_attribute(name)?.parse::<usize>().ok();
        match act.name.as_str() {
            "shape" => {
                let found = SHAPES.iter().find(|(key, ..)| *key == act.value);
                if let Some((.., shape)) = found {
                    typed_table.update(|t| t.set_shape(*shape));
                }
            }
            "units" => {
                if let Ok(units) = act.value.parse() {
                    typed_table.update(|t| t.resize(units));
                }
            }
            "example" => {
                if let Some(example) = Typed::example(&act.value) {
                    typed_table.set(example);
                }
            }
            "take" => typed_table.set(of_net()),
            "clear" => typed_table.update(|t| {
                *t = Typed::new(t.shape, t.units.len());
            }),
            _ => {
                if let (Some(at), Some(port)) = (number("data-at"), number("data-port")) {
                    typed_table.update(|t| t.toggle(at, port));
                }
            }
        }
    });
    let paste = move |text: String| match typed_table.with_untracked(|t| t.paste(&text)) {
        Ok(pasted) => {
            trouble.set(String::new());
            typed_table.set(pasted);
        }
        Err(_) if text.trim().is_empty() => trouble.set(String::new()),
        Err(words) => trouble.set(words),
    };
    view! {
        <div class="net-page typed-page" data-testid="fault-table">
            <p class="quiet typed-about">
                "The host's own faults by unit and port, in the order of the cable from host port 1: 1 is a fault. What the pattern means follows section 4.3.2 of the guide."
            </p>
            <Drawn class="toolbar" draw=controls on_act=on_act/>
            <Drawn class="net-findings" role="status" draw=said/>
            <Drawn class="typed-drawing" draw=drawn/>
            <div class="typed-columns">
                <Drawn class="typed-bits" draw=grid on_act=on_act/>
                <div class="typed-paste">
                    <textarea
                        class="mono"
                        data-testid="typed-paste"
                        spellcheck="false"
                        aria-label="Fault bits, a line for each unit"
                        placeholder="Or paste: a line for each unit with its address, A and B, such as 4 1 0"
                        on:input=move |event| paste(value_of(&event))
                    ></textarea>
                    <Drawn class="" draw=problem/>
                </div>
            </div>
        </div>
    }
}

/// The faults of a network on the line.
fn taken(net: &Net) -> Option<Typed> {
    let shape = net.shape?;
    Some(Typed {
        shape,
        ports: net.ports.len().max(1),
        units: net.units.iter().map(|u| (u.info.unit, u.fault)).collect(),
    })
}
