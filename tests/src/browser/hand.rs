//! What a person does on a page, and what they see of it.

use super::{PATIENCE, Page, Scheme};
use serde_json::{Value, json};
use std::time::Duration;

/// The sizes in which every screen is looked at: a desk and a phone.
const SIZES: [(u32, u32); 2] = [(1440, 900), (390, 844)];

impl Page {
    /// Pastes into the box for bytes.
    pub async fn paste(&self, text: &str) {
        let css = "[data-testid=paste]";
        self.wait_for(css).await;
        self.eval(&format!(
            "const box = document.querySelector({css:?});
             box.value = {text:?};
             box.dispatchEvent(new Event('input', {{ bubbles: true }}));"
        ))
        .await;
    }

    /// Chooses from a list, or types into a field and leaves it.
    pub async fn enter(&self, css: &str, value: &str) {
        self.wait_for(css).await;
        self.eval(&format!(
            "const e = document.querySelector({css:?});
             e.value = {value:?};
             e.dispatchEvent(new Event('input', {{ bubbles: true }}));
             e.dispatchEvent(new Event('change', {{ bubbles: true }}));"
        ))
        .await;
    }

    /// Opens a file in a field for files.
    ///
    /// # Panics
    ///
    /// If there is no such field.
    pub async fn open_file(&self, css: &str, name: &str, text: &str) {
        self.wait_for(css).await;
        // As JSON: a text has signs that a string of Rust writes in another way.
        let text = serde_json::to_string(text).expect("a text");
        self.eval(&format!(
            "const files = new DataTransfer();
             files.items.add(new File([{text}], {name:?}));
             const input = document.querySelector({css:?});
             input.files = files.files;
             input.dispatchEvent(new Event('change', {{ bubbles: true }}));"
        ))
        .await;
    }

    /// Presses a key where the focus is.
    pub async fn press(&self, key: &str) {
        for kind in ["keyDown", "keyUp"] {
            let params = json!({ "type": kind, "key": key, "code": key });
            self.devtools("Input.dispatchKeyEvent", params).await;
        }
    }

    /// How many elements have this selector.
    ///
    /// # Panics
    ///
    /// If it is no selector.
    pub async fn count(&self, css: &str) -> u64 {
        let script = format!("return document.querySelectorAll({css:?}).length");
        self.eval(&script).await.as_u64().expect("a number")
    }

    /// Waits until an expression with `$` for the first element with a selector is true.
    ///
    /// # Panics
    ///
    /// If it stays false.
    pub async fn until(&self, css: &str, test: &str) {
        self.until_within(css, test, PATIENCE).await;
    }

    /// As [`Page::until`], for what a slow line takes its time for.
    ///
    /// # Panics
    ///
    /// If it stays false.
    pub async fn until_within(&self, css: &str, test: &str, limit: Duration) {
        let test = test.replace('$', "e");
        let condition = format!("(e => e && ({test}))(document.querySelector({css:?}))");
        self.wait_within(&condition, limit).await;
    }

    /// Takes pictures of both sizes in both schemes, for people to look at, and goes back to a desk
    /// in the light. Nothing may be wider than the window.
    ///
    /// # Panics
    ///
    /// If something is wider.
    pub async fn look(&self, name: &str) {
        for (scheme, shade) in [(Scheme::Light, "light"), (Scheme::Dark, "dark")] {
            for (width, height) in SIZES {
                self.show(width, height, scheme).await;
                // Colours fade over, and charts are drawn anew.
                tokio::time::sleep(Duration::from_millis(250)).await;
                self.screenshot(&format!("{name}-{width}-{shade}")).await;
                let wide = self
                    .eval("return document.documentElement.scrollWidth > window.innerWidth")
                    .await;
                assert_eq!(wide, Value::Bool(false), "{name} at {width}");
            }
        }
        let [(width, height), _] = SIZES;
        self.show(width, height, Scheme::Light).await;
    }

    /// Keeps what the page saves from now on, so that a test can read it.
    pub async fn keep_saved(&self) {
        self.eval(
            "window.saved = [];
             window.makeUrl ??= URL.createObjectURL.bind(URL);
             URL.createObjectURL = blob => {
               blob.text().then(text => window.saved.push(text));
               return window.makeUrl(blob);
             };",
        )
        .await;
    }

    /// The last text that was saved, when so many were since [`Page::keep_saved`].
    ///
    /// # Panics
    ///
    /// If they are not saved in time.
    pub async fn saved(&self, number: usize) -> String {
        self.wait_until(&format!("window.saved.length >= {number}"))
            .await;
        let text = self
            .eval("return window.saved[window.saved.length - 1]")
            .await;
        text.as_str().expect("a text").to_owned()
    }
}
