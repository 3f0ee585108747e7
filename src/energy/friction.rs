//! Friction of a contact: Coulomb's law, regularised over a speed of slip.
//!
//! Its virtual work is `−μ f φ (u·δu)/√(|u|² + ε²)` of the normal force f φ and the slip u, the relative velocity of both surfaces along
//! them, where δu is the same expression of variations. With the spin `½ Σ d̄ × ḋ` of the directors d of a body, which the midpoint
//! rule makes (sin θ/h) times its axis, velocities are polynomials of vectors. S is the sum of the spins, each times the radius of its body.
//! With a place ρ and a normal ν the relative velocity is v, of which the slip is the part across ν:
//!
//! - along a plane ρ = r, ν = n and v = ṙ + n × S;
//! - along a plane of a body, which turns, the same in its frame T = (t₁, t₂, n): ρ = Tᵀr, ν = e₃ and v = ρ̇ + e₃ × TᵀS, with the directors
//!   of T in S, minus the radius their radius;
//! - between spheres ρ = ν = r and v = ṙ + r × S/(R₁ + R₂). Both forces act at the point that divides the span r as the radii do, so that
//!   friction exerts no couple on a free pair.

use crate::energy::contact::{ramp, vector, virtual_work};
use crate::energy::dot_products::{OfDotProducts, Product};
use crate::energy::{ContactLaw, Energy, Surface, WithDerivatives};
use crate::math::{Derivatives, Jet};
use nalgebra::{Matrix3, SVector, Vector3};

/// Virtual work of the friction of a contact; arguments: variations of the span r, of t₁, t₂, n of a plane of a body, and of three directors of
/// each body that spins, then their midpoints, then their rates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactFriction {
    /// The normal force.
    pub law: ContactLaw,
    /// Radii in mm of the bodies that spin, in their order.
    pub radii: [f64; 2],
    /// Coefficient μ.
    pub coefficient: f64,
    /// Speed ε in mm/ms.
    pub slip_speed: f64,
}

// Vectors of which the work is a function: virtual velocity, place and velocity, by reading, in the same way those of z where it has one, and
// the normal behind all.
const VIRTUAL: usize = 0;
const PLACE: usize = 1;
const VELOCITY: usize = 2;
const BRISTLE: usize = 3;

const IDENTITY: [Matrix3<f64>; 1] = [Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)];

impl ContactFriction {
    /// Place among t₁, t₂, n of a vector of a plane of a body.
    fn axis(&self, v: usize) -> Option<usize> {
        let is_moving = self.law.surface == Surface::MovingPlane;
        v.checked_sub(1).filter(|&axis| is_moving && axis < 3)
    }

    /// Half of the radius of a director; zero of the span.
    fn half_radius(&self, v: usize) -> f64 {
        let first = match self.law.surface {
            Surface::MovingPlane => 4,
            Surface::Plane(_) | Surface::Sphere => 1,
        };
        let radius = match v.checked_sub(first) {
            Some(director) => self.radii[director / 3],
            None if v == 0 => 0.0,
            None => -self.law.distance,
        };
        0.5 * radius
    }

    /// S of rates or variations.
    fn spin(&self, x: &[Vector3<f64>], motion: &[Vector3<f64>]) -> Vector3<f64> {
        let spins = (1..x.len()).map(|v| x[v].cross(&motion[v]) * self.half_radius(v));
        spins.sum()
    }

    /// The frame of a plane of a body, transposed; of other surfaces that of the ground.
    fn frame(&self, x: &[Vector3<f64>]) -> Matrix3<f64> {
        match self.law.surface {
            Surface::MovingPlane => Matrix3::from_columns(&[x[1], x[2], x[3]]).transpose(),
            Surface::Plane(_) | Surface::Sphere => Matrix3::identity(),
        }
    }

    /// Normal ν.
    fn normal(&self, x: &[Vector3<f64>]) -> Vector3<f64> {
        match self.law.surface {
            Surface::Plane(n) => n,
            Surface::MovingPlane => Vector3::z(),
            Surface::Sphere => x[0],
        }
    }

    /// Derivative of the velocity by S.
    fn lever(&self, x: &[Vector3<f64>]) -> Matrix3<f64> {
        let normal = self.normal(x).cross_matrix();
        match self.law.surface {
            Surface::Plane(_) => normal,
            Surface::MovingPlane => normal * self.frame(x),
            Surface::Sphere => normal / self.law.distance,
        }
    }

