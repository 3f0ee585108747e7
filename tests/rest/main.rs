//! States of rest: equilibria, their stability, and the paths that lead there.

#[path = "../common/mod.rs"]
mod common;

mod ball_joint;
mod blocked;
mod domain;
mod front_door;
mod hertz;
mod prestretch;
mod prestretched_elements;
mod similar;
mod stable;
mod trunk;
mod unstable_beside;
mod vibrations;
