//! Energies and virtual works of contacts: their derivatives are those of naive formulas, within the ramp of the overlap and beyond it.

use crate::common::random::Random;
use crate::formulas::law;
use crate::gathered::jet_of;
use crate::naive_formulas::{Formula, along, polarised, squared_length, three};
use nalgebra::{SVector, Vector3};
use num_dual::DualNum;
use proboscis::energy::{
    ContactDamping, ContactElasticity, ContactForce, ContactFriction, ContactGap, ContactLaw,
    StickingFriction, Surface,
};
use proboscis::math::Jet;

/// s/w = y/2 + 5/64 + 15/16 y² − 5/4 y⁴ + y⁶ of y = x/w: the half of x, and an even part.
pub(crate) fn ramp<D: DualNum<f64> + Copy>(x: D, width: f64) -> D {
    let y = x / width;
    if y.re() <= -0.5 {
        return x * 0.0;
    }
    if y.re() >= 0.5 {
        return x;
    }
    let square = y * y;
    let even = square * (square * (square - 1.25) + 0.9375) + 0.078125;
    (y * 0.5 + even) * width
}

/// Distance of the centre from the plane or the other centre.
fn height<D: DualNum<f64> + Copy>(surface: Surface, r: [D; 3], n: [D; 3]) -> D {
    match surface {
        Surface::Plane(n) => r[0] * n.x + r[1] * n.y + r[2] * n.z,
        Surface::MovingPlane => polarised(r, n),
        Surface::Sphere => squared_length(r).sqrt(),
    }
}

pub(crate) fn elastic<D: DualNum<f64> + Copy>(law: &ContactLaw, height: D) -> D {
    let s = ramp(-height + law.distance, law.smoothing);
    s.powf(law.exponent + 1.0) * (law.stiffness / (law.exponent + 1.0))
}

/// Vectors by number, of which those beyond the last are zero.
pub(crate) fn vectors<D: DualNum<f64> + Copy>(p: &[D], readings: usize) -> Vec<Vec<[D; 3]>> {
    let each = p.len() / readings;
    let read = |part: &[D]| part.chunks(3).map(|v| three(v, 0)).collect();
    p.chunks(each).map(read).collect()
}

fn second<D: DualNum<f64> + Copy>(of: &[[D; 3]], place: usize) -> [D; 3] {
    of.get(place).copied().unwrap_or([of[0][0] * 0.0; 3])
}

/// Normal force, the growth of it, and the rate of the height of a variation.
fn normal<D: DualNum<f64> + Copy>(
    law: &ContactLaw,
    [varied, at, rates]: [&[[D; 3]]; 3],
    place: usize,
) -> [D; 3] {
    let six = |of: &[[D; 3]]| -> [D; 6] {
        let n = second(of, place);
        std::array::from_fn(|i| if i < 3 { of[0][i] } else { n[i - 3] })
    };
    let of_motion = |motion: &[[D; 3]]| {
        along(six(at), six(motion), |x| {
            let moving = |p: &[num_dual::Dual<D, f64>; 6], at: usize| three(p, at);
            match law.surface {
                Surface::Plane(n) => x[0] * n.x + x[1] * n.y + x[2] * n.z,
                Surface::MovingPlane => polarised(moving(&x, 0), moving(&x, 3)),
                Surface::Sphere => squared_length(moving(&x, 0)).sqrt(),
            }
        })
    };
    let place = height(law.surface, at[0], second(at, place));
    let force = along([place], [place * 0.0 - 1.0], |h| elastic(law, h[0]));
    let growth = ramp(of_motion(rates) * -law.damping + 1.0, law.release);
    [force, growth, of_motion(varied)]
}

macro_rules! formulas {
    ($($of:ident: $arguments:literal, $count:literal;)*) => {
        $(impl Formula<$arguments> for $of {
            fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; $arguments]) -> D {
                self.written_again(&vectors(p, $count))
            }
        })*
    };
}

formulas! {
    ContactElasticity: 3, 1;
    ContactElasticity: 6, 1;
    ContactGap: 3, 1;
    ContactDamping: 9, 3;
    ContactDamping: 18, 3;
    ContactFriction: 9, 3;
    ContactFriction: 36, 3;
    ContactFriction: 63, 3;
    StickingFriction: 18, 3;
    StickingFriction: 45, 3;
    StickingFriction: 72, 3;
}

/// Forces are only measured, to second order.
macro_rules! measured_formulas {
    ($($arguments:literal)*) => {
        $(impl Formula<$arguments> for ContactForce {
            const HAS_RATES: bool = false;

            fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; $arguments]) -> D {
                let x = vectors(p, 2);
                let [force, growth, _] = normal(&self.law, [&x[1], &x[0], &x[1]], 1);
                force * growth / self.unit
            }
        })*
    };
}

measured_formulas! { 6 12 }

/// A formula of vectors by reading and number.
trait WrittenAgain {
    fn written_again<D: DualNum<f64> + Copy>(&self, x: &[Vec<[D; 3]>]) -> D;
}

