//! Random robots in many forms: what must not depend on the form does not.
//!
//! Seeds are fixed; `PROBOSCIS_SEED` begins elsewhere, and `PROBOSCIS_SECONDS` goes on for that long (`make adversary`).

#[path = "../common/mod.rs"]
mod common;

mod motions;
mod optima;
mod rest;
mod robots;
mod similar;
mod twins;
mod verdicts;

use std::time::{Duration, Instant};

/// Calls a function with `count` seeds from `first` on and with those that found an error before; with fresh ones for as long as the
/// environment asks for.
fn seeds(first: u64, count: u64, found: &[u64], mut each: impl FnMut(u64)) {
    let asked = |name: &str| std::env::var(name).ok()?.parse::<u64>().ok();
    let Some(fresh) = asked("PROBOSCIS_SEED") else {
        let all = (first..first + count).chain(found.iter().copied());
        all.for_each(each);
        return;
    };
    let end = Instant::now() + Duration::from_secs(asked("PROBOSCIS_SECONDS").unwrap_or(60));
    let fresh = (fresh..).take_while(|_| Instant::now() < end);
    fresh.for_each(&mut each);
}
