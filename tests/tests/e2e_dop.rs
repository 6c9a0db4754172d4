//! The diagnostic objects end to end: pasted registers and a simulated unit, as a person sees them.
//! Numbers in a picture are worked out from its own ticks and compared with the registers.

use std::time::Duration;

use serde_json::Value;
use tests::browser::{Page, Scheme};
use tests::server::Server;

/// The registers of a sample, as the file has them.
fn sample(key: &str) -> Vec<u16> {
    let path = format!(
        "{}/../static/samples/dop-{key}.txt",
        env!("CARGO_MANIFEST_DIR")
    );
    let text = std::fs::read_to_string(path).expect("the sample is there");
    let words = text.split_whitespace();
    words
        .map(|w| u16::from_str_radix(w, 16).expect("a register"))
        .collect()
}

/// Two registers, low word first, in two's complement.
fn s32(words: &[u16], at: usize) -> f64 {
    let raw = u32::from(words[at]) | u32::from(words[at + 1]) << 16;
    f64::from(raw.cast_signed())
}

/// Reads what a series shows: pairs of x and y in the units of the axes. The y axis is told by the
/// texts of its ticks, the x axis by its ticks if they are numbers, else by its range.
async fn drawn(page: &Page, chart: &str, series: &str) -> Vec<(f64, f64)> {
    let script = format!(
        "const svg = document.querySelector('[data-chart=\"{chart}\"] [data-testid=chart-svg]');
         const axis = (name, place, shift) => {{
           const ticks = [...svg.querySelectorAll(`text[data-tick=${{name}}]`)].map(t =>
             [Number(t.getAttribute(place)) - shift,
              Number(t.textContent.replaceAll('\\u2009', '').replace('\\u2212', '-'))]);
           const [a, b] = [ticks[0], ticks[ticks.length - 1]];
           return p => a[1] + (p - a[0]) / (b[0] - a[0]) * (b[1] - a[1]);
         }};
         const [left, top, width] = svg.dataset.plot.split(' ').map(Number);
         const [low, high] = svg.dataset.x.split(' ').map(Number);
         const y = axis('y', 'y', 4);
         const x = p => low + (p - left) / width * (high - low);
         const path = svg.querySelector('path[data-series=\"{series}\"]');
         if (path) {{
           const points = [];
           for (const [, x1, y1, x2] of path.getAttribute('d')
                  .matchAll(/[ML](-?[\\d.]+) (-?[\\d.]+)(?:H(-?[\\d.]+))?/g)) {{
             const middle = x2 === undefined ? Number(x1) : (Number(x1) + Number(x2)) / 2;
             points.push([x(middle), y(Number(y1))]);
           }}
           return points;
         }}
         return [...svg.querySelectorAll('rect[data-series=\"{series}\"]')].map(r => {{
           const n = name => Number(r.getAttribute(name));
           const ends = [y(n('y')), y(n('y') + n('height'))];
           // A bar stands on zero or hangs from it.
           const value = Math.abs(ends[0]) > Math.abs(ends[1]) ? ends[0] : ends[1];
           return [x(n('x') + n('width') / 2), value];
         }});"
    );
    let found = page.eval(&script).await;
    let pair = |p: &Value| Some((p.get(0)?.as_f64()?, p.get(1)?.as_f64()?));
    let points = found.as_array().expect("points").iter();
    points.map(|p| pair(p).expect("two numbers")).collect()
}

/// Holds that a series shows these values, within what a pixel can say.
async fn shows(page: &Page, chart: &str, series: &str, wanted: &[f64]) {
    let points = drawn(page, chart, series).await;
    let span = wanted.iter().fold(1.0_f64, |m, v| m.max(v.abs()));
    // A bar is seen however small it is, so it may be a pixel and a half too long.
    let bars = count(page, &format!("[data-chart={chart}] rect[data-series]")).await > 0;
    let within = span * if bars { 0.008 } else { 0.004 } + 0.05;
    assert_eq!(points.len(), wanted.len(), "{chart} {series}: {points:?}");
    for ((_, y), wanted) in points.iter().zip(wanted) {
        assert!(
            (y - wanted).abs() < within,
            "{chart} {series}: {y} instead of {wanted}"
        );
    }
}

