//! Identification: constants recovered from recordings, what the data say of them, and what not.

#[path = "../common/mod.rs"]
mod common;

mod assessed;
mod coverage;
mod derivatives;
mod forces;
mod front;
mod inputs;
mod likelihood;
mod loops;
mod oscillator;
mod places;
mod priors;
mod ratio;
mod recovered;
mod refused;
mod rest;
mod similar;
mod solids;
mod statistics;
mod verdicts;
