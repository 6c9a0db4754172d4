//! Names of series: beside the end of a line where there is room, else in a row above the plot.

use super::ticks::ordered;
use super::{Chart, Shape};

/// Most series that are named in the picture itself.
const DIRECT: usize = 4;

/// Most series that are named above the plot of a narrow window: more names would fill it.
const ABOVE: usize = 8;

/// Average width of a character of 12 pixels.
pub const CHARACTER: f64 = 6.7;

/// Width below which names stand above the plot.
const WIDE: f64 = 560.0;

/// Where the names of the series stand.
#[derive(Clone, Debug, PartialEq)]
pub enum Names {
    /// One series: the title says what it is. Or too many for the room: the list beside the picture
    /// and the values at the cursor name them.
    None,
    /// At the right end of each line; the width they need.
    Right(f64),
    /// In rows above the plot: for each series its row and how far from the left it begins.
    Above(Vec<(usize, f64)>),
}

impl Names {
    /// Where the names stand in a picture of this width.
    #[must_use]
    pub fn of(chart: &Chart, width: f64) -> Self {
        let lines = chart.series.iter().all(|s| s.shape != Shape::Bar);
        let widths = chart.lines().map(|s| text_width(&s.label));
        match chart.lines().count() {
            0 | 1 => Self::None,
            n if n > ABOVE && width < WIDE => Self::None,
            n if n <= DIRECT && lines && width >= WIDE => {
                Self::Right(widths.fold(0.0, f64::max) + 12.0)
            }
            _ => {
                let (mut row, mut left) = (0, 0.0);
                let place = widths.map(|w| {
                    let needs = w + 44.0;
                    if left > 0.0 && left + needs > width - 8.0 {
                        row += 1;
                        left = 0.0;
                    }
                    let at = (row, left);
                    left += needs;
                    at
                });
                Self::Above(place.collect())
            }
        }
    }

    /// Rows above the plot.
    #[must_use]
    pub fn rows(&self) -> usize {
        match self {
            Self::Above(places) => places.last().map_or(0, |p| p.0 + 1),
            _ => 0,
        }
    }
}

/// Width of a text of 12 pixels, about.
#[must_use]
pub fn text_width(text: &str) -> f64 {
    u32::try_from(text.chars().count()).map_or(0.0, f64::from) * CHARACTER
}

/// Moves labels apart so that none covers another, each as near to its line as can be. Takes and
/// gives the middles of the labels.
#[must_use]
pub fn apart(wanted: &[f64], low: f64, high: f64, height: f64) -> Vec<f64> {
    let order = ordered(wanted.len(), &|a, b| wanted[a] < wanted[b]);
    let mut placed = vec![0.0; wanted.len()];
    let mut least = low;
    for &at in &order {
        placed[at] = wanted[at].max(least);
        least = placed[at] + height;
    }
    // What was pushed out at the bottom goes back up.
    let mut most = high;
    for &at in order.iter().rev() {
        placed[at] = placed[at].min(most);
        most = placed[at] - height;
    }
    placed
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::sample::{bars, torque};

    #[test]
    fn names_stand_where_there_is_room() {
        // "reference" has nine characters.
        assert_eq!(
            Names::of(&torque(), 900.0),
            Names::Right(9.0 * CHARACTER + 12.0)
        );
        let narrow = Names::of(&torque(), 360.0);
        assert_eq!(
            narrow,
            Names::Above(vec![(0, 0.0), (0, 9.0 * CHARACTER + 44.0)])
        );
        assert_eq!(narrow.rows(), 1);
        assert_eq!(Names::of(&torque(), 150.0).rows(), 2);
        assert_eq!(Names::of(&bars(), 900.0), Names::None);
    }

    #[test]
    fn labels_keep_apart() {
        assert_eq!(apart(&[50.0, 10.0], 0.0, 100.0, 14.0), [50.0, 10.0]);
        assert_eq!(
            apart(&[50.0, 50.0, 50.0], 0.0, 100.0, 14.0),
            [50.0, 64.0, 78.0]
        );
        assert_eq!(apart(&[99.0, 98.0], 0.0, 100.0, 14.0), [100.0, 86.0]);
        assert_eq!(apart(&[-20.0], 0.0, 100.0, 14.0), [0.0]);
    }
}
