//! Identification: constants fitted to recordings by least squares, with what the data say of them and what not.
//!
//! A recording is simulated on a grid by the midpoint rule (`setup`, `prediction`). The transcription of the same grid, with all inputs
//! given, has the exact derivatives of its discrete equations `c(y, p) = 0` by motion and constants, so that the motion changes by
//! `S = −(∂c/∂y)⁻¹ ∂c/∂p`. Readings are interpolated between instants (`readout`), and predictions of
//! two grids are extrapolated to steps of zero length (`prediction`). `fit` is the method of Levenberg and Marquardt, `information`
//! the covariance and what is not determined, `assessment` the checks and what to measure next, `refine` the whole with
//! the states at starts that were sought.

mod assessment;
mod error;
mod fit;
mod information;
mod prediction;
mod readout;
mod refine;
mod setup;

pub use assessment::{Experiment, HeldOut, Rises, Whiteness, ljung_box};
pub use error::IdentifyError;
pub use fit::{Ended, Fit, Series};
pub use information::{Information, Product, Undetermined};
pub use prediction::{Grid, Unknowns};
pub use readout::Prediction;
pub use refine::{Bias, FittedMotion, Identified, NONE, first_model, identify};
pub use setup::Problem;
