//! What a page asks about a DDC-100 network.

use super::{Followed, MAX_READS, Page, not_allowed, refused, unknown};
use crate::bus::query::{Query, is_counter};
use crate::bus::recorder::encode;
use crate::bus::{Command, Report};
use crate::clock::Clock;
use axum::extract::ws::Utf8Bytes;
use shared::proto::{DdcAsk, DdcNews, Outcome};
use shared::render::hex;

impl Page<'_> {
    /// Does what a message says; gives the answer to it, if there is one at once.
    pub(super) async fn ddc(&mut self, ask: DdcAsk) -> Option<Utf8Bytes> {
        match ask {
            DdcAsk::Follow { bus } => {
                let Some(news) = self.plant.network(&bus) else {
                    return Some(match self.plant.bus(&bus) {
                        None => encode(&unknown("bus", &bus)),
                        Some(_) => refused(no_network(&bus)),
                    });
                };
                let news = news.clone();
                self.networks.retain(|n| n.bus != bus);
                self.networks.push(Followed { bus, news, seen: 0 });
                None
            }
            DdcAsk::Leave { bus } => {
                self.networks.retain(|n| n.bus != bus);
                None
            }
            DdcAsk::Read {
                id,
                bus,
                unit,
                block,
            } => {
                let question = Question {
                    id,
                    bus,
                    unit,
                    request: block.read().map(|r| r.pdu().to_vec()).unwrap_or_default(),
                    clock: self.plant.clock(),
                };
                let query = block.read().map(Query::Read);
                self.read_unit(question, query.ok_or_else(|| not_allowed(block)))
                    .await
            }
            DdcAsk::Counter {
                id,
                bus,
                unit,
                sub_function,
            } => {
                let query = Query::Diagnostic(sub_function);
                let question = Question {
                    id,
                    bus,
                    unit,
                    request: query.pdu(),
                    clock: self.plant.clock(),
                };
                let refusal = format!(
                    "Sub-function {sub_function} of function 08 does not read; 2 and 11 to 18 do."
                );
                let query = is_counter(sub_function).then_some(query).ok_or(refusal);
                self.read_unit(question, query).await
            }
        }
    }

    /// Asks a unit; an error is what the page is told instead.
    async fn read_unit(
        &mut self,
        question: Question,
        query: Result<Query, String>,
    ) -> Option<Utf8Bytes> {
        let (bus, unit) = (&question.bus, question.unit);
        let network = self.plant.network(bus).is_some();
        let tag = self.plant.tag(bus, unit).filter(|_| network);
        let Some((handle, device)) = tag.and_then(|tag| self.plant.device(tag)) else {
            let text = if network {
                format!("There is no unit {unit} on \"{bus}\"; reload the page.")
            } else {
                no_network(bus)
            };
            return Some(question.answer(Report::refused(text)));
        };
        let query = match query {
            Ok(query) => query,
            Err(text) => return Some(question.answer(Report::refused(text))),
        };
        if self.reads >= MAX_READS {
            let text = format!("{MAX_READS} reads are under way already; wait for them.");
            return Some(question.answer(Report::refused(text)));
        }
        self.reads += 1;
        let sender = self.done.clone();
        let reply = Box::new(move |report: Report| {
            // There is room; the page may be gone, though.
            let _gone = sender.try_send(question.answer(report));
        });
        let command = Command::Read {
            device,
            query,
            reply,
        };
        handle.ask(command).await;
        None
    }
}

fn no_network(bus: &str) -> String {
    format!(
        "\"{bus}\" is no DDC-100 network; only a bus of kind \"ddc100\" or \"ddc100-simulator\" is."
    )
}

/// A read that a page waits for.
struct Question {
    id: u32,
    bus: String,
    unit: u8,
    request: Vec<u8>,
    clock: Clock,
}

impl Question {
    fn answer(self, report: Report) -> Utf8Bytes {
        let function = self.request.first().copied().unwrap_or(0);
        let refusal = |code| vec![function | 0x80, code];
        let response = report.pdu.or(report.code.map(refusal));
        let text = match report.outcome {
            Outcome::Ok => String::new(),
            _ => report.text,
        };
        let news = DdcNews::Read {
            id: self.id,
            bus: self.bus,
            unit: self.unit,
            outcome: report.outcome,
            text,
            request: hex(&self.request),
            response: response.as_deref().map(hex).unwrap_or_default(),
            at_us: self.clock.now().get(),
        };
        news.to_text().into()
    }
}
