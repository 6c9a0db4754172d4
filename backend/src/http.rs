//! The page: files that were embedded at build time, with the headers that keep it to itself.

use axum::body::Body;
use axum::http::header::{self, HeaderMap, HeaderName, HeaderValue};
use axum::http::{Response, StatusCode, Uri};
use rust_embed::{EmbeddedFile, RustEmbed};
use std::borrow::Cow;

/// The bundle; empty in a checkout that never ran `cargo xtask web`.
#[derive(RustEmbed)]
#[folder = "../static/dist"]
#[allow_missing = true]
struct Bundle;

/// What the page may load and whom it may call: itself.
const POLICY: &str = "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; connect-src 'self'; \
     img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; frame-ancestors 'none'";

/// Headers of every answer.
const ALWAYS: [(HeaderName, &str); 3] = [
    (header::CONTENT_SECURITY_POLICY, POLICY),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::REFERRER_POLICY, "no-referrer"),
];

/// Serves a file of the bundle. A path without a dot is a place within the page.
pub(crate) async fn file(uri: Uri, headers: HeaderMap) -> Response<Body> {
    let path = uri.path().trim_start_matches('/');
    let name = match path {
        "" => "index.html",
        // The compressed forms are served under the names of the plain ones.
        path if path.ends_with(".br") => return plain(StatusCode::NOT_FOUND, NOT_FOUND),
        path => path,
    };
    if let Some(answer) = find(name, &headers) {
        return answer;
    }
    let is_place = !name
        .rsplit('/')
        .next()
        .is_some_and(|last| last.contains('.'));
    if is_place && let Some(answer) = find("index.html", &headers) {
        return answer;
    }
    if name == "index.html" || is_place {
        return missing();
    }
    plain(StatusCode::NOT_FOUND, NOT_FOUND)
}

/// A file of the bundle as an answer, compressed if the browser takes it and it is worth it.
fn find(name: &str, headers: &HeaderMap) -> Option<Response<Body>> {
    let file = Bundle::get(name)?;
    let compressed = takes_brotli(headers)
        .then(|| Bundle::get(&format!("{name}.br")))
        .flatten();
    // The two forms are different entities.
    let (file, encoding) = match compressed {
        Some(file) => (file, Some("br")),
        None => (file, None),
    };
    let tag = tag(&file);
    let fresh = headers
        .get(header::IF_NONE_MATCH)
        .and_then(|v| v.to_str().ok())
        .is_some_and(|v| v.split(',').any(|t| t.trim() == tag));
    let (status, body) = if fresh {
        (StatusCode::NOT_MODIFIED, Body::empty())
    } else {
        (StatusCode::OK, body(file.data))
    };
    let mut answer = answer(status, body);
    let headers = answer.headers_mut();
    headers.insert(
        header::CONTENT_TYPE,
        HeaderValue::from_static(content_type(name)),
    );
    // Kept, but asked for again each time: the names say nothing of the version.
    headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-cache"));
    headers.insert(header::VARY, HeaderValue::from_static("accept-encoding"));
    if let Ok(tag) = HeaderValue::from_str(&tag) {
        headers.insert(header::ETAG, tag);
    }
    if let Some(encoding) = encoding {
        headers.insert(header::CONTENT_ENCODING, HeaderValue::from_static(encoding));
    }
    Some(answer)
}

/// True if the browser takes brotli. `br;q=0` means that it does not.
fn takes_brotli(headers: &HeaderMap) -> bool {
    let values = headers.get_all(header::ACCEPT_ENCODING).iter();
    values
        .filter_map(|v| v.to_str().ok())
        .flat_map(|v| v.split(','))
        .any(|coding| {
            let mut parts = coding.split(';').map(str::trim);
            parts.next().is_some_and(|c| c.eq_ignore_ascii_case("br"))
                && !parts.any(|p| matches!(p, "q=0" | "q=0.0" | "q=0.00" | "q=0.000"))
        })
}

/// The entity tag of a file, from its hash.
fn tag(file: &EmbeddedFile) -> String {
    let hash = file.metadata.sha256_hash();
    let short = shared::render::hex(hash.get(..12).unwrap_or(&[]));
    format!("\"{short}\"")
}

fn body(data: Cow<'static, [u8]>) -> Body {
    match data {
        Cow::Borrowed(bytes) => Body::from(bytes),
        Cow::Owned(bytes) => Body::from(bytes),
    }
}

/// The media type that belongs to the ending of a name.
fn content_type(name: &str) -> &'static str {
    match name.rsplit_once('.').map_or("", |(_, ending)| ending) {
        "html" => "text/html; charset=utf-8",
        "js" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "wasm" => "application/wasm",
        "svg" => "image/svg+xml",
        "json" => "application/json",
        "txt" | "csv" | "toml" => "text/plain; charset=utf-8",
        "png" => "image/png",
        "ico" => "image/x-icon",
        _ => "application/octet-stream",
    }
}

const NOT_FOUND: &str = "Not found.\n";

const MISSING: &str = "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>Valvescope</title>\
     <h1>The page was not built</h1><p>This program was built without its page. Run \
     <code>cargo xtask web</code>, build it again, and reload.</p></html>\n";

/// An answer with the headers that all have.
fn answer(status: StatusCode, body: Body) -> Response<Body> {
    let mut answer = Response::new(body);
    *answer.status_mut() = status;
    for (name, value) in ALWAYS {
        answer
            .headers_mut()
            .insert(name, HeaderValue::from_static(value));
    }
    answer
}

/// A short text for people.
pub(crate) fn plain(status: StatusCode, text: &'static str) -> Response<Body> {
    let mut answer = answer(status, Body::from(text));
    answer.headers_mut().insert(
        header::CONTENT_TYPE,
        HeaderValue::from_static("text/plain; charset=utf-8"),
    );
    answer
}

/// Says how to build the page.
fn missing() -> Response<Body> {
    let mut answer = answer(StatusCode::SERVICE_UNAVAILABLE, Body::from(MISSING));
    answer.headers_mut().insert(
        header::CONTENT_TYPE,
        HeaderValue::from_static("text/html; charset=utf-8"),
    );
    answer
}

#[cfg(test)]
mod tests {
    use super::*;

    fn accepts(value: &'static str) -> bool {
        let mut headers = HeaderMap::new();
        headers.insert(header::ACCEPT_ENCODING, HeaderValue::from_static(value));
        takes_brotli(&headers)
    }

    #[test]
    fn brotli_is_sent_to_those_who_take_it() {
        assert!(accepts("gzip, deflate, br, zstd"));
        assert!(accepts("BR;q=0.5"));
        assert!(!accepts("br;q=0"));
        assert!(!accepts("gzip"));
        assert!(!accepts("brotli"));
        assert!(!takes_brotli(&HeaderMap::new()));
    }

    #[test]
    fn types_are_those_that_browsers_insist_on() {
        assert_eq!(content_type("a/valvescope_bg.wasm"), "application/wasm");
        assert_eq!(content_type("boot.js"), "text/javascript; charset=utf-8");
        assert_eq!(content_type("LICENSE"), "application/octet-stream");
    }
}
