//! What a page asks about HART devices: checked here, done by the actor of the line.

use super::{Page, unknown};
use crate::bus::Command;
use crate::bus::hart::{Wish, gate};
use shared::hart::link::{LAST_POLLING, Target};
use shared::proto::{HartAsk, HartCommand, HartNews, MAX_HART_COMMANDS, Outcome, ToPage};

impl Page<'_> {
    /// Passes a message on to the actor, or says why not.
    pub(super) async fn hart(&mut self, ask: HartAsk) -> Option<ToPage> {
        match &ask {
            // It does not say on which line: the one that knows it ends it.
            HartAsk::Cancel { .. } => {
                for bus in self.plant.hart_buses() {
                    bus.ask(self.wish(None, ask.clone())).await;
                }
                None
            }
            HartAsk::Read {
                id,
                device,
                commands,
            } => {
                let (id, tag) = (*id, device.clone());
                let at = match self.plant.hart_device(&tag) {
                    Ok(found) => found,
                    Err(text) => return self.refuse_read(id, &tag, commands, text),
                };
                if let Err((at, text)) = check(commands) {
                    let bad = commands.get(at..=at).unwrap_or(commands);
                    return self.refuse_read(id, &tag, bad, text);
                }
                let (bus, at) = at;
                bus.ask(self.wish(Some(at), ask)).await;
                None
            }
            HartAsk::Watch {
                device, commands, ..
            } => {
                let (bus, at) = match self.plant.hart_device(device) {
                    Ok(found) => found,
                    Err(text) => return Some(ToPage::Refused { text }),
                };
                if let Err((_, text)) = check(commands) {
                    return Some(ToPage::Refused { text });
                }
                bus.ask(self.wish(Some(at), ask)).await;
                None
            }
            HartAsk::Scan {
                id,
                bus,
                first,
                last,
            } => {
                let text = format!(
                    "Polling addresses {first} to {last} can't be looked at; write 0 to \
                     {LAST_POLLING}, the lower one first."
                );
                let fits = first <= last && *last <= LAST_POLLING;
                let (id, bus) = (*id, bus.clone());
                self.search(id, &bus, ask, (!fits).then_some(text)).await
            }
            HartAsk::Find { id, bus, tag, long } => {
                let good = if *long {
                    Target::long_tag(tag).is_some()
                } else {
                    Target::tag(tag).is_some()
                };
                let text = if *long {
                    "A long tag has 1 to 32 characters of ISO 8859-1."
                } else {
                    "A tag has 1 to 8 characters: capital letters, digits and signs up to \"_\"."
                };
                let (id, bus) = (*id, bus.clone());
                self.search(id, &bus, ask, (!good).then(|| text.to_owned()))
                    .await
            }
            HartAsk::Link { bus } => {
                let Some(handle) = self.plant.hart_bus(bus) else {
                    return Some(self.no_line(bus));
                };
                handle.ask(self.wish(None, ask)).await;
                None
            }
        }
    }

    /// A scan or search on a line.
    async fn search(
        &mut self,
        id: u32,
        bus: &str,
        ask: HartAsk,
        wrong: Option<String>,
    ) -> Option<ToPage> {
        let Some(handle) = self.plant.hart_bus(bus) else {
            return match self.no_line(bus) {
                ToPage::Refused { text } => self.refuse(id, text),
                other => Some(other),
            };
        };
        if let Some(text) = wrong {
            return self.refuse(id, text);
        }
        handle.ask(self.wish(None, ask)).await;
        None
    }

    fn wish(&self, device: Option<usize>, ask: HartAsk) -> Command {
        Command::Hart(Wish {
            client: self.client,
            device,
            ask,
            out: self.outlet.clone(),
        })
    }

    fn no_line(&self, bus: &str) -> ToPage {
        match self.plant.bus(bus) {
            None => unknown("bus", bus),
            Some(_) => ToPage::Refused {
                text: format!("\"{bus}\" is no HART line."),
            },
        }
    }

    /// Whoever waits for an id is told that it is over.
    fn refuse(&self, id: u32, text: String) -> Option<ToPage> {
        if !self.outlet.has_room() {
            return Some(ToPage::Refused { text });
        }
        self.outlet.send(HartNews::Done {
            id,
            ok: 0,
            failed: 1,
            text,
        });
        None
    }

    fn refuse_read(
        &self,
        id: u32,
        tag: &str,
        commands: &[HartCommand],
        text: String,
    ) -> Option<ToPage> {
        if self.outlet.has_room()
            && let Some(command) = commands.first()
        {
            self.outlet.send(HartNews::Exchange {
                id: Some(id),
                device: tag.to_owned(),
                command: command.number,
                request: String::new(),
                response: String::new(),
                outcome: Outcome::Refused,
                text: text.clone(),
                at_us: self.plant.clock().now().get(),
                took_us: 0,
                tries: 0,
            });
        }
        self.refuse(id, text)
    }
}

/// Which of the commands may not be sent, and why.
fn check(commands: &[HartCommand]) -> Result<(), (usize, String)> {
    if commands.len() > MAX_HART_COMMANDS {
        let text = format!(
            "{} commands are too many at once; ask for at most {MAX_HART_COMMANDS}.",
            commands.len()
        );
        return Err((0, text));
    }
    for (at, command) in commands.iter().enumerate() {
        gate::command(command).map_err(|text| (at, text))?;
    }
    Ok(())
}
