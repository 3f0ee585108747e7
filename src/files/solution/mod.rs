//! `solution.json`: a motion in files' units with all that a later run needs to start from it exactly.
//!
//! People read `time` (s), `configuration` (m, rad), `voltages` and, where a goal has any, the voltages that `hold` it (V);
//! `state` holds coordinates and multipliers of the
//! instants as the program has them (g, mm, ms, N), in reduced coordinates then a quaternion (w, x, y, z) for each spherical or floating joint,
//! behind which its three turns count, and the `momentum` of each coordinate at the end; `costates` has the multipliers of the optimisation, unscaled. A file made
//! by hand needs `time`, `voltages` and the coordinates of the joints, in `joints` or in `configuration.joints`.
//!
//! Of a long motion all arrays stand in `solution.npz` next to it, under the paths that they would have here: `state/z`,
//! `voltages/muscle1`.
//!
//! - `record`: the types; `write`, `read`: conversion between a solution and the file; `arrays`: the file next to it.

mod arrays;
mod read;
mod record;
mod write;

pub(crate) use arrays::file_beside;
pub(crate) use read::record;
pub use read::{SolutionFile, read};
pub(crate) use record::{Body, ConfigurationRecord};
pub use write::{Written, written};
