//! The few things of the browser that components need, each allowed to fail.

use leptos::prelude::*;
use wasm_bindgen::prelude::*;

/// A remembered setting; `None` if there is none or the browser keeps nothing.
#[must_use]
pub fn remembered(key: &str) -> Option<String> {
    let storage = web_sys::window()?.local_storage().ok()??;
    storage.get_item(&format!("valvescope.{key}")).ok()?
}

/// Remembers a setting, if the browser lets us.
pub fn remember(key: &str, value: &str) {
    let storage = web_sys::window().and_then(|w| w.local_storage().ok().flatten());
    if let Some(storage) = storage {
        // Full or forbidden: the setting holds until the page is closed.
        let _refused = storage.set_item(&format!("valvescope.{key}"), value);
    }
}

/// Puts text on the clipboard; false if the browser has none here.
pub async fn copy(text: String) -> bool {
    let clipboard = web_sys::window().map(|w| w.navigator().clipboard());
    let Some(clipboard) = clipboard.filter(|c| !JsValue::from(c).is_undefined()) else {
        return false;
    };
    crate::task::promise(clipboard.write_text(&text))
        .await
        .is_some()
}

/// Offers text as a file to be saved.
pub fn save(name: &str, text: &str) {
    // Fails only where the browser forbids downloads, and then says so itself.
    let _forbidden = try_save(name, text);
}

fn try_save(name: &str, text: &str) -> Result<(), JsValue> {
    let parts = js_sys::Array::of1(&JsValue::from_str(text));
    let options = web_sys::BlobPropertyBag::new();
    options.set_type("text/plain;charset=utf-8");
    let blob = web_sys::Blob::new_with_str_sequence_and_options(&parts, &options)?;
    let url = web_sys::Url::create_object_url_with_blob(&blob)?;
    let link: web_sys::HtmlAnchorElement = document().create_element("a")?.unchecked_into();
    link.set_href(&url);
    link.set_download(name);
    link.click();
    web_sys::Url::revoke_object_url(&url)
}

/// Minutes that local time is ahead of UTC at a moment.
#[must_use]
pub fn offset_minutes(wall_ms: u64) -> i32 {
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        reason = "milliseconds since 1970 and minutes are far below the limits"
    )]
    let minutes = {
        let date = js_sys::Date::new(&JsValue::from_f64(wall_ms as f64));
        -(date.get_timezone_offset() as i32)
    };
    minutes
}

/// True if the page came from a disk instead of a server.
#[must_use]
pub fn is_file() -> bool {
    location().protocol().is_ok_and(|p| p == "file:")
}

/// Text of the field that an event came from.
#[must_use]
pub fn value_of(event: &web_sys::Event) -> String {
    event_target_value(event)
}

/// True if the focus is where text is typed.
#[must_use]
pub fn is_typing() -> bool {
    let Some(element) = document().active_element() else {
        return false;
    };
    match element.tag_name().as_str() {
        "TEXTAREA" | "SELECT" => true,
        "INPUT" => !matches!(
            element.get_attribute("type").as_deref(),
            Some("checkbox" | "radio" | "button" | "file")
        ),
        _ => false,
    }
}

/// Puts the focus on the first element with this selector that is shown.
pub fn focus(selector: &str) {
    let Ok(found) = document().query_selector_all(selector) else {
        return;
    };
    for at in 0..found.length() {
        let element = found
            .item(at)
            .and_then(|n| n.dyn_into::<web_sys::HtmlElement>().ok());
        if let Some(element) = element.filter(|e| e.offset_parent().is_some()) {
            // Fails only without a window.
            let _infallible = element.focus();
            return;
        }
    }
}

/// Calls `act` for events with these names, as long as the element lives.
pub fn listen(element: &web_sys::Element, names: &[&str], act: impl Fn(&web_sys::Event) + 'static) {
    let closure = Closure::<dyn Fn(web_sys::Event)>::new(move |event| act(&event));
    for name in names {
        // Fails only for listeners that are none.
        let _infallible =
            element.add_event_listener_with_callback(name, closure.as_ref().unchecked_ref());
    }
    // Lives until the element does not.
    closure.forget();
}

/// Scrolls an element into view with the least movement.
pub fn reveal(element: &web_sys::Element) {
    let options = web_sys::ScrollIntoViewOptions::new();
    options.set_block(web_sys::ScrollLogicalPosition::Nearest);
    element.scroll_into_view_with_scroll_into_view_options(&options);
}

/// True while the window is narrower than the two panes need.
#[derive(Clone, Copy, Debug)]
pub struct Narrow(pub RwSignal<bool>);

/// Watches the width of the window.
pub fn provide_narrow() {
    let query = web_sys::window()
        .and_then(|w| w.match_media("(max-width: 719.98px)").ok())
        .flatten();
    let narrow = RwSignal::new(query.as_ref().is_some_and(web_sys::MediaQueryList::matches));
    if let Some(query) = query {
        let again = query.clone();
        let listener = Closure::<dyn Fn()>::new(move || {
            // Gone with a program that was closed.
            let _gone = narrow.try_set(again.matches());
        });
        query.set_onchange(Some(listener.as_ref().unchecked_ref()));
        // It costs little, and the page lives as long as its window.
        listener.forget();
    }
    provide_context(Narrow(narrow));
}
