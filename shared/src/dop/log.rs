//! Reading a log: page after page, from its newest record to the oldest or the other way.
//!
//! The manual names only one request of each log; that the options are newest, oldest, older and
//! newer is reading M5. A machine that trusted them blindly could go round for ever, so it stops
//! when a page brings nothing new, when time goes the wrong way, at error 3 and at a limit.
//!
//! "Older" moves a mark inside the device. A page that was asked for and not received in one piece
//! must not be asked for again, or a page would be lost unnoticed: [`LogRun::disturbed`] goes back
//! to the first page instead and passes over what is known.

#[cfg(test)]
mod tests;

use super::profile::{LogCommand, Profile};
use super::{ObjectRead, Request, Stamp, object};
use crate::proto::LogFrom;
use core::fmt;
use std::collections::BTreeSet;

/// Ids of object 1203 have 16 bits and come round again (reading B14).
const SHORT_IDS: u64 = 0x1_0000;

/// How often a run goes back to its first page.
const MAX_REWINDS: u8 = 3;

/// What tells one record from another, and when it was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Key {
    /// When it was written, in seconds since 1970; 0 if never.
    pub time: i64,
    /// Record id.
    pub id: u64,
}

/// Why a log ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Stop {
    /// A page without records: there are no more.
    Complete,
    /// A page with nothing but records that were there before.
    Repeated(u64),
    /// Records of a page are on the wrong side of those before.
    WrongWay(u64),
    /// The device does not know the command (error 3).
    Option,
    /// As many records as were asked for.
    Limit(u32),
    /// As many pages as make sense.
    Pages(u32),
    /// The device counts more records than the page holds, and none is whole.
    Short,
    /// It was cancelled.
    Cancelled,
    /// A page could not be read.
    Failed(String),
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Complete => f.write_str("the end of the log"),
            Self::Repeated(id) => write!(f, "the device repeats record {id}: this is its end"),
            Self::WrongWay(id) => write!(
                f,
                "time goes the wrong way at record {id}; the log commands of the profile may be \
                 others on this device"
            ),
            Self::Option => f.write_str(
                "the device does not know the command for the next page; the log commands of the \
                 profile may be others on this device",
            ),
            Self::Limit(records) => write!(f, "{records} records, as many as were asked for"),
            Self::Pages(pages) => write!(f, "{pages} pages, as many as the profile allows"),
            Self::Short => f.write_str("a page that is too short for its records"),
            Self::Cancelled => f.write_str("cancelled"),
            Self::Failed(why) => f.write_str(why),
        }
    }
}

/// What a page brought.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Page {
    /// Places in the page of the records that are new, in its order.
    pub new: Vec<usize>,
    /// Records that were there before.
    pub repeated: usize,
    /// Records before the one at which the reading goes on.
    pub skipped: usize,
}

/// The reading of one log.
#[derive(Clone, Debug)]
pub struct LogRun {
    first: Request,
    then: Request,
    from: LogFrom,
    short: bool,
    /// Records are left out until this one was seen.
    after: Option<u64>,
    limit: u32,
    max_pages: u32,
    seen: BTreeSet<Key>,
    last: Option<Key>,
    records: u32,
    pages: u32,
    /// The next page is the first again.
    restart: bool,
    /// Pages of known records that may come before new ones.
    known: u32,
    rewinds: u8,
    stop: Option<Stop>,
}

impl LogRun {
    /// A run over the log `id` (1202 or 1203); `None` if that is no log. A `limit` of 0 means
    /// that of the profile. With `after`, records up to and including that id are left out.
    #[must_use]
    pub fn new(
        id: u16,
        from: LogFrom,
        after: Option<u64>,
        limit: u32,
        profile: &Profile,
    ) -> Option<Self> {
        let log = object(id)?;
        let (first, then) = match from {
            LogFrom::Newest => (LogCommand::Newest, LogCommand::Older),
            LogFrom::Oldest => (LogCommand::Oldest, LogCommand::Newer),
        };
        let most = profile.log_limit();
        Some(Self {
            first: log.log_request(first, profile)?,
            then: log.log_request(then, profile)?,
            from,
            short: id == 1203,
            after,
            limit: if limit == 0 { most } else { limit.min(most) },
            max_pages: most,
            seen: BTreeSet::new(),
            last: None,
            records: 0,
            pages: 0,
            restart: true,
            known: 0,
            rewinds: 0,
            stop: None,
        })
    }

    /// The next page to ask for; `None` at the end.
    #[must_use]
    pub const fn next(&self) -> Option<Request> {
        if self.stop.is_some() {
            return None;
        }
        Some(if self.restart { self.first } else { self.then })
    }

    /// True if the next page is the first one: then it may be asked for as often as needed.
    #[must_use]
    pub const fn is_at_start(&self) -> bool {
        self.restart
    }

    /// A page was asked for, and what came is not of one piece. Goes back to the first page; false
    /// if that was done often enough.
    pub const fn disturbed(&mut self) -> bool {
        if self.rewinds >= MAX_REWINDS {
            return false;
        }
        self.rewinds = self.rewinds.saturating_add(1);
        self.restart = true;
        self.known = self.pages.saturating_add(1);
        self.last = None;
        true
    }

