//! Measures of markers: places, regions and velocities.

use crate::energy::{Law, OutsideBox, PositionComponent, Projection, SquaredDistance};
use crate::functional::{Measure, Stencil};
use crate::kinematics::{MaterialVector, Vectors};
use crate::math::Vector;
use crate::model::constants::constant::Constant;
use crate::model::constants::free_parameters::{MovedPoint, Read};
use crate::model::quantities::measures::{Known, Shape, instant};
use crate::model::quantities::quantity::Quantity;
use crate::model::quantities::what::{At, Of, Region, What};

/// Times at which a marker is read: the instants, or a place of the intervals with the parameters that move it.
struct Places {
    marker: usize,
    at: Option<(Stencil, Read)>,
    shape: Shape,
}

impl Places {
    fn of<L: Law<3>>(self, law: L) -> Box<dyn Measure> {
        match self.at {
            None => instant(self.shape, law.formula(&[]), [self.marker]),
            Some((at, moved)) => {
                let element = moved.element(law, [at.of(self.marker)], []);
                self.shape.law::<_, 3, 1, 0>(element)
            }
        }
    }
}

impl Known<'_> {
    /// Place, velocity or clearance of a marker.
    pub(crate) fn of_marker(
        &self,
        quantity: &Quantity,
        shape: Shape,
        vectors: &mut Vectors,
    ) -> Option<Box<dyn Measure>> {
        let origin = Vector::zeros();
        let component = |axis| {
            let normal = Vector::ith(axis, 1.0);
            PositionComponent { origin, normal }
        };
        let times = match (&quantity.what, quantity.of, quantity.at) {
            (What::Speed(_), ..) => Some(Stencil::Rate),
            (_, Of::Step, _) => Some(Stencil::Difference),
            (_, _, At::Instant) => None,
            (_, _, at) => Some(at.stencil()),
        };
        let mut places = |marker: usize| Places {
            marker: self.markers[marker],
            at: times.map(|at| (at, self.moved_marker(marker, vectors))),
            shape,
        };
        Some(match quantity.what {
            What::Place { marker, axis } => places(marker).of(component(axis)),
            // At most one inside a sphere, at least three only outside a box.
            What::Region { marker, region } => match region {
                Region::Sphere { centre, radius } => {
                    let scale = radius.into();
                    places(marker).of(SquaredDistance { centre, scale })
                }
                Region::Box { min, max } => {
                    let (centre, half) = ((min + max) * 0.5, (max - min) * 0.5);
                    places(marker).of(OutsideBox { centre, half })
                }
            },
            What::Speed(marker) => {
                let scale = quantity.unit.into();
                let centre = origin;
                places(marker).of(SquaredDistance { centre, scale })
            }
            What::Clearance { marker, plane } => {
                let body = self.presolved.carrier(plane.body);
                let normal = MaterialVector::direction(body, &plane.normal, self.reference);
                let foot = MaterialVector::point(body, &plane.point, self.reference);
                let place = vectors.list()[self.markers[marker]].clone();
                let read = [normal, MaterialVector::span(&foot, &place)];
                instant(shape, Projection, read.map(|vector| vectors.index(vector)))
            }
            _ => return None,
        })
    }

    /// The parameters that move a marker.
    fn moved_marker(&self, marker: usize, vectors: &mut Vectors) -> Read {
        let mut moved = self.sought.read();
        let of = &self.presolved.system.markers[marker];
        let point = MovedPoint {
            weight: 1.0,
            body: of.point.body,
            place: Some(&|axis| Constant::MarkerPlace(marker, axis)),
        };
        if of.solid.is_none() {
            moved.moves(0, [point], |vector| vectors.index(vector));
        }
        moved
    }
}
