//! Which layout a response has: by its request, and where the manual contradicts itself, by its
//! number of registers.

use super::object::{Choice, Layout, Object, Request};
use super::profile::Profile;
use super::{OBJECTS, RESPONSE_WORDS};

/// A request whose response has so many registers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// The word that asks for it, with the options of the default profile.
    pub request: Request,
    /// The object.
    pub object: &'static Object,
    /// The option.
    pub choice: &'static Choice,
    /// The layout with that number of registers.
    pub layout: &'static Layout,
}

/// Every request whose response can have this number of registers.
pub(super) fn candidates(words: usize) -> impl Iterator<Item = Candidate> {
    OBJECTS
        .iter()
        .flat_map(|object| object.options.iter().map(move |choice| (object, choice)))
        .filter_map(move |(object, choice)| {
            // Only the recommended layout, or one that no other request of the object has.
            let layout = choice
                .layouts()
                .find(|layout| layout.fits(words))
                .filter(|layout| {
                    core::ptr::eq(*layout, choice.layout) || !is_recommended(object, layout)
                })?;
            Some(Candidate {
                request: object.request(choice, &Profile::default()),
                object,
                choice,
                layout,
            })
        })
}

fn is_recommended(object: &Object, layout: &Layout) -> bool {
    object
        .options
        .iter()
        .any(|choice| core::ptr::eq(choice.layout, layout))
}

/// What a response is taken for, and why.
pub(super) struct Chosen {
    pub object: Option<&'static Object>,
    pub choice: Option<&'static Choice>,
    pub layout: Option<&'static Layout>,
    /// True if the one register is taken for an error code.
    pub error: bool,
    pub why: String,
}

pub(super) fn choose(request: Request, count: usize, profile: &Profile) -> Chosen {
    let object = super::object(request.object());
    let mut chosen = Chosen {
        object,
        choice: None,
        layout: None,
        error: false,
        why: String::new(),
    };
    let registers = counted(count);
    let Some(object) = object else {
        chosen.why = format!("The manual has no object {}.", request.object());
        return chosen;
    };
    let known = request.find(profile).map(|(_, choice)| choice);
    chosen.choice = known;
    let Some(choice) = known else {
        let option = request.option();
        if count == 1 {
            chosen.error = true;
            chosen.why = format!(
                "Object {} has no option {option}; one register is an error code.",
                object.id
            );
            return chosen;
        }
        let fitting = object
            .options
            .iter()
            .map(|choice| choice.layout)
            .find(|layout| layout.fits(count) && layout.record.is_none());
        chosen.layout = fitting;
        chosen.why = match fitting {
            Some(layout) => format!(
                "Object {} has no option {option}; {registers} are those of its layout {}.",
                object.id, layout.key
            ),
            None => format!("Object {} has no option {option}.", object.id),
        };
        return chosen;
    };
    let fitting = choice.layouts().find(|layout| layout.fits(count));
    chosen.layout = fitting.or(Some(choice.layout));
    chosen.why = match fitting {
        Some(layout) if core::ptr::eq(layout, choice.layout) => {
            format!("{registers}, as layout {} wants.", layout.key)
        }
        Some(layout) => format!(
            "{registers} are those of layout {}{}; {} would have {}.",
            layout.key,
            layout
                .reading
                .map_or_else(String::new, |reading| format!(" (reading {})", reading.id)),
            choice.layout.key,
            choice.layout.words
        ),
        None if count == 1 => {
            chosen.layout = None;
            chosen.error = true;
            "One register instead of data is an error code.".to_owned()
        }
        None => format!(
            "{registers} fit no layout of this request; shown as layout {}, which has {}{}.",
            choice.layout.key,
            if choice.layout.record.is_some() {
                "at most "
            } else {
                ""
            },
            choice.layout.words
        ),
    };
    if count > usize::from(RESPONSE_WORDS) {
        chosen.why.push_str(" A response has at most 512.");
    }
    chosen
}

fn counted(count: usize) -> String {
    if count == 1 {
        "1 register".to_owned()
    } else {
        format!("{count} registers")
    }
}
