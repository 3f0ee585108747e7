//! Phases of work before there is anything to count, reported to a listener.

use std::cell::RefCell;

type Listener = Box<dyn Fn(&'static str)>;

thread_local! {
    /// Listener to the phases of this thread.
    static LISTENER: RefCell<Option<Listener>> = const { RefCell::new(None) };
}

/// Makes this thread report its phases to `listener`: building the model, finding the start, ….
pub fn listen_to_phases(listener: impl Fn(&'static str) + 'static) {
    LISTENER.replace(Some(Box::new(listener)));
}

/// Reports the phase that begins now.
pub(crate) fn phase(doing: &'static str) {
    LISTENER.with_borrow(|listener| {
        if let Some(listener) = listener {
            listener(doing);
        }
    });
}
