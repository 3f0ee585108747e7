//! The program: commands, results, interruption, studies.

#[path = "../common/mod.rs"]
mod common;
#[path = "../../src/app/multistart/rank.rs"]
mod rank;

mod accuracy;
mod commands;
mod creeping_fields;
mod end_of;
mod end_of_refused;
mod engine;
mod fe_control;
mod feedback;
mod feedback_c;
mod fields;
mod first_hour;
mod gltf;
mod identify;
mod identify_inputs;
mod identify_scenes;
mod kept;
mod killed;
mod loops;
mod materials;
mod messages;
mod motions;
mod multigrid;
mod names;
mod observed;
mod observer;
mod output;
mod page;
mod paraview;
mod parts;
mod path_rows;
mod process;
mod receding;
mod refusals;
mod report;
mod resume;
mod runs;
mod sampled;
mod shell;
mod side_by_side;
mod sought;
mod starts;
mod study;
mod study_conclusion;
mod study_control;
mod study_limits;
mod study_refused;
mod sweep;
mod views;
mod warm_starts;
mod whole_files;
mod written_files;