async fn count(page: &Page, css: &str) -> u64 {
    let script = format!("return document.querySelectorAll({css:?}).length");
    page.eval(&script).await.as_u64().expect("a number")
}

/// Waits until an expression with `$` for the first element of a selector is true.
async fn until(page: &Page, css: &str, test: &str) {
    let test = test.replace('$', "e");
    page.wait_until(&format!(
        "(e => e && ({test}))(document.querySelector({css:?}))"
    ))
    .await;
}

/// Both sizes in both schemes, for people to look at.
async fn look(page: &Page, name: &str) {
    for (scheme, shade) in [(Scheme::Light, "light"), (Scheme::Dark, "dark")] {
        for (width, height) in [(1440, 900), (390, 844)] {
            page.show(width, height, scheme).await;
            tokio::time::sleep(Duration::from_millis(250)).await;
            page.screenshot(&format!("dop-{name}-{width}-{shade}"))
                .await;
        }
    }
    page.show(1440, 900, Scheme::Light).await;
}

/// Opens a sample by its address.
async fn open(server: &Server, key: &str) -> Page {
    let page = Page::open(&server.url(&format!("/#/dop?sample={key}"))).await;
    page.show(1440, 900, Scheme::Light).await;
    page.wait_for("[data-testid=object-view]").await;
    page
}

/// Torque over a stroke: every point, the cursor by keys, zoom by drag, table and files.
#[tokio::test]
async fn a_torque_profile_is_drawn_as_it_was_read() {
    let server = Server::start(&[]);
    let page = open(&server, "torque").await;
    page.wait_for("[data-chart=dop-0191] [data-testid=chart-svg]")
        .await;
    let words = sample("torque");
    let part = |at: usize| -> Vec<f64> {
        words[at..at + 100]
            .iter()
            .map(|w| f64::from(*w) / 10.0)
            .collect()
    };
    for (series, at) in [
        ("max", 0),
        ("min", 100),
        ("average", 200),
        ("long-term", 300),
    ] {
        shows(&page, "dop-0191", series, &part(at)).await;
    }
    let positions = drawn(&page, "dop-0191", "average").await;
    assert!((positions[0].0 - 0.5).abs() < 0.2 && (positions[99].0 - 99.5).abs() < 0.2);

    // The keyboard reads values where they stand.
    page.eval("document.querySelector('.chart-plot').focus()")
        .await;
    for key in ["Home", "ArrowRight", "ArrowRight"] {
        page.eval(&format!(
            "document.activeElement.dispatchEvent(new KeyboardEvent('keydown', {{ key: '{key}', bubbles: true }}))"
        ))
        .await;
    }
    let average = format!("{}.{}", words[202] / 10, words[202] % 10);
    until(
        &page,
        "[data-testid=chart-readout]",
        &format!("$.innerText.includes('2 to 3 %') && $.innerText.includes('{average}')"),
    )
    .await;

    // A drag shows a part, a double click all of it.
    let drag = |from: f64, to: f64| {
        format!(
            "const plot = document.querySelector('.chart-plot');
             const svg = plot.querySelector('svg');
             const [left, , width] = svg.dataset.plot.split(' ').map(Number);
             const box = plot.getBoundingClientRect();
             const at = part => ({{ clientX: box.left + left + part * width, clientY: box.top + 60,
                                    button: 0, pointerId: 1, pointerType: 'mouse', bubbles: true }});
             plot.dispatchEvent(new PointerEvent('pointerdown', at({from})));
             plot.dispatchEvent(new PointerEvent('pointermove', at({to})));
             plot.dispatchEvent(new PointerEvent('pointerup', at({to})));"
        )
    };
    page.eval(&drag(0.25, 0.5)).await;
    until(&page, "[data-testid=chart-svg]", "Math.abs($.dataset.x.split(' ')[0] - 25) < 1 && Math.abs($.dataset.x.split(' ')[1] - 50) < 1").await;
    page.screenshot("dop-torque-part").await;
    page.eval("document.querySelector('.chart-plot').dispatchEvent(new MouseEvent('dblclick', { bubbles: true }))").await;
    until(&page, "[data-testid=chart-svg]", "$.dataset.x === '0 100'").await;

    page.click("[data-testid=chart-data]").await;
    page.wait_for("[data-testid=chart-table]").await;
    assert_eq!(
        count(&page, "[data-testid=chart-table] tbody tr").await,
        100
    );
    page.click("[data-testid=chart-data]").await;
    for form in ["svg", "png", "csv"] {
        page.click(&format!("[data-testid=chart-save-{form}]"))
            .await;
    }
    tokio::time::sleep(Duration::from_millis(500)).await;
    assert!(
        !page.text(".chart-head").await.contains("could not"),
        "the PNG was painted"
    );
    look(&page, "torque").await;
    page.assert_clean().await;
}

