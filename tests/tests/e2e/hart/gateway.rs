//! A HART-IP gateway with one device behind it, written byte by byte: it answers with the worked
//! frames R2, R6, R10 and R13, and to every other command that it does not implement it.

use std::io::{self, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::thread;

/// Answers by command: identity of a HART 7 device, dynamic variables, additional status of an IQ, tag.
const ANSWERS: [(u8, &str); 4] = [
    (
        0,
        "06 80 00 18 00 20 FE 6E DD 05 07 02 01 08 00 01 23 45 05 05 00 07 00 00 6E 00 6E 01 9B",
    ),
    (
        3,
        "86 AE DD 01 23 45 03 1A 00 00 41 40 00 00 39 42 48 00 00 39 42 46 00 00 39 41 48 00 00 39 \
         7F A0 00 00 52",
    ),
    (
        48,
        "86 AE DD 01 23 45 30 0B 00 90 02 00 02 00 A4 40 08 00 00 D5",
    ),
    (
        13,
        "86 AE DD 01 23 45 0D 17 00 00 58 13 16 16 DC 31 20 14 94 80 10 D4 54 15 0F 4A 08 20 1B 0A \
          6D 9A",
    ),
];

/// Starts it; it serves for as long as the test runs.
pub fn start() -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = listener.local_addr().expect("an address");
    thread::spawn(move || {
        for client in listener.incoming().flatten() {
            thread::spawn(move || serve(client));
        }
    });
    address
}

/// Version, type, id, status, sequence number, length; then the body. Ends when the client goes.
fn serve(mut client: TcpStream) -> io::Result<()> {
    loop {
        let mut head = [0; 8];
        client.read_exact(&mut head)?;
        let length = usize::from(u16::from_be_bytes([head[6], head[7]]));
        let mut body = vec![0; length.saturating_sub(8)];
        client.read_exact(&mut body)?;
        // A token-passing PDU is answered with one, everything else with what it said.
        if head[2] == 3 {
            body = answer(&body);
        }
        head[1] = 1;
        head[3] = 0;
        let length = u16::try_from(8 + body.len()).expect("a short answer");
        head[6..].copy_from_slice(&length.to_be_bytes());
        client.write_all(&[&head[..], &body].concat())?;
    }
}

fn answer(frame: &[u8]) -> Vec<u8> {
    let long = frame[0] & 0x80 != 0;
    let command = frame[if long { 6 } else { 2 }];
    let known = ANSWERS.iter().find(|(of, text)| {
        // The identity of the list is that to a short address.
        *of == command && text.starts_with(if long { "86" } else { "06" })
    });
    if let Some((_, text)) = known {
        let bytes = text.split_whitespace();
        return bytes
            .map(|b| u8::from_str_radix(b, 16).expect("a byte"))
            .collect();
    }
    // Code 64, not implemented; as frame R28.
    let mut answer = frame[..if long { 7 } else { 3 }].to_vec();
    answer[0] = frame[0] + 4;
    answer.extend([2, 64, 0]);
    let check = answer.iter().fold(0, |all, byte| all ^ byte);
    answer.push(check);
    answer
}