    /// Derivative by the vector `w` of the transposed lever times derivatives by the velocity.
    fn lean(&self, w: usize, by: &Vector3<f64>) -> Option<Matrix3<f64>> {
        match (self.law.surface, self.axis(w)) {
            (Surface::Sphere, _) if w == 0 => Some(by.cross_matrix() / self.law.distance),
            (_, Some(axis)) => Some(Matrix3::from_diagonal_element(
                by.cross(&Vector3::z())[axis],
            )),
            _ => None,
        }
    }

    /// Velocity of rates or variations.
    fn velocity(&self, x: &[Vector3<f64>], motion: &[Vector3<f64>]) -> Vector3<f64> {
        let turned = match self.law.surface {
            Surface::MovingPlane => self.frame(motion) * x[0],
            Surface::Plane(_) | Surface::Sphere => Vector3::zeros(),
        };
        self.frame(x) * motion[0] + turned + self.lever(x) * self.spin(x, motion)
    }

    /// Derivative of the place by a vector, and of the velocity by its motion at no spin.
    fn by_vector(&self, v: usize, x: &[Vector3<f64>]) -> Matrix3<f64> {
        match self.axis(v) {
            Some(axis) => Vector3::ith(axis, 1.0) * x[0].transpose(),
            None if v == 0 => self.frame(x),
            None => Matrix3::zeros(),
        }
    }

    /// Derivative of the velocity of a motion by a vector.
    fn by_place(
        &self,
        v: usize,
        x: &[Vector3<f64>],
        motion: &[Vector3<f64>],
        lever: &Matrix3<f64>,
    ) -> Matrix3<f64> {
        let turned = lever * motion[v].cross_matrix() * -self.half_radius(v);
        let spin = || self.spin(x, motion);
        let direct = match (self.law.surface, self.axis(v)) {
            (Surface::Sphere, _) if v == 0 => spin().cross_matrix() / -self.law.distance,
            (Surface::MovingPlane, None) if v == 0 => self.frame(motion),
            (_, Some(axis)) => {
                let axis = Vector3::ith(axis, 1.0);
                let across = Vector3::z().cross(&axis);
                axis * motion[0].transpose() + across * spin().transpose()
            }
            _ => return turned,
        };
        turned + direct
    }

    /// Second derivatives by `v` and `w`, the span and an axis of a frame, of the place times derivatives by it.
    fn turned(&self, [v, w]: [usize; 2], by: &Vector3<f64>) -> Matrix3<f64> {
        let axis = match [v, w] {
            [0, _] => self.axis(w),
            [_, 0] => self.axis(v),
            _ => None,
        };
        Matrix3::from_diagonal_element(axis.map_or(0.0, |axis| by[axis]))
    }

    /// Second derivatives by the motion of `v` and the place of `w` of the velocity times derivatives by it.
    fn mixed(&self, [v, w]: [usize; 2], x: &[Vector3<f64>], by: &ByVelocity) -> Matrix3<f64> {
        let half = self.half_radius(v);
        let mut block = self.turned([v, w], &by.velocity);
        if let Some(lean) = self.lean(w, &by.velocity) {
            block -= x[v].cross_matrix() * lean * half;
        }
        if v == w {
            block += by.spin.cross_matrix() * half;
        }
        block
    }

    /// Second derivatives by the places of `v` and `w` of the velocity of a motion times derivatives by it.
    fn placed(&self, pair: [usize; 2], motion: &[Vector3<f64>], by: &ByVelocity) -> Matrix3<f64> {
        let turned = |[v, w]: [usize; 2]| {
            let lean = self.lean(w, &by.velocity)?;
            Some(motion[v].cross_matrix() * lean * self.half_radius(v))
        };
        let [v, w] = pair;
        turned([v, w]).unwrap_or_default() + turned([w, v]).unwrap_or_default().transpose()
    }

    /// Sizes of friction in N and slip in mm/ms at vectors and rates, at a normal force in N and the vector z + τ (1 − α) ż of friction that sticks.
    pub fn of_rates(
        &self,
        x: &[Vector3<f64>],
        rates: &[Vector3<f64>],
        force: f64,
        bristle: Option<Vector3<f64>>,
    ) -> [f64; 2] {
        let normal = self.normal(x);
        let across =
            |v: Vector3<f64>| (v - normal * (normal.dot(&v) / normal.norm_squared())).norm();
        let speed = across(self.velocity(x, rates));
        let part = bristle.map_or(speed / speed.hypot(self.slip_speed), across);
        [self.coefficient * force * part, speed]
    }