impl WrittenAgain for ContactElasticity {
    fn written_again<D: DualNum<f64> + Copy>(&self, x: &[Vec<[D; 3]>]) -> D {
        elastic(&self.0, height(self.0.surface, x[0][0], second(&x[0], 1)))
    }
}

impl WrittenAgain for ContactGap {
    fn written_again<D: DualNum<f64> + Copy>(&self, x: &[Vec<[D; 3]>]) -> D {
        height(self.0.surface, x[0][0], second(&x[0], 1)) - self.0.distance
    }
}

impl WrittenAgain for ContactDamping {
    fn written_again<D: DualNum<f64> + Copy>(&self, x: &[Vec<[D; 3]>]) -> D {
        let [force, growth, lift] = normal(&self.0, [&x[0], &x[1], &x[2]], 1);
        force * (growth - 1.0) * lift
    }
}

fn cross<D: DualNum<f64> + Copy>(a: [D; 3], b: [D; 3]) -> [D; 3] {
    let product = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    [product(1, 2), product(2, 0), product(0, 1)]
}

fn sum<D: DualNum<f64> + Copy>(a: [D; 3], b: [D; 3], factor: f64) -> [D; 3] {
    std::array::from_fn(|i| a[i] + b[i] * factor)
}

/// The part of a vector across another one.
fn across<D: DualNum<f64> + Copy>(u: [D; 3], n: [D; 3]) -> [D; 3] {
    let part = polarised(u, n) / squared_length(n);
    std::array::from_fn(|i| u[i] - n[i] * part)
}

/// Slip of rates or variations, along a plane of a body by its two components.
pub(crate) fn slip<D: DualNum<f64> + Copy>(
    of: &ContactFriction,
    at: &[[D; 3]],
    motion: &[[D; 3]],
) -> [D; 3] {
    let zero = at[0][0] * 0.0;
    let size = of.law.distance;
    let mut radii = of.radii.to_vec();
    if of.law.surface == Surface::MovingPlane {
        radii.insert(0, -size);
    }
    let mut spin = [zero; 3];
    for (v, radius) in (1..at.len()).zip(radii.iter().flat_map(|r| [r; 3])) {
        spin = sum(spin, cross(at[v], motion[v]), 0.5 * radius);
    }
    match of.law.surface {
        Surface::Plane(n) => {
            let n = [n.x, n.y, n.z].map(|n| zero + n);
            across(sum(motion[0], cross(spin, n), -1.0), n)
        }
        Surface::Sphere => {
            let lever = cross(spin, at[0]);
            across(sum(motion[0], lever, -1.0 / size), at[0])
        }
        Surface::MovingPlane => {
            // The rate of t·r.
            let along_tangent =
                |t: usize| polarised(motion[t], at[0]) + polarised(at[t], motion[0]);
            let [a, b] = [polarised(spin, at[2]), polarised(spin, at[1])];
            [along_tangent(1) - a, along_tangent(2) + b, zero]
        }
    }
}

impl WrittenAgain for ContactFriction {
    fn written_again<D: DualNum<f64> + Copy>(&self, x: &[Vec<[D; 3]>]) -> D {
        let [force, growth, _] = normal(&self.law, [&x[0], &x[1], &x[2]], 3);
        let [slip, virtual_slip] = [&x[2], &x[0]].map(|motion| slip(self, &x[1], motion));
        let speed = (squared_length(slip) + self.slip_speed * self.slip_speed).sqrt();
        force * growth * polarised(slip, virtual_slip) / speed * -self.coefficient
    }
}

impl WrittenAgain for StickingFriction {
    fn written_again<D: DualNum<f64> + Copy>(&self, x: &[Vec<[D; 3]>]) -> D {
        let ContactFriction {
            law, coefficient, ..
        } = self.friction;
        let [varied, at, rates] = [0, 1, 2].map(|reading| {
            let (last, before) = x[reading].split_last().unwrap();
            (*last, before)
        });
        let [force, growth, _] = normal(&law, [varied.1, at.1, rates.1], 3);
        let [slip, virtual_slip] =
            [rates, varied].map(|motion| slip(&self.friction, at.1, motion.1));
        let square = squared_length(at.0);
        let t = (square - 0.81) / 0.19;
        let slips = match t.re() {
            ..=0.0 => square * 0.0,
            1.0.. => square * 0.0 + 1.0,
            _ => {
                let rest = -t + 1.0;
                -(rest * rest * rest * (t * (t * 6.0 + 3.0) + 1.0)) + 1.0
            }
        };
        let speed = (squared_length(slip) + self.friction.slip_speed.powi(2)).sqrt();
        let lag = sum(rates.0, slip, -1.0 / self.displacement);
        let back = slips * speed / self.displacement;
        let equation = polarised(varied.0, lag) + polarised(varied.0, at.0) * back;
        let stiffness = coefficient * law.stiffness * self.displacement.powf(law.exponent + 1.0);
        let holds = (-slips + 1.0) * self.damping;
        let damped: [D; 3] = std::array::from_fn(|i| at.0[i] + rates.0[i] * holds);
        force * growth * polarised(damped, virtual_slip) * -coefficient - equation * stiffness
    }
}

