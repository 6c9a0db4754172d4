//! Goes over the frames of a line.

use super::words::Act;
use super::{Doubt, Open, Procedure, Step};
use crate::frame::Framing;
use crate::hart::frame::{Address, Head, Type, extended, preamble};
use crate::hart::model::Class;
use crate::hart::{class, ip};

/// Devices that are followed at once; the one that was quiet for longest makes room.
const DEVICES: usize = 128;

/// A request that waits for its answer.
#[derive(Clone, Debug)]
struct Asked {
    address: Address,
    primary: bool,
    number: u16,
    data: Vec<u8>,
    act: Option<Act>,
    /// The procedure and the number of its run.
    run: Option<(Procedure, u32)>,
}

/// A procedure of a device that is going on.
#[derive(Clone, Copy, Debug)]
struct Run {
    procedure: Procedure,
    number: u32,
    primary: bool,
    /// The frame by which the device agreed; until then the mode does not stand.
    since: Option<u32>,
}

/// What is known of a device.
#[derive(Clone, Debug)]
struct Device {
    address: Address,
    runs: Vec<Run>,
    /// The fixed current in mA.
    fixed: Option<f32>,
    simulates: bool,
    /// The entry of the map behind the last page that was read.
    page: Option<u8>,
    /// The device works on this command.
    delayed: Option<u16>,
}

impl Device {
    fn run(&self, procedure: Procedure) -> Option<Run> {
        self.runs.iter().find(|r| r.procedure == procedure).copied()
    }

    fn end(&mut self, procedure: Procedure) {
        self.runs.retain(|r| r.procedure != procedure);
    }

    fn stands(&mut self, procedure: Procedure, index: u32) {
        for run in self.runs.iter_mut().filter(|r| r.procedure == procedure) {
            run.since.get_or_insert(index);
        }
    }
}

/// Follows the procedures of one line. See the [module](super) for how.
#[derive(Clone, Debug, Default)]
pub struct Procedures {
    /// Oldest first.
    devices: Vec<Device>,
    asked: Option<Asked>,
    runs: u32,
}

