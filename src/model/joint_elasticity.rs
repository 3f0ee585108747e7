//! Springs and stops of a joint coordinate: their constants.

/// A linear spring of a joint coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointSpring {
    /// Stiffness: N mm/rad for an angle, N/mm for a displacement.
    pub stiffness: f64,
    /// Coordinate without force in rad or mm; zero is the reference configuration.
    pub rest: f64,
}

/// Elastic stops of a joint coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointStops {
    /// Lowest and highest coordinate without force, in rad or mm; infinite where there is no stop.
    pub at: [f64; 2],
    /// Stiffness beyond: N mm/rad for an angle, N/mm for a displacement.
    pub stiffness: f64,
    /// Width around a stop over which the stiffness grows, in rad or mm; zero where it jumps.
    pub smoothing: f64,
}

impl JointStops {
    /// Distance in rad or mm by which a coordinate is beyond a stop; negative between the stops.
    pub fn beyond(&self, coordinate: f64) -> f64 {
        (self.at[0] - coordinate).max(coordinate - self.at[1])
    }
}
