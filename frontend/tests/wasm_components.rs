//! The wiring of the page, in a browser: what is pasted is listed, what is clicked is marked.
#![cfg(target_arch = "wasm32")]

use frontend::App;
use leptos::prelude::*;
use wasm_bindgen::prelude::*;
use wasm_bindgen_test::{wasm_bindgen_test, wasm_bindgen_test_configure};
use web_sys::{Element, HtmlElement};

wasm_bindgen_test_configure!(run_in_browser);

/// The worked example of LMAIM4019-00, section 3.2, and a read of an ICON3000v2.
const POLL: &str = "7D0300070003BFF6\n7D0306003D084400003E07\n";

/// A page in a place of its own; it goes away with this value.
struct Page {
    root: HtmlElement,
    _mounted: Box<dyn core::any::Any>,
}

impl Page {
    /// Mounts the page at an address.
    async fn at(hash: &str) -> Self {
        window().location().set_hash(hash).unwrap();
        let root: HtmlElement = document().create_element("div").unwrap().unchecked_into();
        document().body().unwrap().append_child(&root).unwrap();
        let mounted = mount_to(root.clone(), App);
        let page = Self {
            root,
            _mounted: Box::new(mounted),
        };
        page.wait_for("main").await;
        page
    }

    fn all(&self, selector: &str) -> Vec<Element> {
        let found = self.root.query_selector_all(selector).unwrap();
        (0..found.length())
            .filter_map(|at| found.item(at))
            .map(JsCast::unchecked_into)
            .collect()
    }

    async fn wait_for(&self, selector: &str) -> HtmlElement {
        for _ in 0..200 {
            if let Some(found) = self.root.query_selector(selector).unwrap() {
                return found.unchecked_into();
            }
            frontend::task::sleep(10).await;
        }
        panic!("no {selector} in {}", self.root.inner_html());
    }

    async fn click(&self, selector: &str) {
        self.wait_for(selector).await.click();
        frontend::task::sleep(30).await;
    }

    /// Types into the input of the decode page.
    async fn write(&self, text: &str) {
        let field: web_sys::HtmlTextAreaElement =
            self.wait_for("[data-testid=paste]").await.unchecked_into();
        field.set_value(text);
        let event = web_sys::Event::new("input").unwrap();
        field.dispatch_event(&event).unwrap();
        frontend::task::sleep(60).await;
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        self.root.remove();
    }
}

fn key(target: &HtmlElement, name: &str) {
    let init = web_sys::KeyboardEventInit::new();
    init.set_key(name);
    init.set_bubbles(true);
    init.set_cancelable(true);
    let event = web_sys::KeyboardEvent::new_with_keyboard_event_init_dict("keydown", &init);
    target.dispatch_event(&event.unwrap()).unwrap();
}

fn hover(target: &HtmlElement) {
    let init = web_sys::MouseEventInit::new();
    init.set_bubbles(true);
    let event = web_sys::MouseEvent::new_with_mouse_event_init_dict("mouseover", &init);
    target.dispatch_event(&event.unwrap()).unwrap();
}

fn offsets(elements: &[Element]) -> Vec<String> {
    let offset = |e: &Element| e.get_attribute("data-offset");
    elements.iter().filter_map(offset).collect()
}

#[wasm_bindgen_test]
async fn what_is_pasted_is_listed_and_linked() {
    let page = Page::at("#/decode").await;
    page.write(POLL).await;
    page.wait_for("[data-testid=frame-row]").await;
    assert_eq!(page.all("[data-testid=frame-row]").len(), 2);

    page.click("[data-testid=frame-row][data-index='1']").await;
    page.wait_for("[data-path='byte_count']").await;
    assert_eq!(page.all("[data-testid=hex-byte]").len(), 11);

    // A click on a field marks its bytes.
    page.click("[data-path='byte_count']").await;
    let selected = page.all("[data-testid=hex-byte].selected");
    assert_eq!(offsets(&selected), ["2"]);

    // A click on a byte selects its field.
    page.click("[data-offset='9']").await;
    let crc = page.wait_for("[data-path='crc']").await;
    assert!(crc.class_list().contains("selected"));
    let selected = page.all("[data-testid=hex-byte].selected");
    assert_eq!(offsets(&selected), ["9", "10"]);
    let facts = page.wait_for("[data-testid=field-facts]").await;
    assert!(facts.text_content().unwrap().contains("0x3E07"));
}

#[wasm_bindgen_test]
async fn hovering_lights_the_other_side() {
    let page = Page::at("#/decode").await;
    page.write(POLL).await;
    page.click("[data-testid=frame-row][data-index='0']").await;
    hover(&page.wait_for("[data-path='crc']").await);
    frontend::task::sleep(30).await;
    assert_eq!(offsets(&page.all(".marked[data-offset]")), ["6", "7"]);
    hover(&page.wait_for("[data-offset='0']").await);
    frontend::task::sleep(30).await;
    let unit = page.wait_for("[data-path='unit']").await;
    assert!(unit.class_list().contains("marked"));
    assert_eq!(offsets(&page.all(".marked[data-offset]")), ["0"]);
}