/// A trend runs from its start to its end; twelve months of which nine are there.
#[tokio::test]
async fn a_trend_runs_from_start_to_end() {
    let server = Server::start(&[]);
    let page = open(&server, "temperature").await;
    page.wait_for("[data-chart=dop-225c] [data-testid=chart-svg]")
        .await;
    let words = sample("temperature");
    let oldest_first = |at: usize| -> Vec<f64> {
        (0..9)
            .rev()
            .map(|i| s32(&words, at + 2 * i) / 10.0)
            .collect()
    };
    shows(&page, "dop-225c", "max", &oldest_first(1)).await;
    shows(&page, "dop-225c", "min", &oldest_first(25)).await;
    shows(&page, "dop-225c", "average", &oldest_first(49)).await;
    let points = drawn(&page, "dop-225c", "average").await;
    // 2026-02-20 and 2026-11-20; a ninth of the time lies between points.
    let (start, end) = (1_771_545_600.0, 1_795_132_800.0);
    let step = (end - start) / 9.0;
    assert!(
        (points[0].0 - (start + step / 2.0)).abs() < step * 0.02,
        "{points:?}"
    );
    assert!((points[8].0 - (end - step / 2.0)).abs() < step * 0.02);
    let said = page.text("[data-testid=object-view]").await;
    assert!(said.contains("9 of at most 12 points are valid"), "{said}");
    assert!(page.text("[data-testid=assumptions]").await.contains("°C"));
    look(&page, "trend").await;
    page.assert_clean().await;
}

/// Bins of two widths, and bars for three axes.
#[tokio::test]
async fn bars_are_as_high_as_their_bins() {
    let server = Server::start(&[]);
    let page = open(&server, "vibration").await;
    page.wait_for("[data-chart=dop-0002] rect[data-series]")
        .await;
    let words = sample("vibration");
    let seconds: Vec<f64> = (0..15).map(|i| s32(&words, 1 + 2 * i)).collect();
    shows(&page, "dop-0002", "amount", &seconds).await;
    let bars = drawn(&page, "dop-0002", "amount").await;
    // The last narrow bin is 3.6 to 4.0 G, the last wide one 16.8 to 20 G.
    assert!(
        (bars[9].0 - 3.8).abs() < 0.05 && (bars[14].0 - 18.4).abs() < 0.1,
        "{bars:?}"
    );
    look(&page, "histogram").await;

    page.eval("location.hash = '#/dop?sample=axes'").await;
    page.wait_for("[data-chart=dop-0005-level] rect[data-series]")
        .await;
    shows(&page, "dop-0005-level", "rms", &[112.0, 87.0, 245.0]).await;
    shows(&page, "dop-0005-level", "peak", &[318.0, 266.0, -722.0]).await;
    shows(
        &page,
        "dop-0005-spectrum",
        "frequency",
        &[24.7, 50.2, 119.6],
    )
    .await;
    look(&page, "axes").await;
    page.assert_clean().await;
}

