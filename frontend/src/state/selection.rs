//! The link between bytes and fields.

use shared::place::Place;
use shared::tree::{Decoded, FieldId};

/// Who changed the selection; the others scroll, so that nothing moves under the hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The field tree.
    Tree,
    /// The bytes.
    Hex,
    /// The strip of problems.
    Problem,
}

/// What is selected in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Selection {
    /// The field, if one owns the place.
    pub field: Option<FieldId>,
    /// The bytes.
    pub place: Place,
    /// The byte under the cursor.
    pub byte: u16,
    /// Who selected it.
    pub origin: Origin,
}

impl Selection {
    /// A field, chosen in the tree.
    #[must_use]
    pub fn field(decoded: &Decoded, id: FieldId) -> Option<Self> {
        let place = decoded.field(id)?.place;
        Some(Self {
            field: Some(id),
            place,
            byte: place.start,
            origin: Origin::Tree,
        })
    }

    /// A byte, chosen in the hex view: the field that owns it is meant.
    #[must_use]
    pub fn byte(decoded: &Decoded, byte: u16) -> Self {
        let field = decoded.owner(byte);
        let place = field.and_then(|id| decoded.field(id)).map_or_else(
            || Place {
                start: byte,
                len: 1,
            },
            |f| f.place,
        );
        Self {
            field,
            place,
            byte,
            origin: Origin::Hex,
        }
    }

    /// The bytes of a problem.
    #[must_use]
    pub fn problem(decoded: &Decoded, place: Place) -> Self {
        // A problem of the whole frame is about no field in particular.
        let whole = usize::from(place.len) >= decoded.bytes().len() && place.len > 1;
        Self {
            field: decoded.owner(place.start).filter(|_| !whole),
            place,
            byte: place.start,
            origin: Origin::Problem,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::decode::Context;
    use shared::session::Session;

    fn decoded() -> Decoded {
        let bytes = [0x7D, 3, 0, 7, 0, 3, 0xBF, 0xF6];
        let mut session = Session::new(shared::frame::Framing::Rtu);
        session.push(&shared::capture::Capture::of(&bytes));
        session.finish();
        let mut out = Decoded::default();
        assert!(session.decode(0, &Context::default(), &mut out));
        out
    }

    #[test]
    fn a_byte_selects_its_field_and_a_field_its_bytes() {
        let decoded = decoded();
        let byte = Selection::byte(&decoded, 7);
        assert_eq!((byte.place.start, byte.place.len, byte.byte), (6, 2, 7));
        let field = Selection::field(&decoded, byte.field.unwrap()).unwrap();
        assert_eq!(field.place, byte.place);
        assert_eq!(decoded.path(byte.field.unwrap()), "crc");
    }

    #[test]
    fn a_problem_of_the_whole_frame_selects_no_field() {
        let decoded = decoded();
        assert_eq!(Selection::problem(&decoded, Place::new(0, 8)).field, None);
        assert!(
            Selection::problem(&decoded, Place::new(6, 2))
                .field
                .is_some()
        );
    }
}