    /// The normal among the vectors of the work: that between spheres is the span.
    fn normal_of<const K: usize>(&self) -> usize {
        match self.law.surface {
            Surface::Sphere => PLACE,
            Surface::Plane(_) | Surface::MovingPlane => K - 1,
        }
    }

    /// −μ f φ at the form q of the contact and its rate.
    fn limit<const D: usize>(&self, q: &Jet<D, 2>, rate: &Jet<D, 2>) -> Jet<D, 2> {
        let [_, force, growth] = self.law.force(q, rate);
        match force.value == 0.0 {
            true => Jet::constant(0.0),
            false => (force * growth).scaled(-self.coefficient),
        }
    }

    /// A product with the normal over the square of the normal, which between spheres is 2 q.
    fn part<const D: usize>(&self, q: &Jet<D, 2>, product: Jet<D, 2>) -> Jet<D, 2> {
        match self.law.surface {
            Surface::Sphere => product * q.scaled(2.0).recip(),
            Surface::Plane(_) | Surface::MovingPlane => product,
        }
    }

    /// √(|u|² + ε²) of half of the square of the velocity, its product with the normal and the part of that.
    fn speed<const D: usize>(&self, [half, along, part]: [Jet<D, 2>; 3]) -> Jet<D, 2> {
        let square = half.scaled(2.0) - part * along;
        square.shifted(self.slip_speed * self.slip_speed).sqrt()
    }

    /// The work as a function of its vectors, with −μ f φ as a function of the form and its rate.
    pub(super) fn work(
        &self,
        vectors: [Vector3<f64>; 4],
        limit: impl FnOnce(&Jet<3, 2>, &Jet<3, 2>) -> Jet<3, 2>,
    ) -> OfDotProducts<4> {
        let (mut work, normal) = (OfDotProducts::new(vectors), self.normal_of::<4>());
        let virtuals: [Product<'_>; 2] = [&[[VIRTUAL, VELOCITY]], &[[VIRTUAL, normal]]];
        let products: [Product<'_>; 3] = [
            &[[PLACE, normal]],
            &[[VELOCITY, normal]],
            &[[VELOCITY, VELOCITY]],
        ];
        work.add(virtuals, products, |[q, along, half]| {
            let part = self.part(&q, along);
            let factor = limit(&q, &along) * self.speed([half, along, part]).recip();
            [factor, -(factor * part)]
        });
        work
    }

    fn local<const N: usize, const M: usize>(&self, p: &SVector<f64, M>) -> FrictionLocal<N, 4> {
        self.derivatives(p, |_, vectors| {
            self.work(vectors, |q, along| self.limit(q, along))
        })
    }

    /// Derivatives of a work of virtual velocity, place, velocity and normal, and where `K` has room of the readings of a last vector.
    pub(super) fn derivatives<const N: usize, const K: usize, const M: usize>(
        &self,
        p: &SVector<f64, M>,
        work: impl FnOnce([Vector3<f64>; 3], [Vector3<f64>; 4]) -> OfDotProducts<K>,
    ) -> FrictionLocal<N, K> {
        let read = |reading: usize| std::array::from_fn(|v| vector(p, reading * N + v));
        let readings: [[Vector3<f64>; N]; 3] = [0, 1, 2].map(read);
        let count = FrictionLocal::<N, K>::COUNT;
        let [varied, x, rates] = readings.each_ref().map(|of| &of[..count]);
        let lever = self.lever(x);
        let work = work(
            readings.map(|of| of[N - 1]),
            [
                self.velocity(x, varied),
                self.frame(x) * x[0],
                self.velocity(x, rates),
                self.normal(x),
            ],
        );
        let rows = std::array::from_fn(|v| {
            if v == count {
                return Rows::default();
            }
            let direct = self.by_vector(v, x);
            let [virtual_velocity, velocity] =
                [varied, rates].map(|motion| self.by_place(v, x, motion, &lever));
            Rows {
                by_motion: [direct + lever * x[v].cross_matrix() * self.half_radius(v)],
                by_place: [virtual_velocity, direct, velocity],
            }
        });
        let by = [VIRTUAL, VELOCITY].map(|k| {
            let velocity = work.gradient[k];
            let spin = lever.tr_mul(&velocity);
            ByVelocity { velocity, spin }
        });
        let mut local = FrictionLocal {
            of: *self,
            work,
            rows,
            weighted: [[[Matrix3::zeros(); K]; N]; 2],
            readings,
            by,
        };
        // At no variations the work has no second derivatives but by them.
        let is_still = readings[VIRTUAL].iter().all(|v| *v == Vector3::zeros());
        for v in 0..N {
            for k in (0..K - 1).filter(|k| !is_still || k % 3 == VIRTUAL) {
                local.weighted[0][v][k] = local.weigh(k, PLACE, v);
                local.weighted[1][v][k] = local.weigh(k, VELOCITY, v);
            }
        }
        local
    }
}

/// Derivatives of the work by a velocity, and by S through it.
#[derive(Clone, Copy, Debug)]
struct ByVelocity {
    velocity: Vector3<f64>,
    spin: Vector3<f64>,
}

/// Derivatives by one vector: of its velocity by its motion, and of virtual velocity, place and velocity by its place.
#[derive(Clone, Copy, Debug, Default)]
struct Rows {
    by_motion: [Matrix3<f64>; 1],
    by_place: [Matrix3<f64>; 3],
}

/// Derivatives of the work of friction, block by block.
#[derive(Clone, Copy, Debug)]
pub struct FrictionLocal<const N: usize, const K: usize> {
    of: ContactFriction,
    work: OfDotProducts<K>,
    rows: [Rows; N],
    /// Second derivatives of the work by each midpoint and rate and by its vectors.
    weighted: [[[Matrix3<f64>; K]; N]; 2],
    /// Variations, midpoints and rates.
    readings: [[Vector3<f64>; N]; 3],
    /// By virtual velocity and velocity.
    by: [ByVelocity; 2],
}

impl<const N: usize, const K: usize> FrictionLocal<N, K> {
    /// Number of vectors without a last one of which the readings are vectors of the work.
    const COUNT: usize = if K > 4 { N - 1 } else { N };

