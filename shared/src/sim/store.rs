//! The registers. One value that stands at several addresses is kept once.

use super::clock::Stamp;

/// Number of holding registers of the ICON3000v2.
pub(super) const HOLDING_V2: u16 = 3989;
/// Number of holding registers before it. Reading E56: taken as its end.
pub(super) const HOLDING: u16 = 3474;
/// Number of holding registers of the ICON2000v4.
pub(super) const HOLDING_2000: u16 = 22;
/// Number of input registers.
pub(super) const INPUTS: u16 = 369;

/// Addresses of holding registers (VCIOM-16345-EN, table 5).
pub(super) mod at {
    pub(in crate::sim) const ACTUATOR_ID: u16 = 44;
    pub(in crate::sim) const COMPATIBILITY: u16 = 45;
    pub(in crate::sim) const IDENTIFIER: u16 = 3000;
    pub(in crate::sim) const STATUS_1: u16 = 3001;
    pub(in crate::sim) const STATUS_2: u16 = 3002;
    pub(in crate::sim) const STATUS_3: u16 = 3003;
    pub(in crate::sim) const POSITION: u16 = 3004;
    pub(in crate::sim) const TORQUE: u16 = 3005;
    pub(in crate::sim) const COMMAND_BITS: u16 = 3006;
    pub(in crate::sim) const POSITION_REQUEST: u16 = 3007;
    pub(in crate::sim) const COMMAND: u16 = 3008;
    pub(in crate::sim) const WARNINGS: u16 = 3009;
    pub(in crate::sim) const ALARMS_1: u16 = 3010;
    pub(in crate::sim) const AUX_MA: u16 = 3012;
    pub(in crate::sim) const AUX_BITS: u16 = 3013;
    pub(in crate::sim) const CLEAR_LOG: u16 = 3014;
    pub(in crate::sim) const RESET: u16 = 3015;
    pub(in crate::sim) const ALARMS_3: u16 = 3016;
    pub(in crate::sim) const DEAD_BAND: u16 = 3017;
    pub(in crate::sim) const MOTION_INHIBIT: u16 = 3018;
    pub(in crate::sim) const FAIL_SAFE_ACTION: u16 = 3019;
    pub(in crate::sim) const FAIL_SAFE_DELAY: u16 = 3020;
    pub(in crate::sim) const FAIL_SAFE_POSITION: u16 = 3021;
    pub(in crate::sim) const CHANNEL_MODE: u16 = 3022;
    pub(in crate::sim) const DATE: u16 = 3023;
    pub(in crate::sim) const TIME: u16 = 3025;
    pub(in crate::sim) const INTERLOCK_MODE: u16 = 3027;
    pub(in crate::sim) const EFS_INPUT_MODE: u16 = 3028;
    pub(in crate::sim) const INTERLOCK_COMMANDS: u16 = 3029;
    pub(in crate::sim) const NAME: u16 = 3034;
    pub(in crate::sim) const SERIAL: u16 = 3042;
    pub(in crate::sim) const TAG: u16 = 3056;
    pub(in crate::sim) const BASE_VERSION: u16 = 3070;
    pub(in crate::sim) const MODBUS_VERSION: u16 = 3072;
    pub(in crate::sim) const NOMINAL_TORQUE: u16 = 3074;
    pub(in crate::sim) const TEST_DATE: u16 = 3078;
    pub(in crate::sim) const START_UP: u16 = 3082;
    pub(in crate::sim) const NEXT_MAINTENANCE: u16 = 3084;
    pub(in crate::sim) const LAST_MAINTENANCE: u16 = 3086;
    pub(in crate::sim) const RECENT_LOG: u16 = 3088;
    pub(in crate::sim) const ALARM_LOG: u16 = 3090;
    pub(in crate::sim) const WARNING_LOG: u16 = 3115;
    pub(in crate::sim) const OPENING_TIME: u16 = 3145;
    pub(in crate::sim) const CLOSING_TIME: u16 = 3146;
    pub(in crate::sim) const CYCLES: u16 = 3147;
    pub(in crate::sim) const RUN_TIME: u16 = 3149;
    pub(in crate::sim) const UNPOWERED: u16 = 3151;
    pub(in crate::sim) const UTILIZATION: u16 = 3153;
    pub(in crate::sim) const RECENT_CYCLES: u16 = 3154;
    pub(in crate::sim) const RECENT_RUN_TIME: u16 = 3156;
    pub(in crate::sim) const RECENT_UNPOWERED: u16 = 3158;
    pub(in crate::sim) const RECENT_UTILIZATION: u16 = 3160;
    pub(in crate::sim) const TEMPERATURES: u16 = 3161;
    pub(in crate::sim) const MOTOR_ALARMS: u16 = 3166;
    pub(in crate::sim) const RECENT_TEMPERATURES: u16 = 3168;
    pub(in crate::sim) const LAST_OPEN_PROFILE: u16 = 3180;
    pub(in crate::sim) const LAST_CLOSE_PROFILE: u16 = 3185;
    pub(in crate::sim) const REFERENCE_OPEN_PROFILE: u16 = 3190;
    pub(in crate::sim) const REFERENCE_CLOSE_PROFILE: u16 = 3195;
    pub(in crate::sim) const LAST_CLOSE_CURVE: u16 = 3200;
    pub(in crate::sim) const REFERENCE_CLOSE_CURVE: u16 = 3264;
    pub(in crate::sim) const LAST_OPEN_CURVE: u16 = 3328;
    pub(in crate::sim) const REFERENCE_OPEN_CURVE: u16 = 3392;
    pub(in crate::sim) const TYPE: u16 = 3460;
    pub(in crate::sim) const LEVEL_LOGGED: u16 = 3480;
    pub(in crate::sim) const LEVEL: u16 = 3482;
    pub(in crate::sim) const PASSWORD: u16 = 3483;
    pub(in crate::sim) const PASSWORD_END: u16 = 3486;
    pub(in crate::sim) const OUTPUTS: u16 = 3500;
    pub(in crate::sim) const INPUTS: u16 = 3501;
    pub(in crate::sim) const SPEED: u16 = 3502;
    pub(in crate::sim) const VOLTAGE: u16 = 3503;
    pub(in crate::sim) const CURRENT: u16 = 3504;
    pub(in crate::sim) const TEMPERATURE: u16 = 3505;
    pub(in crate::sim) const MOTOR_TEMPERATURE: u16 = 3506;
    pub(in crate::sim) const BOARD_TEMPERATURE: u16 = 3507;
    pub(in crate::sim) const OUTPUT_MA: u16 = 3508;
    pub(in crate::sim) const OUTPUT_BITS: u16 = 3509;
    pub(in crate::sim) const LOGIC_REQUEST: u16 = 3510;
    pub(in crate::sim) const OPEN_CURVES: u16 = 3511;
    pub(in crate::sim) const PST_PROGRESS: u16 = 3515;
    pub(in crate::sim) const PST_STATUS: u16 = 3516;
    pub(in crate::sim) const ENCODER: u16 = 3519;
    pub(in crate::sim) const ENCODER_STATUS: u16 = 3521;
    pub(in crate::sim) const WHEELS: u16 = 3522;
    pub(in crate::sim) const TORQUE_POTENTIOMETER: u16 = 3528;
    pub(in crate::sim) const BATTERY: u16 = 3529;
    pub(in crate::sim) const MODBUS_STATUS: u16 = 3530;
    pub(in crate::sim) const COUNTERS: u16 = 3531;
    pub(in crate::sim) const COUNTERS_2: u16 = 3537;
    pub(in crate::sim) const WINK: u16 = 3555;
    pub(in crate::sim) const ENCODER_LIMITS: u16 = 3558;
    pub(in crate::sim) const RELAY_FUNCTION: u16 = 3580;
    pub(in crate::sim) const RELAY_CONTACT: u16 = 3588;
    pub(in crate::sim) const RELAY_POSITION: u16 = 3596;
    pub(in crate::sim) const PST_TRAVEL: u16 = 3615;
    pub(in crate::sim) const MAX_T_PST: u16 = 3616;
    pub(in crate::sim) const PST_PAUSE: u16 = 3617;
    pub(in crate::sim) const MAX_T_RET: u16 = 3618;
    pub(in crate::sim) const MAX_OV_TR: u16 = 3619;
    pub(in crate::sim) const NEXT_PST: u16 = 3620;
    pub(in crate::sim) const DIN_FUNCTION: u16 = 3622;
    pub(in crate::sim) const DIN_POSITION: u16 = 3628;
    pub(in crate::sim) const CH1_BAUD: u16 = 3649;
    pub(in crate::sim) const CH1_PARITY: u16 = 3650;
    pub(in crate::sim) const CH2_BAUD: u16 = 3652;
    pub(in crate::sim) const CH2_PARITY: u16 = 3653;
    pub(in crate::sim) const MODBUS_FIRMWARE: u16 = 3654;
    pub(in crate::sim) const MODBUS_HARDWARE: u16 = 3655;
    pub(in crate::sim) const ESD_ACTION: u16 = 3656;
    pub(in crate::sim) const ESD_POSITION: u16 = 3658;
    pub(in crate::sim) const OPEN_TORQUE: u16 = 3670;
    pub(in crate::sim) const CLOSE_TORQUE: u16 = 3671;
    pub(in crate::sim) const FAIL_SAFE_ENABLED: u16 = 3940;
    pub(in crate::sim) const DISPLAY_PASSWORD: u16 = 3948;
    pub(in crate::sim) const DISPLAY_PASSWORD_END: u16 = 3949;
    pub(in crate::sim) const SET_REFERENCES: u16 = 3981;
    pub(in crate::sim) const SET_PROFILE: u16 = 3985;
    pub(in crate::sim) const CLEAR_RECENT: u16 = 3986;
}

