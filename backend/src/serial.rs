//! Serial ports.

use crate::config::{Mode, Parity};
use std::io;
use tokio_serial::{DataBits, FlowControl, SerialPortBuilderExt, SerialStream, StopBits};

/// Opens a serial port for us alone.
///
/// # Errors
/// If it is not there, not allowed, or in use.
pub fn open(port: &str, baud: u32, mode: Mode) -> io::Result<SerialStream> {
    let data = match mode.data {
        7 => DataBits::Seven,
        _ => DataBits::Eight,
    };
    let parity = match mode.parity {
        Parity::None => tokio_serial::Parity::None,
        Parity::Even => tokio_serial::Parity::Even,
        Parity::Odd => tokio_serial::Parity::Odd,
    };
    let stop = match mode.stop {
        2 => StopBits::Two,
        _ => StopBits::One,
    };
    low_latency(port);
    let stream = tokio_serial::new(port, baud)
        .data_bits(data)
        .parity(parity)
        .stop_bits(stop)
        .flow_control(FlowControl::None)
        .open_native_async()?;
    Ok(stream)
}

/// Asks a USB adapter to hand bytes on at once, and says so if it will not.
fn low_latency(port: &str) {
    let Ok(real) = std::fs::canonicalize(port) else {
        return;
    };
    let Some(name) = real.file_name().and_then(|n| n.to_str()) else {
        return;
    };
    let file = format!("/sys/class/tty/{name}/device/latency_timer");
    let read = || {
        let text = std::fs::read_to_string(&file).ok()?;
        text.trim().parse::<u32>().ok()
    };
    if read().is_none_or(|ms| ms <= 1) {
        return;
    }
    // Usually only root may; then it stays as it is.
    let _refused = std::fs::write(&file, "1");
    if let Some(ms) = read().filter(|ms| *ms > 1) {
        tracing::warn!(
            "{port} holds bytes back for up to {ms} ms, which slows every answer; as root, \
             write 1 to {file}"
        );
    }
}
