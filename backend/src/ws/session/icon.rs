//! What a page asks about an ICON3000: checked here, done by the actor of the line.

use super::{Page, unknown};
use crate::bus::Command;
use shared::proto::{IconAsk, IconNews, MAX_ICON_STEPS, Outcome, ToPage};

impl Page<'_> {
    /// Passes a message on to the actor, or says why not.
    pub(super) async fn icon(&mut self, ask: IconAsk) -> Option<ToPage> {
        let IconAsk::Read { id, device, steps } = &ask else {
            // It does not say on which device: the one that knows it ends it.
            for (bus, device) in self.plant.icon_devices() {
                bus.ask(self.icon_command(device, ask.clone())).await;
            }
            return None;
        };
        let refusal = match self.plant.device(device) {
            None => Some(format!("There is no device \"{device}\"; reload the page.")),
            Some(_) if !self.plant.is_icon(device) => Some(format!(
                "{device} is no ICON3000, so it has no files, report and counters of one."
            )),
            Some(_) if steps.len() > MAX_ICON_STEPS => Some(format!(
                "{} steps are too many at once; ask for at most {MAX_ICON_STEPS}.",
                steps.len()
            )),
            Some(_) => None,
        };
        if let Some(text) = refusal {
            return self.refuse_icon(*id, device, text);
        }
        let (bus, at) = self.plant.device(device)?;
        bus.ask(self.icon_command(at, ask)).await;
        None
    }

    fn icon_command(&self, device: usize, ask: IconAsk) -> Command {
        Command::Icon {
            client: self.client,
            device,
            ask,
            out: self.outlet.clone(),
        }
    }

    /// Whoever waits for an id is told that it is over.
    fn refuse_icon(&self, id: u32, tag: &str, text: String) -> Option<ToPage> {
        if !self.outlet.has_room() {
            return Some(unknown("device", tag));
        }
        self.outlet.send(IconNews::Exchange {
            id,
            device: tag.to_owned(),
            step: 0,
            request: String::new(),
            response: String::new(),
            outcome: Outcome::Refused,
            text,
            at_us: 0,
        });
        self.outlet.send(IconNews::Done {
            id,
            device: tag.to_owned(),
            ok: 0,
            failed: 1,
        });
        None
    }
}
