//! One WebSocket, with its handlers kept alive as long as it is.

use shared::proto::ToBackend;
use wasm_bindgen::prelude::*;
use web_sys::{MessageEvent, WebSocket};

use crate::state::wire;

/// What a socket tells.
#[derive(Debug)]
pub enum Event {
    /// It is open.
    Open,
    /// A message came.
    Text(String),
    /// It is closed; nothing more comes.
    Closed,
}

/// An open or opening WebSocket. Dropping it closes it silently.
pub struct Socket {
    socket: WebSocket,
    _handlers: [Closure<dyn Fn(JsValue)>; 3],
}

impl core::fmt::Debug for Socket {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("Socket")
    }
}

impl Socket {
    /// Opens a socket; `None` if the browser refuses the address.
    pub fn open(url: &str, on: impl Fn(Event) + Clone + 'static) -> Option<Self> {
        let socket = WebSocket::new(url).ok()?;
        let opened = {
            let on = on.clone();
            Closure::<dyn Fn(JsValue)>::new(move |_| on(Event::Open))
        };
        let message = {
            let on = on.clone();
            Closure::<dyn Fn(JsValue)>::new(move |event: JsValue| {
                let data = event.unchecked_ref::<MessageEvent>().data().as_string();
                on(Event::Text(data.unwrap_or_default()));
            })
        };
        let closed = Closure::<dyn Fn(JsValue)>::new(move |_| on(Event::Closed));
        socket.set_onopen(Some(opened.as_ref().unchecked_ref()));
        socket.set_onmessage(Some(message.as_ref().unchecked_ref()));
        // An error is followed by a close.
        socket.set_onclose(Some(closed.as_ref().unchecked_ref()));
        Some(Self {
            socket,
            _handlers: [opened, message, closed],
        })
    }

    /// Sends a message. One that can't be sent is lost with the connection, which is then closed.
    pub fn send(&self, message: &ToBackend) {
        if let Some(text) = wire::write(message) {
            self.send_text(&text);
        }
    }

    /// Sends a message that is text already.
    pub fn send_text(&self, text: &str) {
        let _lost = self.socket.send_with_str(text);
    }
}

impl Drop for Socket {
    fn drop(&mut self) {
        self.socket.set_onopen(None);
        self.socket.set_onmessage(None);
        self.socket.set_onclose(None);
        let _closed_already = self.socket.close();
    }
}
