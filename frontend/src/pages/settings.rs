//! How the page looks, where its facts come from, and what keys there are.

use leptos::prelude::*;

use crate::browser::is_file;
use crate::components::help::KeyTable;
use crate::components::icon::{Glyph, Icon};
use crate::theme::{Theme, ThemeChoice};

/// Documents that facts were taken from: short name, title, revision.
const SOURCES: [(&str, &str, &str); 5] = [
    (
        "VCIOM-16345-EN",
        "Biffi ICON3000 Modbus RTU Module",
        "PC-15081, 2022",
    ),
    (
        "LMAIM4019-00",
        "Limitorque DDC-100 Direct-to-Host Programming Guide",
        "September 2004; one sample",
    ),
    (
        "Modbus V1.1b3",
        "Modbus Application Protocol Specification",
        "V1.1b3, 2012",
    ),
    (
        "Modbus Serial V1.02",
        "Modbus over Serial Line, Specification and Implementation Guide",
        "V1.02, 2006",
    ),
    (
        "Modbus TCP V1.0b",
        "Modbus Messaging on TCP/IP Implementation Guide",
        "V1.0b, 2006",
    ),
];

/// Settings and facts about the program.
#[component]
pub fn SettingsPage() -> impl IntoView {
    let ThemeChoice(theme) = expect_context();
    view! {
        <div class="page settings" data-testid="page-settings">
            <h1>"Settings"</h1>
            <section>
                <h2 id="theme-title">"Appearance"</h2>
                <div class="segments" role="radiogroup" aria-labelledby="theme-title">
                    {Theme::ALL
                        .map(|choice| {
                            view! {
                                <label class="segment">
                                    <input
                                        type="radio"
                                        name="theme"
                                        value=choice.key()
                                        data-testid=format!("theme-{}", choice.key())
                                        prop:checked=move || theme.get() == choice
                                        on:change=move |_| theme.set(choice)
                                    />
                                    <span>{choice.label()}</span>
                                </label>
                            }
                        })}
                </div>
            </section>
            <section>
                <h2>"Keys"</h2>
                <KeyTable/>
            </section>
            <section>
                <h2>"Sources"</h2>
                <p class="quiet">
                    "Every value names the document and place that it was taken from. Only facts were taken: addresses, ranges, units, codes and names."
                </p>
                <table class="plain">
                    <thead>
                        <tr>
                            <th>"Printed as"</th>
                            <th>"Title"</th>
                            <th>"Revision"</th>
                        </tr>
                    </thead>
                    <tbody>
                        {SOURCES
                            .map(|(short, title, revision)| {
                                view! {
                                    <tr>
                                        <td class="mono">{short}</td>
                                        <td>{title}</td>
                                        <td>{revision}</td>
                                    </tr>
                                }
                            })}
                    </tbody>
                </table>
            </section>
            <section>
                <h2>"About"</h2>
                <p>
                    "Valvescope " {env!("CARGO_PKG_VERSION")}
                    ". It reads, and never writes to a device. Licence: MIT or Apache-2.0, as you like."
                </p>
                <Show when=|| !is_file()>
                    <p>
                        <a class="button" href="valvescope.html" download="valvescope.html">
                            <Icon glyph=Glyph::Save/>
                            "Save as one file"
                        </a>
                        <span class="quiet">
                            " The whole page in one file, for a computer without a network: decoding works from a double click."
                        </span>
                    </p>
                </Show>
            </section>
        </div>
    }
}
