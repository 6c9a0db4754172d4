//! Keys of the whole page: one listener, and who wants to hear of an action.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use leptos::ev;
use leptos::prelude::*;

use crate::browser::is_typing;
use crate::state::shortcuts::{Action, Keys};

type Listener = Rc<dyn Fn(Action)>;

/// Those who want to hear of actions.
#[derive(Clone, Default)]
struct Listeners {
    list: Rc<RefCell<Vec<(u32, Listener)>>>,
    next: Rc<Cell<u32>>,
}

/// The keys of the page.
#[derive(Clone, Copy)]
pub struct KeyBus(StoredValue<Listeners, LocalStorage>);

impl core::fmt::Debug for KeyBus {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("KeyBus")
    }
}

impl KeyBus {
    /// Listens to the keyboard and makes the bus available.
    pub fn provide() -> Self {
        let bus = Self(StoredValue::new_local(Listeners::default()));
        provide_context(bus);
        let keys = Cell::new(Keys::default());
        let handle = window_event_listener(ev::keydown, move |event| {
            if event.ctrl_key() || event.alt_key() || event.meta_key() || event.default_prevented()
            {
                return;
            }
            let mut now = keys.get();
            let action = now.press(&event.key(), is_typing());
            keys.set(now);
            if let Some(action) = action {
                if action != Action::Close {
                    event.prevent_default();
                }
                bus.send(action);
            }
        });
        on_cleanup(move || handle.remove());
        bus
    }

    fn send(self, action: Action) {
        let list = self.0.with_value(|l| l.list.borrow().clone());
        for (_, listener) in list {
            listener(action);
        }
    }
}

/// Calls `listener` for every action while the current component lives.
pub fn on_action(listener: impl Fn(Action) + 'static) {
    let Some(KeyBus(bus)) = use_context::<KeyBus>() else {
        return;
    };
    let id = bus.with_value(|l| {
        let id = l.next.get();
        l.next.set(id.wrapping_add(1));
        l.list.borrow_mut().push((id, Rc::new(listener)));
        id
    });
    on_cleanup(move || {
        // The bus goes away with the page, maybe first.
        let _gone = bus.try_with_value(|l| l.list.borrow_mut().retain(|(i, _)| *i != id));
    });
}
