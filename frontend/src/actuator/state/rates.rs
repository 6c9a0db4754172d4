//! Error rates of the line, from counters that were read again and again.

use shared::icon3000::counters::{rate, since};
use shared::scale::Scale;

use super::dossier::{Dossier, Reading};
use crate::chart::{Axis, Chart, Kind, Point, Series, Shape, Stroke};

/// Errors whose rate is shown: their sub-function, key and name, and the sub-function that counts
/// the messages among which they are. On a line with several units those are, for what only this
/// unit does, the messages for it.
const ERRORS: [(u16, &str, &str, u16); 4] = [
    (12, "crc", "CRC errors", 11),
    (13, "exceptions", "Exceptions", 14),
    (17, "busy", "Busy", 14),
    (18, "overruns", "Overruns", 11),
];

/// Errors in percent of the messages between two readings, over time. `None` before two readings.
#[must_use]
pub fn chart(dossier: &Dossier) -> Option<Chart> {
    let readings = |sub: &u16| dossier.counters.get(sub).map_or(&[][..], Vec::as_slice);
    if readings(&11).len() < 2 {
        return None;
    }
    let strokes = [
        Stroke::Solid,
        Stroke::Dashed,
        Stroke::DashDot,
        Stroke::Dotted,
    ];
    let series = ERRORS
        .iter()
        .zip(strokes)
        .map(|((sub, key, label, among), stroke)| Series {
            key: (*key).to_owned(),
            label: (*label).to_owned(),
            shape: Shape::Step,
            stroke,
            points: points(dossier, readings(among), readings(sub)),
        });
    Some(Chart {
        key: "rates".to_owned(),
        title: "Errors of the line, in percent of its messages".to_owned(),
        x: Axis {
            label: "Time".to_owned(),
            unit: "UTC".to_owned(),
            kind: Kind::Time,
        },
        y: Axis::number("Errors", "%"),
        series: series.collect(),
        bands: Vec::new(),
        notes: vec![
            "Counters of FC 08; they go round at 65536 and begin at 0 with power up (reading E60). \
             CRC errors and overruns are of all messages (11), exceptions and busy of those for \
             this device (14)."
                .to_owned(),
        ],
    })
}

/// Thousandths of a percent.
const THOUSANDTH: Scale = Scale::new(1, 1000, 3);

/// Counters that are read within so many microseconds of each other are of one round.
const ROUND: u64 = 2_500_000;

fn points(dossier: &Dossier, messages: &[Reading], errors: &[Reading]) -> Vec<Point> {
    // Any counter may be missing in any round.
    let near = |error: &Reading| {
        let away = |m: &&Reading| m.at.abs_diff(error.at);
        let nearest = messages.iter().min_by_key(away);
        (*error, nearest.filter(|m| away(m) <= ROUND).copied())
    };
    let rounds: Vec<_> = errors.iter().map(near).collect();
    let pairs = rounds.windows(2).filter_map(|pair| pair.first_chunk());
    pairs
        .map(|&[(e0, m0), (e1, m1)]| {
            let among = m0.zip(m1).and_then(|(m0, m1)| {
                let all = counted(m0, m1, u64::MAX)?;
                Some((counted(e0, e1, all.into())?, all, m0.at, m1.at))
            });
            let (errors, all, from, to) = among.unwrap_or((0, 0, e0.at, e1.at));
            let rate = rate(errors, all);
            Point {
                from: seconds(dossier.wall(from)),
                to: seconds(dossier.wall(to)),
                y: rate.map(|r| THOUSANDTH.to_f64(r.into())),
                text: rate.map_or_else(String::new, |r| THOUSANDTH.apply(r.into()).to_string()),
                note: if among.is_some() {
                    format!("{errors} of {all}")
                } else {
                    "not both read, or counted anew".to_owned()
                },
            }
        })
        .collect()
}

/// How far a counter went. `None` if it fell and going round would make it more than `most`, or
/// than a line carries, 1000 a second: then it began anew.
fn counted(before: Reading, now: Reading, most: u64) -> Option<u16> {
    let count = since(before.count, now.count);
    let most = most.min(now.at.saturating_sub(before.at) / 1000);
    (now.count >= before.count || u64::from(count) <= most).then_some(count)
}

