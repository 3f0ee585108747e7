//! Memory available to this process, in bytes.

use std::fs;

/// Bytes that the machine and the group of this process leave; `None` where that is not known.
pub(crate) fn available() -> Option<f64> {
    let machine = fs::read_to_string("/proc/meminfo").ok();
    let machine = machine.as_deref().and_then(of_machine);
    let of_group = |name: &str| -> Option<f64> {
        let text = fs::read_to_string(format!("/sys/fs/cgroup/{name}")).ok()?;
        text.trim().parse().ok()
    };
    let group = of_group("memory.max").zip(of_group("memory.current"));
    // What is cached is given back when it is needed.
    let group = group.map(|(limit, used)| (limit - used).max(0.5 * limit));
    [machine, group].into_iter().flatten().reduce(f64::min)
}

/// Returns the available memory that `/proc/meminfo` states, in bytes.
fn of_machine(text: &str) -> Option<f64> {
    let line = text
        .lines()
        .find(|line| line.starts_with("MemAvailable:"))?;
    let kilobytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024.0 * kilobytes)
}

/// A number of bytes for people.
pub(crate) fn readable(bytes: f64) -> String {
    match bytes < 1e8 {
        true => format!("{:.1} MB", bytes / 1e6),
        false => format!("{:.1} GB", bytes / 1e9),
    }
}