/// Linear within a wide ramp, and after Hertz beyond a narrow one.
pub(crate) fn laws(surface: Surface) -> [ContactLaw; 2] {
    let law = |exponent, distance, smoothing| ContactLaw {
        surface,
        distance,
        stiffness: 0.7,
        exponent,
        smoothing,
        damping: 0.08,
        release: 0.4,
    };
    [law(1.0, 1.3, 14.0), law(1.5, 6.0, 0.2)]
}

const NORMAL: Vector3<f64> = Vector3::new(0.48, 0.6, 0.64);

#[test]
fn normal_forces_have_the_derivatives_of_naive_formulas() {
    for surface in [Surface::Plane(NORMAL), Surface::Sphere] {
        for of in laws(surface) {
            law::<_, 3>("contact", &ContactElasticity(of), 0.4, 1.1);
            law::<_, 9>("contact damping", &ContactDamping(of), 0.4, 1.1);
            // Heights over planes are polynomials of a degree of their own.
            if surface == Surface::Sphere {
                law::<_, 3>("contact gap", &ContactGap(of), 0.4, 1.1);
            }
            law::<_, 6>(
                "contact force",
                &ContactForce { law: of, unit: 0.3 },
                0.4,
                1.1,
            );
        }
    }
    for of in laws(Surface::MovingPlane) {
        law::<_, 6>("contact", &ContactElasticity(of), 0.4, 1.1);
        law::<_, 18>("contact damping", &ContactDamping(of), 0.4, 1.1);
        law::<_, 12>(
            "contact force",
            &ContactForce { law: of, unit: 0.3 },
            0.4,
            1.1,
        );
    }
}

#[test]
fn friction_has_the_derivatives_of_its_naive_formula() {
    for surface in [
        Surface::Plane(NORMAL),
        Surface::Sphere,
        Surface::MovingPlane,
    ] {
        for of in laws(surface) {
            let friction = ContactFriction {
                law: of,
                radii: [0.9, 0.4],
                coefficient: 0.3,
                slip_speed: 0.7,
            };
            if surface != Surface::MovingPlane {
                law::<_, 9>("friction", &friction, 0.4, 1.1);
            }
            law::<_, 36>("friction", &friction, 0.4, 1.1);
            law::<_, 63>("friction", &friction, 0.4, 1.1);
            // Lengths of z on both sides of where it begins to slip, and of one.
            let sticking = StickingFriction {
                friction,
                displacement: 0.8,
                damping: 0.6,
            };
            if surface != Surface::MovingPlane {
                law::<_, 18>("sticking", &sticking, 0.45, 0.65);
            }
            law::<_, 45>("sticking", &sticking, 0.45, 0.65);
            law::<_, 72>("sticking", &sticking, 0.45, 0.65);
        }
    }
}

#[test]
fn what_slips_takes_energy() {
    let mut random = Random(7);
    let mut largest = 0.0_f64;
    for law in laws(Surface::Plane(NORMAL)) {
        let friction = ContactFriction {
            law,
            radii: [0.0; 2],
            coefficient: 0.3,
            slip_speed: 0.1,
        };
        let sticking = StickingFriction {
            friction,
            displacement: 0.8,
            damping: 0.6,
        };
        for _ in 0..100 {
            // Variations are zero. The equation is that of z; its part beside the rate, which is its residual at no rate, tells the rate.
            let mut p = SVector::<f64, 18>::from_fn(|i, _| match i {
                ..6 | 15.. => 0.0,
                _ => random.between(-1.2, 1.2),
            });
            let bristle: Vector3<f64> = p.fixed_rows::<3>(9).into();
            p.fixed_rows_mut::<3>(9)
                .copy_from(&(bristle / bristle.norm().max(1.0)));
            let slopes = |p: &SVector<f64, 18>| {
                let jet: Jet<18, 1> = jet_of(&sticking, p, &SVector::zeros());
                let of = |i: usize| -> Vector3<f64> { jet.gradient.fixed_rows::<3>(i).into() };
                [of(0), of(3)]
            };
            let scale = 0.3 * law.stiffness * 0.8_f64.powf(law.exponent);
            let rate = slopes(&p)[1] / (0.8 * scale);
            p.fixed_rows_mut::<3>(15).copy_from(&rate);
            let [force, equation] = slopes(&p);
            assert!(equation.norm() < 1e-12, "{equation}");
            // What comes in beside what the displacement stores, of which the force without its damping is the slope.
            let undamped = slopes(&{
                let mut still = p;
                still.fixed_rows_mut::<3>(15).fill(0.0);
                still
            })[0];
            let velocity: Vector3<f64> = p.fixed_rows::<3>(12).into();
            let power = force.dot(&velocity) - undamped.dot(&(rate * 0.8));
            assert!(power < 1e-14, "{power}");
            largest = largest.max(-power);
        }
    }
    assert!(largest > 1e-2, "nothing slips: {largest}");
}