impl Procedures {
    /// At the start of a list.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            devices: Vec::new(),
            asked: None,
            runs: 0,
        }
    }

    /// The next frame as it was received, with or without preamble; of HART-IP a whole message.
    /// `index` is its number in the list. `None` if it belongs to no procedure.
    ///
    /// The frame must be sound: a damaged one says nothing.
    pub fn frame(&mut self, framing: Framing, bytes: &[u8], index: u32) -> Option<Step> {
        let frame = match framing {
            Framing::HartIp => ip::carried(bytes)?,
            _ => bytes.get(preamble(bytes)..)?,
        };
        let head = Head::of(frame)?;
        let number = extended(&head, frame).unwrap_or(u16::from(head.command));
        let from = head.data;
        let body = frame.get(from..from.saturating_add(usize::from(head.count)))?;
        match head.delimiter.kind() {
            Type::Stx => {
                let skip = if head.command == 31 { 2 } else { 0 };
                let data = body.get(skip..).unwrap_or(&[]);
                self.request(&head, number, data)
            }
            Type::Ack => self.answer(&head, body, index),
            Type::Back => None,
        }
    }

    /// What was begun and not ended, in the order in which it began: a warning each.
    #[must_use]
    pub fn open(&self) -> Vec<Open> {
        let mut open: Vec<Open> = self
            .devices
            .iter()
            .flat_map(|device| {
                device
                    .runs
                    .iter()
                    .filter(|r| r.procedure.lasts())
                    .filter_map(|run| {
                        Some(Open {
                            procedure: run.procedure,
                            run: run.number,
                            address: device.address,
                            since: run.since?,
                        })
                    })
            })
            .collect();
        open.sort_by_key(|o| o.since);
        open
    }

    fn device(&mut self, address: Address) -> Option<&mut Device> {
        let device = match self.devices.iter().position(|d| d.address == address) {
            Some(at) => self.devices.remove(at),
            None => Device {
                address,
                runs: Vec::new(),
                fixed: None,
                simulates: false,
                page: None,
                delayed: None,
            },
        };
        if self.devices.len() >= DEVICES {
            self.devices.remove(0);
        }
        self.devices.push(device);
        self.devices.last_mut()
    }

    /// The run of a procedure of a device, begun if there is none.
    fn enter(&mut self, address: Address, procedure: Procedure, primary: bool) -> Option<Run> {
        let fresh = self.runs.saturating_add(1);
        let device = self.device(address)?;
        if let Some(run) = device.run(procedure) {
            return Some(run);
        }
        let run = Run {
            procedure,
            number: fresh,
            primary,
            since: None,
        };
        device.runs.push(run);
        self.runs = fresh;
        Some(run)
    }

    fn request(&mut self, head: &Head, number: u16, data: &[u8]) -> Option<Step> {
        let before = self.asked.take();
        let act = Act::of(number, data);
        let mut asked = Asked {
            address: head.address,
            primary: head.primary,
            number,
            data: data.to_vec(),
            act,
            run: None,
        };
        let step = self.ask(&mut asked, before.as_ref());
        self.asked = Some(asked);
        step
    }

    fn ask(&mut self, asked: &mut Asked, before: Option<&Asked>) -> Option<Step> {
        let number = asked.number;
        let mut doubts = Vec::new();
        // Sent again is no doubt; something else before an answer is.
        let lost = before.filter(|b| {
            b.address == asked.address
                && b.act.is_some_and(Act::changes)
                && (b.number, &b.data) != (number, &asked.data)
        });
        if let Some(lost) = lost {
            doubts.push(Doubt::Unanswered(lost.number));
        }
        let waits = self.device(asked.address)?.delayed;
        if waits == Some(number) {
            let run = self.enter(asked.address, Procedure::Delayed, asked.primary)?;
            asked.run = Some((Procedure::Delayed, run.number));
            return Some(Step {
                procedure: Procedure::Delayed,
                run: run.number,
                key: "asks-again",
                text: format!("Asks again for command {number}, on which the device works."),
                doubts,
            });
        }
        let device = self.device(asked.address)?;
        let Some(act) = asked.act else {
            device.end(Procedure::Identify);
            return None;
        };
        // Reading about itself is part of a procedure only behind an identification.
        let identifies = |run: Run| run.primary == asked.primary;
        if act == Act::About && !device.run(Procedure::Identify).is_some_and(identifies) {
            return None;
        }
        let procedure = match act.procedure() {
            Some(procedure) => procedure,
            // A reset: of what it ends.
            None => self.device(asked.address)?.runs.first()?.procedure,
        };
        let device = self.device(asked.address)?;
        if act != Act::About {
            device.end(Procedure::Identify);
        }
        if procedure != Procedure::StatusMap {
            device.end(Procedure::StatusMap);
            device.page = None;
        }
        match act {
            Act::Trim(end, _) => match device.fixed {
                None => doubts.push(Doubt::NotFixed),
                Some(fixed) if (fixed - end).abs() > 1.0 => {
                    doubts.push(Doubt::OtherEnd(fixed, end));
                }
                Some(_) => {}
            },
            Act::SimulateBit(..) if !device.simulates => doubts.push(Doubt::NotSimulated),
            Act::ReadMap(first, _) => {
                if let Some(page) = device.page
                    && first > page
                {
                    doubts.push(Doubt::Skipped(page, first.saturating_sub(1)));
                }
            }
            _ => {}
        }
        let run = self.enter(asked.address, procedure, asked.primary)?;
        if run.primary != asked.primary && procedure.lasts() {
            doubts.push(Doubt::OtherMaster);
        }
        asked.run = Some((procedure, run.number));
        Some(Step {
            procedure,
            run: run.number,
            key: act.key(),
            text: act.asks(number),
            doubts,
        })
    }

    fn answer(&mut self, head: &Head, body: &[u8], index: u32) -> Option<Step> {
        let number = |asked: &Asked| u8::try_from(asked.number).unwrap_or(31) == head.command;
        let asked = self.asked.take_if(|asked| {
            let same = asked.address == head.address || asked.address == Address::BROADCAST;
            same && asked.primary == head.primary && number(asked)
        })?;
        let code = *body.first()?;
        let damaged = code & 0x80 != 0;
        let agreed = !damaged && class(code).0 != Class::Error;
        if let Some(step) = self.delayed(&asked, code, index) {
            return Some(step);
        }
        let (procedure, run) = asked.run?;
        let Some(act) = asked.act else {
            return self.done(&asked, procedure, run);
        };
        if !agreed {
            let doubt = if damaged {
                Doubt::Damaged
            } else {
                Doubt::Refused(code)
            };
            let device = self.device(asked.address)?;
            // What never stood is over.
            device.runs.retain(|r| r.number != run || r.since.is_some());
            return Some(Step {
                procedure,
                run,
                key: act.key(),
                text: "The device did not do it.".to_owned(),
                doubts: vec![doubt],
            });
        }
        let mut doubts = Vec::new();
        self.take(&asked, act, head.address, body, index);
        if act == Act::Reset {
            doubts.push(Doubt::Reset);
        }
        let procedure = if procedure == Procedure::Delayed {
            act.procedure().unwrap_or(procedure)
        } else {
            procedure
        };
        Some(Step {
            procedure,
            run,
            key: act.key(),
            text: act.agrees(asked.number),
            doubts,
        })
    }

    /// The device agreed: what stands now.
    fn take(
        &mut self,
        asked: &Asked,
        act: Act,
        answerer: Address,
        body: &[u8],
        index: u32,
    ) -> Option<()> {
        if act == Act::Find {
            // Whoever was found goes on by its own address.
            let run = self.device(asked.address)?.run(Procedure::Identify)?;
            let long = found(answerer, body);
            self.device(asked.address)?.end(Procedure::Identify);
            let device = self.device(long)?;
            device.end(Procedure::Identify);
            device.runs.push(run);
            return Some(());
        }
        let device = self.device(asked.address)?;
        match act {
            Act::Fix(current) => {
                device.fixed = Some(current);
                device.stands(Procedure::Trim, index);
            }
            Act::Free => {
                device.fixed = None;
                device.end(Procedure::Trim);
            }
            Act::Simulate(true) => {
                device.simulates = true;
                device.stands(Procedure::StatusSimulation, index);
            }
            Act::Simulate(false) => {
                device.simulates = false;
                device.end(Procedure::StatusSimulation);
            }
            Act::Force(..) => device.stands(Procedure::ForcedVariable, index),
            Act::Release(_) => device.end(Procedure::ForcedVariable),
            Act::Control(_) => device.stands(Procedure::DigitalControl, index),
            Act::Analog => {
                device.end(Procedure::DigitalControl);
                // Command 132 ends what command 79 forced, too (section 8.1).
                device.end(Procedure::ForcedVariable);
            }
            Act::ReadMap(first, count) => device.page = first.checked_add(count),
            Act::WriteStatus => device.end(Procedure::Acknowledge),
            Act::Reset => {
                device.runs.clear();
                device.fixed = None;
                device.simulates = false;
                device.delayed = None;
            }
            _ => {}
        }
        Some(())
    }

    /// Codes 33 to 36.
    fn delayed(&mut self, asked: &Asked, code: u8, index: u32) -> Option<Step> {
        if !matches!(code, 33..=36) {
            return None;
        }
        let run = self.enter(asked.address, Procedure::Delayed, asked.primary)?;
        let device = self.device(asked.address)?;
        let (key, text) = match code {
            33 => ("begun", "The device has begun and needs longer; ask again."),
            34 => ("running", "The device still works on it; ask again."),
            35 => ("dead", "The device gave up what it worked on."),
            _ => ("conflict", "The device works on another command."),
        };
        if code == 33 {
            device.delayed = Some(asked.number);
        }
        device.stands(Procedure::Delayed, index);
        if code == 35 {
            device.delayed = None;
            device.end(Procedure::Delayed);
        }
        Some(Step {
            procedure: Procedure::Delayed,
            run: run.number,
            key,
            text: text.to_owned(),
            doubts: Vec::new(),
        })
    }

    /// What took long is done.
    fn done(&mut self, asked: &Asked, procedure: Procedure, run: u32) -> Option<Step> {
        let device = self.device(asked.address)?;
        device.delayed = None;
        device.end(Procedure::Delayed);
        Some(Step {
            procedure,
            run,
            key: "done",
            text: format!("Command {} is done.", asked.number),
            doubts: Vec::new(),
        })
    }
}

/// The address by which a device that was found is spoken to from now on: type and id of its
/// answer to command 0, behind the two status bytes.
fn found(answerer: Address, body: &[u8]) -> Address {
    let long = |body: &[u8]| {
        let &[high, low] = body.get(3..5)?.first_chunk::<2>()?;
        let &[a, b, c] = body.get(11..14)?.first_chunk::<3>()?;
        let kind = u16::from_be_bytes([high & 0x3F, low]);
        Some(Address::Long(kind, u32::from_be_bytes([0, a, b, c])))
    };
    match answerer {
        Address::Short(_) => long(body).unwrap_or(answerer),
        Address::Long(..) => answerer,
    }
}
