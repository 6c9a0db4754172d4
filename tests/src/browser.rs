//! A headless Chromium that shows one page and tells everything about it.
//!
//! ```no_run
//! # async fn example() {
//! use tests::browser::{Page, Scheme};
//! use tests::server::Server;
//!
//! let server = Server::start(&[]);
//! let page = Page::open(&server.url("/")).await;
//! page.wait_for("main").await;
//! page.show(1280, 800, Scheme::Dark).await;
//! page.screenshot("dark").await;
//! page.assert_clean().await;
//! # }
//! ```

mod driver;
mod hand;
mod log;
mod picture;

pub use log::{ConsoleLine, leaves_loopback};

use driver::{Driver, Post};
use fantoccini::elements::Element;
use fantoccini::{Client, Locator};
use serde_json::{Value, json};
use std::fs;
use std::path::PathBuf;
use std::time::Duration;

/// How long an element may take to appear.
const PATIENCE: Duration = Duration::from_secs(10);

/// Light or dark, as the system of the reader says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Dark on light.
    Light,
    /// Light on dark.
    Dark,
}

/// One page in a browser of its own, closed when this is dropped.
///
/// Every method panics, with what the browser said, when the browser does not do what it is told.
#[derive(Debug)]
pub struct Page {
    /// For everything that has no shorthand here.
    pub client: Client,
    _driver: Driver,
}

impl Page {
    /// Starts a browser and loads a URL.
    ///
    /// # Panics
    ///
    /// If there is no browser, or the URL cannot be loaded.
    pub async fn open(url: &str) -> Self {
        let driver = Driver::start();
        let client = driver.connect().await;
        client
            .goto(url)
            .await
            .unwrap_or_else(|error| panic!("cannot load {url}: {error}"));
        Self {
            client,
            _driver: driver,
        }
    }

    /// Waits until an element with this CSS selector is in the page.
    ///
    /// # Panics
    ///
    /// If none appears; the panic shows the console.
    pub async fn wait_for(&self, css: &str) -> Element {
        match self
            .client
            .wait()
            .at_most(PATIENCE)
            .for_element(Locator::Css(css))
            .await
        {
            Ok(element) => element,
            Err(error) => panic!(
                "no `{css}` in the page: {error}\nconsole: {:#?}",
                self.console().await
            ),
        }
    }

    /// The text that a reader sees in the first element with this selector, once it is there.
    ///
    /// # Panics
    ///
    /// If none appears.
    pub async fn text(&self, css: &str) -> String {
        self.wait_for(css)
            .await
            .text()
            .await
            .expect("an element has a text")
    }

    /// Clicks the first element with this selector, once it is there.
    ///
    /// # Panics
    ///
    /// If none appears, or if something lies over it.
    pub async fn click(&self, css: &str) {
        let click = self.wait_for(css).await.click().await;
        click.unwrap_or_else(|error| panic!("cannot click `{css}`: {error}"));
    }

    /// Waits until JavaScript finds `condition` true: an expression such as `document.title == "x"`.
    ///
    /// # Panics
    ///
    /// If it stays false.
    pub async fn wait_until(&self, condition: &str) {
        self.wait_within(condition, PATIENCE).await;
    }

    /// As [`Page::wait_until`], with more patience.
    ///
    /// # Panics
    ///
    /// If it stays false; the panic shows what a reader sees.
    pub async fn wait_within(&self, condition: &str, limit: Duration) {
        let end = tokio::time::Instant::now() + limit;
        while self.eval(&format!("return Boolean({condition})")).await != Value::Bool(true) {
            if tokio::time::Instant::now() >= end {
                let seen = self.eval("return document.body.innerText").await;
                panic!("never true: {condition}\n{seen}");
            }
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
    }

    /// Runs the body of a JavaScript function and returns what it returns.
    ///
    /// # Panics
    ///
    /// If it throws.
    pub async fn eval(&self, body: &str) -> Value {
        self.client
            .execute(body, vec![])
            .await
            .unwrap_or_else(|error| panic!("`{body}`: {error}"))
    }

    /// Sets the size of the page and the scheme of the system.
    pub async fn show(&self, width: u32, height: u32, scheme: Scheme) {
        let size =
            json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.devtools("Emulation.setDeviceMetricsOverride", size)
            .await;
        let scheme = if scheme == Scheme::Dark {
            "dark"
        } else {
            "light"
        };
        self.emulate_media(&[("prefers-color-scheme", scheme)])
            .await;
    }

    /// Sets media features, such as `prefers-reduced-motion`; those not named go back to normal.
    pub async fn emulate_media(&self, features: &[(&str, &str)]) {
        let features: Vec<Value> = features
            .iter()
            .map(|(name, value)| json!({ "name": name, "value": value }))
            .collect();
        self.devtools(
            "Emulation.setEmulatedMedia",
            json!({ "features": features }),
        )
        .await;
    }

    /// Gives a command of the DevTools protocol.
    ///
    /// # Panics
    ///
    /// If the browser refuses it.
    pub async fn devtools(&self, command: &str, params: Value) -> Value {
        let post = Post::new(
            "goog/cdp/execute",
            json!({ "cmd": command, "params": params }),
        );
        self.client
            .issue_cmd(post)
            .await
            .unwrap_or_else(|error| panic!("{command}: {error}"))
    }

    /// Writes what is visible to `target/screenshots/<name>.png`, and returns the path.
    ///
    /// # Panics
    ///
    /// If the file cannot be written.
    pub async fn screenshot(&self, name: &str) -> PathBuf {
        let folder = crate::target_dir().join("screenshots");
        fs::create_dir_all(&folder).expect("the target folder is writable");
        let path = folder.join(name).with_extension("png");
        let png = self.client.screenshot().await.expect("a page can be drawn");
        fs::write(&path, png).expect("the target folder is writable");
        path
    }

    /// What the page has written to the console since the last call.
    pub async fn console(&self) -> Vec<ConsoleLine> {
        log::console(&self.drain("browser").await)
    }

    /// The URLs that the page has asked for since the last call, WebSockets included.
    pub async fn requests(&self) -> Vec<String> {
        log::requests(&self.drain("performance").await)
    }

    /// Holds that since the last look the console has no error and no request left this machine.
    ///
    /// # Panics
    ///
    /// If one did; the panic shows it.
    pub async fn assert_clean(&self) {
        let errors: Vec<_> = self
            .console()
            .await
            .into_iter()
            .filter(ConsoleLine::is_error)
            .collect();
        assert!(errors.is_empty(), "errors in the console: {errors:#?}");
        let strays: Vec<_> = self
            .requests()
            .await
            .into_iter()
            .filter(|url| leaves_loopback(url))
            .collect();
        assert!(
            strays.is_empty(),
            "requests that leave this machine: {strays:#?}"
        );
    }

    /// Takes the entries of one of the driver's logs; each entry is given once.
    async fn drain(&self, kind: &str) -> Vec<Value> {
        let post = Post::new("se/log", json!({ "type": kind }));
        let entries = self.client.issue_cmd(post).await;
        match entries.unwrap_or_else(|error| panic!("log `{kind}`: {error}")) {
            Value::Array(entries) => entries,
            other => panic!("log `{kind}` is not a list: {other}"),
        }
    }
}
