//! Every reading of the ICON3000 manual (E01 to E89) is held by a test, or says why it needs none.
//!
//! What the manual says of the behaviour of a device is held by the simulated one, which is what
//! other masters meet; what it says of bytes is held by the decoder alone.

use shared::address::{Address, Table};
use shared::capture::Micros;
use shared::icon3000::model::READINGS;
use shared::icon3000::read::Log;
use shared::icon3000::records::{Files, Records};
use shared::icon3000::snapshot::Snapshot;
use shared::icon3000::{File, FileRead, Span, counters, identity, say, words};
use shared::image::Image;
use shared::map::decode::value;
use shared::map::row::{Access, Level, Model, Row, Settled, Trust};
use shared::sim::{Fault, Icon3000, Programme};
use shared::value::Quality;
use tests::golden::{FILES, cases};

/// How a reading is held.
enum Held {
    /// By this.
    By(fn()),
    /// Elsewhere, or not at all, for this reason.
    Because(&'static str),
}
use Held::{Because, By};

const HR: Table = Table::Holding;
const IR: Table = Table::Input;
const V2: Model = Model::Icon3000v2;

/// All readings, in the order of the manual's sections.
const HELD: [(&str, Held); 89] = [
    (
        "E01",
        By(|| {
            rests("E01", HR, &[3483]);
            assert_eq!(row(HR, 3482).key, "user_level");
            assert_eq!(row(HR, 3483).words, 4);
            assert_eq!(row(HR, 3844).key, "valve_serial_number");
        }),
    ),
    (
        "E02",
        By(|| {
            rests("E02", IR, &[99, 103, 106, 110]);
            assert_eq!(row(IR, 99).range, Some((-127, 127)));
        }),
    ),
    (
        "E03",
        By(|| {
            assert_eq!(row(HR, 3615).range, Some((5, 40)));
            assert_eq!(shared::icon3000::config::range(row(HR, 3615)), "5 to 40 %");
        }),
    ),
    ("E04", By(|| says(HR, 3784, &[1], "Nm (1)"))),
    (
        "E05",
        By(|| {
            for address in [21, 3022, 3646] {
                says(HR, address, &[2], "CH1 Enabled, CH2 Enabled (2)");
            }
        }),
    ),
    (
        "E06",
        By(|| {
            for (at, number) in [(70, 1), (75, 2), (80, 3), (85, 4), (90, 5)] {
                assert_eq!(row(IR, at).label, format!("Warning Log {number} - Code"));
            }
            says(IR, 90, &[10], "PST Failed (10)");
        }),
    ),
    ("E07", By(|| says(HR, 3110, &[32], "Hardware 13 (32)"))),
    ("E08", By(|| says(HR, 11, &[0x1511, 0x2020], "2020-11-15"))),
    ("E09", By(|| says(HR, 3093, &[0x0012, 0x3456], "12:34:56"))),
    (
        "E10",
        By(|| {
            says(HR, 3657, &[0], "Present (0)");
            says(HR, 3611, &[0], "Absent (0)");
            says(HR, 3563, &[0], "Absent (0)");
            assert_eq!(settled("E10"), Settled::No);
        }),
    ),
    (
        "E11",
        By(|| assert_eq!(row(HR, 3659).set.map(|s| s.mask), Some(0x7F))),
    ),
    (
        "E12",
        By(|| {
            says(
                HR,
                3517,
                &[0x0002, 0x0008],
                "ESD, EFS Mid Travel (EFS Only)",
            );
            golden("E12");
        }),
    ),
    (
        "E13",
        By(|| {
            says(HR, 3516, &[4], "Failed - T-RET (T2)");
            golden("E13");
        }),
    ),
    (
        "E14",
        By(|| {
            assert_eq!(row(HR, 3580).range, Some((0, 29)));
            assert_eq!(row(HR, 3587).range, Some((0, 30)));
            assert_eq!(row(HR, 3627).range, Some((0, 30)));
            says(HR, 3622, &[30], "Heater (only AS8) (30)");
        }),
    ),
    (
        "E15",
        By(|| says(HR, 3620, &[0x0101, 0x2027], "2027-01-01")),
    ),
    (
        "E16",
        By(|| says(HR, 3775, &[0x1234, 0xABCD], "0x1234ABCD")),
    ),
    (
        "E17",
        By(|| {
            let amount = [0x0134, 0x3830, 0x2020, 0x2020];
            says(HR, 3074, &amount, "480 Nm");
            says(HR, 3074, &[0x3134, 0x3830, 0x2020, 0x2020], "480 Nm");
            says(IR, 95, &amount, "480 Nm");
        }),
    ),
    (
        "E18",
        By(|| {
            // Seven characters, the last in the high byte; or in the low one if that is empty.
            says(HR, 3780, &[0x3132, 0x3334, 0x3536, 0x3720], "1234567");
            says(HR, 3780, &[0x3132, 0x3334, 0x3536, 0x0037], "123456 7");
        }),
    ),
    (
        "E19",
        By(|| {
            says(HR, 3070, &[0x392E, 0x3032], "9.02");
            let mut tag = [0; 14];
            tag[..3].copy_from_slice(&[0x5856, 0x2D31, 0x2020]);
            says(HR, 3056, &tag, "XV-1");
        }),
    ),
    (
        "E20",
        By(|| {
            says(HR, 3005, &[0xFFF4], "-12 %");
            says(HR, 3161, &[0xFFF7], "-9 °C");
            says(HR, 3161, &[0x00F7], "-9 °C");
            assert_eq!(quality(HR, 3161, &[0x00F7]), Quality::Disputed);
            golden("E20");
        }),
    ),
    (
        "E21",
        By(|| {
            let span = row(HR, 3947);
            assert_eq!(
                (span.level, span.access),
                (Some(Level::Observer), Access::WriteGuarded)
            );
            rests("E21", HR, &[3947]);
        }),
    ),
    (
        "E22",
        By(|| {
            let mut sim = sim(V2);
            // As observer, then back to user: nobody is locked out.
            log_in(&mut sim, 0, b"ANYTHING");
            assert_eq!(read(&mut sim, 3480), 0);
            log_in(&mut sim, 1, b"USER0000");
            assert_eq!(read(&mut sim, 3480), 1);
        }),
    ),
    (
        "E23",
        By(|| {
            for address in [3027, 3028, 3460, 3911] {
                assert_eq!(row(HR, address).access, Access::Read);
            }
            let mut sim = sim(V2);
            log_in(&mut sim, 0, b"ANYTHING");
            assert_eq!(sim.answer(&[3, 0x0B, 0xD3, 0, 1]).unwrap()[0], 3);
        }),
    ),
    (
        "E24",
        By(|| {
            for address in [3027, 3028] {
                assert!(row(HR, address).note.contains("E24"), "{address}");
            }
            let pst = words::pst(V2, &Image::new());
            assert_eq!(pst.reasons[0].source.part, "section 12");
        }),
    ),
    (
        "E25",
        By(|| {
            rests("E25", HR, &[3987]);
            says(HR, 3988, &[1], "Active (1)");
        }),
    ),
    ("E26", By(|| says(HR, 3028, &[0], "PST-EFS (0)"))),
    (
        "E27",
        By(|| {
            let number = shared::address::RegisterNumber::of(HR, Address::new(3580));
            assert_eq!(number.get(), 403_581);
            golden("coils 1");
        }),
    ),
    (
        "E28",
        By(|| {
            says(HR, 3013, &[4095], "100.00 %");
            says(HR, 3013, &[1], "0.02 %");
        }),
    ),
    ("E29", By(|| says(HR, 3799, &[75], "0.75 kW"))),
    (
        "E30",
        By(|| {
            rests("E30", HR, &[3654, 3655, 3772]);
            says(HR, 3654, &[401], "401");
        }),
    ),
    (
        "E31",
        By(|| {
            rests("E31", HR, &[3180, 3197]);
            says(HR, 3180, &[65_535], "65535");
        }),
    ),
    (
        "E32",
        By(|| {
            let mut sim = sim(V2);
            assert_eq!(sim.answer(&[6, 0x0F, 0x8D, 0, 0]).unwrap(), [0x86, 3]);
            assert_eq!(row(HR, 3981).range, Some((0, 100)));
        }),
    ),
    (
        "E33",
        By(|| {
            // Off and on, or idle and execute, though the manual has no text for them; the reset is
            // left without names, and no write of it goes unasked.
            for address in (3913..=3914).chain(3965..=3972).chain(3985..=3986) {
                let row = row(HR, address);
                assert_eq!((row.range, row.words), (Some((0, 1)), 1), "{address}");
                let set = row.set.expect("0 and 1 have names");
                let named = |code| set.get(code).map(|m| m.label.to_lowercase());
                let [no, yes] = [0, 1].map(|code| named(code).expect("a name"));
                let pairs = [("no", "yes"), ("off", "on"), ("idle", "execute")];
                assert!(
                    pairs
                        .iter()
                        .any(|(a, b)| no.starts_with(a) && yes.starts_with(b)),
                    "{address}: {no}, {yes}"
                );
                assert_eq!(named(2), None);
                assert_eq!(quality(HR, address, &[2]), Quality::Invalid);
            }
            rests("E33", HR, &[3549, 3555]);
            assert!(row(HR, 3549).set.is_none() && row(HR, 3549).access.is_guarded());
        }),
    ),
    (
        "E34",
        By(|| {
            let mut bytes = vec![0; 128];
            bytes[0] = 200;
            bytes[101..107].copy_from_slice(&[0x15, 0x11, 0x20, 0x56, 0x34, 0x12]);
            let curve =
                shared::icon3000::curve::Curve::of_registers(row(HR, 3328), &bytes).unwrap();
            assert_eq!(curve.at(0), Some(200));
            assert_eq!(curve.when.as_deref(), Some("2020-11-15 12:34:56"));
        }),
    ),
    (
        "E35",
        By(|| {
            assert_eq!(
                Model::Icon2000v4
                    .map()
                    .row_at(HR, Address::new(22))
                    .unwrap()
                    .access,
                Access::Absent
            );
            assert_eq!(
                Model::Icon3000
                    .map()
                    .row_at(HR, Address::new(3474))
                    .unwrap()
                    .access,
                Access::Absent
            );
            assert_ne!(
                Model::Icon3000
                    .map()
                    .row_at(HR, Address::new(3473))
                    .unwrap()
                    .access,
                Access::Absent
            );
        }),
    ),
    (
        "E36",
        By(|| {
            assert_eq!(
                (row(Table::Coil, 0).key, row(Table::Coil, 1).key),
                ("open_command", "close_command")
            );
            says(HR, 3006, &[1], "Close Command");
            let mut sim = sim(V2);
            sim.answer(&[5, 0, 0, 0xFF, 0]).unwrap();
            assert_eq!(read(&mut sim, 3006), 2, "coil 0 opens, and that is bit 1");
        }),
    ),
    (
        "E37",
        By(|| {
            let coil =
                |model: Model, at| model.map().row_at(Table::Coil, Address::new(at)).unwrap();
            assert!(coil(Model::Icon3000, 3).label.contains("PST"));
            assert_eq!(coil(V2, 5).key, "pst_command");
        }),
    ),
    (
        "E38",
        By(|| {
            // The command itself comes back in a device only: the simulated one has no local controls.
            for stops in [row(HR, 3006), row(Table::Coil, 2)] {
                assert!(stops.note.contains("E38"));
            }
            assert_eq!(settled("E38"), Settled::Likely);
            // Commands wait while it is pressed, not while it is released: HR 3622, function 11 (local
            // STOP), makes bit 8 of HR 3001 show which.
            let said = |pressed: u16| {
                let mut image = Image::new();
                for (address, word) in [(3622, 11), (3001, pressed << 8)] {
                    image.set(HR, Address::new(address), word, Micros::default());
                }
                let pst = words::pst(V2, &image);
                let stop = pst
                    .reasons
                    .into_iter()
                    .find(|r| r.key == "local_stop")
                    .unwrap();
                (stop.holds, stop.text)
            };
            let (holds, text) = said(1);
            assert_eq!(holds, Some(words::Truth::No));
            assert!(text.ends_with("the local STOP is pressed."), "{text}");
            assert_eq!(said(0).0, Some(words::Truth::Yes));
        }),
    ),
    (
        "E39",
        By(|| {
            for address in [3006, 3008] {
                assert!(row(HR, address).note.contains("E39"));
            }
            // An alarm while the valve opens, by each kind of command: the enumerated one is cleared,
            // the bit and the coil stay, and the valve goes on when the alarm is gone.
            for (write, register, after, goes_on) in [
                ([6, 0x0B, 0xC0, 0, 2], 3008, 0, false),
                ([6, 0x0B, 0xBE, 0, 2], 3006, 2, true),
                ([5, 0, 0, 0xFF, 0], 3006, 2, true),
            ] {
                let mut sim = sim(V2);
                let wait = |sim: &mut Icon3000, at: u64| {
                    sim.advance(Micros::new(at * 1_000_000), 1_795_651_200 + at);
                };
                sim.answer(&write).expect("an answer");
                wait(&mut sim, 5);
                sim.set_fault(Fault::Thermostat, true);
                wait(&mut sim, 10);
                assert_eq!(read(&mut sim, register), after, "HR {register}");
                let held = sim.position();
                sim.set_fault(Fault::Thermostat, false);
                wait(&mut sim, 15);
                assert_eq!(sim.position() > held, goes_on, "HR {register}");
            }
        }),
    ),
    (
        "E40",
        By(|| {
            let mut sim = sim(V2);
            // Not open, so the test is refused; the device clears the code, but not the bit.
            sim.answer(&[6, 0x0B, 0xC0, 0, 5]).unwrap();
            assert_eq!(read(&mut sim, 3008), 0);
            sim.answer(&[6, 0x0B, 0xBE, 0, 0x20]).unwrap();
            assert_eq!(read(&mut sim, 3006), 0x20);
        }),
    ),
    (
        "E41",
        By(|| {
            let home =
                |at| shared::icon3000::model::Mirror::home(Table::Discrete, Address::new(at));
            assert_eq!(home(15), (HR, Address::new(3001), Some(15)));
            assert_eq!(home(28), (HR, Address::new(3002), Some(12)));
            assert_eq!(home(30), (Table::Discrete, Address::new(30), None));
        }),
    ),
    (
        "E42",
        By(|| {
            // One wording for registers and files.
            says(HR, 3090, &[11], "Main Voltage (11)");
            let log = Log::read(2, &Records::of(0, [1, 0, 0, 11])).unwrap();
            assert_eq!(
                log.entries[0].get("code").unwrap().text(),
                "Main Voltage (11)"
            );
        }),
    ),
    (
        "E43",
        By(|| {
            assert!(row(HR, 3881).label.contains("Stem"));
            says(HR, 3779, &[3], "in/s (3)");
            says(HR, 3784, &[3], "kN (3)");
            assert_eq!(row(HR, 3799).unit, "kW");
        }),
    ),
    (
        "E44",
        By(|| {
            let home = |at| {
                shared::icon3000::model::Mirror::home(HR, Address::new(at))
                    .1
                    .get()
            };
            assert_eq!(
                [2, 21, 3022, 3742, 3027].map(home),
                [3017, 3646, 3646, 3042, 3920]
            );
        }),
    ),
    (
        "E45",
        By(|| {
            let mut image = Image::new();
            for (at, word) in [(3019, 4), (3020, 20), (3021, 50), (3940, 1)] {
                image.set(HR, Address::new(at), word, Micros::default());
            }
            let said = words::fail_safe(V2, &image);
            assert!(
                said[0]
                    .text
                    .contains("goes to 50 % after 30 s (10 s and the 20 s"),
                "{said:?}"
            );
            assert_eq!(said[1].holds, Some(words::Truth::Yes));
        }),
    ),
    (
        "E46",
        By(|| {
            // As printed, each within its own range and without a common factor.
            assert_eq!(row(HR, 3528).range, Some((0, 4095)));
            // It is not settled, so not even the largest value is beyond doubt.
            assert_eq!(settled("E46"), Settled::No);
            assert_eq!(quality(HR, 3528, &[4095]), Quality::Disputed);
            assert_eq!(quality(HR, 3528, &[4096]), Quality::OutOfRange);
            says(HR, 3528, &[4095], "4095");
            for address in 3789..=3794 {
                assert_eq!(row(HR, address).range, Some((0, 1023)), "{address}");
                assert_eq!(quality(HR, address, &[1024]), Quality::OutOfRange);
                says(HR, address, &[1023], "1023");
            }
            assert_eq!(row(HR, 3528).scale, row(HR, 3789).scale);
        }),
    ),
    (
        "E47",
        By(|| {
            for address in [3006, 3016, 3521, 3605, 3647] {
                assert!(
                    row(HR, address)
                        .set
                        .unwrap()
                        .members
                        .iter()
                        .any(|m| m.states.is_none() || address == 3521)
                );
            }
            says(HR, 3016, &[1], "EFS Mid Travel");
        }),
    ),
    (
        "E48",
        By(|| {
            let row = row(HR, 3948);
            assert_eq!((row.words, row.kind.key()), (2, "ascii"));
            let mut sim = sim(V2);
            sim.answer(&[16, 0x0F, 0x6C, 0, 2, 4, 0x31, 0x32, 0x33, 0x34])
                .unwrap();
            assert_eq!([read(&mut sim, 3948), read(&mut sim, 3949)], [0, 0]);
        }),
    ),
    (
        "E49",
        By(|| assert_eq!(row(HR, 3622).set.unwrap().members.len(), 31)),
    ),
    (
        "E50",
        By(|| {
            let mut image = Image::new();
            image.set(HR, Address::new(3010), 1 << 3, Micros::default());
            let health = shared::icon3000::health::health(V2, &image);
            // The bit is told as itself; no code is made of it.
            let keys: Vec<_> = health.findings.iter().map(|f| f.meaning.key).collect();
            assert_eq!(keys, ["blocked_op"]);
        }),
    ),
    (
        "E51",
        By(|| {
            let mut sim = sim(V2);
            assert_eq!(sim.answer(&[1, 0, 6, 0, 5]).unwrap(), [1, 1, 0]);
            assert_eq!(sim.answer(&[3, 0, 46, 0, 2]).unwrap(), [3, 4, 0, 0, 0, 0]);
        }),
    ),
    (
        "E52",
        By(|| {
            assert_eq!(row(Table::Coil, 0).level, Some(Level::User));
            let coil = Model::Icon3000
                .map()
                .row_at(Table::Coil, Address::new(0))
                .unwrap();
            assert_eq!(coil.level, None);
        }),
    ),
    (
        "E53",
        By(|| {
            for (function, end) in [(1_u8, 11_u16), (2, 32), (4, 369)] {
                let last = (end - 1).to_be_bytes();
                let mut sim = sim(V2);
                assert_eq!(
                    sim.answer(&[function, last[0], last[1], 0, 1]).unwrap()[0],
                    function
                );
                assert_eq!(
                    sim.answer(&[function, last[0], last[1], 0, 2]).unwrap()[1],
                    2
                );
            }
            assert_eq!(sim(V2).answer(&[5, 0, 11, 0xFF, 0]).unwrap(), [0x85, 2]);
        }),
    ),
    ("E54", By(|| golden("coils 1"))),
    (
        "E55",
        By(|| {
            let mut sim = sim(V2);
            assert_eq!(sim.answer(&[2, 0, 0, 0, 33]).unwrap(), [0x82, 3]);
            golden("inputs 2");
        }),
    ),
    (
        "E56",
        By(|| {
            let mut sim = sim(V2);
            assert_eq!(sim.answer(&[3, 0x0F, 0x94, 0, 1]).unwrap()[0], 3);
            assert_eq!(sim.answer(&[3, 0x0F, 0x94, 0, 2]).unwrap(), [0x83, 2]);
        }),
    ),
    (
        "E57",
        By(|| {
            let writable = |r: &&&Row| matches!(r.access, Access::Write | Access::WriteGuarded);
            assert!(V2.map().rows_of(HR).iter().filter(writable).count() > 200);
            let mut sim = sim(V2);
            sim.answer(&[6, 0x0E, 0x1C, 0, 33]).unwrap();
            assert_eq!(read(&mut sim, 3612), 0, "33 is no PST mode");
            sim.answer(&[6, 0x0E, 0x1C, 0, 2]).unwrap();
            assert_eq!(read(&mut sim, 3612), 2);
        }),
    ),
    (
        "E58",
        By(|| {
            let mut sim = sim(V2);
            assert_eq!(
                sim.answer(&[6, 0x0B, 0xC9, 0, 0]).unwrap(),
                [0x86, 3],
                "dead band 1 to 255"
            );
            assert_eq!(sim.answer(&[6, 0x0B, 0xC9, 0, 255]).unwrap()[0], 6);
        }),
    ),
    (
        "E59",
        By(|| {
            let mut sim = sim(V2);
            sim.overheard(false);
            // An exception counts under 13, not under 12.
            sim.answer(&[99]).unwrap();
            let count = |sim: &mut Icon3000, sub| sim.answer(&[8, 0, sub, 0, 0]).unwrap()[4];
            assert_eq!((count(&mut sim, 12), count(&mut sim, 13)), (1, 1));
            assert_eq!(counters::NAMES[1].registers, [3533, 3539]);
        }),
    ),
    (
        "E60",
        By(|| {
            let mut sim = sim(V2);
            for sub in [1, 10] {
                assert_eq!(sim.answer(&[8, 0, sub, 0, 0]).unwrap(), [0x88, 1]);
            }
            for counter in &counters::NAMES {
                assert_eq!(
                    row(HR, counter.registers[0]).address.get(),
                    counter.registers[0]
                );
                assert_eq!(counter.registers[1] - counter.registers[0], 6);
            }
        }),
    ),
    (
        "E61",
        By(|| {
            let mut sim = sim(V2);
            let write = |band: u8| [16, 0x0B, 0xC8, 0, 2, 4, 0, 1, 0, band];
            assert_eq!(sim.answer(&write(0)).unwrap(), [0x90, 3]);
            // HR 3016 may only be read: answered well, and discarded.
            assert_eq!(sim.answer(&write(77)).unwrap()[0], 16);
            assert_eq!([read(&mut sim, 3016), read(&mut sim, 3017)], [0, 77]);
        }),
    ),
    ("E62", By(|| golden("Holding Registers 1"))),
    (
        "E63",
        By(|| {
            for count in [0x52, 0x54] {
                let report = identity::Report::of_pdu(&report(count)).unwrap();
                assert_eq!(report.interface, "4.01");
                assert_eq!(report.valve_tag, "XV-101");
            }
            assert_eq!(identity::Report::of_pdu(&report(0x53)), None);
        }),
    ),
    (
        "E64",
        By(|| {
            let mut pdu = report(0x52);
            pdu[4..18].copy_from_slice(b"Something else");
            let report = identity::Report::of_pdu(&pdu).unwrap();
            let guess = identity::detect(&Image::new(), Some(&report), None, None);
            assert_eq!(
                guess.model,
                Some(V2),
                "the text of the type decides nothing"
            );
        }),
    ),
    (
        "E65",
        By(|| {
            let mut sim = sim(V2);
            log_in(&mut sim, 0, b"ANYTHING");
            let before = read(&mut sim, 3017);
            assert_eq!(
                sim.answer(&[6, 0x0B, 0xC9, 0, 99]).unwrap(),
                [6, 0x0B, 0xC9, 0, 99]
            );
            assert_eq!(read(&mut sim, 3017), before);
        }),
    ),
    (
        "E66",
        By(|| {
            let ask = FileRead::new(vec![Span::new(2, 0, 1)]).unwrap().pdu();
            assert_eq!(sim(Model::Icon3000).answer(&ask).unwrap(), [0x94, 1]);
            let mut sim = sim(V2);
            assert_eq!(sim.answer(&ask).unwrap(), [20, 4, 3, 6, 0, 2]);
            for (span, what) in [(Span::new(6, 0, 1), "file"), (Span::new(2, 7, 1), "record")] {
                let ask = FileRead::new(vec![span]).unwrap().pdu();
                assert_eq!(sim.answer(&ask).unwrap(), [0x94, 2], "{what}");
            }
            assert_eq!(sim.answer(&[20, 6, 6, 0, 2, 0, 0, 0]).unwrap(), [0x94, 3]);
            sim.set_busy(true);
            assert_eq!(sim.answer(&ask).unwrap(), [0x94, 6]);
            sim.broadcast(&ask);
        }),
    ),
    (
        "E67",
        By(|| {
            assert_eq!(File::of(1000).unwrap().key, "open_curves");
            assert_eq!(File::of(0x1000), None);
            assert_eq!(row(HR, 3511).range, Some((0, 100)));
            assert_eq!(row(HR, 3513).range, Some((0, 16)));
        }),
    ),
    (
        "E68",
        By(|| {
            let key = |number: u16| File::of(number).and_then(|f| f.layout).map(|l| l.key);
            assert_eq!(key(3), Some("warning_log"));
            assert_eq!(key(1001), Some("fst_curve"));
            assert_eq!(key(5000), Some("event_log"));
        }),
    ),
    (
        "E69",
        By(|| {
            assert_eq!(File::of(5).unwrap().layout, None);
            assert_eq!(Log::read(5, &Records::of(0, [1, 2])), None);
            golden("E69");
        }),
    ),
    (
        "E70",
        By(|| {
            let log = Log::read(2, &Records::of(0, [1, 0, 0, 6])).unwrap();
            let code = log.entries[0].get("code").unwrap();
            assert_eq!(code.text(), "Hi-Hi Torque in open direction (6)");
            golden("E70");
        }),
    ),
    (
        "E71",
        By(|| {
            let layout = File::of(4).unwrap().layout.unwrap();
            assert_eq!((layout.head_records, layout.entry_records), (1, 32));
            golden("E71");
        }),
    ),
    ("E72", By(|| golden("E72"))),
    (
        "E73",
        By(|| {
            let log = Log::read(2, &Records::of(0, [1, 0, 0, 0])).unwrap();
            let time = log.entries[0].get("time").unwrap();
            // No zone is told, so none is shown.
            assert_eq!(time.text(), "2000-01-01 00:00:00");
            golden("E73");
        }),
    ),
    (
        "E74",
        By(|| {
            let layout = File::of(1000).unwrap().layout.unwrap();
            assert_eq!(layout.head_field("torque").unwrap().unit, "%");
            assert_eq!(layout.head_field("torque").unwrap().trust, Trust::Reading);
            golden("E74");
        }),
    ),
    ("E75", By(|| golden("E75"))),
    (
        "E76",
        By(|| {
            let layout = File::of(2).unwrap().layout.unwrap();
            assert_eq!(layout.records(100), 301, "602 bytes");
            let all = Records::of(0, [u16::MAX]);
            assert_eq!(all.expected(layout), Some(10_000));
        }),
    ),
    (
        "E77",
        By(|| {
            assert_eq!(File::of(5300).unwrap().layout.unwrap().head_records, 32);
            golden("E77");
        }),
    ),
    (
        "E78",
        By(|| {
            let mut words = vec![0; 118];
            words[..16]
                .copy_from_slice(&[4, 8, 12, 16, 20, 24, 28, 32, 36, 40, 44, 48, 52, 56, 60, 64]);
            words[20] = 999;
            (words[108], words[113]) = (0, 15);
            let stroke =
                shared::icon3000::stroke::Stroke::of_file(3001, &Records::of(0, words)).unwrap();
            assert_eq!(
                stroke.out.len(),
                16,
                "what lies beyond the travel is left out"
            );
            assert_eq!(stroke.in_words(), "The result has the unknown code 0.");
            golden("E78");
        }),
    ),
    (
        "E79",
        By(|| {
            says(HR, 3619, &[10], "10 %");
            golden("E79");
        }),
    ),
    (
        "E80",
        By(|| {
            assert!(FileRead::new(vec![Span::new(1000, 0, 121)]).is_some());
            assert!(FileRead::new(vec![Span::new(1000, 0, 122)]).is_none());
        }),
    ),
    (
        "E81",
        By(|| {
            let mut sim = sim(V2);
            // Quantity 0 at a bad address: the quantity wins.
            assert_eq!(sim.answer(&[4, 0x02, 0, 0, 0]).unwrap(), [0x84, 3]);
            sim.set_failing(true);
            assert_eq!(sim.answer(&[4, 0, 0, 0, 1]).unwrap(), [0x84, 4]);
        }),
    ),
    (
        "E82",
        By(|| {
            let mut sim = sim(V2);
            // A broadcast returns nothing to send, and a read changes nothing.
            sim.broadcast(&[6, 0x0B, 0xC9, 0, 44]);
            assert_eq!(read(&mut sim, 3017), 44);
        }),
    ),
    (
        "E83",
        By(|| {
            let mut sim = sim(V2);
            assert_eq!(read(&mut sim, 3480), 1, "user after power-up");
            log_in(&mut sim, 2, b"WRONG000");
            assert_eq!(read(&mut sim, 3480), 1);
            log_in(&mut sim, 2, b"SERVICE0");
            assert_eq!(read(&mut sim, 3480), 2);
        }),
    ),
    (
        "E84",
        By(|| {
            let mut image = Image::new();
            let guess = |image: &Image, a, b| identity::detect(image, None, a, b).model;
            assert_eq!(guess(&image, None, None), None);
            image.set(HR, Address::new(3000), 0x9000, Micros::default());
            assert_eq!(guess(&image, None, None), None, "9000 tells nothing");
            assert_eq!(
                guess(&image, Some(true), Some(false)),
                Some(Model::Icon3000)
            );
            assert_eq!(
                guess(&Image::new(), Some(true), Some(true)),
                Some(Model::Icon2000v4)
            );
            for (software, model) in [([0x342E, 0x3030], V2), ([0x322E, 0x3033], Model::Icon3000)] {
                for (at, word) in (3072..).zip(software) {
                    image.set(HR, Address::new(at), word, Micros::default());
                }
                assert_eq!(guess(&image, None, None), Some(model));
            }
            image.set(HR, Address::new(3480), 1, Micros::default());
            assert_eq!(guess(&image, None, None), Some(V2));
        }),
    ),
    (
        "E85",
        Because(
            "Card revision and terminal names concern the wiring; no register or file has them.",
        ),
    ),
    (
        "E86",
        By(|| {
            assert!(row(HR, 3003).note.contains("E86"));
            assert_eq!(row(HR, 3628).label, "DIN1 Position");
            assert_eq!(row(HR, 3629).label, "DIN2 Position");
            says(HR, 3003, &[1 << 11], "Pos <= xx% (DIN1 Position)");
            says(HR, 3003, &[1 << 10], "Pos >= yy% (DIN2 Position)");
            // The simulated valve is closed: at most 20 % (b11), not at least 80 % (b10); with other
            // thresholds the other way round, whatever DIN1 and DIN2 are set to.
            let mut sim = sim(V2);
            let write = |sim: &mut Icon3000, register: u16, word: u8| {
                let [high, low] = register.to_be_bytes();
                assert_eq!(
                    sim.answer(&[6, high, low, 0, word]).expect("an answer")[0],
                    6
                );
                read(sim, 3003) >> 10 & 0b11
            };
            assert_eq!(write(&mut sim, 3628, 20), 0b10);
            assert_eq!(write(&mut sim, 3629, 0), 0b11);
            assert_eq!(write(&mut sim, 3622, 9), 0b11);
            assert_eq!(write(&mut sim, 3629, 80), 0b10);
        }),
    ),
    (
        "E87",
        By(|| {
            assert_eq!(
                shared::icon3000::config::range(row(HR, 3017)),
                "0.1 to 25.5 %"
            );
            says(HR, 3504, &[15], "1.5 A");
            says(HR, 3529, &[90], "9.0 V");
        }),
    ),
    (
        "E88",
        By(|| {
            says(HR, 3921, &[5], "5 s");
            rests("E88", HR, &[3921]);
        }),
    ),
    (
        "E89",
        By(|| {
            rests("E89", HR, &[3616, 3618, 3619]);
            let mut image = Image::new();
            image.set(HR, Address::new(3616), 150, Micros::default());
            let limits = shared::icon3000::stroke::limits(&image, None);
            assert_eq!(
                (limits[0].percent, limits[0].presumed_tenths),
                (Some(150), None)
            );
        }),
    ),
];

fn row(table: Table, address: u16) -> &'static Row {
    let row = V2.map().row_at(table, Address::new(address));
    row.expect("the map covers the address")
}

