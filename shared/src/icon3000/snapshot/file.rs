//! The file of a snapshot: one JSON document, one part a line.
//!
//! ```json
//! {
//! "format":"valvescope-snapshot",
//! "version":1,
//! "tool":"valvescope 0.1.0",
//! "device":"icon3000v2",
//! "unit":17,
//! "tag":"XV-101",
//! "taken":"2026-11-26T23:50:00Z",
//! "took_ms":8120,
//! "parts":[
//! {"table":"coil","start":0,"bits":"010000"},
//! {"table":"holding","start":3000,"words":"900000010000…"},
//! {"hole":"holding","start":46,"count":2954,"why":"reserved"},
//! {"identity":"11520000…"},
//! {"counter":11,"value":1207},
//! {"file":2,"start":0,"words":"0001324D…"},
//! {"failed":"file","file":1002,"start":0,"count":108,"why":"illegal data address"}
//! ],
//! "hash":"sha256:…"
//! }
//! ```
//!
//! | part | means |
//! |---|---|
//! | `table`, `start`, `words` | registers from address `start`, four hexadecimal digits each |
//! | `table`, `start`, `bits` | coils or discrete inputs from address `start`, `0` or `1` each |
//! | `hole`, `start`, `count`, `why` | addresses that the map has and the snapshot has not |
//! | `hole` `file`, `file`, `start`, `count`, `why` | records that the file should have and the snapshot has not |
//! | `identity` | the response PDU of function 17 |
//! | `counter`, `value` | a counter of function 08 by its sub-function |
//! | `file`, `start`, `words` | records of a file, four hexadecimal digits each |
//! | `failed` and its place, `why` | `block` (`table`, `start`, `count`), `identity`, `counter` (`sub`) or `file` (`file`, `start`, `count`) that was asked for and not had |
//!
//! `took_ms` is `null` where it is not known. After it `clock_read` may follow: when the clock of
//! the device was read, where that was another time than `taken`. After these `guess` and
//! `guess_why` may follow: which model the device itself says it is (`null` if that did not tell) and
//! why in words; they are missing where it was not asked. `device` is the model it was read as.
//!
//! The hash is the SHA-256 of the bytes before the line that holds it, as this module writes them; a
//! reader writes what it understood once more and compares, so that other white space does no harm.

use core::fmt::Write;

use sha2::{Digest, Sha256};

use super::{Failure, Part, Snapshot};
use crate::address::Table;
use crate::icon3000::plan::Span;
use crate::json::Quoted;
use crate::render::hex;

/// What the key `format` says.
pub const FORMAT: &str = "valvescope-snapshot";
/// The version of the format.
pub const VERSION: u64 = 1;