    /// Derivatives by an argument of the vectors of the work, from the first on that it moves.
    fn parts(&self, reading: usize, v: usize) -> (usize, &[Matrix3<f64>]) {
        match reading {
            _ if v == Self::COUNT => (BRISTLE + reading, &IDENTITY),
            PLACE => (0, &self.rows[v].by_place),
            moved => (moved, &self.rows[v].by_motion),
        }
    }

    /// Second derivatives of the work by its vector `k` and an argument.
    fn weigh(&self, k: usize, reading: usize, v: usize) -> Matrix3<f64> {
        let (first, parts) = self.parts(reading, v);
        let blocks = self.work.hessian[k][first..].iter().zip(parts);
        blocks.map(|(block, part)| block * part).sum()
    }

    /// Second derivatives of the work by two arguments, of which the second is a midpoint or rate. It is compiled once, not for each pair.
    #[inline(never)]
    fn second(&self, readings: [usize; 2], [v, w]: [usize; 2]) -> Matrix3<f64> {
        let (first, parts) = self.parts(readings[0], v);
        let weighted = &self.weighted[readings[1] - PLACE][w];
        let blocks = weighted[first..].iter().zip(parts);
        let block: Matrix3<f64> = blocks.map(|(block, part)| part.tr_mul(block)).sum();
        block + self.curved(readings, [v, w])
    }

    /// Second derivatives of the vectors of the work by two arguments, times the derivatives of the work by them.
    fn curved(&self, readings: [usize; 2], [v, w]: [usize; 2]) -> Matrix3<f64> {
        let [varied, x, rates] = &self.readings;
        let [by_virtual, by_velocity] = &self.by;
        match readings {
            _ if v.max(w) == Self::COUNT => Matrix3::zeros(),
            [VIRTUAL, PLACE] => self.of.mixed([v, w], x, by_virtual),
            [VELOCITY, PLACE] => self.of.mixed([v, w], x, by_velocity),
            [PLACE, PLACE] => {
                self.of.placed([v, w], rates, by_velocity)
                    + self.of.placed([v, w], varied, by_virtual)
                    + self.of.turned([v, w], &self.work.gradient[PLACE])
            }
            _ => Matrix3::zeros(),
        }
    }
}

impl<const N: usize, const K: usize> WithDerivatives for FrictionLocal<N, K> {
    fn scalar(&self) -> f64 {
        self.work.value
    }
}

impl<const N: usize, const K: usize> Derivatives for FrictionLocal<N, K> {
    #[inline(never)]
    fn force(&self, i: usize) -> Vector3<f64> {
        let (first, parts) = self.parts(i / N, i % N);
        let slopes = self.work.gradient[first..].iter().zip(parts);
        slopes.map(|(slope, part)| part.tr_mul(slope)).sum()
    }

