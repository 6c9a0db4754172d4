//! Rows of a list of frames.

use leptos::prelude::*;
use shared::frame::Role;

use crate::components::frame_detail::SeverityMark;
use crate::components::icon::{Glyph, Icon};
use crate::format::thousands;
use crate::state::summary::{Summary, role};

/// Names of the columns of a list of frames.
#[component]
pub fn FrameListHead(
    /// What the second column is: `Offset` or `Time`.
    second: &'static str,
    /// True if the list has a column for the latency.
    #[prop(optional)]
    latency: bool,
) -> impl IntoView {
    view! {
        <div class="frame-row frame-head" class:with-latency=latency aria-hidden="true">
            <span class="num">"#"</span>
            <span class="num">{second}</span>
            <span></span>
            <span class="num">"Unit"</span>
            <span>"Function"</span>
            <span>"About"</span>
            {latency.then(|| view! { <span class="num">"Latency"</span> })}
            <span class="num">"Bytes"</span>
            <span></span>
        </div>
    }
}

/// One frame in a list.
#[component]
pub fn FrameRow(
    /// Its number.
    index: u32,
    /// What it says.
    summary: Summary,
    /// Offset or time.
    second: String,
    /// Time from the request to this answer.
    #[prop(optional_no_strip)]
    latency: Option<String>,
    /// Called to go to the other frame of the pair.
    on_pair: Callback<u32>,
) -> impl IntoView {
    let frame = summary.frame;
    let noise = frame.is_noise();
    let glyph = match frame.role {
        Role::Request => Some(Glyph::Right),
        Role::Response | Role::Exception => Some(Glyph::Left),
        Role::Unknown | Role::Noise => None,
    };
    let words = role(frame.role);
    let arrow = match (frame.pair(), glyph) {
        (Some(pair), Some(glyph)) => view! {
            <button
                class="pair"
                tabindex="-1"
                title=format!("{words}, goes with frame {pair}")
                aria-label=format!("{words}, goes with frame {pair}")
                on:click=move |event| {
                    event.stop_propagation();
                    on_pair.run(pair);
                }
            >
                <Icon glyph=glyph/>
            </button>
        }
        .into_any(),
        (None, Some(glyph)) => view! {
            <span class="pair alone" title=format!("{words}, without its other half")>
                <Icon glyph=glyph/>
            </span>
        }
        .into_any(),
        _ => view! { <span class="pair alone" title=words>{if noise { "" } else { "?" }}</span> }
            .into_any(),
    };
    let with_latency = latency.is_some();
    let code = (!noise).then(|| format!("{:02X}", frame.function));
    view! {
        <div
            class="frame-row"
            class:noise=noise
            class:with-latency=with_latency
            class:exception=frame.role == Role::Exception
            data-testid="frame-row"
            data-index=index.to_string()
            data-role=frame.role.key()
        >
            <span class="num quiet">{thousands(u64::from(index))}</span>
            <span class="num mono">{second}</span>
            {arrow}
            <span class="num">{(!noise).then(|| frame.unit.to_string())}</span>
            <span class="frame-function">
                <code>{code}</code>
                " "
                {summary.function}
            </span>
            <span class="frame-about">{summary.detail}</span>
            {latency.map(|l| view! { <span class="num">{l}</span> })}
            <span class="num">{thousands(u64::from(frame.len))}</span>
            <span class="frame-mark">
                {summary.worst.map(|severity| view! { <SeverityMark severity=severity/> })}
            </span>
        </div>
    }
}