/// Ranges of holding registers that show the same values as others: first address, how many, and
/// the first address where the values are kept.
///
/// The registers of the ICON2000v4 and their copies of the ICON3000, and the writable copies of the
/// ICON3000v2 (readings E44, and sections 11 and 12 for two of them).
const SAME: [(u16, u16, u16); 19] = [
    (0, 1, at::COMMAND),
    (1, 1, at::POSITION_REQUEST),
    (2, 1, at::DEAD_BAND),
    (3, 1, at::MOTION_INHIBIT),
    (7, 1, at::FAIL_SAFE_ACTION),
    (8, 1, at::FAIL_SAFE_DELAY),
    (9, 1, at::FAIL_SAFE_POSITION),
    (11, 2, at::NEXT_MAINTENANCE),
    (13, 2, at::LAST_MAINTENANCE),
    (15, 2, at::DATE),
    (17, 2, at::TIME),
    (19, 2, at::START_UP),
    (21, 1, at::CHANNEL_MODE),
    (3610, 1, at::EFS_INPUT_MODE),
    (3646, 1, at::CHANNEL_MODE),
    (3742, 14, at::SERIAL),
    (3756, 14, at::TYPE),
    (3770, 2, at::TEST_DATE),
    (3920, 1, at::INTERLOCK_MODE),
];

