//! A line on which everything goes wrong: no answer may be taken for that to another request.

use super::world::{Device, World, reply};
use super::*;

/// Requests for every kind of fault. With 40,000 in a release build this is the bar of the project
/// for every line; that takes a minute.
const MANY: u64 = 600;

/// What happens to the answers.
#[derive(Clone, Copy, Debug)]
enum Fault {
    Flip,
    Lost,
    Late,
    Twice,
    Garbage,
    Cut,
    All,
}

/// Requests and percentage of damaged answers, then what came of it: good answers, and failures.
fn storm(fault: Fault, percent: u64, requests: u64) -> (u64, u64) {
    let mut world = World::new(&[Setup::primary()]);
    let mut seed = percent + 1;
    let mut random = move || {
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1442695040888963407);
        seed >> 33
    };
    world.devices.push(Device::new(Box::new(move |request| {
        // The answer repeats the data of the request.
        let data = request[8..request.len() - 1].to_vec();
        let mut bytes = reply(request, [0, 0], &data);
        let mut delay = 10_000 + random() % 200_000;
        if random() % 100 < percent {
            let kind = match fault {
                Fault::All => [
                    Fault::Flip,
                    Fault::Lost,
                    Fault::Late,
                    Fault::Twice,
                    Fault::Garbage,
                    Fault::Cut,
                ][random() as usize % 6],
                one => one,
            };
            match kind {
                Fault::Flip => {
                    let at = random() as usize % bytes.len();
                    bytes[at] ^= 1 << (random() % 8);
                }
                Fault::Lost => return None,
                Fault::Late => delay = 310_000 + random() % 300_000,
                Fault::Twice => bytes = [bytes.clone(), bytes].concat(),
                Fault::Garbage => {
                    let noise: Vec<u8> = (0..random() % 9).map(|_| random() as u8).collect();
                    bytes = [noise, bytes].concat();
                }
                Fault::Cut | Fault::All => bytes.truncate(random() as usize % bytes.len() + 1),
            }
        }
        Some((delay, bytes))
    })));
    let (mut good, mut bad) = (0, 0);
    for number in 0..requests {
        let data = (number as u32).to_be_bytes();
        let number = if number % 7 == 0 { 33 } else { 9 };
        ask(
            &mut world,
            0,
            Request::new(DEVICE, number, &data).with_preambles(5),
        );
        match world.outcome(0, u64::MAX).unwrap().outcome {
            Ok(answer) => {
                assert_eq!(
                    answer.data(),
                    data,
                    "{fault:?}: an answer to another request"
                );
                good += 1;
            }
            Err(_) => bad += 1,
        }
        world.forget();
    }
    (good, bad)
}

/// No wrong answer among many, at 3 % and at 30 % of faults; of those at 3 % hardly any request is
/// lost, since four tries in a row rarely fail.
#[test]
fn no_answer_is_taken_for_another() {
    use Fault::{All, Cut, Flip, Garbage, Late, Lost, Twice};
    for fault in [Flip, Lost, Late, Twice, Garbage, Cut, All] {
        let (good, bad) = storm(fault, 3, MANY);
        assert!(bad <= 1, "{fault:?}: {good} {bad}");
        let (good, bad) = storm(fault, 30, MANY / 2);
        assert!(good > MANY * 4 / 10, "{fault:?}: {good} {bad}");
    }
}
