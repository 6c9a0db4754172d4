//! What happened on a HART line, in words: what, where, and what to do next.

use super::{Exchange, Fault};
use crate::config::LineConfig;
use crate::config::hart::HartWay;
use shared::hart::link::{Answer, Failure, Stats, Target};
use shared::hart::values::unpack;
use shared::hart::{code_words, command};
use shared::proto::Outcome;

/// How a device is found, in words.
pub fn target(target: &Target) -> String {
    match target {
        Target::Polling(polling) => format!("polling address {polling}"),
        Target::Unique(kind, id) => format!("address {kind:04X}{id:06X}"),
        Target::Tag(packed) => format!("tag \"{}\"", unpack(packed).trim_end()),
        Target::LongTag(bytes) => {
            let text: String = bytes.iter().copied().map(char::from).collect();
            format!("long tag \"{}\"", text.trim_end_matches('\0'))
        }
    }
}

/// The outcome that an exchange means.
pub const fn outcome(exchange: &Exchange) -> Outcome {
    match &exchange.outcome {
        Ok(_) => Outcome::Ok,
        Err(Fault::Link(Failure::Silence | Failure::Crowded)) => Outcome::Silence,
        Err(_) => Outcome::Damaged,
    }
}

/// How an exchange went.
pub fn exchange(exchange: &Exchange, target: &Target, line: &LineConfig) -> String {
    let tries = match exchange.tries {
        0 | 1 => String::new(),
        n => format!(", {n} tries"),
    };
    match &exchange.outcome {
        Ok(answer) => {
            let ms = exchange.ended.since(exchange.began) / 1000;
            format!("{} in {ms} ms{tries}", good(answer))
        }
        Err(Fault::Link(Failure::Silence)) => {
            let advice = match line {
                LineConfig::Hart(hart) if matches!(hart.way, HartWay::Ip { .. }) => {
                    "that the gateway knows the device".to_owned()
                }
                _ => format!(
                    "that the loop is powered and that the device has {}",
                    self::target(target)
                ),
            };
            format!("no answer{tries}; check {advice}")
        }
        Err(Fault::Link(Failure::Crowded)) => {
            format!(
                "{}{tries}; another master or a device never leaves it",
                Failure::Crowded
            )
        }
        Err(Fault::Link(failure)) => match line {
            LineConfig::Hart(hart) if matches!(hart.way, HartWay::Ip { .. }) => {
                format!("{failure}{tries}")
            }
            _ => format!(
                "{failure}{tries}; check the wiring, the loop resistance (230 to 600 ohm) and the \
                 modem's supply"
            ),
        },
        Err(Fault::Gateway(why)) => format!("{why}{tries}"),
    }
}

/// An answer by its response code.
fn good(answer: &Answer) -> String {
    match answer.code() {
        None | Some(0) => "answered".to_owned(),
        Some(code) => {
            let words = code_words(command(answer.number()), code);
            let words = words.to_lowercase();
            let words = if words.is_empty() {
                String::new()
            } else {
                format!(", {words}")
            };
            format!("answered with response code {code}{words}")
        }
    }
}

/// Who else is on a line.
pub fn link(other: bool, burst: bool, stats: &Stats) -> String {
    let mut text = match (other, burst) {
        (false, false) => "no other master and no bursts heard".to_owned(),
        (true, false) => "another master is on the line".to_owned(),
        (false, true) => "a device sends bursts".to_owned(),
        (true, true) => "another master is on the line, and a device sends bursts".to_owned(),
    };
    if stats.sent > 0 {
        text.push_str(&format!(
            "; {} of {} requests answered",
            stats.answered, stats.sent
        ));
    }
    text
}