/// Single values with times in words and exactly, reasons in words, candidates to choose from.
#[tokio::test]
async fn registers_find_their_object() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/dop")).await;
    page.show(1440, 900, Scheme::Light).await;
    page.wait_for("[data-testid=dop-welcome]").await;
    look(&page, "welcome").await;
    let text: String = sample("pst").iter().map(|w| format!("{w:04X} ")).collect();
    page.eval(&format!(
        "const box = document.querySelector('[data-testid=dop-paste]');
         box.value = {text:?};
         box.dispatchEvent(new Event('input', {{ bubbles: true }}));"
    ))
    .await;
    page.wait_for("[data-testid=dop-fit]").await;
    assert_eq!(count(&page, "[data-testid=dop-fit]").await, 2);
    let cards = page.text(".object-values").await;
    for words in ["41", "2026-11-03 06:00:12 UTC", "ago"] {
        assert!(cards.contains(words), "{words}: {cards}");
    }
    assert!(cards.to_lowercase().contains("valve jam"), "{cards}");
    look(&page, "cards").await;
    // Another candidate, by a click.
    page.click("[data-testid=dop-fit][aria-pressed=false]")
        .await;
    until(
        &page,
        "[data-testid=object-view]",
        "$.dataset.request === '0x00CF'",
    )
    .await;

    // A register lights its field.
    page.eval("location.hash = '#/dop?sample=pst'").await;
    until(
        &page,
        "[data-testid=object-view]",
        "$.dataset.request === '0x00D1'",
    )
    .await;
    page.click("[data-testid=register][data-offset='24']").await;
    until(
        &page,
        "[data-testid=field-row].selected",
        "$.dataset.path.includes('open_reason')",
    )
    .await;
    assert!(
        page.text("[data-testid=field-facts]")
            .await
            .contains("AIIOM000698-01")
    );

    page.eval("location.hash = '#/dop?sample=events'").await;
    page.wait_for("[data-testid=log-row][data-id='1205']").await;
    assert_eq!(count(&page, "[data-testid=log-row]").await, 6);
    let failure = page.text("[data-testid=log-row][data-id='1205']").await;
    assert!(
        failure.contains("Failure") && failure.contains("Open overtorque"),
        "{failure}"
    );
    look(&page, "events").await;
    page.assert_clean().await;
}

/// A capture of a session is recognised, its addresses inferred and said to be so.
#[tokio::test]
async fn a_capture_becomes_reads() {
    let server = Server::start(&[]);
    let page = open(&server, "session").await;
    page.wait_until("document.querySelectorAll('[data-testid=found-read]').length === 2")
        .await;
    let found = page.text("[data-testid=dop-found]").await;
    assert!(
        found.contains("inferred") && found.contains("request 500"),
        "{found}"
    );
    // The lines of the sample are 60 ms apart: ready in the sixth, all registers in the tenth.
    let first = page.text("[data-testid=found-read][data-index='0']").await;
    assert!(first.contains("540.0 ms, busy 300.0 ms"), "{first}");
    page.click("[data-testid=found-read][data-index='1']").await;
    page.wait_for("[data-chart=dop-025c] [data-testid=chart-svg]")
        .await;
    look(&page, "session").await;
    page.assert_clean().await;
}

