//! The time on a line of progress, updated while there is no other news.

use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread;
use std::time::Duration;

use indicatif::ProgressBar;

/// Time between two pictures of the line.
const PERIOD: Duration = Duration::from_millis(120);

/// A thread that draws a line again and again, until it is dropped.
#[derive(Debug)]
pub(super) struct Ticker {
    /// Nothing is ever sent: the thread notices that it is gone.
    _alive: Sender<()>,
}

impl Ticker {
    /// Draws a line; none where no thread can be had, and then it is drawn at the next message.
    pub(super) fn for_bar(bar: &ProgressBar) -> Option<Self> {
        let (alive, gone) = mpsc::channel();
        let bar = bar.downgrade();
        let draw = move || {
            while gone.recv_timeout(PERIOD) == Err(RecvTimeoutError::Timeout) {
                match bar.upgrade() {
                    Some(bar) if bar.is_finished() => {}
                    Some(bar) => bar.tick(),
                    None => return,
                }
            }
        };
        let thread = thread::Builder::new().spawn(draw);
        thread.is_ok().then_some(Self { _alive: alive })
    }
}
