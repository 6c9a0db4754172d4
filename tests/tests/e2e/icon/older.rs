//! Models before the ICON3000v2 on the line: no files, and an ICON2000v4 with registers of its own.

use shared::address::{Address, Table};
use shared::icon3000::Snapshot;
use shared::map::row::Model;
use tests::browser::{Page, Scheme};
use tests::server::Server;

use super::device;
use super::live::done;

/// Codes that a simulated actuator has in its log registers: five times code and time (table 5,
/// HR 3090 and on; table 4, IR 45 and on); 0 is none.
fn logged(snapshot: &Snapshot, table: Table, addresses: impl Iterator<Item = u16>) -> u64 {
    let codes = addresses.filter(|address| {
        let cell = snapshot.image.cell(table, Address::new(*address));
        cell.is_some_and(|c| c.word != 0)
    });
    u64::try_from(codes.count()).expect("five at most")
}

async fn visit(page: &Page, tab: &str) {
    page.eval(&format!("location.hash = '#/device/XV-9/{tab}'"))
        .await;
    page.wait_for(&format!("[data-testid=page-{tab}]")).await;
    done(page).await;
}

/// What they have is shown, and what they do not have is said: logs from registers, torque curves
/// from registers, health, words; nothing fails.
#[tokio::test]
async fn older_models_are_read_from_the_line() {
    for (kind, model) in [
        ("icon3000", Model::Icon3000),
        ("icon2000v4", Model::Icon2000v4),
    ] {
        let folder = std::env::temp_dir().join(format!("valvescope-{kind}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder for the configuration");
        let file = folder.join("valvescope.toml");
        let text = format!(
            "[[bus]]\nname = \"Bench\"\nkind = \"simulator\"\n\
             [[device]]\ntag = \"XV-9\"\nkind = \"{kind}\"\nbus = \"Bench\"\nunit = 1\n"
        );
        std::fs::write(&file, text).expect("a folder that can be written to");
        let server = Server::start(&["--config", file.to_str().expect("a plain path")]);
        let page = Page::open(&server.url("/#/device/XV-9/overview")).await;
        page.show(1440, 900, Scheme::Light).await;
        page.until("[data-testid=position]", "/\\d/.test($.innerText)")
            .await;
        page.look(&format!("icon-{kind}-overview")).await;

        let alike = device(model);
        let (table, first, step) = match model {
            Model::Icon2000v4 => (Table::Input, 45, 5),
            _ => (Table::Holding, 3090, 5),
        };
        visit(&page, "logs").await;
        let words = page.text("[data-testid=page-logs]").await;
        assert!(words.contains("came with the ICON3000v2"), "{words}");
        let alarms = logged(&alike, table, (0..5).map(|n| first + n * step));
        page.click("[data-testid=icon-log-2]").await;
        page.wait_until(&format!(
            "document.querySelectorAll('[data-testid=log-row]').length === {alarms}"
        ))
        .await;
        page.look(&format!("icon-{kind}-logs")).await;

        visit(&page, "curves").await;
        page.wait_for("[data-chart=torque] path[data-series]").await;
        page.look(&format!("icon-{kind}-curves")).await;
        visit(&page, "health").await;
        page.until("[data-testid=health-sum]", "!/Not known/.test($.innerText)")
            .await;
        page.look(&format!("icon-{kind}-health")).await;
        visit(&page, "identity").await;
        let said = page.text("[data-testid=model]").await;
        assert!(!said.contains("change it"), "{kind}: {said}");
        visit(&page, "communication").await;
        visit(&page, "configuration").await;
        let stroke = page.text("[data-testid=words-pst]").await;
        assert!(
            stroke.contains("coil 3") || stroke.contains("Coil 3"),
            "{kind}: {stroke}"
        );
        page.look(&format!("icon-{kind}-configuration")).await;
        assert_eq!(page.count("[data-testid=icon-failed]").await, 0, "{kind}");
        page.assert_clean().await;
        std::fs::remove_dir_all(&folder).expect("only the configuration is in it");
    }
}

/// Nobody knows how long file 5 is: it is found out. The simulated one has 64 records.
#[tokio::test]
async fn a_file_of_unknown_length_is_read() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/device/XV-101/logs?log=5")).await;
    page.show(1440, 900, Scheme::Light).await;
    page.wait_for("[data-testid=page-logs]").await;
    done(&page).await;
    page.click("[data-testid=icon-log-5]").await;
    page.until(
        "[data-testid=log-status]",
        "/^64 records/.test($.innerText)",
    )
    .await;
    assert_eq!(page.count("[data-testid=icon-failed]").await, 0);
    page.look("icon-live-log-5").await;

    // Counters over time: two readings make a rate.
    page.eval("location.hash = '#/device/XV-101/communication'")
        .await;
    page.click("[data-testid=watch]").await;
    page.wait_within(
        "document.querySelector('[data-testid=page-communication] [data-testid=chart-svg]')",
        std::time::Duration::from_secs(25),
    )
    .await;
    page.look("icon-live-rates").await;
    page.click("[data-testid=watch]").await;
    page.assert_clean().await;
}
