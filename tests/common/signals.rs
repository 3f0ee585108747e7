//! Signals to programs under test, without another program to send them.
#![allow(dead_code, reason = "each test binary uses a part")]

use nix::sys::signal::{Signal, kill, killpg};
use nix::unistd::Pid;
use std::process::Child;

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

/// Whether a process of the group that a program led still runs.
pub(crate) fn group_runs(leader: &Child) -> bool {
    killpg(pid(leader), None).is_ok()
}

/// Ends all processes of the group that a program led.
pub(crate) fn kill_group(leader: &Child) {
    killpg(pid(leader), Signal::SIGKILL).expect("the group runs");
}
