//! Where the host, the units and the cable lie in the drawing of a network.
//!
//! ```text
//!  ┌────┐ 1 ──o──o──o──o──╮        a loop: the cable goes out along one row
//!  │host│                 │        and comes back along the next; 250 units
//!  └────┘ 2 ──o──o──o──o──╯        are ten rows
//! ```
//!
//! Whole numbers in the units of the drawing.

use shared::proto::DdcShape;

/// Width of the drawing.
pub const WIDTH: i32 = 1200;
/// Where the field of units begins and ends.
const LEFT: i32 = 190;
const RIGHT: i32 = 1150;
/// Right side of the host.
pub const HOST_RIGHT: i32 = 104;
/// The column in which the cable turns at the left.
const TURN: i32 = 144;
/// Radius of a turn.
const ROUND: i32 = 12;
/// The first row, and from row to row.
const TOP: i32 = 34;
const STEP: i32 = 54;
/// Most units in a row.
const MOST: usize = 26;
/// How far below the trunk the units of a multi-drop line hang.
pub const DROP: i32 = 16;

/// Where everything is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Height of the drawing.
    pub height: i32,
    /// Where the cable leaves host port 1, and where it comes back to port 2 in a loop.
    pub ports: [(i32, i32); 2],
    /// The units, in the order of the cable.
    pub units: Vec<(i32, i32)>,
    /// Path of each stretch of the cable: to the first unit, between units, from the last one on;
    /// without the last one where the cable ends at the last unit.
    pub stretches: Vec<String>,
    /// The middle of each stretch, where a break is marked.
    pub middles: Vec<(i32, i32)>,
}

/// A row of the drawing: how many units lie in it.
fn rows(units: usize, shape: DdcShape) -> Vec<usize> {
    let least = units.div_ceil(MOST).max(1);
    // A loop has to come back to the host.
    let rows = if shape == DdcShape::Loop {
        least.next_multiple_of(2)
    } else {
        least
    };
    let (each, more) = (units / rows, units % rows);
    (0..rows)
        .map(|row| each + usize::from(row < more))
        .collect()
}

fn int(number: usize) -> i32 {
    i32::try_from(number).unwrap_or(0)
}

/// Lays a network out.
#[must_use]
pub fn layout(units: usize, shape: DdcShape) -> Layout {
    let rows = rows(units, shape);
    let y_of = |row: usize| TOP + STEP * int(row);
    let mut places = Vec::with_capacity(units);
    for (row, count) in rows.iter().enumerate() {
        for at in 0..*count {
            let along = (RIGHT - LEFT) * (2 * int(at) + 1) / (2 * int(*count));
            let x = if row % 2 == 0 {
                LEFT + along
            } else {
                RIGHT - along
            };
            places.push((x, y_of(row)));
        }
    }
    let last = y_of(rows.len() - 1);
    let mut layout = Layout {
        height: last + 44,
        ports: [(HOST_RIGHT, TOP), (HOST_RIGHT, last)],
        units: Vec::new(),
        stretches: Vec::new(),
        middles: Vec::new(),
    };
    let mut from = layout.ports[0];
    for to in &places {
        layout.lay(from, *to, rows.len());
        from = *to;
    }
    if shape == DdcShape::Loop {
        layout.lay(from, layout.ports[1], rows.len());
    }
    layout.units = places;
    layout
}

impl Layout {
    /// Lays the cable from one point to the next, round the end of the rows between them.
    fn lay(&mut self, from: (i32, i32), to: (i32, i32), rows: usize) {
        let mut path = format!("M{} {}", from.0, from.1);
        let mut at = from;
        let mut middle = ((from.0 + to.0) / 2, from.1);
        while at.1 < to.1 {
            let row = (at.1 - TOP) / STEP;
            let down = at.1 + STEP;
            let outwards = row % 2 == 0;
            // Rows that hold no unit are passed along their whole length.
            let x = if outwards { RIGHT + ROUND } else { TURN };
            let back = if outwards { x - ROUND } else { x + ROUND };
            path.push_str(&format!(
                "H{back}Q{x} {} {x} {}V{}Q{x} {down} {back} {down}",
                at.1,
                at.1 + ROUND,
                down - ROUND
            ));
            middle = (x, at.1 + STEP / 2);
            at = (back, down);
        }
        debug_assert!(rows > 0, "a drawing has at least one row");
        path.push_str(&format!("H{}", to.0));
        self.stretches.push(path);
        self.middles.push(middle);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every size: nothing outside, nothing on top of each other, and the order of the cable kept.
    #[test]
    fn units_have_room() {
        for shape in [DdcShape::Loop, DdcShape::SingleEnded, DdcShape::MultiDrop] {
            for units in 1..=250 {
                let drawn = layout(units, shape);
                assert_eq!(drawn.units.len(), units);
                let stretches = units + usize::from(shape == DdcShape::Loop);
                assert_eq!(drawn.stretches.len(), stretches);
                assert_eq!(drawn.middles.len(), stretches);
                for pair in drawn.units.windows(2) {
                    let [(ax, ay), (bx, by)] = pair else { continue };
                    let outwards = (ay - TOP) / STEP % 2 == 0;
                    if ay == by {
                        assert_eq!(bx > ax, outwards);
                        assert!((bx - ax).abs() >= 34, "{units}");
                    } else {
                        assert_eq!(by - ay, STEP);
                    }
                }
                assert!(
                    drawn
                        .units
                        .iter()
                        .all(|(x, y)| { (LEFT..=RIGHT).contains(x) && *y + 40 <= drawn.height })
                );
            }
        }
    }

    #[test]
    fn a_loop_comes_back_to_the_host() {
        for (units, rows) in [(1, 2), (5, 2), (52, 2), (53, 4), (250, 10)] {
            let drawn = layout(units, DdcShape::Loop);
            assert_eq!(drawn.ports[1].1, TOP + (rows - 1) * STEP, "{units}");
            assert!(drawn.stretches[units].ends_with(&format!("H{HOST_RIGHT}")));
        }
        assert_eq!(layout(5, DdcShape::SingleEnded).height, TOP + 44);
    }

    #[test]
    fn five_units_as_in_the_guide() {
        let drawn = layout(5, DdcShape::Loop);
        let y: Vec<i32> = drawn.units.iter().map(|u| u.1).collect();
        assert_eq!(y, [34, 34, 34, 88, 88]);
        // Between unit 3 and 4 the cable turns at the right.
        assert!(drawn.stretches[3].contains("Q1162"));
        assert_eq!(drawn.middles[3], (1162, 61));
    }
}
