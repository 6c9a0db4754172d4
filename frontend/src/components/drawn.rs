//! Parts of the page that are drawn as markup and brought up to date in place.

use std::sync::Arc;

use leptos::html::Div;
use leptos::prelude::*;
use wasm_bindgen::prelude::*;
use web_sys::{Element, HtmlInputElement, HtmlSelectElement, Node};

use crate::erased::effect;
use crate::markup::Markup;

/// Draws a part; it is drawn again when a signal that it follows changes.
pub type Draw = Arc<dyn Fn(&mut Markup) + Send + Sync>;

/// What was done to a control: an element with `data-act`.
#[derive(Clone, Debug)]
pub struct Act {
    /// The name in `data-act`.
    pub name: String,
    /// Its value, for fields and lists of choices; `on` or empty for a box to tick.
    pub value: String,
    /// The control.
    pub element: Element,
}

/// A part of the page made of markup. Elements stay where they are while only their text or
/// attributes change, so that focus, clicks and typing are not disturbed.
#[component]
pub fn Drawn(
    /// Its class.
    class: &'static str,
    /// Draws what is in it.
    draw: Draw,
    /// Called when one of its controls is used.
    #[prop(optional)]
    on_act: Option<Callback<Act>>,
    /// Its `data-testid`.
    #[prop(optional)]
    testid: Option<&'static str>,
    /// Its ARIA role.
    #[prop(optional)]
    role: Option<&'static str>,
    /// Its name for those who do not see it.
    #[prop(optional)]
    label: Option<&'static str>,
) -> impl IntoView {
    let node = NodeRef::<Div>::new();
    effect(move || {
        let Some(node) = node.get() else { return };
        let mut html = Markup::new();
        draw(&mut html);
        morph_into(&node, &html.finish());
    });
    let act = move |event: web_sys::Event| {
        if let (Some(on_act), Some(act)) = (on_act, act_of(&event)) {
            on_act.run(act);
        }
    };
    view! {
        <div
            class=class
            role=role
            aria-label=label
            data-testid=testid
            node_ref=node
            on:click=move |event| act(event.into())
            on:change=act
            on:input=act
        ></div>
    }
}

/// The control that an event is about. Boxes and lists report changes, fields what is typed,
/// everything else clicks.
fn act_of(event: &web_sys::Event) -> Option<Act> {
    let target = event.target()?.dyn_into::<Element>().ok()?;
    let element = target.closest("[data-act]").ok()??;
    let (wanted, value) = if let Some(list) = element.dyn_ref::<HtmlSelectElement>() {
        ("change", list.value())
    } else if let Some(field) = element.dyn_ref::<HtmlInputElement>() {
        match field.type_().as_str() {
            "checkbox" | "radio" if !field.checked() => ("change", String::new()),
            "checkbox" => ("change", "on".to_owned()),
            "radio" => ("change", field.value()),
            _ => ("input", field.value()),
        }
    } else {
        ("click", String::new())
    };
    let name = element.get_attribute("data-act")?;
    (event.type_() == wanted).then_some(Act {
        name,
        value,
        element,
    })
}

/// Makes the content of an element what the HTML says, touching only what differs.
pub fn morph_into(element: &Element, html: &str) {
    let Ok(fresh) = document().create_element("div") else {
        return;
    };
    fresh.set_inner_html(html);
    children(element, &fresh);
}

fn children(old: &Element, new: &Element) {
    let (mut now, mut next) = (old.first_child(), new.first_child());
    while let Some(fresh) = next {
        next = fresh.next_sibling();
        match now {
            None => {
                // Fails only for nodes that can't have children.
                let _infallible = old.append_child(&fresh);
            }
            Some(node) => {
                now = node.next_sibling();
                one(old, &node, &fresh);
            }
        }
    }
    while let Some(node) = now {
        now = node.next_sibling();
        let _infallible = old.remove_child(&node);
    }
}

fn one(parent: &Element, node: &Node, fresh: &Node) {
    match (node.dyn_ref::<Element>(), fresh.dyn_ref::<Element>()) {
        (Some(old), Some(new)) if old.tag_name() == new.tag_name() => {
            attributes(old, new);
            if old.inner_html() != new.inner_html() {
                children(old, new);
            }
            values(old);
        }
        (None, None) => {
            if node.node_value() != fresh.node_value() {
                node.set_node_value(fresh.node_value().as_deref());
            }
        }
        _ => {
            let _infallible = parent.replace_child(fresh, node);
        }
    }
}

fn attributes(old: &Element, new: &Element) {
    let names = |element: &Element| -> Vec<String> {
        let names = element.get_attribute_names();
        names.iter().filter_map(|n| n.as_string()).collect()
    };
    for name in names(old) {
        // What somebody opened stays open.
        if !new.has_attribute(&name) && name != "open" {
            // Fails only for names that are none.
            let _infallible = old.remove_attribute(&name);
        }
    }
    for name in names(new) {
        let value = new.get_attribute(&name).unwrap_or_default();
        if old.get_attribute(&name).as_ref() != Some(&value) {
            let _infallible = old.set_attribute(&name, &value);
        }
    }
}

/// A control shows what `data-value` says, unless somebody types in it right now.
fn values(element: &Element) {
    let Some(value) = element.get_attribute("data-value") else {
        return;
    };
    if let Some(list) = element.dyn_ref::<HtmlSelectElement>() {
        if list.value() != value {
            list.set_value(&value);
        }
    } else if let Some(field) = element.dyn_ref::<HtmlInputElement>() {
        let is_box = matches!(field.type_().as_str(), "checkbox" | "radio");
        if is_box {
            field.set_checked(!value.is_empty());
        } else if field.value() != value && document().active_element().as_ref() != Some(element) {
            field.set_value(&value);
        }
    }
}
