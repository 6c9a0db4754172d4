//! Sorting short lists in little code.
//!
//! The sorts of the standard library are four kilobytes for each type of element, which a page pays
//! for on every load. This one is a few dozen bytes, and as fast where a list is short or nearly in
//! order already. Lists that can be long and mixed belong to the standard library.

use core::cmp::Ordering;

/// Sorts a short list; equal elements stay in their order.
pub fn sort_by<T>(list: &mut [T], order: impl Fn(&T, &T) -> Ordering) {
    for end in 1..list.len() {
        let mut at = end;
        while let Some(before) = at.checked_sub(1) {
            let pair = list.get(before).zip(list.get(at));
            if !pair.is_some_and(|(a, b)| order(a, b).is_gt()) {
                break;
            }
            list.swap(before, at);
            at = before;
        }
    }
}

/// The same by a key.
pub fn sort_by_key<T, K: Ord>(list: &mut [T], key: impl Fn(&T) -> K) {
    sort_by(list, |a, b| key(a).cmp(&key(b)));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All lists of five digits from 0 to 3, with their places, against the standard library.
    #[test]
    fn lists_are_sorted_and_equals_stay() {
        for number in 0..1024_u32 {
            let digits = (0..5).map(|place| (number >> (2 * place)) & 3);
            let mut list: Vec<(u32, u32)> = digits.zip(0..).collect();
            let mut theirs = list.clone();
            sort_by_key(&mut list, |(digit, _)| *digit);
            theirs.sort_by_key(|(digit, _)| *digit);
            assert_eq!(list, theirs);
        }
        sort_by(&mut [0; 0], Ord::cmp);
    }
}
