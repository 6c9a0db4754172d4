//! The page as one file that works from `file://`.

use super::{Glue, files, html};
use crate::Result;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use std::fs;
use std::path::{Path, PathBuf};

/// Lets the page run what it contains and talk to a bridge on this machine, and nothing else.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline' 'wasm-unsafe-eval'; \
    style-src 'unsafe-inline'; img-src data: blob:; font-src data:; \
    connect-src ws://127.0.0.1:* ws://localhost:*";

/// Starts the page from the bytes in the file, and the other programs when they are wanted.
const START: &str = include_str!("start.js");

/// Builds the single file from `index.html` and the glue for classic scripts, that of the page and
/// those of the programs that it loads later.
pub fn page(source: &Path, index: &str, glue: &Glue, later: &[(&str, Glue)]) -> Result<String> {
    let page = html::replace_links(index, |tag| {
        let href = tag.attribute("href").unwrap_or_default();
        match tag.attribute("rel") {
            Some("stylesheet") => Ok(Some(format!(
                "<style>\n{}</style>",
                style(&source.join(href))?
            ))),
            Some("icon") => Ok(Some(format!(
                "<link rel=\"icon\" href=\"{}\">",
                data_url(&source.join(href))?
            ))),
            // Hints to load early, manifests: nothing to load here.
            _ => Ok(Some(String::new())),
        }
    })?;
    let policy = format!("<meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">");
    let page = html::replace_boot(&page, "").replacen("<head>", &format!("<head>\n{policy}"), 1);
    let Some((head, tail)) = page.rsplit_once("</body>") else {
        return Err("static/index.html has no </body>".into());
    };
    let samples = samples(source)?;
    let later: String = later
        .iter()
        .map(|(name, glue)| {
            let js = script(&glue.js);
            let wasm = STANDARD.encode(&glue.wasm);
            format!(
                "<script type=\"text/plain\" id=\"{name}-glue\">{js}</script>\n\
             <script type=\"application/base64\" id=\"{name}\">{wasm}</script>\n"
            )
        })
        .collect();
    // A classic script, at the end of the body: everything it needs stands before it.
    let wasm = STANDARD.encode(&glue.wasm);
    let js = script(&glue.js);
    Ok(format!(
        "{head}\
         <script type=\"application/json\" id=\"embedded-files\">{samples}</script>\n\
         {later}\
         <script type=\"application/base64\" id=\"program\">{wasm}</script>\n\
         <script>\n{js}\n{START}</script>\n\
         </body>{tail}"
    ))
}

/// JavaScript that may stand in a script element.
fn script(js: &str) -> String {
    js.replace("</script", "<\\/script")
}

/// The sample captures as an object from name to base64.
fn samples(source: &Path) -> Result<String> {
    let mut object = serde_json::Map::new();
    for file in files::walk(&source.join("samples"))? {
        let name = file.strip_prefix(source)?.to_string_lossy().into_owned();
        object.insert(name, STANDARD.encode(fs::read(&file)?).into());
    }
    Ok(serde_json::Value::Object(object).to_string())
}

/// A style sheet with the files it names inside.
fn style(sheet: &Path) -> Result<String> {
    let css = read(sheet)?;
    let css = String::from_utf8(css).map_err(|_| format!("{} is not UTF-8", sheet.display()))?;
    if css.contains("@import") {
        return Err(format!(
            "{}: link the sheet in index.html instead of @import",
            sheet.display()
        )
        .into());
    }
    let folder = sheet.parent().unwrap_or(sheet);
    let mut parts = css.split("url(");
    let mut result = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (target, rest) = part.split_once(')').unwrap_or((part, ""));
        let target = target.trim().trim_matches(['"', '\'']);
        if target.starts_with("data:") || target.starts_with('#') {
            result.push_str("url(");
            result.push_str(part);
        } else {
            result.push_str(&format!("url({}){rest}", data_url(&folder.join(target))?));
        }
    }
    Ok(result)
}

/// A file as a `data:` URL.
fn data_url(file: &Path) -> Result<String> {
    let kind = match file.extension().and_then(|e| e.to_str()) {
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("woff2") => "font/woff2",
        _ => {
            return Err(format!(
                "{}: only svg, png and woff2 go into the single file",
                file.display()
            )
            .into());
        }
    };
    Ok(format!(
        "data:{kind};base64,{}",
        STANDARD.encode(read(file)?)
    ))
}

fn read(file: &Path) -> Result<Vec<u8>> {
    fs::read(file).map_err(|error| {
        format!(
            "static/index.html names {}: {error}",
            PathBuf::from(file).display()
        )
        .into()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_ends_up_inside() {
        let folder = std::env::temp_dir().join(format!("xtask-single-{}", std::process::id()));
        fs::create_dir_all(folder.join("samples")).unwrap();
        fs::write(folder.join("i.svg"), "<svg/>").unwrap();
        fs::write(folder.join("a.css"), "a{b:url('i.svg')} c{d:url(data:x)}").unwrap();
        fs::write(folder.join("samples/s.hex"), "01 03").unwrap();
        let index = "<html><head><link rel=\"icon\" href=\"i.svg\">\
            <link rel=\"stylesheet\" href=\"a.css\"><link rel=\"preload\" href=\"a.css\">\
            <script type=\"module\" src=\"boot.js\"></script></head><body></body></html>";
        let glue = Glue {
            js: "'</script>'".into(),
            wasm: vec![1, 2, 3],
        };
        let other = Glue {
            js: "let other".into(),
            wasm: vec![4, 5, 6],
        };
        let page = page(&folder, index, &glue, &[("other", other)]).unwrap();
        fs::remove_dir_all(&folder).unwrap();

        assert!(page.contains("href=\"data:image/svg+xml;base64,PHN2Zy8+\""));
        assert!(page.contains("a{b:url(data:image/svg+xml;base64,PHN2Zy8+)} c{d:url(data:x)}"));
        assert!(page.contains("{\"samples/s.hex\":\"MDEgMDM=\"}"));
        assert!(page.contains("id=\"program\">AQID</script>"));
        assert!(page.contains("'<\\/script>'"));
        assert!(page.contains("<script type=\"text/plain\" id=\"other-glue\">let other</script>"));
        assert!(page.contains("id=\"other\">BAUG</script>"));
        assert!(!page.contains("boot.js") && !page.contains("preload"));
    }
}
