//! Troubles of a simulated network, and when they come and go.

use shared::capture::Micros;
use shared::sim::ddc100::Trouble;
use std::fmt;
use std::str::FromStr;

/// Something that is wrong with a simulated network, always or for a part of the time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// What.
    pub trouble: Trouble,
    /// When; `None` always.
    pub span: Option<Span>,
}

/// A part of a time that comes again and again, in seconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// It begins then,
    pub from: u32,
    /// ends then,
    pub to: u32,
    /// and so again after this time.
    pub every: u32,
}

impl Span {
    pub(super) fn holds(self, now: Micros) -> bool {
        let second = now.get() / 1_000_000 % u64::from(self.every.max(1));
        (u64::from(self.from)..u64::from(self.to)).contains(&second)
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.trouble)?;
        match self.span {
            Some(Span { from, to, every }) => write!(f, " from {from} to {to} every {every}"),
            None => Ok(()),
        }
    }
}

impl FromStr for Fault {
    type Err = String;

    /// Reads `break-3`, or `break-3 from 60 to 120 every 240` (seconds).
    fn from_str(text: &str) -> Result<Self, String> {
        let words: Vec<&str> = text.split_whitespace().collect();
        let number = |word: &str| word.parse::<u32>().ok();
        let span = match words.as_slice() {
            [_] => None,
            [_, "from", from, "to", to, "every", every] => {
                let span = (number(from), number(to), number(every));
                match span {
                    (Some(from), Some(to), Some(every)) if from < to && to <= every => {
                        Some(Span { from, to, every })
                    }
                    _ => return Err(when(text)),
                }
            }
            _ => return Err(when(text)),
        };
        let trouble = words.first().copied().unwrap_or_default().parse()?;
        Ok(Self { trouble, span })
    }
}

fn when(text: &str) -> String {
    format!(
        "\"{text}\" is not understood; write a trouble alone, as break-3, or with its time in \
         seconds, as break-3 from 60 to 120 every 240"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::sim::ddc100::UnitTrouble;

    #[test]
    fn faults_are_read_as_they_are_written() {
        for text in [
            "break-3",
            "off-7",
            "port-2",
            "short-0 from 60 to 120 every 240",
        ] {
            assert_eq!(text.parse::<Fault>().unwrap().to_string(), text);
        }
        let off: Fault = "off-250".parse().unwrap();
        assert_eq!(off.trouble, Trouble::Unit(250, UnitTrouble::Off));
        for (bad, word) in [
            ("", "not understood"),
            ("break", "break-N"),
            ("melt-3", "off-7"),
            ("break-3 from 60 to 60 every 240", "seconds"),
            ("break-3 from 60 to 250 every 240", "seconds"),
            ("break-3 for 5", "seconds"),
        ] {
            let why = bad.parse::<Fault>().unwrap_err();
            assert!(why.contains(word), "{why}");
        }
    }

    #[test]
    fn a_span_comes_again() {
        let span = Span {
            from: 60,
            to: 120,
            every: 240,
        };
        let holds: Vec<u64> = (0..500)
            .filter(|s| span.holds(Micros::new(s * 1_000_000)))
            .collect();
        let want: Vec<u64> = (60..120).chain(300..360).collect();
        assert_eq!(holds, want);
    }
}
