//! Motions: what they conserve, their order, closed forms, the same motion in all coordinates, steps that do not resolve one.

#[path = "../common/mod.rs"]
mod common;
#[allow(dead_code, reason = "a module of another program of tests")]
#[path = "../adversary/robots.rs"]
mod robots;

mod charge;
mod closed_loop;
mod columns;
mod component_files;
mod components;
mod conserve;
mod contact;
mod contact_nodes;
mod contact_shapes;
mod dissipation;
mod elastic_laws;
mod estimates;
mod exchange;
mod four_bars;
mod free_robots;
mod integrators;
mod joint_springs;
mod joint_stops;
mod leakage;
mod loads;
mod loop_rates;
mod loop_trees;
mod maxwell;
mod maxwell_limits;
mod observe;
mod order;
mod pairs;
mod parts;
mod prescribed;
mod reactions;
mod reductions;
mod redundant_loops;
mod reference;
mod resolution;
mod resumed;
mod screws;
mod similar;
mod single_joints;
mod squeezer;
mod sticking;
mod tolerance;
mod touch_events;
mod tree;
mod urdf;
