//! Identification: constants fitted to recordings by least squares, with what the data say of them and what not.
//!
//! A recording is simulated on a grid by the midpoint rule (`setup`, `simulated`). The transcription of the same grid, with all inputs
//! given, has the exact derivatives of its discrete equations `c(y, p) = 0` by motion and constants, so that the motion changes by
//! `S = −(∂c/∂y)⁻¹ ∂c/∂p` (`sensitivity`). Readings are interpolated between instants (`readout`), and predictions of
//! two grids are extrapolated to steps of zero length (`prediction`). `fit` is the method of Levenberg and Marquardt, `information`
//! the covariance and what is not determined, `residuals` the deviations, `likelihood` and
//! `held_out` the checks, `experiments` what to measure next, `starts` the
//! states at starts that were sought.

mod error;
mod experiments;
mod fit;
mod held_out;
mod information;
mod input_constants;
mod likelihood;
mod prediction;
mod readout;
mod refine;
mod residuals;
mod sensitivity;
mod setup;
mod simulated;
mod starts;
mod unknowns;

pub use error::IdentifyError;
pub use experiments::Experiment;
pub use fit::{Ended, Fit, fit};
pub use held_out::HeldOut;
pub use held_out::{Whiteness, ljung_box};
pub use information::{Information, Product, Undetermined};
pub use likelihood::Rises;
pub use prediction::{Grid, Prediction, predict};
pub use refine::{Bias, Identified, NONE, first_model, identify};
pub use residuals::Series;
pub use starts::{FoundStart, found_starts};
pub use unknowns::Unknowns;