/// The profile as a form and as text, mistakes beside their field, kept for the next visit.
#[tokio::test]
async fn a_profile_is_edited() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/dop/profile")).await;
    page.show(1440, 900, Scheme::Light).await;
    page.wait_for("[data-testid=profile-text]").await;
    let set = |testid: &str, value: &str, event: &str| {
        format!(
            "const field = document.querySelector('[data-testid=\"{testid}\"]');
             field.value = '{value}';
             field.dispatchEvent(new Event('{event}', {{ bubbles: true }}));"
        )
    };
    page.eval(&set("profile-registers.request", "70000", "input"))
        .await;
    page.wait_for("[data-testid=profile-problem]").await;
    let problem = page.text("[data-testid=text-problem]").await;
    assert!(
        problem.contains("registers.request") && problem.contains("65535"),
        "{problem}"
    );
    page.screenshot("dop-profile-mistake").await;
    page.eval(&set("profile-registers.request", "500", "input"))
        .await;
    page.eval(&set("profile-temperature", "degF", "change"))
        .await;
    until(
        &page,
        "[data-testid=profile-text]",
        "$.value.includes('\"request\": 500') && $.value.includes('degF')",
    )
    .await;
    assert_eq!(count(&page, "[data-testid=profile-problem]").await, 0);
    page.click("[data-testid=add-indicators]").await;
    page.wait_for("[data-testid=bit-row]").await;
    look(&page, "profile").await;
    // The setting holds at once, and is no longer assumed.
    page.eval("location.hash = '#/dop?sample=temperature'")
        .await;
    page.wait_for("[data-chart=dop-225c]").await;
    until(
        &page,
        "[data-chart=dop-225c]",
        "$.textContent.includes('°F')",
    )
    .await;
    assert!(!page.text("[data-testid=assumptions]").await.contains("°C"));
    page.assert_clean().await;
}

/// The registers that the page shows.
async fn registers(page: &Page) -> Vec<u16> {
    let found = page
        .eval("return [...document.querySelectorAll('[data-testid=register]')].map(r => r.textContent)")
        .await;
    let cells = found.as_array().expect("registers").iter();
    cells
        .map(|c| u16::from_str_radix(c.as_str().expect("text"), 16).expect("a register"))
        .collect()
}

/// The simulated unit at a glance: what is active with sign and explanation, who it is, its clock.
#[tokio::test]
async fn the_overview_of_a_unit() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/device/MX-301/overview")).await;
    page.show(1440, 900, Scheme::Light).await;
    page.wait_for("[data-testid=indicators] [data-testid=active-bit] .sign")
        .await;
    until(
        &page,
        "[data-testid=panel][data-object='1006']",
        "$.innerText.includes('MX-301')",
    )
    .await;
    page.wait_for("[data-testid=clock-deviation]").await;
    page.wait_for("[data-testid=panel][data-object='209'] [data-testid=card-line]")
        .await;
    page.wait_for("[data-testid=warnings] [data-testid=active-bit]")
        .await;
    look(&page, "overview").await;
    // An indicator leads to the object that says more, which is read when it is opened.
    page.click("[data-testid=explained]").await;
    page.wait_for("[data-testid=object-view] [data-testid=card-line]")
        .await;
    let how = page.text("[data-testid=object-how]").await;
    assert!(
        how.contains("read from the device") && how.contains("busy"),
        "{how}"
    );
    page.assert_clean().await;
}

