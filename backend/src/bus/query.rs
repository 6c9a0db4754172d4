//! What a device can be asked without changing anything in it, as PDUs.

use shared::address::{Address, Table};
use shared::encode::Read;
use shared::icon3000::FileRead;
use shared::pdu::length::report;

/// Length of the report of an ICON3000: function code, byte count, 84 bytes.
const REPORT: usize = 86;

/// A request that reads.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Query {
    /// Registers or bits: FC 01 to 04.
    Read(Read),
    /// Records of files: FC 20.
    File(FileRead),
    /// Who it is: FC 17.
    Identity,
    /// A counter or the diagnostic register: FC 08 with a sub-function that reads.
    Diagnostic(u16),
}

impl Query {
    /// Reads a request PDU; `None` if it is none of these, and so none that may be sent.
    #[must_use]
    pub fn of_pdu(pdu: &[u8]) -> Option<Self> {
        match *pdu {
            [17] => Some(Self::Identity),
            [8, high, low, 0, 0] => {
                let sub = u16::from_be_bytes([high, low]);
                is_counter(sub).then_some(Self::Diagnostic(sub))
            }
            [function, s0, s1, c0, c1] => {
                let table = Table::ALL
                    .into_iter()
                    .find(|t| t.read_function() == function)?;
                let start = Address::new(u16::from_be_bytes([s0, s1]));
                let read = Read::new(table, start, u16::from_be_bytes([c0, c1]))?;
                Some(Self::Read(read))
            }
            _ => FileRead::of_pdu(pdu).map(Self::File),
        }
    }

    /// The request PDU.
    #[must_use]
    pub fn pdu(&self) -> Vec<u8> {
        match self {
            Self::Read(read) => read.pdu().to_vec(),
            Self::File(file) => file.pdu(),
            Self::Identity => vec![17],
            Self::Diagnostic(sub) => {
                let [high, low] = sub.to_be_bytes();
                vec![8, high, low, 0, 0]
            }
        }
    }

    /// Length of a good response PDU; that of an identity is the device's affair, this is the one
    /// of an ICON3000.
    #[must_use]
    pub fn response_len(&self) -> usize {
        match self {
            Self::Read(read) => read.response_len(),
            Self::File(file) => file.response_len(),
            Self::Identity => REPORT,
            Self::Diagnostic(_) => 5,
        }
    }

    /// True if a PDU has the shape of a good answer to this.
    #[must_use]
    pub fn is_answered_by(&self, pdu: &[u8]) -> bool {
        let request = self.pdu();
        pdu.first() == request.first() && is_answer(&request, self.response_len(), pdu)
    }
}

impl From<Read> for Query {
    fn from(read: Read) -> Self {
        Self::Read(read)
    }
}

/// True for sub-functions of FC 08 that read: the diagnostic register and the counters.
///
/// Source: Modbus Application Protocol V1.1b3, section 6.8. Others clear counters (10, 20), restart
/// the device (1) or silence it (4).
#[must_use]
pub const fn is_counter(sub_function: u16) -> bool {
    matches!(sub_function, 2 | 11..=18)
}

/// True if a response PDU with the right function code has the shape of an answer to a request.
/// Content that the request determines is compared.
#[must_use]
pub fn is_answer(request: &[u8], response_len: usize, pdu: &[u8]) -> bool {
    let count = pdu.get(1).copied().map(usize::from);
    match request {
        // A report has any length; that of an ICON3000 counts two bytes less than it has.
        [17] => count.is_some_and(|c| c + 2 == pdu.len()) || report(pdu) == Some(pdu.len()),
        _ if pdu.len() != response_len => false,
        [1..=4, ..] => count.is_some_and(|c| c + 2 == pdu.len()),
        // An echo that differs answers another request; of a counter the sub-function is the same.
        [8, high, low, ..] if is_counter(u16::from_be_bytes([*high, *low])) => {
            pdu.get(..3) == request.get(..3)
        }
        [6 | 8, ..] => pdu == request,
        // Address and quantity.
        [16, ..] => request.get(..5) == Some(pdu),
        [20, ..] => groups_fit(request, pdu),
        _ => true,
    }
}

