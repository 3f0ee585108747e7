//! Optimal control: optima, guesses, limits, and the tests that a solution has to stand.

#[path = "../common/mod.rs"]
mod common;

mod accuracy;
mod closed_form;
mod creep;
mod direct_sources;
mod drivers;
mod electrode_circuits;
mod endings;
mod energies;
mod feasible;
mod field_limits;
mod final_time;
mod given_inputs;
mod goals;
mod guesses;
mod held_ends;
mod identified;
mod interface;
mod interface_measured;
mod limits;
mod loads;
mod measured;
mod meshes;
mod moved;
mod optimality;
mod peak_voltage;
mod periodic;
mod prescribed;
mod rate_limits;
mod reaction_limits;
mod reaction_torques;
mod reference;
mod resample;
mod resisted_energies;
mod single_times;
mod sought;
mod sought_hold;
mod squares;
mod tension_limits;
mod timed;
mod tracking;
mod unreached;
mod verdicts;
mod waypoints;
