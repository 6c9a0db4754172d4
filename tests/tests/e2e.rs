//! End to end: the built binary, a browser, and what a person sees.

use tests::browser::{Page, Scheme, leaves_loopback};
use tests::server::Server;

/// The page comes up in both schemes without an error and without calling anybody.
#[tokio::test]
async fn the_page_loads() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/")).await;
    assert!(!page.text("main").await.is_empty());
    for (scheme, name) in [(Scheme::Light, "light"), (Scheme::Dark, "dark")] {
        page.show(1280, 800, scheme).await;
        assert!(page.screenshot(name).await.is_file());
    }
    assert!(
        page.requests()
            .await
            .contains(&server.url("/valvescope_bg.wasm"))
    );
    page.assert_clean().await;
}

/// The guard of the other tests: an error in the console and a stray request are seen.
#[tokio::test]
async fn strays_and_errors_are_noticed() {
    let page = Page::open(
        "data:text/html,<img src='http://192.0.2.1/a'><script>console.error('b')</script>",
    )
    .await;
    page.wait_until("document.images[0].complete").await;
    let requests = page.requests().await;
    assert!(
        requests.iter().any(|url| leaves_loopback(url)),
        "{requests:?}"
    );
    let console = page.console().await;
    assert!(
        console
            .iter()
            .any(|line| line.is_error() && line.message.contains("\"b\"")),
        "{console:?}"
    );
    assert!(
        console
            .iter()
            .any(|line| line.message.contains("ERR_NAME_NOT_RESOLVED")),
        "{console:?}"
    );
}