/// Where the input registers take their values from (tables 4 and 5, by their names).
const INPUT_SOURCES: [(u16, u16, u16); 15] = [
    (0, 2, at::POSITION),
    (2, 3, at::WARNINGS),
    (5, 2, at::OPENING_TIME),
    (7, 7, at::CYCLES),
    (14, 2, at::TEST_DATE),
    (16, 2, at::RECENT_LOG),
    (18, 7, at::RECENT_CYCLES),
    (25, 20, at::LAST_OPEN_PROFILE),
    (45, 25, at::ALARM_LOG),
    (70, 25, at::WARNING_LOG),
    (95, 4, at::NOMINAL_TORQUE),
    (99, 7, at::TEMPERATURES),
    (106, 7, at::RECENT_TEMPERATURES),
    (113, 128, at::LAST_CLOSE_CURVE),
    (241, 128, at::LAST_OPEN_CURVE),
];

/// The place in a list of ranges.
fn look_up(ranges: &[(u16, u16, u16)], address: u16) -> Option<u16> {
    ranges.iter().find_map(|(first, count, kept)| {
        let offset = address.checked_sub(*first).filter(|o| o < count)?;
        kept.checked_add(offset)
    })
}

/// The holding registers of an actuator.
#[derive(Clone, Debug)]
pub(super) struct Store {
    words: Vec<u16>,
}

impl Store {
    pub(super) fn new() -> Self {
        Self {
            words: vec![0; HOLDING_V2.into()],
        }
    }

    /// The address where a value is kept.
    pub(super) fn home(address: u16) -> u16 {
        look_up(&SAME, address).unwrap_or(address)
    }

    /// A holding register; 0 beyond the end.
    pub(super) fn get(&self, address: u16) -> u16 {
        let home = usize::from(Self::home(address));
        self.words.get(home).copied().unwrap_or(0)
    }

    /// An input register; 0 beyond the end.
    pub(super) fn input(&self, address: u16) -> u16 {
        look_up(&INPUT_SOURCES, address).map_or(0, |kept| self.get(kept))
    }

    pub(super) fn set(&mut self, address: u16, word: u16) {
        let home = usize::from(Self::home(address));
        if let Some(slot) = self.words.get_mut(home) {
            *slot = word;
        }
    }

    /// Words from an address on.
    pub(super) fn fill(&mut self, address: u16, words: impl IntoIterator<Item = u16>) {
        for (address, word) in (address..).zip(words) {
            self.set(address, word);
        }
    }

    /// Negative numbers are two's complement (reading E20).
    pub(super) fn signed(&mut self, address: u16, value: i16) {
        self.set(address, value.cast_unsigned());
    }

    /// Two words, high word first (note 11).
    pub(super) fn long(&mut self, address: u16, value: u32) {
        let [a, b, c, d] = value.to_be_bytes();
        self.fill(
            address,
            [u16::from_be_bytes([a, b]), u16::from_be_bytes([c, d])],
        );
    }

    /// Bytes, two a word, the first in the high byte.
    pub(super) fn bytes(&mut self, address: u16, bytes: &[u8]) {
        let words = bytes.chunks(2).map(|pair| match pair {
            [high, low] => u16::from_be_bytes([*high, *low]),
            [high] => u16::from_be_bytes([*high, 0]),
            _ => 0,
        });
        self.fill(address, words);
    }

    /// Text, filled up with blanks to so many words (reading E19).
    pub(super) fn text(&mut self, address: u16, words: u16, text: &str) {
        let len = usize::from(words).saturating_mul(2);
        let mut bytes: Vec<u8> = text.bytes().take(len).collect();
        bytes.resize(len, b' ');
        self.bytes(address, &bytes);
    }

    /// A date in BCD.
    pub(super) fn date(&mut self, address: u16, stamp: Stamp) {
        self.fill(address, stamp.date());
    }

    /// The bytes of a run of registers.
    pub(super) fn run(&self, address: u16, words: u16) -> Vec<u8> {
        (address..address.saturating_add(words))
            .flat_map(|a| self.get(a).to_be_bytes())
            .collect()
    }
}
