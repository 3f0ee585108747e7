//! The program: commands, results, interruption, studies.

#[path = "../common/mod.rs"]
mod common;

mod accuracy;
mod commands;
mod fields;
mod paraview;
mod report;
mod starts;
mod study;
mod study_conclusion;
mod told;
mod whole_files;
