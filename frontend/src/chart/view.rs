//! A chart in the page: pointer, keys, buttons.

use std::sync::Arc;

use leptos::html::Div;
use leptos::prelude::*;
use leptos::task::spawn_local;
use wasm_bindgen::prelude::*;

use super::cursor::{dragged, key, nearest, readout, stops, zoomed};
use super::svg::{Frame, Look, Size, draw};
use super::{Chart, View, export, table};
use crate::browser::listen;
use crate::components::drawn::{Act, Draw, Drawn, morph_into};
use crate::components::icon::Glyph;
use crate::erased::{effect, memo};
use crate::markup::Markup;

/// A drag shorter than this is a click.
const DRAG: f64 = 6.0;

/// A chart with its values at the cursor, zoom, table and files.
#[component]
pub fn ChartView(
    /// What to draw.
    #[prop(into)]
    chart: Signal<Chart>,
) -> impl IntoView {
    let view = RwSignal::new(View::default());
    let width = RwSignal::new(720_i64);
    let table_open = RwSignal::new(false);
    let failed = RwSignal::new(false);
    let plot = NodeRef::<Div>::new();
    observe_width(plot, width);
    let size = move || {
        let width = pixels(width.get());
        chart.with(|c| Size::of(c, width))
    };
    // Another picture begins with all of it.
    let shown = memo(move || {
        chart.with(|c| {
            let (low, high) = c.extent().unwrap_or_default();
            format!("{} {} {}", c.key, low.to_bits(), high.to_bits())
        })
    });
    effect(move || {
        shown.track();
        view.set(View::default());
        failed.set(false);
    });
    effect(move || {
        let Some(plot) = plot.get() else { return };
        let size = size();
        let picture = chart.with(|c| draw(c, size, view.get(), Look::Page));
        morph_into(&plot, &picture);
    });
    let frame = move || {
        let size = untrack(size);
        chart.with_untracked(|c| Frame::of(c, size, view.get_untracked()))
    };
    let place_of = move |event: &web_sys::PointerEvent| -> Option<(f64, f64)> {
        let left = plot.get_untracked()?.get_bounding_client_rect().left();
        let pixels = f64::from(event.client_x()) - left;
        Some((pixels, frame().at(pixels)))
    };
    let point_at = move |place: f64| {
        let cursor = chart.with_untracked(|c| nearest(&stops(c), place));
        view.update(|v| v.cursor = cursor);
    };
    let on_move = move |event: &web_sys::PointerEvent| {
        let Some((_, place)) = place_of(event) else {
            return;
        };
        view.update_untracked(|v| {
            if let Some((from, _)) = v.drag {
                v.drag = Some((from, place));
            }
        });
        point_at(place);
    };
    let on_down = move |event: &web_sys::PointerEvent| {
        let Some((_, place)) = place_of(event) else {
            return;
        };
        point_at(place);
        // A finger moves the cursor; only a mouse or pen drags.
        if event.button() == 0 && event.pointer_type() != "touch" {
            view.update(|v| v.drag = Some((place, place)));
            if let Some(plot) = plot.get_untracked() {
                // Fails only if the pointer is gone by now.
                let _gone = plot.set_pointer_capture(event.pointer_id());
            }
        }
    };
    let on_up = move |event: &web_sys::PointerEvent| {
        let Some((_, place)) = place_of(event) else {
            return;
        };
        let Some((from, _)) = view.get_untracked().drag else {
            return;
        };
        let frame = frame();
        let far = (frame.px(from) - frame.px(place)).abs() >= DRAG;
        view.update(|v| {
            *v = if far {
                chart.with_untracked(|c| dragged(c, *v, from, place))
            } else {
                View { drag: None, ..*v }
            };
        });
    };
    let on_key = move |event: &web_sys::KeyboardEvent| {
        if event.ctrl_key() || event.alt_key() || event.meta_key() {
            return;
        }
        let next = chart.with_untracked(|c| key(c, view.get_untracked(), &event.key()));
        if let Some(next) = next {
            event.prevent_default();
            event.stop_propagation();
            view.set(next);
        }
    };
    let tools: Draw = Arc::new(move |html: &mut Markup| {
        let view = view.get();
        chart.with(|c| draw_tools(html, c, view, table_open.get()));
        if failed.get() {
            html.node("span", "quiet", "The browser could not save the picture.");
        }
    });
    let on_act = Callback::new(move |act: Act| {
        let now = view.get_untracked();
        match act.name.as_str() {
            "in" => view.set(chart.with_untracked(|c| zoomed(c, now, 0.5))),
            "out" => view.set(chart.with_untracked(|c| zoomed(c, now, 2.0))),
            "whole" => view.set(View { range: None, ..now }),
            "data" => table_open.update(|open| *open = !*open),
            extension => {
                let (extension, chart) = (extension.to_owned(), chart.get_untracked());
                spawn_local(async move {
                    let done = export::save(chart, now, &extension).await;
                    let _gone = failed.try_set(done.is_err());
                });
            }
        }
    });
    let values: Draw = Arc::new(move |html: &mut Markup| {
        chart.with(|c| readout(html, c, view.get()));
    });
    let numbers: Draw = Arc::new(move |html: &mut Markup| {
        if table_open.get() {
            chart.with(|c| table::draw(html, c));
        }
        chart.with(|c| {
            for note in &c.notes {
                html.node("p", "quiet chart-note", note);
            }
        });
    });
    // One listener for all, and attributes set by hand: each handler and each changing attribute of
    // a view would bring its own machinery.
    plot.on_load(move |element| {
        let names = [
            "pointermove",
            "pointerdown",
            "pointerup",
            "pointercancel",
            "dblclick",
            "keydown",
        ];
        listen(&element, &names, move |event| {
            // The element may serve another chart by now.
            if view.try_get_untracked().is_none() {
                return;
            }
            if let Some(event) = event.dyn_ref::<web_sys::KeyboardEvent>() {
                on_key(event);
            } else if event.type_() == "dblclick" {
                view.update(|v| v.range = None);
            } else if let Some(event) = event.dyn_ref::<web_sys::PointerEvent>() {
                match event.type_().as_str() {
                    "pointermove" => on_move(event),
                    "pointerdown" => on_down(event),
                    "pointerup" => on_up(event),
                    _ => view.update(|v| v.drag = None),
                }
            }
        });
    });
    effect(move || {
        let Some(plot) = plot.get() else { return };
        let (key, title) = chart.with(|c| (c.key.clone(), c.title.clone()));
        let label = format!("{title}. Arrow keys read values, plus and minus zoom, 0 shows all.");
        // Fails only for names that are none.
        let _infallible = plot.set_attribute("aria-label", &label);
        if let Some(figure) = plot.parent_element() {
            let _infallible = figure.set_attribute("data-chart", &key);
        }
    });
    view! {
        <figure class="chart" data-testid="chart">
            <Drawn class="chart-head" draw=tools on_act=on_act/>
            <Drawn class="chart-readout" draw=values testid="chart-readout" role="status"/>
            <div class="chart-plot" tabindex="0" role="group" node_ref=plot></div>
            <Drawn class="chart-data" draw=numbers/>
        </figure>
    }
}

