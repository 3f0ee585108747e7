//! Quantities that path limits and goals bound.

use crate::energy::{Energy, OfSquare, law};
use crate::math::{Jet, Number, Vector};
use nalgebra::SVector;

/// `(x − c)·n`, arguments: x.
#[derive(Clone, Copy, Debug)]
pub struct PositionComponent {
    /// c in mm.
    pub origin: Vector,
    /// n.
    pub normal: Vector,
}

law!(PositionComponent of 3);

impl<T: Number> Energy<3, T> for PositionComponent {
    type Local<const ORDER: usize> = Jet<3, ORDER, T>;

    const DEGREE: usize = 1;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 3>, w: &SVector<T, 3>) -> Jet<3, ORDER, T> {
        let normal = self.normal.map(T::of);
        let mut jet = Jet::constant((p - self.origin.map(T::of)).dot(&normal));
        jet.gradient = normal;
        jet.value_w = normal.dot(w);
        jet
    }
}

/// `|x − c|²/s²`, arguments: x. The squared stretch of a muscle, the distance from a centre.
#[derive(Clone, Copy, Debug)]
pub struct SquaredDistance<T = f64> {
    /// c in mm.
    pub centre: Vector,
    /// s in mm.
    pub scale: T,
}

law!(SquaredDistance { centre, scale } of 3);

impl<T: Number> Energy<3, T> for SquaredDistance<T> {
    type Local<const ORDER: usize> = OfSquare<T>;

    const DEGREE: usize = 2;
    const ISOTROPIC: bool = true;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 3>, w: &SVector<T, 3>) -> OfSquare<T> {
        let scale = (self.scale * self.scale).recip();
        let [none, one] = [T::zero(), T::one()];
        let from_centre = p - self.centre.map(T::of);
        OfSquare::new(
            &from_centre,
            w,
            scale,
            |i| [i, one, none, none],
            |_| [none; 4],
        )
    }
}

/// `Σ ((x − c)_i/a_i)¹⁶`, arguments: x. At least 3 only outside the box with half edges a.
#[derive(Clone, Copy, Debug)]
pub struct OutsideBox {
    /// c in mm.
    pub centre: Vector,
    /// a in mm.
    pub half: Vector,
}

law!(OutsideBox of 3);

impl<T: Number> Energy<3, T> for OutsideBox {
    type Local<const ORDER: usize> = Jet<3, ORDER, T>;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 3>, w: &SVector<T, 3>) -> Jet<3, ORDER, T> {
        let axis = |i: usize| {
            let x = (Jet::argument(i, p, w) + T::of(-self.centre[i])) * T::of(1.0 / self.half[i]);
            x.powi(16)
        };
        axis(0) + axis(1) + axis(2)
    }
}

/// `V²/(E² I)` with I = |r|²/L₀²: the squared ratio of the true field |V|/(t Λ) to a limit, arguments: r and V.
#[derive(Clone, Copy, Debug)]
pub struct SquaredField<T = f64> {
    /// Rest length L₀ in mm.
    pub length: T,
    /// Voltage t E that reaches the limit field E at rest length, in V.
    pub voltage: T,
}

law!(SquaredField { length, voltage } of 4);

impl<T: Number> Energy<4, T> for SquaredField<T> {
    type Local<const ORDER: usize> = OfSquare<T>;

    const OF_SQUARES: bool = true;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 4>, w: &SVector<T, 4>) -> OfSquare<T> {
        let factor = (self.voltage * self.voltage).recip();
        let inverse = |i: T| {
            let r = i.recip();
            let by_i = [r, -r * r, r.scaled(2.0) * r * r, r.scaled(-6.0) * r * r * r];
            by_i.map(|e| factor * e)
        };
        let scale = (self.length * self.length).recip();
        OfSquare::new(p, w, scale, |_| [T::zero(); 4], inverse)
    }
}

/// `s/u`, arguments: s. A parameter in another unit.
#[derive(Clone, Copy, Debug)]
pub struct Multiple {
    /// u.
    pub unit: f64,
}

impl Energy<1> for Multiple {
    type Local<const ORDER: usize> = Jet<1, ORDER>;

    const DEGREE: usize = 1;

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 1>, w: &SVector<f64, 1>) -> Jet<1, ORDER> {
        Jet::argument(0, p, w) * (1.0 / self.unit)
    }
}