impl Snapshot {
    /// The text of its file.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut text = self.body();
        let hash = hash(&text);
        // Writing to a String cannot fail.
        let _ = write!(text, "\"hash\":\"{hash}\"\n}}\n");
        text
    }

    /// The hash that its file carries: `sha256:…`.
    #[must_use]
    pub fn hash(&self) -> String {
        hash(&self.body())
    }

    /// The text of its file up to the hash.
    fn body(&self) -> String {
        let mut out = String::from("{\n");
        let _ = write!(
            out,
            "\"format\":\"{FORMAT}\",\n\"version\":{VERSION},\n\"tool\":{},\n\"device\":\"{}\",\n\
             \"unit\":{},\n\"tag\":{},\n\"taken\":{},\n\"took_ms\":",
            Quoted(&self.tool),
            self.model.key(),
            self.unit,
            Quoted(&self.tag),
            Quoted(&self.taken)
        );
        let _ = match self.took_ms {
            Some(ms) => write!(out, "{ms}"),
            None => out.write_str("null"),
        };
        if !self.clock_read.is_empty() {
            let _ = write!(out, ",\n\"clock_read\":{}", Quoted(&self.clock_read));
        }
        if let Some(guess) = &self.guess {
            out.push_str(",\n\"guess\":");
            let _ = match guess.model {
                Some(model) => write!(out, "\"{}\"", model.key()),
                None => out.write_str("null"),
            };
            let _ = write!(out, ",\n\"guess_why\":{}", Quoted(&guess.why));
        }
        out.push_str(",\n\"parts\":[");
        let mut parts = Parts { out, first: true };
        self.tables(&mut parts);
        for hole in self.holes() {
            let _ = write!(
                parts.next(),
                r#"{{"hole":"{}","start":{},"count":{},"why":{}}}"#,
                hole.table.key(),
                hole.start,
                hole.count,
                Quoted(&hole.why)
            );
        }
        for Span { file, start, count } in self.file_holes() {
            let _ = write!(
                parts.next(),
                r#"{{"hole":"file","file":{file},"start":{start},"count":{count},"why":"not read"}}"#
            );
        }
        if let Some(pdu) = &self.identity {
            let _ = write!(parts.next(), r#"{{"identity":"{}"}}"#, hex(pdu));
        }
        for (sub, value) in &self.counters {
            let _ = write!(parts.next(), r#"{{"counter":{sub},"value":{value}}}"#);
        }
        for (number, records) in self.files.iter() {
            for (start, words) in records.stretches() {
                let _ = write!(
                    parts.next(),
                    r#"{{"file":{number},"start":{start},"words":"{}"}}"#,
                    digits(&words)
                );
            }
        }
        for failure in &self.failures {
            failed(parts.next(), failure);
        }
        let mut out = parts.out;
        out.push_str("\n],\n");
        out
    }

    /// Stretches of words and bits.
    fn tables(&self, parts: &mut Parts) {
        let mut run: Option<(Table, u16, Vec<u16>)> = None;
        for (table, address, cell) in self.image.iter() {
            match &mut run {
                Some((of, start, words))
                    if *of == table
                        && usize::from(address.get().saturating_sub(*start)) == words.len() =>
                {
                    words.push(cell.word);
                }
                _ => {
                    stretch(parts, run.take());
                    run = Some((table, address.get(), vec![cell.word]));
                }
            }
        }
        stretch(parts, run);
    }
}

/// The list of parts, with a comma before each but the first.
struct Parts {
    out: String,
    first: bool,
}

impl Parts {
    fn next(&mut self) -> &mut String {
        self.out.push_str(if self.first { "\n" } else { ",\n" });
        self.first = false;
        &mut self.out
    }
}

fn stretch(parts: &mut Parts, run: Option<(Table, u16, Vec<u16>)>) {
    let Some((table, start, words)) = run else {
        return;
    };
    let out = parts.next();
    let _ = write!(out, r#"{{"table":"{}","start":{start},"#, table.key());
    if table.is_bits() {
        out.push_str("\"bits\":\"");
        out.extend(words.iter().map(|w| if *w == 0 { '0' } else { '1' }));
    } else {
        let _ = write!(out, "\"words\":\"{}", digits(&words));
    }
    out.push_str("\"}");
}

fn digits(words: &[u16]) -> String {
    let mut text = String::with_capacity(words.len().saturating_mul(4));
    for word in words {
        // Writing to a String cannot fail.
        let _ = write!(text, "{word:04X}");
    }
    text
}

fn failed(out: &mut String, failure: &Failure) {
    let _ = match failure.part {
        Part::Block(table, start, count) => write!(
            out,
            r#"{{"failed":"block","table":"{}","start":{start},"count":{count},"#,
            table.key()
        ),
        Part::Identity => out.write_str(r#"{"failed":"identity","#),
        Part::Counter(sub) => write!(out, r#"{{"failed":"counter","sub":{sub},"#),
        Part::File(span) => write!(
            out,
            r#"{{"failed":"file","file":{},"start":{},"count":{},"#,
            span.file, span.start, span.count
        ),
    };
    let _ = write!(out, r#""why":{}}}"#, Quoted(&failure.why));
}

fn hash(body: &str) -> String {
    let mut sum = Sha256::new();
    sum.update(body.as_bytes());
    format!("sha256:{}", hex(&sum.finalize()).to_ascii_lowercase())
}
