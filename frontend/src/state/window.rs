//! Which rows of a long list are in view.
//!
//! Browsers stop at some ten million pixels, so the spacer of a list of a million rows is shorter
//! than its rows would be, and scrolling is stretched.

use core::ops::Range;

use crate::format::within;

/// Highest spacer in pixels that all browsers can do.
const TALLEST: f64 = 8_000_000.0;

/// Rows drawn above and below those in view.
const SPARE: usize = 6;

/// A list of rows of equal height behind a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Number of rows.
    pub count: usize,
    /// Height of a row in pixels.
    pub row: f64,
    /// Height of the window in pixels.
    pub view: f64,
}

/// The rows to draw, and where the first one goes.
#[derive(Clone, Debug, PartialEq)]
pub struct Slice {
    /// Rows to draw.
    pub rows: Range<usize>,
    /// Distance of the first one from the top of the spacer, in pixels.
    pub top: f64,
}

#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "pixels and rows are far below 2^52, and negative ones become 0"
)]
impl Window {
    /// Height that the rows would have.
    fn real(&self) -> f64 {
        self.count as f64 * self.row
    }

    /// Height of the spacer.
    #[must_use]
    pub fn spacer(&self) -> f64 {
        self.real().min(TALLEST)
    }

    /// How many real pixels one pixel of scrolling stands for.
    fn stretch(&self) -> f64 {
        let travel = (self.spacer() - self.view).max(1.0);
        ((self.real() - self.view) / travel).max(1.0)
    }

    /// The rows to draw at a scroll position.
    #[must_use]
    pub fn at(&self, scroll: f64) -> Slice {
        let scroll = within(scroll, 0.0, (self.spacer() - self.view).max(0.0));
        let real = scroll * self.stretch();
        let first = (real / self.row).floor() as usize;
        let from = first.saturating_sub(SPARE).min(self.count);
        let shown = (self.view / self.row).ceil() as usize + 1;
        let to = (first + shown + SPARE).min(self.count);
        Slice {
            rows: from..to,
            top: scroll - (real - from as f64 * self.row),
        }
    }

    /// The rows wholly or partly in view, without the spare ones.
    #[must_use]
    pub fn visible(&self, scroll: f64) -> Range<usize> {
        let scroll = within(scroll, 0.0, (self.spacer() - self.view).max(0.0));
        let real = scroll * self.stretch();
        let first = (real / self.row).floor() as usize;
        let end = ((real + self.view) / self.row).ceil() as usize;
        first.min(self.count)..end.min(self.count)
    }

    /// The scroll position that brings a row into view with the least movement.
    #[must_use]
    pub fn reveal(&self, index: usize, scroll: f64) -> f64 {
        let stretch = self.stretch();
        let real = scroll * stretch;
        let top = index as f64 * self.row;
        let wanted = if top < real {
            top
        } else if top + self.row > real + self.view {
            top + self.row - self.view
        } else {
            return scroll;
        };
        wanted.max(0.0) / stretch
    }

    /// Rows that fit into the window, for paging.
    #[must_use]
    pub fn page(&self) -> usize {
        ((self.view / self.row).floor() as usize)
            .saturating_sub(1)
            .max(1)
    }
}

/// A key that moves the cursor of a list.
#[must_use]
pub fn moved(key: &str, at: Option<usize>, count: usize, page: usize) -> Option<usize> {
    let last = count.checked_sub(1)?;
    let Some(at) = at else {
        return matches!(
            key,
            "ArrowDown" | "ArrowUp" | "j" | "k" | "Home" | "End" | "PageDown" | "PageUp"
        )
        .then_some(if matches!(key, "ArrowUp" | "k" | "End") {
            last
        } else {
            0
        });
    };
    Some(match key {
        "ArrowDown" | "j" => (at + 1).min(last),
        "ArrowUp" | "k" => at.saturating_sub(1),
        "PageDown" => (at + page).min(last),
        "PageUp" => at.saturating_sub(page),
        "Home" => 0,
        "End" => last,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHORT: Window = Window {
        count: 4000,
        row: 28.0,
        view: 560.0,
    };
    const LONG: Window = Window {
        count: 5_000_000,
        row: 28.0,
        view: 560.0,
    };

    #[test]
    fn only_what_is_in_view_is_drawn() {
        let slice = SHORT.at(2800.0);
        assert_eq!(slice.rows, 94..127);
        assert!((slice.top - 94.0 * 28.0).abs() < 1e-6);
        assert_eq!(SHORT.visible(2800.0), 100..120);
        assert_eq!(SHORT.at(-50.0).rows.start, 0);
    }

    #[test]
    fn a_long_list_reaches_both_ends() {
        assert_eq!(LONG.at(0.0).rows.start, 0);
        assert_eq!(LONG.at(LONG.spacer()).rows.end, LONG.count);
        let at_end = LONG.at(LONG.spacer() - LONG.view);
        let rows = (at_end.rows.end - at_end.rows.start) as f64;
        let bottom = at_end.top + rows * LONG.row;
        assert!((bottom - LONG.spacer()).abs() < 1.0, "{bottom}");
    }

    #[test]
    fn a_row_is_revealed_with_the_least_movement() {
        for window in [SHORT, LONG] {
            for index in [0, 1, 19, 20, 3999] {
                let scroll = window.reveal(index, 0.0);
                assert!(window.visible(scroll).contains(&index), "{index}");
            }
        }
        assert!((SHORT.reveal(3, 0.0)).abs() < 1e-9);
        assert!((SHORT.reveal(3, 500.0) - 84.0).abs() < 1e-9);
    }

    #[test]
    fn an_empty_list_draws_nothing() {
        let none = Window { count: 0, ..SHORT };
        assert_eq!(none.at(100.0).rows, 0..0);
        assert_eq!(moved("j", None, 0, 5), None);
    }

    #[test]
    fn keys_move_within_the_list() {
        assert_eq!(moved("j", None, 9, 5), Some(0));
        assert_eq!(moved("ArrowDown", Some(8), 9, 5), Some(8));
        assert_eq!(moved("PageUp", Some(3), 9, 5), Some(0));
        assert_eq!(moved("End", Some(3), 9, 5), Some(8));
        assert_eq!(moved("x", Some(3), 9, 5), None);
    }
}
