//! The procedures of a capture: runs with their steps, each a way to its frame.

use crate::format::count;
use crate::hart::state::steps::Steps;
use crate::markup::Markup;
use shared::problem::Severity;

/// What was not ended, then all runs.
pub fn steps(html: &mut Markup, steps: &Steps) {
    if steps.all.is_empty() {
        html.node(
            "p",
            "empty",
            "No procedure of several frames is in this: no identification, trim, map or forced mode.",
        );
        return;
    }
    for (frame, words) in &steps.open {
        html.open(
            "p",
            &[("class", "hart-doubt"), ("data-testid", "hart-open-run")],
        );
        html.severity(Severity::Warning).node("span", "", words);
        link(html, *frame);
        html.close("p");
    }
    for (run, all) in steps.runs() {
        html.open(
            "section",
            &[("class", "hart-run"), ("data-testid", "hart-run")],
        );
        let label = all.first().map_or("", |at| at.step.procedure.label());
        html.open("h2", &[]).text(label).text(" ");
        let many = count(u64::try_from(all.len()).unwrap_or(0), "step");
        html.node("span", "quiet", &format!("run {run}, {many}"));
        html.close("h2").open("ol", &[("class", "hart-steps")]);
        for at in all {
            html.open(
                "li",
                &[("data-testid", "hart-step"), ("data-key", at.step.key)],
            );
            link(html, at.frame);
            html.node("span", "", &at.step.text);
            for doubt in &at.step.doubts {
                html.open("span", &[("class", "hart-doubt")]);
                html.severity(doubt.severity())
                    .node("span", "", &doubt.to_string())
                    .close("span");
            }
            html.close("li");
        }
        html.close("ol").close("section");
    }
}

fn link(html: &mut Markup, frame: u32) {
    html.open(
        "button",
        &[
            ("class", "link num"),
            ("data-act", "frame"),
            ("data-frame", &frame.to_string()),
        ],
    );
    html.text(&format!("frame {frame}")).close("button");
}