/// The title of a chart and its buttons.
fn draw_tools(html: &mut Markup, chart: &Chart, view: View, open: bool) {
    html.node("h3", "chart-title", &chart.title);
    html.open("div", &[("class", "chart-tools")]);
    for (act, text, name) in [
        ("in", "+", "Show a smaller part"),
        ("out", "\u{2212}", "Show a larger part"),
    ] {
        let disabled = act == "out" && view.range.is_none();
        button(html, act, text, name, disabled, None);
    }
    button(
        html,
        "whole",
        "Whole",
        "Show all of it",
        view.range.is_none(),
        None,
    );
    button(
        html,
        "data",
        "Data",
        "Numbers as a table",
        false,
        Some(open),
    );
    html.icon(Glyph::Save);
    for (act, text) in [("svg", "SVG"), ("png", "PNG"), ("csv", "CSV")] {
        button(html, act, text, &format!("Save as {text}"), false, None);
    }
    html.close("div");
}

fn button(
    html: &mut Markup,
    act: &str,
    text: &str,
    name: &str,
    disabled: bool,
    pressed: Option<bool>,
) {
    let testid = match act {
        "svg" | "png" | "csv" => format!("chart-save-{act}"),
        _ => format!("chart-{act}"),
    };
    let mut attributes = vec![
        ("class", "chart-button"),
        ("data-act", act),
        ("data-testid", &testid),
        ("title", name),
        ("aria-label", name),
    ];
    if disabled {
        attributes.push(("disabled", ""));
    }
    if let Some(pressed) = pressed {
        attributes.push(("aria-pressed", if pressed { "true" } else { "false" }));
    }
    html.open("button", &attributes).text(text).close("button");
}

fn pixels(width: i64) -> f64 {
    i32::try_from(width).map_or(720.0, f64::from)
}

/// Keeps the width of the plot.
fn observe_width(plot: NodeRef<Div>, width: RwSignal<i64>) {
    plot.on_load(move |element| {
        let watched = element.clone();
        let closure = Closure::<dyn Fn()>::new(move || {
            let now = i64::from(watched.client_width());
            // The plot may be hidden, or gone already.
            if now > 0 && width.try_get_untracked().is_some_and(|w| w != now) {
                let _gone = width.try_set(now);
            }
        });
        if let Ok(observer) = web_sys::ResizeObserver::new(closure.as_ref().unchecked_ref()) {
            observer.observe(&element);
            // Lives until the element does not.
            closure.forget();
        }
    });
}
