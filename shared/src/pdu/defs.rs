//! The fields of Modbus frames: key, label and the section that describes them.

use crate::map::row::Source;
use crate::tree::FieldDef;

const APP: &str = "Modbus Application Protocol V1.1b3";
const SERIAL: &str = "Modbus over Serial Line V1.02";
const TCP: &str = "Modbus Messaging on TCP/IP V1.0b";

/// Declares field definitions: name, key, label, document, section.
macro_rules! defs {
    ($($name:ident = $key:literal, $label:literal, $doc:ident, $part:literal;)*) => {
        $(pub(crate) static $name: FieldDef = FieldDef {
            key: $key,
            label: $label,
            unit: "",
            source: Source { doc: $doc, part: concat!("section ", $part) },
        };)*
    };
}

defs! {
    UNIT = "unit", "Unit address", SERIAL, "2.2";
    FUNCTION = "function", "Function code", APP, "5";
    CRC = "crc", "CRC", SERIAL, "2.5.1.2";
    LRC = "lrc", "LRC", SERIAL, "2.5.2.2";
    COLON = "start", "Start character", SERIAL, "2.5.2.1";
    LINE_END = "end", "Line end", SERIAL, "2.5.2.1";
    TRANSACTION = "transaction", "Transaction identifier", TCP, "3.1.3";
    PROTOCOL = "protocol", "Protocol identifier", TCP, "3.1.3";
    LENGTH = "length", "Length", TCP, "3.1.3";
    NOISE = "noise", "Not part of a frame", SERIAL, "2.5.1.1";
    UNKNOWN = "unknown", "Unknown bytes", APP, "4.1";

    START = "start_address", "First address", APP, "6";
    QUANTITY = "quantity", "Quantity", APP, "6";
    BYTE_COUNT = "byte_count", "Byte count", APP, "6";
    DATA = "data", "Data", APP, "6";
    ADDRESS = "address", "Address", APP, "6";
    EXCEPTION = "exception", "Exception code", APP, "7";

    EXCEPTION_STATUS = "exception_status", "Exception status", APP, "6.7";
    SUB_FUNCTION = "sub_function", "Sub-function", APP, "6.8";
    DIAGNOSTIC = "diagnostic_data", "Data", APP, "6.8";
    COUNTER = "counter", "Counter", APP, "6.8.1";
    STATUS = "status", "Status word", APP, "6.9";
    EVENTS = "event_count", "Event count", APP, "6.9";
    MESSAGES = "message_count", "Message count", APP, "6.10";
    EVENT = "event", "Event", APP, "6.10";
    SERVER_ID = "server_id", "Server ID", APP, "6.13";
    RUN = "run_indicator", "Run indicator status", APP, "6.13";
    ADDITIONAL = "additional", "Additional data", APP, "6.13";

    SUB_REQUEST = "sub_request", "Sub-request", APP, "6.14";
    SUB_RESPONSE = "sub_response", "Sub-response", APP, "6.14";
    REFERENCE = "reference_type", "Reference type", APP, "6.14";
    FILE = "file", "File number", APP, "6.14";
    RECORD = "record", "First record", APP, "6.14";
    RECORDS = "records", "Record length", APP, "6.14";
    FILE_LENGTH = "length", "File response length", APP, "6.14";
    RECORD_DATA = "record_data", "Record", APP, "6.14";

    AND_MASK = "and_mask", "AND mask", APP, "6.16";
    OR_MASK = "or_mask", "OR mask", APP, "6.16";
    READ_START = "read_start", "First address to read", APP, "6.17";
    READ_QUANTITY = "read_quantity", "Quantity to read", APP, "6.17";
    WRITE_START = "write_start", "First address to write", APP, "6.17";
    WRITE_QUANTITY = "write_quantity", "Quantity to write", APP, "6.17";
    FIFO_COUNT = "fifo_count", "FIFO count", APP, "6.18";
    FIFO_VALUE = "fifo_value", "FIFO value", APP, "6.18";

    MEI = "mei_type", "MEI type", APP, "6.19";
    READ_ID = "read_device_id", "Read device ID code", APP, "6.21";
    OBJECT_ID = "object_id", "Object ID", APP, "6.21";
    CONFORMITY = "conformity", "Conformity level", APP, "6.21";
    MORE = "more_follows", "More follows", APP, "6.21";
    NEXT_OBJECT = "next_object", "Next object ID", APP, "6.21";
    OBJECTS = "objects", "Number of objects", APP, "6.21";
    OBJECT = "object", "Object", APP, "6.21";
    OBJECT_LENGTH = "object_length", "Object length", APP, "6.21";
    OBJECT_VALUE = "object_value", "Object value", APP, "6.21";
}

/// Fields of the report of an ICON3000 (FC 17).
pub(crate) const ICON_REPORT: [(&FieldDef, usize); 6] = [
    (&ICON_TYPE, 16),
    (&ICON_SERIAL, 28),
    (&ICON_TAG, 28),
    (&ICON_BASE, 4),
    (&ICON_BLANK, 2),
    (&ICON_INTERFACE, 4),
];

const ICON: &str = "VCIOM-16345-EN";
defs! {
    ICON_TYPE = "actuator_type", "Actuator type", ICON, "8.10, p. 60";
    ICON_SERIAL = "actuator_serial_number", "Actuator serial number", ICON, "8.10, p. 60";
    ICON_TAG = "valve_tag_name", "Valve tag name", ICON, "8.10, p. 60";
    ICON_BASE = "base_card_sw", "Base card SW revision", ICON, "8.10, p. 60";
    ICON_BLANK = "blank", "Blank characters", ICON, "8.10, p. 60";
    ICON_INTERFACE = "interface_sw", "Modbus interface SW revision", ICON, "8.10, p. 60";
    CURVE_SAMPLES = "samples", "Torque samples, 0 to 100 % of position", ICON, "7, torque curve notes";
    CURVE_DATE = "date", "Date of the curve", ICON, "7, torque curve notes";
    CURVE_TIME = "time", "Time of the curve", ICON, "7, torque curve notes";
    CURVE_RESERVED = "reserved", "Reserved", ICON, "7, torque curve notes";
    TORQUE_UNIT = "unit_code", "Unit code", ICON, "7, nominal torque notes";
    TORQUE_VALUE = "amount", "Amount", ICON, "7, nominal torque notes";
}

/// Declares field definitions with a unit.
macro_rules! with_unit {
    ($($name:ident = $key:literal, $label:literal, $unit:literal;)*) => {
        $(pub(crate) static $name: FieldDef = FieldDef {
            key: $key,
            label: $label,
            unit: $unit,
            source: Source { doc: ICON, part: "section 7, torque curve notes" },
        };)*
    };
}

with_unit! {
    CURVE_ELECTRONICS = "electronics_temperature", "Electronics temperature", "°C";
    CURVE_TERMINALS = "terminal_board_temperature", "Terminal board temperature", "°C";
    CURVE_MOTOR = "motor_temperature", "Motor/speed temperature", "°C";
    CURVE_VOLTAGE = "voltage", "Voltage", "V";
    CURVE_STROKE = "stroke_time", "Stroke time", "s";
}
