//! ChromeDriver as a process, and its commands beyond the standard.

use crate::process::Process;
use fantoccini::wd::{Capabilities, WebDriverCompatibleCommand};
use fantoccini::{Client, ClientBuilder};
use hyper_util::client::legacy::connect::HttpConnector;
use serde_json::{Value, json};
use std::env;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::process::Command;
use std::time::Duration;

/// No window, no sandbox (tests may run as root), nothing that calls its maker, and no way out:
/// a request that would leave this machine is logged, and fails.
const FLAGS: [&str; 10] = [
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--disable-dev-shm-usage",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1, EXCLUDE localhost, EXCLUDE [::1]",
];

/// A running driver. Dropping it closes the browsers it has opened.
#[derive(Debug)]
pub(super) struct Driver {
    process: Process,
    port: u16,
}

impl Driver {
    /// Starts a driver on a free port.
    pub(super) fn start() -> Self {
        let mut command =
            Command::new(env::var_os("CHROMEDRIVER").unwrap_or_else(|| "chromedriver".into()));
        let advice =
            "run the tests with `cargo xtask test`, which installs Chromium and its driver";
        let (process, port) = Process::start(command.arg("--port=0"), advice, |line| {
            // "ChromeDriver was started successfully on port 40123."
            let (_, port) = line.split_once("successfully on port ")?;
            port.trim_end_matches('.').parse().ok()
        });
        Self { process, port }
    }

    /// Opens a browser.
    pub(super) async fn connect(&self) -> Client {
        let mut options = json!({ "args": FLAGS });
        if let Some(binary) = env::var_os("CHROMIUM") {
            options["binary"] = binary.to_string_lossy().into();
        }
        let mut wanted = Capabilities::new();
        wanted.insert("goog:chromeOptions".into(), options);
        wanted.insert(
            "goog:loggingPrefs".into(),
            json!({ "browser": "ALL", "performance": "ALL" }),
        );
        let client = ClientBuilder::new(HttpConnector::new())
            .capabilities(wanted)
            .connect(&format!("http://127.0.0.1:{}", self.port))
            .await;
        client.unwrap_or_else(|error| {
            panic!(
                "{error}; the driver said:\n{}",
                self.process.output().join("\n")
            )
        })
    }

    /// Asks the driver to end, which closes its browsers. A killed driver would leave them behind.
    fn shut_down(&mut self) -> std::io::Result<()> {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port))?;
        stream.set_read_timeout(Some(Duration::from_secs(5)))?;
        let host = format!("127.0.0.1:{}", self.port);
        write!(
            stream,
            "GET /shutdown HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n"
        )?;
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer)?;
        self.process.ends_within(Duration::from_secs(5));
        Ok(())
    }
}

impl Drop for Driver {
    fn drop(&mut self) {
        let _ = self.shut_down(); // the process is killed in any case
    }
}

/// A command of the session that the WebDriver standard does not have.
#[derive(Debug)]
pub(super) struct Post {
    path: &'static str,
    body: Value,
}

impl Post {
    /// A command at `/session/{id}/{path}`.
    pub(super) fn new(path: &'static str, body: Value) -> Self {
        Self { path, body }
    }
}

impl WebDriverCompatibleCommand for Post {
    fn endpoint(
        &self,
        base: &url::Url,
        session: Option<&str>,
    ) -> Result<url::Url, url::ParseError> {
        base.join(&format!(
            "session/{}/{}",
            session.unwrap_or_default(),
            self.path
        ))
    }

    fn method_and_body(&self, _: &url::Url) -> (http::Method, Option<String>) {
        (http::Method::POST, Some(self.body.to_string()))
    }
}
