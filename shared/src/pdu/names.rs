//! Names of function codes, sub-functions and exception codes.
//!
//! Source: Modbus Application Protocol V1.1b3, sections 6 and 7.

/// Name of a function code without its exception bit; `None` outside the standard.
#[must_use]
pub const fn function(code: u8) -> Option<&'static str> {
    Some(match code {
        1 => "Read coils",
        2 => "Read discrete inputs",
        3 => "Read holding registers",
        4 => "Read input registers",
        5 => "Write single coil",
        6 => "Write single register",
        7 => "Read exception status",
        8 => "Diagnostics",
        11 => "Get comm event counter",
        12 => "Get comm event log",
        15 => "Write multiple coils",
        16 => "Write multiple registers",
        17 => "Report server ID",
        20 => "Read file record",
        21 => "Write file record",
        22 => "Mask write register",
        23 => "Read/write multiple registers",
        24 => "Read FIFO queue",
        43 => "Encapsulated interface transport",
        _ => return None,
    })
}

/// True for function codes that change something in a device.
#[must_use]
pub const fn writes(code: u8) -> bool {
    matches!(code, 5 | 6 | 15 | 16 | 21 | 22 | 23)
}

/// Name and meaning of an exception code; `None` outside the standard.
#[must_use]
pub const fn exception(code: u8) -> Option<(&'static str, &'static str)> {
    Some(match code {
        1 => (
            "Illegal function",
            "it does not have this function, or not in its present state",
        ),
        2 => (
            "Illegal data address",
            "an address or a range of addresses does not exist",
        ),
        3 => ("Illegal data value", "a quantity or value is not allowed"),
        4 => (
            "Server device failure",
            "it failed while it carried the request out",
        ),
        5 => ("Acknowledge", "it needs longer; poll until it is done"),
        6 => ("Server device busy", "it is busy; ask again later"),
        8 => (
            "Memory parity error",
            "its extended memory did not pass its check",
        ),
        10 => (
            "Gateway path unavailable",
            "the gateway is overloaded or not configured for this unit",
        ),
        11 => (
            "Gateway target failed to respond",
            "the device behind the gateway did not answer",
        ),
        _ => return None,
    })
}

/// Name of a sub-function of FC 08; `None` where the standard reserves it.
#[must_use]
pub const fn diagnostic(sub: u16) -> Option<&'static str> {
    Some(match sub {
        0 => "Return query data",
        1 => "Restart communications option",
        2 => "Return diagnostic register",
        3 => "Change ASCII input delimiter",
        4 => "Force listen only mode",
        10 => "Clear counters and diagnostic register",
        11 => "Return bus message count",
        12 => "Return bus communication error count",
        13 => "Return bus exception error count",
        14 => "Return server message count",
        15 => "Return server no response count",
        16 => "Return server NAK count",
        17 => "Return server busy count",
        18 => "Return bus character overrun count",
        20 => "Clear overrun counter and flag",
        _ => return None,
    })
}

/// Name of an object of the device identification (FC 43/14); `None` for those of a maker.
#[must_use]
pub const fn object(id: u8) -> Option<&'static str> {
    Some(match id {
        0 => "Vendor name",
        1 => "Product code",
        2 => "Major minor revision",
        3 => "Vendor URL",
        4 => "Product name",
        5 => "Model name",
        6 => "User application name",
        _ => return None,
    })
}

/// Name of a read device ID code (FC 43/14).
#[must_use]
pub const fn read_id(code: u8) -> Option<&'static str> {
    Some(match code {
        1 => "Basic, stream",
        2 => "Regular, stream",
        3 => "Extended, stream",
        4 => "One object",
        _ => return None,
    })
}