/// A stroke is read and drawn as its registers say; all objects with progress; what changed.
#[tokio::test]
async fn objects_are_read_and_compared() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/device/MX-301/objects?object=401&option=0")).await;
    page.show(1440, 900, Scheme::Light).await;
    page.wait_for("[data-chart=dop-0191] [data-testid=chart-svg]")
        .await;
    let words = registers(&page).await;
    assert_eq!(words.len(), 410);
    for (series, at) in [
        ("max", 0),
        ("min", 100),
        ("average", 200),
        ("long-term", 300),
    ] {
        let wanted: Vec<f64> = words[at..at + 100]
            .iter()
            .map(|w| f64::from(*w) / 10.0)
            .collect();
        shows(&page, "dop-0191", series, &wanted).await;
    }
    // Its reference lies over it, dashed.
    page.eval(
        "document.querySelector(\"[data-testid=object-option][data-request='0x1191']\").click()",
    )
    .await;
    until(
        &page,
        "[data-testid=object-view]",
        "$.dataset.request === '0x1191'",
    )
    .await;
    page.wait_for("[data-chart=dop-strokes-avg] path[data-series=option-1].dashed")
        .await;
    let reference = registers(&page).await;
    let average: Vec<f64> = reference[200..300]
        .iter()
        .map(|w| f64::from(*w) / 10.0)
        .collect();
    shows(&page, "dop-strokes-avg", "option-1", &average).await;

    // All of them, cancelled and begun anew.
    page.click("[data-testid=read-all-objects]").await;
    until(
        &page,
        "[data-testid=dop-job]",
        "/\\d+ of 55/.test($.innerText)",
    )
    .await;
    page.screenshot("dop-reading").await;
    page.click("[data-testid=cancel-objects]").await;
    until(
        &page,
        "[data-testid=dop-job]",
        "$.innerText.includes('Cancelled')",
    )
    .await;

    // A trend of a live unit, from its start to its end.
    page.eval("location.hash = '#/device/MX-301/objects?object=1&option=1'")
        .await;
    page.wait_for("[data-chart=dop-1001] [data-testid=chart-svg]")
        .await;
    let words = registers(&page).await;
    let points = usize::from(words[0].min(30));
    let oldest_first: Vec<f64> = (0..points).rev().map(|i| s32(&words, 61 + 2 * i)).collect();
    shows(&page, "dop-1001", "average", &oldest_first).await;

    // Kept, read again, compared.
    page.eval("location.hash = '#/device/MX-301/objects?object=1007&option=0'")
        .await;
    page.wait_for("[data-testid=object-view][data-request='0x03EF']")
        .await;
    page.click("[data-testid=keep-objects]").await;
    page.wait_for("[data-testid=earlier-note]").await;
    tokio::time::sleep(Duration::from_millis(1200)).await;
    page.click("[data-testid=read-object]").await;
    page.wait_for("[data-testid=difference]").await;
    let change = page.text("[data-testid=differences]").await;
    assert!(change.contains("Date and time"), "{change}");
    look(&page, "compared").await;
    page.eval("location.hash = '#/device/MX-301/objects?object=401&option=0'")
        .await;
    page.wait_for("[data-chart=dop-0191-compared] path[data-series=earlier-average].dashed")
        .await;
    look(&page, "objects").await;
    page.eval("location.hash = '#/device/MX-301/settings'")
        .await;
    page.wait_for("[data-testid=setting][data-key='registers.request']")
        .await;
    look(&page, "settings").await;
    page.assert_clean().await;
}

/// The logs page by page, once each, filtered, with sign and words.
#[tokio::test]
async fn logs_are_read_to_their_end() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/device/MX-301/logs")).await;
    page.show(1440, 900, Scheme::Light).await;
    until(&page, "[data-testid=log-newest]", "!$.disabled").await;
    page.click("[data-testid=log-newest]").await;
    page.wait_for("[data-testid=log-row]").await;
    page.click("[data-testid=log-cancel]").await;
    until(&page, "[data-testid=log-resume]", "!$.disabled").await;
    let before = page.text("[data-testid=log-status] b").await;
    page.click("[data-testid=log-resume]").await;
    // Two dozen pages, half a second each.
    tokio::time::sleep(Duration::from_secs(10)).await;
    until(
        &page,
        "[data-testid=log-status]",
        "$.innerText.includes('end of the log')",
    )
    .await;
    let after = page.text("[data-testid=log-status] b").await;
    assert_ne!(before, after, "more came after going on");
    let rows = count(&page, "[data-testid=log-row]").await;
    assert!((8..80).contains(&rows), "{rows} rows in the page");
    page.eval(
        "const list = document.querySelector('[data-testid=log-category]');
         list.value = '3';
         list.dispatchEvent(new Event('change', { bubbles: true }));",
    )
    .await;
    until(
        &page,
        "[data-testid=log-status]",
        "$.innerText.includes('shown')",
    )
    .await;
    until(&page, "[data-testid=log-list]", "[...$.querySelectorAll('[data-testid=log-row]')].every(r => r.innerText.includes('Failure') && r.querySelector('.sign-f'))").await;
    look(&page, "logs").await;
    page.click("[data-testid=log-1203]").await;
    until(&page, "[data-testid=log-oldest]", "!$.disabled").await;
    page.click("[data-testid=log-oldest]").await;
    page.wait_for("[data-testid=log-row] .log-number").await;
    look(&page, "movements").await;
    page.assert_clean().await;
}