/// `(V² − s²)/u²`, arguments: V and s. Not positive where s is no less than |V|.
#[derive(Clone, Copy, Debug)]
pub struct PeakExcess {
    /// u in V.
    pub unit: f64,
}

impl Energy<2> for PeakExcess {
    type Local<const ORDER: usize> = Jet<2, ORDER>;

    const DEGREE: usize = 2;
    const OF_SQUARES: bool = true;

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 2>, w: &SVector<f64, 2>) -> Jet<2, ORDER> {
        let square = |i: usize| (Jet::argument(i, p, w) * (1.0 / self.unit)).squared();
        square(0) - square(1)
    }
}

/// Angle `atan2(b·c, a·c)` of the vector c in the plane of two perpendicular unit vectors a, b; arguments a, b, c.
///
/// The branch is the one nearest to `near`.
#[derive(Clone, Copy, Debug)]
pub struct Angle {
    /// An angle in rad of the branch that is meant.
    pub near: f64,
}

impl Energy<9> for Angle {
    type Local<const ORDER: usize> = Jet<9, ORDER>;

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 9>, w: &SVector<f64, 9>) -> Jet<9, ORDER> {
        let cosine = Jet::dot(0, 6, p, w);
        let sine = Jet::dot(3, 6, p, w);
        // With the reference angle β: angle = β + atan2(s cos β − c sin β, c cos β + s sin β), and atan2(y, x) = atan(y/x) for x > 0.
        let reference = sine.value.atan2(cosine.value);
        let (sin, cos) = reference.sin_cos();
        let y = sine * cos - cosine * sin;
        let x = cosine * cos + sine * sin;
        let ratio = y * x.recip();
        let turns = ((self.near - reference) / std::f64::consts::TAU).round();
        ratio.map([0.0, 1.0, 0.0, -2.0]) + (reference + turns * std::f64::consts::TAU)
    }
}

/// Difference of the angles `atan2(b·c, a·c)` of two instants in (−π, π]; arguments a, b, c of the first and of the second.
#[derive(Clone, Copy, Debug)]
pub struct AngleStep;

impl Energy<18> for AngleStep {
    type Local<const ORDER: usize> = Jet<18, ORDER>;

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 18>, w: &SVector<f64, 18>) -> Jet<18, ORDER> {
        let dot = |i: usize, j: usize| Jet::dot(3 * i, 3 * j, p, w);
        let [c, s] = [dot(0, 2), dot(1, 2)];
        let [c_next, s_next] = [dot(3, 5), dot(4, 5)];
        let sine = s_next * c - c_next * s;
        let cosine = c_next * c + s_next * s;
        // As for the angle itself, with the step as reference.
        let reference = sine.value.atan2(cosine.value);
        let (sin, cos) = reference.sin_cos();
        let y = sine * cos - cosine * sin;
        let x = cosine * cos + sine * sin;
        let ratio = y * x.recip();
        ratio.map([0.0, 1.0, 0.0, -2.0]) + reference
    }
}

/// Difference of `n·r` of two instants, arguments: n and r of the first and of the second.
#[derive(Clone, Copy, Debug)]
pub struct ProjectionStep;

impl Energy<12> for ProjectionStep {
    type Local<const ORDER: usize> = Jet<12, ORDER>;

    const DEGREE: usize = 2;
    const ISOTROPIC: bool = true;

    fn couples(i: usize, j: usize) -> bool {
        i != j && i / 2 == j / 2
    }

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 12>, w: &SVector<f64, 12>) -> Jet<12, ORDER> {
        Jet::dot(6, 9, p, w) - Jet::dot(0, 3, p, w)
    }
}

/// `n·r`, arguments: n and r. The coordinate of a prismatic joint.
#[derive(Clone, Copy, Debug)]
pub struct Projection;

impl Energy<6> for Projection {
    type Local<const ORDER: usize> = Jet<6, ORDER>;

    const DEGREE: usize = 2;
    const ISOTROPIC: bool = true;

    fn couples(i: usize, j: usize) -> bool {
        i != j
    }

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 6>, w: &SVector<f64, 6>) -> Jet<6, ORDER> {
        Jet::dot(0, 3, p, w)
    }
}
