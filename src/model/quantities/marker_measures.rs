//! Measures of markers: places, regions and velocities.

use crate::energy::{Law, OutsideBox, PositionComponent, Projection, SquaredDistance};
use crate::functional::Stencil;
use crate::kinematics::MaterialVector;
use crate::math::Vector;
use crate::model::constants::constant::Constant;
use crate::model::constants::free_parameters::{MovedPoints, Read};
use crate::model::quantities::measures::{Made, Reading};
use crate::model::quantities::what::{At, Of, Region, What};

impl Reading<'_, '_> {
    /// Place, velocity or clearance of a marker.
    pub(super) fn of_marker(&mut self) -> Made {
        let origin = Vector::zeros();
        match self.quantity.what {
            What::Place { marker, axis } => {
                let normal = Vector::ith(axis, 1.0);
                self.marker(marker, PositionComponent { origin, normal })
            }
            // At most one inside a sphere, at least three only outside a box.
            What::Region { marker, region } => match region {
                Region::Sphere { centre, radius } => {
                    let scale = radius.into();
                    self.marker(marker, SquaredDistance { centre, scale })
                }
                Region::Box { min, max } => {
                    let (centre, half) = ((min + max) * 0.5, (max - min) * 0.5);
                    self.marker(marker, OutsideBox { centre, half })
                }
            },
            What::Speed(marker) => {
                let (centre, scale) = (origin, self.quantity.unit.into());
                self.marker(marker, SquaredDistance { centre, scale })
            }
            What::Clearance { marker, plane } => {
                let (reference, list) = (self.known.reference, self.vectors.list());
                let body = self.known.presolved.carrier(plane.body);
                let normal = MaterialVector::direction(body, &plane.normal, reference);
                let foot = MaterialVector::point(body, &plane.point, reference);
                let place = list[self.known.markers[marker]].clone();
                let read = [normal, MaterialVector::span(&foot, &place)];
                let read = read.map(|vector| self.vectors.index(vector));
                self.instant(Projection, read)
            }
            _ => None,
        }
    }

    /// Measure of a law of the place or velocity of a marker, with the parameters that move it in the intervals.
    fn marker<L: Law<3>>(&mut self, marker: usize, law: L) -> Made {
        let vector = self.known.markers[marker];
        let read = match (&self.quantity.what, self.quantity.of) {
            (What::Speed(_), _) => Stencil::Rate.of(vector),
            (_, Of::Step) => Stencil::Difference.of(vector),
            _ => self.at(vector),
        };
        let moved = match self.quantity.at {
            At::Instant => Read::nothing(),
            _ => self.moved_marker(marker),
        };
        self.law::<_, 3, 1, 0>(moved.element(law, [read], []))
    }

    /// The parameters that move a marker.
    fn moved_marker(&mut self, marker: usize) -> Read {
        let mut moved = self.known.sought.read();
        let of = &self.known.presolved.system.markers[marker];
        let point = MovedPoints {
            parts: [1.0],
            bodies: [of.point.body],
            places: Some(&|_, axis| Constant::MarkerPlace(marker, axis)),
        };
        if of.solid.is_none() {
            moved.moves(0, point, |vector| self.vectors.index(vector));
        }
        moved
    }
}
