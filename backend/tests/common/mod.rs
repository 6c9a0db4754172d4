//! A backend on a free port, and a page that talks to it.
#![allow(dead_code, reason = "each test file uses a part of it")]

use backend::app::{App, app};
use backend::config::Config;
use backend::listen::Limited;
use backend::plant::Plant;
use backend::ws::Hosts;
use futures_util::{SinkExt, StreamExt};
use shared::proto::{
    DdcNews, DopNews, HartNews, IconNews, PROGRAM_PREFIXES, ToBackend, ToPage, VERSION,
};
use std::collections::VecDeque;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::time::timeout;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;
use tokio_tungstenite::tungstenite::{Error, Message};
use tokio_tungstenite::{MaybeTlsStream, WebSocketStream, connect_async};

/// How long a test waits for anything.
pub const WAIT: Duration = Duration::from_secs(10);

/// Serves a configuration; gives the address.
pub async fn serve(config: &Config) -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let plant = Arc::new(Plant::start(config));
    let router = app(App::new(plant, Hosts::new(address, &[])));
    tokio::spawn(async move { axum::serve(Limited::new(listener), router).await });
    address
}

/// Asks for a path with these header lines; gives the whole answer.
pub async fn get(address: SocketAddr, path: &str, headers: &str) -> (String, Vec<u8>) {
    let mut stream = TcpStream::connect(address).await.unwrap();
    let request =
        format!("GET {path} HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n{headers}\r\n");
    stream.write_all(request.as_bytes()).await.unwrap();
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).await.unwrap();
    let at = answer.windows(4).position(|w| w == b"\r\n\r\n").unwrap();
    let body = answer.split_off(at + 4);
    (String::from_utf8(answer).unwrap().to_lowercase(), body)
}

/// A page.
pub struct Page {
    socket: WebSocketStream<MaybeTlsStream<TcpStream>>,
    /// News for programs that nobody has looked at yet.
    news: VecDeque<String>,
}

impl Page {
    /// Connects with these headers.
    pub async fn open(
        address: SocketAddr,
        headers: &[(&'static str, &str)],
    ) -> Result<Self, Error> {
        let mut request = format!("ws://{address}/ws").into_client_request()?;
        for (name, value) in headers {
            request.headers_mut().insert(*name, value.parse().unwrap());
        }
        let (socket, _) = connect_async(request).await?;
        Ok(Self {
            socket,
            news: VecDeque::new(),
        })
    }

    /// Connects as a browser does, and says hello.
    pub async fn greet(address: SocketAddr) -> (Self, ToPage) {
        let origin = format!("http://{address}");
        let mut page = Self::open(address, &[("Origin", &origin)]).await.unwrap();
        page.say(&ToBackend::Hello { version: VERSION }).await;
        let hello = page.hear().await.unwrap();
        (page, hello)
    }

    /// Sends a message.
    pub async fn say(&mut self, message: &ToBackend) {
        let text = serde_json::to_string(message).unwrap();
        self.send(Message::text(text)).await;
    }

    /// Sends anything.
    pub async fn send(&mut self, message: Message) {
        self.socket.send(message).await.unwrap();
    }

    /// The next message of the protocol; `None` when the backend has closed.
    pub async fn hear(&mut self) -> Option<ToPage> {
        loop {
            let next = timeout(WAIT, self.socket.next()).await.expect("a message");
            match next {
                Some(Ok(Message::Text(text))) if is_news(&text) => {
                    self.news.push_back(text.to_string());
                }
                Some(Ok(Message::Text(text))) => return Some(serde_json::from_str(&text).unwrap()),
                Some(Ok(Message::Close(_)) | Err(_)) | None => return None,
                Some(Ok(_)) => {}
            }
        }
    }

    /// The next news about HART devices, progress left out.
    pub async fn hart(&mut self) -> HartNews {
        loop {
            let next = timeout(WAIT, self.socket.next()).await.expect("news");
            if let Some(Ok(Message::Text(text))) = next
                && let Some(news) = HartNews::from_text(&text)
                && !matches!(news, HartNews::Progress { .. })
            {
                return news;
            }
        }
    }

    /// Waits for the message that `find` finds.
    pub async fn until<T>(&mut self, mut find: impl FnMut(ToPage) -> Option<T>) -> T {
        let search = async {
            loop {
                let message = self.hear().await.expect("the backend closed");
                if let Some(found) = find(message) {
                    return found;
                }
            }
        };
        timeout(WAIT, search).await.expect("what is looked for")
    }

    /// The next news about diagnostic objects.
    pub async fn news(&mut self) -> DopNews {
        self.next_news(DopNews::from_text).await
    }

    /// The next news about an ICON3000.
    pub async fn icon_news(&mut self) -> IconNews {
        self.next_news(IconNews::from_text).await
    }

    /// The next news of a kind; others are passed over.
    pub async fn next_news<T>(&mut self, read: impl Fn(&str) -> Option<T>) -> T {
        loop {
            while let Some(text) = self.news.pop_front() {
                if let Some(news) = read(&text) {
                    return news;
                }
            }
            let next = timeout(WAIT, self.socket.next()).await.expect("news");
            if let Some(Ok(Message::Text(text))) = next
                && is_news(&text)
            {
                self.news.push_back(text.to_string());
            }
        }
    }

    /// Waits for the news about a DDC-100 network that `find` finds.
    pub async fn ddc<T>(&mut self, mut find: impl FnMut(DdcNews) -> Option<T>) -> T {
        let search = async {
            loop {
                let news = self.next_news(DdcNews::from_text).await;
                if let Some(found) = find(news) {
                    return found;
                }
            }
        };
        timeout(WAIT, search).await.expect("what is looked for")
    }
}

fn is_news(text: &str) -> bool {
    PROGRAM_PREFIXES.iter().any(|p| text.starts_with(p))
}