/// True if the groups of a file response are those that were asked for: as many, as long, and of
/// reference type 6. Which file they are of, no response says.
fn groups_fit(request: &[u8], pdu: &[u8]) -> bool {
    let Some((count, mut rest)) = pdu.get(1..).and_then(<[u8]>::split_first) else {
        return false;
    };
    if usize::from(*count) != rest.len() {
        return false;
    }
    for group in request.get(2..).unwrap_or(&[]).chunks_exact(7) {
        let &[_, _, _, _, _, high, low] = group else {
            return false;
        };
        let bytes = usize::from(u16::from_be_bytes([high, low])) * 2;
        match rest {
            [length, 6, data @ ..] if usize::from(*length) == bytes + 1 && data.len() >= bytes => {
                rest = data.get(bytes..).unwrap_or(&[]);
            }
            _ => return false,
        }
    }
    rest.is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::icon3000::Span;

    fn file(spans: &[(u16, u16, u16)]) -> Query {
        let spans = spans.iter().map(|(f, s, c)| Span::new(*f, *s, *c));
        Query::File(FileRead::new(spans.collect()).unwrap())
    }

    /// Modbus Application Protocol V1.1b3, section 6.14: the example of the standard.
    #[test]
    fn a_file_response_has_the_groups_asked_for() {
        let query = file(&[(4, 1, 2), (3, 9, 2)]);
        let request = [0x14, 0x0E, 6, 0, 4, 0, 1, 0, 2, 6, 0, 3, 0, 9, 0, 2];
        assert_eq!(query.pdu(), request);
        let good = [
            0x14, 0x0C, 5, 6, 0x0D, 0xFE, 0, 0x20, 5, 6, 0x33, 0xCD, 0, 0x40,
        ];
        assert_eq!(query.response_len(), good.len());
        assert!(query.is_answered_by(&good));
        for at in [0, 1, 2, 3, 8, 9] {
            let mut bad = good;
            bad[at] ^= 1;
            assert!(!query.is_answered_by(&bad), "byte {at}");
        }
        assert!(!query.is_answered_by(&good[..13]));
    }

    #[test]
    fn a_report_counts_either_way() {
        let report = |count: u8, len: usize| {
            let mut pdu = vec![0; len];
            (pdu[0], pdu[1]) = (17, count);
            pdu
        };
        assert!(Query::Identity.is_answered_by(&report(82, 86)));
        assert!(Query::Identity.is_answered_by(&report(84, 86)));
        assert!(Query::Identity.is_answered_by(&report(82, 84)));
        assert!(Query::Identity.is_answered_by(&report(3, 5)));
        assert!(!Query::Identity.is_answered_by(&report(3, 6)));
        assert!(!Query::Identity.is_answered_by(&[17]));
    }

    #[test]
    fn requests_come_back() {
        let read = Read::new(Table::Input, Address::new(7), 3).unwrap();
        for query in [
            Query::Read(read),
            file(&[(2, 0, 4), (5300, 0, 16)]),
            Query::Identity,
            Query::Diagnostic(14),
        ] {
            assert_eq!(Query::of_pdu(&query.pdu()), Some(query));
        }
        for pdu in [
            &[6, 0, 0, 0, 1][..],
            &[5, 0, 0, 0xFF, 0],
            &[8, 0, 10, 0, 0],
            &[3, 0, 0, 0, 0],
            &[21, 9, 6, 0, 2, 0, 0, 0, 1, 0, 1],
            &[],
        ] {
            assert_eq!(Query::of_pdu(pdu), None, "{pdu:?}");
        }
    }

    #[test]
    fn a_counter_answers_its_own_sub_function() {
        let query = Query::Diagnostic(11);
        assert_eq!(query.pdu(), [8, 0, 11, 0, 0]);
        assert!(query.is_answered_by(&[8, 0, 11, 0x12, 0x34]));
        assert!(!query.is_answered_by(&[8, 0, 12, 0x12, 0x34]));
        for sub in 0..=u16::MAX {
            let reads = [2, 11, 12, 13, 14, 15, 16, 17, 18].contains(&sub);
            assert_eq!(is_counter(sub), reads, "{sub}");
        }
    }
}
