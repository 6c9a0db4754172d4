//! The overview of a device: what is active, and what the unit says about itself.

use std::sync::Arc;

use leptos::prelude::*;

use crate::components::drawn::{Act, Draw, Drawn};
use crate::components::icon::Glyph;
use crate::dop::markup::overview::{self, SHOWN};
use crate::dop::store::Store;
use crate::markup::Markup;
use crate::markup::control::Button;

/// What is active, and the objects about identity, clock, supply, work and tests.
#[component]
pub(super) fn OverviewPage() -> impl IntoView {
    let store = Store::get();
    let active: Draw = Arc::new(move |html: &mut Markup| {
        let (now, now_us, tag) = (
            store.now.get(),
            store.now_us.get().cast_unsigned(),
            store.tag.get(),
        );
        store
            .site
            .with(|site| overview::active(html, site, &tag, now_us, now));
    });
    let panels: Draw = Arc::new(move |html: &mut Markup| {
        let (now, tag) = (store.now.get(), store.tag.get());
        store.site.with(|site| {
            let objects = SHOWN.into_iter().skip(1).filter_map(shared::dop::object);
            for object in objects {
                overview::panel(html, site, &tag, object, now);
            }
        });
    });
    let tools: Draw = Arc::new(move |html: &mut Markup| {
        let online = store.online.get();
        store.site.with(|site| {
            let job = site.reading();
            Button {
                act: "read",
                testid: "read-overview",
                words: "Read again",
                glyph: Some(Glyph::Poll),
                disabled: job.is_some() || !online,
                ..Button::default()
            }
            .draw(html);
            html.open("span", &[("class", "quiet"), ("role", "status")]);
            match job {
                Some(job) => {
                    html.text(&format!("{} of {}, {}", job.done, job.total, job.text));
                }
                None if site.known && site.profile.registers.request.is_none() => {
                    html.text(
                        "The profile of this device names no registers, so nothing can be read: \
                         see Settings.",
                    );
                }
                None => {
                    html.text(&site.last);
                }
            }
            html.close("span");
        });
    });
    let on_act = Callback::new(move |_: Act| {
        let requests = store
            .site
            .with_untracked(|site| overview::requests(&site.profile));
        store.read(requests);
    });
    view! {
        <div class="dop-page dop-overview">
            <Drawn class="toolbar" draw=tools on_act=on_act/>
            <Drawn class="active-all" draw=active/>
            <Drawn class="panels" draw=panels/>
        </div>
    }
}