fn id(row: &Row) -> Option<&'static str> {
    row.reading.map(|r| r.id)
}

/// The rows at these addresses rest on the reading.
fn rests(reading: &str, table: Table, addresses: &[u16]) {
    for address in addresses {
        let row = row(table, *address);
        assert_eq!(id(row), Some(reading), "{address}");
        assert_eq!(row.trust, Trust::Reading);
    }
}

fn settled(id: &str) -> Settled {
    let readings = V2.map().readings.iter().chain(&READINGS);
    let found = readings.into_iter().find(|r| r.id == id);
    found.expect("the reading exists").settled
}

fn bytes(words: &[u16]) -> Vec<u8> {
    words.iter().flat_map(|w| w.to_be_bytes()).collect()
}

/// The words at an address say this.
fn says(table: Table, address: u16, words: &[u16], text: &str) {
    let row = row(table, address);
    assert_eq!(row.address.get(), address);
    assert_eq!(usize::from(row.words), words.len(), "{address}");
    assert_eq!(say::bytes_of(row, &bytes(words)), text, "{address}");
}

fn quality(table: Table, address: u16, words: &[u16]) -> Quality {
    value(row(table, address), &bytes(words)).quality
}

/// A golden case by hand names this.
fn golden(what: &str) {
    let named = FILES
        .iter()
        .filter(|(name, ..)| name.starts_with("icon3000"))
        .flat_map(|(_, text, _)| cases(text))
        .any(|case| case.name.to_lowercase().contains(&what.to_lowercase()));
    assert!(named, "no golden case names {what}");
}