    /// How often it went back.
    #[must_use]
    pub const fn rewinds(&self) -> u8 {
        self.rewinds
    }

    /// Pages that were read.
    #[must_use]
    pub const fn pages(&self) -> u32 {
        self.pages
    }

    /// Records that were new.
    #[must_use]
    pub const fn records(&self) -> u32 {
        self.records
    }

    /// Why it ended; `None` as long as it goes on.
    #[must_use]
    pub const fn stop(&self) -> Option<&Stop> {
        self.stop.as_ref()
    }

    /// Ends it.
    pub fn cancel(&mut self) {
        self.stop.get_or_insert(Stop::Cancelled);
    }

    /// A page could not be read.
    pub fn failed(&mut self, code: Option<u16>, text: &str) {
        let stop = match code {
            // Without a first page there is nothing that "older" could be older than.
            Some(3) if self.pages > 0 => Stop::Option,
            _ => Stop::Failed(text.to_owned()),
        };
        self.stop.get_or_insert(stop);
    }

    /// Takes a page that was read.
    pub fn page(&mut self, read: &ObjectRead) -> Page {
        let keys: Vec<Key> = read
            .records()
            .iter()
            .map(|record| Key {
                time: match record.time {
                    Stamp::Never => 0,
                    Stamp::At(seconds) | Stamp::Odd(seconds) => seconds,
                },
                id: u64::from(record.id),
            })
            .collect();
        // A count that the registers do not bear out is no end of the log.
        let counted = read.words.first().copied().unwrap_or(0);
        if keys.is_empty() && counted > 0 {
            self.pages = self.pages.saturating_add(1);
            self.stop.get_or_insert(Stop::Short);
            return Page::default();
        }
        self.take(&keys)
    }

    /// Takes the records of a page.
    pub fn take(&mut self, keys: &[Key]) -> Page {
        self.pages = self.pages.saturating_add(1);
        self.restart = false;
        let mut page = Page::default();
        if self.stop.is_some() {
            return page;
        }
        if keys.is_empty() {
            self.stop = Some(Stop::Complete);
            return page;
        }
        for (at, key) in keys.iter().enumerate() {
            if !self.seen.insert(*key) {
                page.repeated = page.repeated.saturating_add(1);
                continue;
            }
            if self.after.is_some() {
                page.skipped = page.skipped.saturating_add(1);
                if self.after == Some(key.id) {
                    self.after = None;
                }
                continue;
            }
            if self.records >= self.limit {
                self.stop = Some(Stop::Limit(self.limit));
                break;
            }
            page.new.push(at);
            self.records = self.records.saturating_add(1);
        }
        self.judge(keys, &page);
        page
    }

    /// Decides whether a page is the last.
    fn judge(&mut self, keys: &[Key], page: &Page) {
        let newest = keys.iter().max_by_key(|k| k.time);
        let oldest = keys.iter().min_by_key(|k| k.time);
        if self.stop.is_none() {
            let fresh = page.new.len().saturating_add(page.skipped);
            if fresh > 0 {
                self.known = 0;
            }
            self.stop = match (keys.first(), newest, oldest, self.last) {
                (Some(_), ..) if fresh == 0 && self.known > 0 => {
                    self.known = self.known.saturating_sub(1);
                    None
                }
                (Some(first), ..) if fresh == 0 => Some(Stop::Repeated(first.id)),
                // The whole page lies on the wrong side of the page before.
                (_, Some(new), Some(old), Some(last)) if self.is_wrong_way(*new, *old, last) => {
                    Some(Stop::WrongWay(new.id))
                }
                _ if self.records >= self.limit => Some(Stop::Limit(self.limit)),
                _ if self.pages >= self.max_pages => Some(Stop::Pages(self.pages)),
                _ => None,
            };
        }
        let end = match self.from {
            LogFrom::Newest => oldest,
            LogFrom::Oldest => newest,
        };
        if let Some(end) = end {
            self.last = Some(*end);
        }
    }

    /// True if a page can't follow the record before it. Equal times are no proof; the ids are
    /// asked then, unless they may have come round.
    fn is_wrong_way(&self, newest: Key, oldest: Key, last: Key) -> bool {
        let (near, backwards) = match self.from {
            LogFrom::Newest => (newest, newest.time > last.time),
            LogFrom::Oldest => (oldest, oldest.time < last.time),
        };
        if near.time != last.time {
            return backwards;
        }
        match self.from {
            LogFrom::Newest => self.is_after(near.id, last.id),
            LogFrom::Oldest => self.is_after(last.id, near.id),
        }
    }

    /// True if record id `a` is younger than `b`, the shorter way round.
    fn is_after(&self, a: u64, b: u64) -> bool {
        if self.short {
            let ahead = a.wrapping_sub(b) & SHORT_IDS.wrapping_sub(1);
            (1..SHORT_IDS >> 1).contains(&ahead)
        } else {
            a > b
        }
    }
}
