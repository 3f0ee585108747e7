//! Signals to programs under test, without another program to send them.
#![allow(dead_code, reason = "each test binary uses a part")]

use nix::sys::signal::{SigHandler, Signal, kill, killpg, signal};
use nix::unistd::Pid;
use std::io;
use std::process::{Child, Command};
use std::sync::Once;

/// Programs that hear of signals.
pub(crate) trait Listening {
    /// Starts a program as a terminal does: with the signals of a stop neither caught nor ignored.
    ///
    /// A shell without job control starts what runs in its background with SIGINT ignored, and so do its tests; a program
    /// that inherits this never hears of Ctrl-C, as it should.
    fn spawn_listening(&mut self) -> io::Result<Child>;
}

impl Listening for Command {
    fn spawn_listening(&mut self) -> io::Result<Child> {
        static TO_DEFAULT: Once = Once::new();
        TO_DEFAULT.call_once(|| {
            for asking in [Signal::SIGINT, Signal::SIGTERM, Signal::SIGHUP] {
                #[expect(unsafe_code, reason = "handlers may be unsafe, the default is not")]
                // SAFETY: the default action runs no code of this process.
                unsafe { signal(asking, SigHandler::SigDfl) }.expect("a signal that may be caught");
            }
        });
        self.spawn()
    }
}

fn pid(child: &Child) -> Pid {
    Pid::from_raw(
        child
            .id()
            .try_into()
            .expect("numbers of processes are small"),
    )
}

/// Ctrl-C to a program.
pub(crate) fn interrupt(child: &Child) {
    kill(pid(child), Signal::SIGINT).expect("the program runs");
}

/// Ctrl-C as a terminal sends it: to the whole group that a program leads.
pub(crate) fn interrupt_group(leader: &Child) {
    killpg(pid(leader), Signal::SIGINT).expect("the group runs");
}

/// Returns true if a process of the group that a program led still runs.
pub(crate) fn group_runs(leader: &Child) -> bool {
    killpg(pid(leader), None).is_ok()
}

/// Ends all processes of the group that a program led.
pub(crate) fn kill_group(leader: &Child) {
    killpg(pid(leader), Signal::SIGKILL).expect("the group runs");
}
