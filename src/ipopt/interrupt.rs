//! Ctrl-C as a request to stop at the next iteration.

use std::process;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

/// Exit status of a program ended by Ctrl-C: 128 plus the number of SIGINT.
const EXIT_STATUS: i32 = 130;

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Makes Ctrl-C end the solves of this process with [`Status::Interrupted`](crate::ipopt::Status::Interrupted);
/// the second Ctrl-C ends the process with exit status 130.
///
/// Only the first call has an effect.
pub fn install() {
    static INSTALLED: Once = Once::new();
    INSTALLED.call_once(|| {
        let installed = ctrlc::set_handler(|| {
            if REQUESTED.swap(true, Ordering::SeqCst) {
                process::exit(EXIT_STATUS);
            }
        });
        if let Err(error) = installed {
            tracing::warn!("Ctrl-C will not stop a solve in good order: {error}");
        }
    });
}

/// Whether Ctrl-C was pressed since [`install`].
#[must_use]
pub fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}