fn sim(model: Model) -> Icon3000 {
    let mut sim = Icon3000::new(model, "XV-101", Programme::Idle);
    sim.advance(Micros::new(0), 1_795_651_200);
    sim
}

/// A holding register of the simulated device.
fn read(sim: &mut Icon3000, address: u16) -> u16 {
    let [high, low] = address.to_be_bytes();
    let answer = sim.answer(&[3, high, low, 0, 1]).expect("an answer");
    u16::from_be_bytes([answer[2], answer[3]])
}

/// Level and password in one request.
fn log_in(sim: &mut Icon3000, level: u8, password: &[u8; 8]) {
    let mut pdu = vec![16, 0x0D, 0x9A, 0, 5, 10, 0, level];
    pdu.extend(password);
    assert_eq!(sim.answer(&pdu).expect("an answer")[0], 16);
}

/// A response of function 17 with this byte count.
fn report(count: u8) -> Vec<u8> {
    let mut pdu = vec![17, count, 0, 0];
    pdu.extend(b"Biffi ICON3000  ");
    pdu.extend(format!("{:28}{:28}9.02  4.01", "SIM004711", "XV-101").bytes());
    pdu
}

#[test]
fn every_reading_is_held() {
    let mut ids: Vec<&str> = V2
        .map()
        .readings
        .iter()
        .chain(&READINGS)
        .map(|r| r.id)
        .collect();
    ids.sort_unstable();
    let held: Vec<&str> = HELD.iter().map(|(id, _)| *id).collect();
    assert_eq!(held, ids);
    let mut wrong: Vec<&str> = Vec::new();
    for (id, how) in &HELD {
        println!("{id}");
        match how {
            By(test) => {
                if std::panic::catch_unwind(test).is_err() {
                    wrong.push(*id);
                }
            }
            Because(reason) => assert!(reason.len() > 20, "{id}"),
        }
    }
    assert_eq!(wrong, [""; 0], "these readings are not held; see above");
}

/// A snapshot of the readings' device comes back from its file: the pieces work together from
/// outside of their crate.
#[test]
fn files_and_snapshot_from_outside() {
    let mut files = Files::default();
    let read = FileRead::new(vec![Span::new(2, 0, 1)]).expect("legal");
    assert!(files.absorb(&read.pdu(), &[20, 4, 3, 6, 0, 0]).is_some());
    let mut snapshot = Snapshot::new(V2, 1, "XV-101");
    assert!(snapshot.absorb(&read.pdu(), &[20, 4, 3, 6, 0, 0]));
    assert_eq!(snapshot.files, files);
}
