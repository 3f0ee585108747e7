//! Sensitivities of optima: against closed forms, and against differences of optima that are found anew.

mod backward;
mod loops;
mod parametric;
mod refused;
mod resolved;
mod written;
