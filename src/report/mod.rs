//! What a run leaves behind: tables, figures and a page.
pub mod atomic;
pub mod axes;
pub mod body;
pub mod canvas;
pub mod joints;
pub mod lines;
pub mod origin;
pub mod pose;
pub mod solids;
pub mod style;
pub mod table;
pub mod tip_path;
pub mod view;
pub mod voltages;