#[expect(
    clippy::cast_precision_loss,
    reason = "seconds since 1970 are far below 2^52"
)]
const fn seconds(time: i64) -> f64 {
    time as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::device::Device;

    fn read(dossier: &mut Dossier, sub: u8, count: u16, at: u64) {
        let [high, low] = count.to_be_bytes();
        assert!(dossier.absorb(&[8, 0, sub, 0, 0], &[8, 0, sub, high, low], at));
    }

    /// 200 messages with one error are 0.5 %; then the counter goes round: 65530 to 94 are 100.
    #[test]
    fn rates_are_those_between_two_readings() {
        let mut dossier = Dossier::new("XV", Device::Icon3000v2);
        read(&mut dossier, 11, 65_330, 0);
        read(&mut dossier, 12, 4, 0);
        assert_eq!(chart(&dossier), None);
        read(&mut dossier, 11, 65_530, 5_000_000);
        read(&mut dossier, 12, 5, 5_000_000);
        read(&mut dossier, 11, 94, 10_000_000);
        read(&mut dossier, 12, 5, 10_000_000);
        let chart = chart(&dossier).unwrap();
        let crc = &chart.series[0].points;
        assert_eq!(crc.len(), 2);
        assert_eq!((crc[0].y, crc[0].text.as_str()), (Some(0.5), "0.500"));
        assert_eq!(crc[0].note, "1 of 200");
        assert_eq!((crc[1].y, crc[1].note.as_str()), (Some(0.0), "0 of 100"));
        assert_eq!((crc[0].from, crc[0].to, crc[1].to), (0.0, 5.0, 10.0));
        assert!(chart.series[1].points.is_empty(), "not read, not zero");
        // Of 1000 messages on the line 50 were for this unit, and one of those was refused: 2 %.
        for (sub, count, at) in [(13, 0, 0), (14, 100, 0), (13, 1, 5), (14, 150, 5)] {
            read(&mut dossier, sub, count, at * 1_000_000);
        }
        let refused = &super::chart(&dossier).unwrap().series[1].points[0];
        assert_eq!((refused.y, refused.note.as_str()), (Some(2.0), "1 of 50"));
    }

    /// The messages of second 5 were not read, nor the errors of second 15. From second 10 to 20
    /// there were 3 errors among 600 messages.
    #[test]
    fn a_counter_that_is_missing_in_a_round_shifts_no_other() {
        let mut dossier = Dossier::new("XV", Device::Icon3000v2);
        for (count, at) in [(0, 0), (200, 10), (700, 15), (800, 20)] {
            read(&mut dossier, 11, count, at * 1_000_000);
        }
        for (count, at) in [(0, 0), (0, 5), (1, 10), (4, 20)] {
            read(&mut dossier, 12, count, at * 1_000_000 + 40_000);
        }
        let crc = &chart(&dossier).unwrap().series[0].points;
        let shown: Vec<_> = crc.iter().map(|p| (p.from, p.to, p.y)).collect();
        // 3 of 600 messages are 0.5 %.
        assert_eq!(
            shown,
            [(0.0, 5.0, None), (5.0, 10.0, None), (10.0, 20.0, Some(0.5))]
        );
        assert_eq!(crc[0].note, "not both read, or counted anew");
        assert_eq!(crc[2].note, "3 of 600");
    }

    /// With power up the counters begin at 0: 5 errors that become none are no 65531, nor are 900
    /// messages that become 3 64639. In 5 s a line carries no more than 5000.
    #[test]
    fn a_reset_is_a_gap() {
        let mut dossier = Dossier::new("XV", Device::Icon3000v2);
        for (sub, counts) in [(11, [800, 900, 3, 103]), (12, [0, 5, 0, 1])] {
            for (count, at) in counts.into_iter().zip(0..) {
                read(&mut dossier, sub, count, at * 5_000_000);
            }
        }
        let ys = |dossier: &Dossier| -> Vec<_> {
            let points = chart(dossier).unwrap().series[0].points.clone();
            points.iter().map(|p| p.y).collect()
        };
        assert_eq!(ys(&dossier), [Some(5.0), None, Some(1.0)]);
        // 65000 messages that become 3 may have gone round, but not with 65531 errors among 539.
        let mut dossier = Dossier::new("XV", Device::Icon3000v2);
        for (sub, counts) in [(11, [65_000, 3]), (12, [5, 0])] {
            for (count, at) in counts.into_iter().zip(0..) {
                read(&mut dossier, sub, count, at * 100_000_000);
            }
        }
        assert_eq!(ys(&dossier), [None]);
    }
}