    fn block(&self, i: usize, j: usize) -> Matrix3<f64> {
        let (readings, pair) = ([i / N, j / N], [i % N, j % N]);
        match readings {
            [VIRTUAL, VIRTUAL] => Matrix3::zeros(),
            [_, VIRTUAL] | [PLACE, VELOCITY] => {
                let [a, b] = readings;
                let [v, w] = pair;
                self.second([b, a], [w, v]).transpose()
            }
            _ => self.second(readings, pair),
        }
    }
}

virtual_work! {
    ContactFriction, 1 of 9 as FrictionLocal<1, 4>;
    ContactFriction, 4 of 36 as FrictionLocal<4, 4>;
    ContactFriction, 7 of 63 as FrictionLocal<7, 4>;
    StickingFriction, 2 of 18 as FrictionLocal<2, 7>;
    StickingFriction, 5 of 45 as FrictionLocal<5, 7>;
    StickingFriction, 8 of 72 as FrictionLocal<8, 7>;
}

/// Virtual work of friction that sticks; arguments as of [`ContactFriction`], with the vector z behind those of each reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StickingFriction {
    /// Limit of the force and scale of the slip.
    pub friction: ContactFriction,
    /// Greatest elastic displacement in mm.
    pub displacement: f64,
    /// Time τ in ms of the damping of its vibrations: the force is that of z + τ (1 − α) ż.
    pub damping: f64,
}

/// Length of z up to which it does not slip.
const ELASTIC: f64 = 0.9;

/// Part α of the velocity that slips, with two derivatives, at the square of z.
fn part_that_slips(square: f64) -> [f64; 3] {
    let middle = 0.5 * (1.0 + ELASTIC * ELASTIC);
    let [_, part, first, second] = ramp(square - middle, 1.0 - ELASTIC * ELASTIC);
    [part, first, second]
}

/// The same of half of the square.
fn slips<const D: usize>(half: &Jet<D, 2>) -> Jet<D, 2> {
    let square = half.scaled(2.0);
    let [part, first, second] = part_that_slips(square.value);
    square.map([part, first, second, 0.0])
}

impl StickingFriction {
    /// The vector z + τ (1 − α) ż at z and ż with a time τ in ms.
    pub fn damped([z, rate]: [Vector3<f64>; 2], time: f64) -> Vector3<f64> {
        let [slips, ..] = part_that_slips(z.norm_squared());
        z + rate * (time * (1.0 - slips))
    }

    fn work(&self, vectors: [Vector3<f64>; 7]) -> OfDotProducts<7> {
        let (of, length) = (&self.friction, self.displacement);
        let (mut work, normal) = (OfDotProducts::new(vectors), of.normal_of::<7>());
        let [varied, bristle, rate] = [0, 1, 2].map(|reading| BRISTLE + reading);
        let [q, along]: [Product<'_>; 2] = [&[[PLACE, normal]], &[[VELOCITY, normal]]];
        let force: [Product<'_>; 3] = [
            &[[VIRTUAL, bristle]],
            &[[VIRTUAL, rate]],
            &[[VIRTUAL, normal]],
        ];
        let products: [Product<'_>; 5] = [
            q,
            along,
            &[[bristle, normal]],
            &[[rate, normal]],
            &[[bristle, bristle]],
        ];
        work.add(force, products, |[q, along, lift, lift_rate, stretch]| {
            let limit = of.limit(&q, &along);
            let time = slips(&stretch).shifted(-1.0).scaled(-self.damping);
            let lift = lift + time * lift_rate;
            [limit, limit * time, -(limit * of.part(&q, lift))]
        });
        let equation: [Product<'_>; 4] = [
            &[[varied, rate]],
            &[[varied, VELOCITY]],
            &[[varied, normal]],
            &[[varied, bristle]],
        ];
        let products = [q, along, &[[VELOCITY, VELOCITY]], &[[bristle, bristle]]];
        let scale = of.coefficient * of.law.stiffness * length.powf(of.law.exponent);
        work.add(equation, products, |[q, along, half, stretch]| {
            let part = of.part(&q, along);
            let speed = of.speed([half, along, part]);
            [
                Jet::constant(-length),
                Jet::constant(1.0),
                -part,
                -(slips(&stretch) * speed),
            ]
            .map(|factor| factor.scaled(scale))
        });
        work
    }

    fn local<const N: usize, const M: usize>(&self, p: &SVector<f64, M>) -> FrictionLocal<N, 7> {
        let work =
            |[varied, bristle, rate]: [Vector3<f64>; 3],
             [virtual_velocity, place, velocity, normal]: [Vector3<f64>; 4]| {
                self.work([
                    virtual_velocity,
                    place,
                    velocity,
                    varied,
                    bristle,
                    rate,
                    normal,
                ])
            };
        self.friction.derivatives(p, work)
    }
}
