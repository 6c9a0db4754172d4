//! Charts as files: SVG, PNG and comma-separated values.

use leptos::prelude::document;
use wasm_bindgen::prelude::*;

use super::svg::{Look, Size, draw};
use super::{Chart, View, table};

/// Size of a picture in a file.
const SIZE: Size = Size {
    width: 960.0,
    height: 480.0,
};

/// Pixels of a PNG for each unit of the drawing: enough for print.
const SHARP: u32 = 2;

/// The chart as an SVG file of its own, with its title.
#[must_use]
pub fn svg(chart: &Chart, view: View) -> String {
    let view = View {
        cursor: None,
        drag: None,
        ..view
    };
    let picture = draw(chart, SIZE, view, Look::Paper);
    let mut out = crate::markup::Markup::new();
    out.open(
        "svg",
        &[
            ("xmlns", "http://www.w3.org/2000/svg"),
            ("width", "1000"),
            ("height", "530"),
            ("viewBox", "-20 -40 1000 530"),
        ],
    );
    let all = [
        ("x", "-20"),
        ("y", "-40"),
        ("width", "1000"),
        ("height", "530"),
        ("fill", "#fff"),
    ];
    out.open("rect", &all).close("rect");
    let title = [
        ("x", "0"),
        ("y", "-16"),
        ("font-family", "Helvetica, Arial, sans-serif"),
        ("font-size", "16"),
        ("font-weight", "bold"),
    ];
    out.open("text", &title).text(&chart.title).close("text");
    let mut text = out.finish();
    text.push_str(&picture);
    text.push_str("</svg>");
    text
}

/// Name of a file for a chart.
#[must_use]
pub fn name(chart: &Chart, extension: &str) -> String {
    let safe = |c: char| {
        if c.is_ascii_alphanumeric() || c == '-' {
            c
        } else {
            '-'
        }
    };
    let key: String = chart.key.chars().map(safe).collect();
    format!("valvescope-{key}.{extension}")
}

/// Saves the chart in the form that an extension names.
pub async fn save(chart: Chart, view: View, extension: &str) -> Result<(), JsValue> {
    let name = name(&chart, extension);
    match extension {
        "svg" => crate::browser::save(&name, &svg(&chart, view)),
        "csv" => crate::browser::save(&name, &table::csv(&chart)),
        _ => save_png(&name, &svg(&chart, view)).await?,
    }
    Ok(())
}

/// Lets the browser paint the SVG, and saves what it painted.
async fn save_png(name: &str, svg: &str) -> Result<(), JsValue> {
    let (width, height) = (1000, 530);
    let image = web_sys::HtmlImageElement::new()?;
    let text: String = js_sys::encode_uri_component(svg).into();
    image.set_src(&format!("data:image/svg+xml;charset=utf-8,{text}"));
    wasm_bindgen_futures::JsFuture::from(image.decode()).await?;
    let canvas: web_sys::HtmlCanvasElement = document().create_element("canvas")?.unchecked_into();
    canvas.set_width(width * SHARP);
    canvas.set_height(height * SHARP);
    let context = canvas.get_context("2d")?.ok_or(JsValue::NULL)?;
    let context: web_sys::CanvasRenderingContext2d = context.unchecked_into();
    context.draw_image_with_html_image_element_and_dw_and_dh(
        &image,
        0.0,
        0.0,
        f64::from(width * SHARP),
        f64::from(height * SHARP),
    )?;
    let link: web_sys::HtmlAnchorElement = document().create_element("a")?.unchecked_into();
    link.set_href(&canvas.to_data_url_with_type("image/png")?);
    link.set_download(name);
    link.click();
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::sample::torque;

    #[test]
    fn a_file_stands_alone() {
        let text = svg(&torque(), View::default());
        assert!(text.contains(">Torque</text>") && text.ends_with("</svg></svg>"));
        assert!(!text.contains("var(") && !text.contains("class="));
        assert_eq!(name(&torque(), "png"), "valvescope-torque.png");
    }
}