#[wasm_bindgen_test]
async fn keys_move_in_list_tree_and_bytes() {
    let page = Page::at("#/decode").await;
    page.write(POLL).await;
    let list = page.wait_for("[data-testid=frame-list]").await;
    key(&list, "ArrowDown");
    frontend::task::sleep(30).await;
    let row = page
        .wait_for(".windowed-row.selected [data-testid=frame-row]")
        .await;
    assert_eq!(row.get_attribute("data-index").as_deref(), Some("1"));

    let byte = page.wait_for("[data-offset='0']").await;
    byte.click();
    key(&byte, "ArrowRight");
    frontend::task::sleep(30).await;
    let function = page.wait_for("[data-path='function']").await;
    assert!(function.class_list().contains("selected"));
    key(&function, "ArrowDown");
    frontend::task::sleep(30).await;
    let count = page.wait_for("[data-path='byte_count']").await;
    assert!(count.class_list().contains("selected"));
}

#[wasm_bindgen_test]
async fn problems_lead_to_their_bytes() {
    let page = Page::at("#/decode").await;
    page.write("7D0300070003BFF6\n7D0306003D084400003E08\n0G")
        .await;
    page.wait_for("[data-testid=problem]").await;
    page.click("[data-testid=problem][data-code='crc-mismatch']")
        .await;
    let selected = page.all("[data-testid=hex-byte].selected");
    assert_eq!(offsets(&selected), ["9", "10"]);
    assert_eq!(page.all(".byte.bad-error").len(), 2);
    // What is no byte is said with its line.
    let places: Vec<_> = page
        .all("[data-testid=problem]")
        .iter()
        .filter_map(|e| e.text_content())
        .collect();
    assert!(places.iter().any(|p| p.contains("line 3")), "{places:?}");
}

#[wasm_bindgen_test]
async fn a_sample_opens_from_its_link() {
    let page = Page::at("#/decode?sample=damaged").await;
    page.wait_for("[data-testid=frame-row]").await;
    assert!(!page.all("[data-testid=problem]").is_empty());
}

#[wasm_bindgen_test]
async fn the_register_browser_finds_by_every_notation() {
    use frontend::components::values::ValuesView;
    use frontend::live::Live;
    use frontend::router::Router;
    use shared::map::row::Model;

    window()
        .location()
        .set_hash("#/device/XV-1/values")
        .unwrap();
    let root: HtmlElement = document().create_element("div").unwrap().unchecked_into();
    // The style sheet is not here; what makes the list scroll is.
    let style = document().create_element("style").unwrap();
    style.set_text_content(Some(
        ".windowed { height: 400px; overflow: auto } .windowed-row { height: 30px }",
    ));
    root.append_child(&style).unwrap();
    document().body().unwrap().append_child(&root).unwrap();
    let mounted = mount_to(root.clone(), || {
        Router::provide();
        frontend::keys::KeyBus::provide();
        frontend::browser::provide_narrow();
        Live::provide();
        view! { <ValuesView tag="XV-1".to_owned() map=Model::Icon3000v2.map()/> }
    });
    let page = Page {
        root,
        _mounted: Box::new(mounted),
    };
    page.wait_for("[data-testid=register-row]").await;
    // Of some 700 rows only those in view are drawn.
    assert!(page.all("[data-testid=register-row]").len() < 120);
    let search: web_sys::HtmlInputElement = page
        .wait_for("[data-testid=register-search]")
        .await
        .unchecked_into();
    for query in ["403005", "43005", "0x0BBC", "3004"] {
        search.set_value(query);
        let init = web_sys::EventInit::new();
        init.set_bubbles(true);
        let event = web_sys::Event::new_with_event_init_dict("input", &init).unwrap();
        search.dispatch_event(&event).unwrap();
        frontend::task::sleep(60).await;
        let rows = page.all("[data-testid=register-row]");
        assert_eq!(rows.len(), 1, "{query}");
        let address = rows[0].get_attribute("data-address");
        assert_eq!(address.as_deref(), Some("3004"), "{query}");
        assert!(rows[0].text_content().unwrap().contains("403005"));
    }
}

#[wasm_bindgen_test]
async fn help_opens_and_closes_by_key() {
    let page = Page::at("#/settings").await;
    let body = document().body().unwrap();
    key(&body, "?");
    page.wait_for("[data-testid=help]").await;
    key(&body, "Escape");
    frontend::task::sleep(30).await;
    assert!(page.all("[data-testid=help]").is_empty());
}
