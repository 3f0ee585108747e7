//! Sensitivities of optima: against closed forms, and against differences of optima that are found anew.

mod parametric;
mod refused;
mod resolved;
mod written;
