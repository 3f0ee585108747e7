//! Quantities that a problem may bound or prescribe, measured at the instants or in the intervals.

use crate::energy::{Angle, Energy, OutsideBox, Place, Projection, SquaredDistance, SquaredField};
use crate::functional::{Element, Group, Measure, Stencil, VectorArg};
use crate::kinematics::{MaterialVector, Pose, Vectors};
use crate::math::Vector;
use crate::model::Condensed;
use crate::model::joints::{JointGauge, Measure as Gauge};

/// A region of space in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Region {
    /// Box between two corners.
    Box {
        /// Lower corner.
        min: Vector,
        /// Upper corner.
        max: Vector,
    },
    /// Ball.
    Sphere {
        /// Centre.
        centre: Vector,
        /// Radius.
        radius: f64,
    },
}

/// Something to measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quantity {
    /// Coordinate of a revolute joint (rad, in the branch nearest to `near`) or prismatic joint (mm), at the instants.
    Joint {
        /// Joint index.
        joint: usize,
        /// Branch of an angle.
        near: f64,
    },
    /// Squared stretch Λ² of a muscle at the instants.
    SquaredStretch {
        /// Muscle index.
        muscle: usize,
    },
    /// (|V|/(t Λ E))² of a muscle in the intervals.
    SquaredField {
        /// Muscle index.
        muscle: usize,
        /// E in V/mm.
        limit: f64,
    },
    /// A component of the place of a marker in mm at the instants.
    MarkerPlace {
        /// Marker index.
        marker: usize,
        /// Component 0, 1 or 2.
        axis: usize,
    },
    /// How far a component of the place of a marker moves in an interval, in mm.
    MarkerStep {
        /// Marker index.
        marker: usize,
        /// Component 0, 1 or 2.
        axis: usize,
    },
    /// (|x − c|/r)² of a marker for a ball, Σ ((x − c)_i/a_i)¹⁶ for a box, at the instants.
    MarkerRegion {
        /// Marker index.
        marker: usize,
        /// The region.
        region: Region,
    },
}

impl Quantity {
    /// Whether it is measured in the intervals rather than at the instants.
    pub fn is_of_intervals(&self) -> bool {
        matches!(self, Self::SquaredField { .. } | Self::MarkerStep { .. })
    }
}

/// Measures by site, in the order of the quantities.
#[derive(Debug, Default)]
pub(super) struct Measures {
    pub(super) instants: Vec<Box<dyn Measure>>,
    pub(super) intervals: Vec<Box<dyn Measure>>,
}

fn here(vector: usize) -> VectorArg {
    VectorArg {
        vector,
        stencil: Stencil::Here,
    }
}

fn instant<E: Energy<M> + 'static, const M: usize, const NV: usize>(
    energy: E,
    vectors: [usize; NV],
) -> Box<dyn Measure> {
    let element = Element {
        energy,
        vectors: vectors.map(here),
        scalars: [],
    };
    Box::new(Group::<E, M, NV, 0>::instants(
        "measure",
        1.0,
        vec![element],
    ))
}

/// What quantities are measured on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known<'a> {
    pub(super) condensed: &'a Condensed,
    pub(super) reference: &'a [Pose],
    /// Source of each voltage.
    pub(super) voltages: &'a [usize],
    /// Vector of each marker.
    pub(super) markers: &'a [usize],
}

/// The measures of a list of quantities.
pub(super) fn measures(
    quantities: &[Quantity],
    &Known {
        condensed,
        reference,
        voltages,
        markers,
    }: &Known<'_>,
    vectors: &mut Vectors,
) -> Measures {
    let system = &condensed.system;
    let mut out = Measures::default();
    let span = |index: usize, vectors: &mut Vectors| {
        let muscle = &system.muscles[index];
        let [from, to] =
            [&muscle.from, &muscle.to].map(|a| MaterialVector::point(a.body, &a.at, reference));
        vectors.index(MaterialVector::span(&from, &to))
    };
    for quantity in quantities {
        let measure = match *quantity {
            Quantity::Joint { joint, near } => {
                let Some(joint) = condensed.joint(joint) else {
                    continue;
                };
                let gauge = JointGauge::new(&system.joints[joint], None, reference);
                match gauge.measure {
                    Gauge::Angle { vectors: v } => {
                        instant(Angle { near }, v.map(|x| vectors.index(x)))
                    }
                    Gauge::Displacement { axis, span } => {
                        instant(Projection, [axis, span].map(|x| vectors.index(x)))
                    }
                    Gauge::None => continue,
                }
            }
            Quantity::SquaredStretch { muscle } => {
                let scale = system.muscles[muscle].length();
                instant(
                    SquaredDistance {
                        centre: Vector::zeros(),
                        scale,
                    },
                    [span(muscle, vectors)],
                )
            }
            Quantity::MarkerPlace { marker: m, axis } => {
                let normal = Vector::ith(axis, 1.0);
                instant(
                    Place {
                        origin: Vector::zeros(),
                        normal,
                    },
                    [markers[m]],
                )
            }
            Quantity::MarkerRegion { marker: m, region } => match region {
                Region::Sphere { centre, radius } => instant(
                    SquaredDistance {
                        centre,
                        scale: radius,
                    },
                    [markers[m]],
                ),
                Region::Box { min, max } => {
                    let energy = OutsideBox {
                        centre: (min + max) * 0.5,
                        half: (max - min) * 0.5,
                    };
                    instant(energy, [markers[m]])
                }
            },
            Quantity::MarkerStep { marker, axis } => {
                let element = Element {
                    energy: Place {
                        origin: Vector::zeros(),
                        normal: Vector::ith(axis, 1.0),
                    },
                    vectors: [VectorArg {
                        vector: markers[marker],
                        stencil: Stencil::Difference,
                    }],
                    scalars: [],
                };
                out.intervals.push(Box::new(Group::<_, 3, 1, 0>::intervals(
                    "measure",
                    1.0,
                    vec![element],
                )));
                continue;
            }
            Quantity::SquaredField { muscle, limit } => {
                let Some(scalar) = voltages.iter().position(|&m| m == muscle) else {
                    continue;
                };
                let of = &system.muscles[muscle];
                let element = Element {
                    energy: SquaredField {
                        length: of.length(),
                        voltage: of.layer_thickness * limit,
                    },
                    vectors: [VectorArg {
                        vector: span(muscle, vectors),
                        stencil: Stencil::Mid,
                    }],
                    scalars: [scalar],
                };
                out.intervals.push(Box::new(Group::<_, 4, 1, 1>::intervals(
                    "measure",
                    1.0,
                    vec![element],
                )));
                continue;
            }
        };
        out.instants.push(measure);
    }
    out
}
