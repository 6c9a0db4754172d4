//! Taking connections: not more than can be served, and none that sends nothing.

use std::future::Future;
use std::io;
use std::net::SocketAddr;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll, ready};
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::{Instant, Sleep, sleep};

/// Connections that may be open at once; a browser opens six.
const MAX_CONNECTIONS: usize = 256;
/// A connection from which nothing comes for so long is closed. Pages answer every two seconds.
const PATIENCE: Duration = Duration::from_secs(20);
/// Pause after a connection could not be taken, for want of descriptors as a rule.
const PAUSE: Duration = Duration::from_millis(100);

/// A listener with a limit.
#[derive(Debug)]
pub struct Limited {
    inner: TcpListener,
    seats: Arc<Semaphore>,
}

impl Limited {
    /// Limits a listener.
    #[must_use]
    pub fn new(inner: TcpListener) -> Self {
        Self {
            inner,
            seats: Arc::new(Semaphore::new(MAX_CONNECTIONS)),
        }
    }
}

impl axum::serve::Listener for Limited {
    type Io = Patient;
    type Addr = SocketAddr;

    async fn accept(&mut self) -> (Self::Io, Self::Addr) {
        loop {
            // Nobody closes the semaphore.
            let Ok(seat) = Arc::clone(&self.seats).acquire_owned().await else {
                return std::future::pending().await;
            };
            match self.inner.accept().await {
                Ok((stream, address)) => {
                    // Small messages go out at once; if not, they are only later.
                    let _slower = stream.set_nodelay(true);
                    return (Patient::new(stream, seat), address);
                }
                Err(error) => {
                    tracing::debug!("no connection: {error}");
                    sleep(PAUSE).await;
                }
            }
        }
    }

    fn local_addr(&self) -> io::Result<Self::Addr> {
        self.inner.local_addr()
    }
}

/// A connection that ends if nothing comes for too long.
#[derive(Debug)]
pub struct Patient {
    stream: TcpStream,
    /// When it is enough.
    end: Pin<Box<Sleep>>,
    /// Free again when the connection is gone.
    _seat: OwnedSemaphorePermit,
}

impl Patient {
    fn new(stream: TcpStream, seat: OwnedSemaphorePermit) -> Self {
        Self {
            stream,
            end: Box::pin(sleep(PATIENCE)),
            _seat: seat,
        }
    }
}

impl AsyncRead for Patient {
    fn poll_read(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        into: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        if let Poll::Ready(read) = Pin::new(&mut self.stream).poll_read(cx, into) {
            let end = Instant::now() + PATIENCE;
            self.end.as_mut().reset(end);
            return Poll::Ready(read);
        }
        ready!(self.end.as_mut().poll(cx));
        Poll::Ready(Err(io::ErrorKind::TimedOut.into()))
    }
}

impl AsyncWrite for Patient {
    fn poll_write(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        Pin::new(&mut self.stream).poll_write(cx, bytes)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        bytes: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        Pin::new(&mut self.stream).poll_write_vectored(cx, bytes)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(cx)
    }
}
