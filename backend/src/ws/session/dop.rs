//! What a page asks about diagnostic objects: checked here, done by the actor of the line.

use super::{Page, unknown};
use crate::bus::Command;
use shared::proto::{DopAsk, DopNews, MAX_DOP_REQUESTS, Outcome, ToPage};

impl Page<'_> {
    /// Passes a message on to the actor, or says why not.
    pub(super) async fn dop(&mut self, ask: DopAsk) -> Option<ToPage> {
        let (id, tag) = match &ask {
            // It does not say on which device: the one that knows it ends it.
            DopAsk::Cancel { .. } => {
                for (bus, device) in self.plant.dop_devices() {
                    bus.ask(self.command(device, ask.clone())).await;
                }
                return None;
            }
            DopAsk::Read { id, device, .. } | DopAsk::Log { id, device, .. } => (Some(*id), device),
            DopAsk::Watch { device, .. } | DopAsk::Profile { device } => (None, device),
        };
        let Some((bus, at)) = self.plant.device(tag) else {
            return self.refuse_dop(id, tag, None);
        };
        if !self.plant.has_objects(tag) {
            let text =
                format!("{tag} has no diagnostic objects; only a device of kind \"dop\" has.");
            return self.refuse_dop(id, tag, Some(text));
        }
        if let DopAsk::Read { requests, .. } = &ask
            && requests.len() > MAX_DOP_REQUESTS
        {
            let text = format!(
                "{} objects are too many at once; ask for at most {MAX_DOP_REQUESTS}.",
                requests.len()
            );
            return self.refuse_dop(id, tag, Some(text));
        }
        bus.ask(self.command(at, ask)).await;
        None
    }

    fn command(&self, device: usize, ask: DopAsk) -> Command {
        Command::Dop {
            client: self.client,
            device,
            ask,
            out: self.outlet.clone(),
        }
    }

    /// Whoever waits for an id is told that it is over; others get a plain refusal.
    fn refuse_dop(&self, id: Option<u32>, tag: &str, text: Option<String>) -> Option<ToPage> {
        let (Some(id), true) = (id, self.outlet.has_room()) else {
            return Some(match text {
                Some(text) => ToPage::Refused { text },
                None => unknown("device", tag),
            });
        };
        self.outlet.send(DopNews::Failed {
            id,
            device: tag.to_owned(),
            request: 0,
            code: None,
            outcome: Outcome::Refused,
            text: text.unwrap_or_else(|| format!("There is no device \"{tag}\"; reload the page.")),
        });
        self.outlet.send(DopNews::Done {
            id,
            device: tag.to_owned(),
            ok: 0,
            failed: 1,
        });
        None
    }
}
