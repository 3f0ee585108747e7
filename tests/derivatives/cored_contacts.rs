//! Contacts between shapes with cores: their derivatives are those of naive formulas, and their gaps those of a search over points of both cores.

use crate::common::random::Random;
use crate::contacts::{elastic, laws, ramp, slip, vectors};
use crate::formulas::law;
use crate::gathered::jet_of;
use crate::naive_formulas::{Formula, along, polarised, squared_length};
use nalgebra::{SVector, Vector3};
use num_dual::{Dual, DualNum};
use proboscis::energy::{
    ContactDamping, ContactElasticity, ContactForce, ContactFriction, ContactGap, ContactLaw,
    CoreFriction, Cores, OfCores, Surface,
};
use proboscis::math::Jet;

/// Half length of the axis of the round shape, and of those of the other one.
const ROUND: f64 = 0.25;
const OTHER: [f64; 3] = [0.2, 0.3, 0.1];

/// Cores of a number of vectors: the span, the axis of the round shape where the number is odd, and one axis or three.
fn cores(count: usize, distance: f64) -> Cores {
    let (round, other) = half_lengths(count);
    Cores::new(round, other, distance)
}

fn half_lengths(count: usize) -> (Option<f64>, &'static [f64]) {
    let round = (count % 2 == 1).then_some(ROUND);
    let other = if count > 3 { &OTHER[..] } else { &OTHER[..1] };
    (round, other)
}

/// Half length, width and slope of the clamp of each axis.
fn clamps(count: usize, distance: f64) -> Vec<[f64; 3]> {
    let (round, other) = half_lengths(count);
    let clamp = |(axis, &l): (usize, &f64)| {
        let slope = match (round, axis) {
            (Some(_), 0) => 1.0 / (1.0 + 1e-3 * distance / l),
            _ => 1.0,
        };
        [l, 0.1 * f64::min(l, distance), slope]
    };
    round.iter().chain(other).enumerate().map(clamp).collect()
}

/// G of a clamp.
fn rounded<D: DualNum<f64> + Copy>(y: D, [l, width, slope]: [f64; 3]) -> D {
    let x = y * slope;
    let [over, under] = [x - l, -x - l].map(|x| ramp(x, width));
    (x * x - over * over - under * under) * (0.5 / slope)
}

fn foot<D: DualNum<f64> + Copy>(y: D, clamp: [f64; 3]) -> D {
    along([y], [y * 0.0 + 1.0], |y| rounded(y[0], clamp))
}

/// Excess of y over what follows from it, at the products of the span and the cosines of an axis with the others.
fn excess<D: DualNum<f64> + Copy>(y: D, [products, cosines]: [&[D]; 2], clamps: &[[f64; 3]]) -> D {
    let first = foot(y, clamps[0]);
    let others = products[1..].iter().zip(cosines).zip(&clamps[1..]);
    others.fold(y - products[0], |excess, ((product, cosine), clamp)| {
        excess + *cosine * foot(*product - *cosine * first, *clamp)
    })
}

/// The root of the excess by bisection, and its slope there.
fn root<D: DualNum<f64> + Copy>(at: [&[D]; 2], clamps: &[[f64; 3]]) -> [f64; 2] {
    let real = at.map(|list| list.iter().map(D::re).collect::<Vec<f64>>());
    let excess = |y: f64| excess(y, [&real[0], &real[1]], clamps);
    let [mut low, mut high] = [-3.0, 3.0];
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        match excess(middle) > 0.0 {
            true => high = middle,
            false => low = middle,
        }
    }
    let step = 1e-6;
    [
        low,
        (excess(low + step) - excess(low - step)) / (2.0 * step),
    ]
}

/// The form, and the feet on the axes, at the span and the axes.
fn closest<D: DualNum<f64> + Copy>(x: &[[D; 3]], distance: f64) -> (D, Vec<D>) {
    let clamps = clamps(x.len(), distance);
    let products: Vec<D> = x[1..].iter().map(|axis| polarised(x[0], *axis)).collect();
    let mut form = squared_length(x[0]) * 0.5;
    if x.len().is_multiple_of(2) {
        for (y, clamp) in products.iter().zip(&clamps) {
            form -= rounded(*y, *clamp);
        }
        let feet = products.iter().zip(&clamps);
        return (form, feet.map(|(y, clamp)| foot(*y, *clamp)).collect());
    }
    let cosines: Vec<D> = x[2..].iter().map(|axis| polarised(x[1], *axis)).collect();
    let at = [&products[..], &cosines[..]];
    let [root, slope] = root(at, &clamps);
    let mut y = products[0] * 0.0 + root;
    // An order of derivatives a step, and some digits of the slope.
    for _ in 0..4 {
        y -= excess(y, at, &clamps) * slope.recip();
    }
    let others = |first: D| -> Vec<D> {
        let each = products[1..].iter().zip(&cosines);
        let other = each.map(|(product, cosine)| *product - *cosine * first);
        other.collect()
    };
    let first = foot(y, clamps[0]);
    let each = others(first);
    form -= rounded(y, clamps[0]);
    let mut feet = vec![first];
    for ((y, cosine), clamp) in each.iter().zip(&cosines).zip(&clamps[1..]) {
        let other = foot(*y, *clamp);
        form -= rounded(*y, *clamp) + *cosine * first * other;
        feet.push(other);
    }
    (form, feet)
}

fn height<D: DualNum<f64> + Copy>(x: &[[D; 3]], distance: f64) -> D {
    (closest(x, distance).0 * 2.0).sqrt()
}

/// Normal force, the growth of it, and the rate of the height of a variation.
fn normal<D: DualNum<f64> + Copy>(law: &ContactLaw, [varied, at, rates]: [&[[D; 3]]; 3]) -> [D; 3] {
    let flat = |of: &[[D; 3]]| -> [D; 15] {
        std::array::from_fn(|i| of.get(i / 3).map_or(at[0][0] * 0.0, |v| v[i % 3]))
    };
    let of_motion = |motion: &[[D; 3]]| {
        along(flat(at), flat(motion), |x: [Dual<D, f64>; 15]| {
            let x: Vec<[Dual<D, f64>; 3]> = x.chunks(3).map(|v| [v[0], v[1], v[2]]).collect();
            height(&x[..at.len()], law.distance)
        })
    };
    let place = height(at, law.distance);
    let force = along([place], [place * 0.0 - 1.0], |h| elastic(law, h[0]));
    let growth = ramp(of_motion(rates) * -law.damping + 1.0, law.release);
    [force, growth, of_motion(varied)]
}

macro_rules! formulas {
    ($($once:literal $twice:literal $thrice:literal)*) => {
        $(
            impl Formula<$once> for OfCores<ContactElasticity> {
                fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; $once]) -> D {
                    elastic(&self.of.0, height(&vectors(p, 1)[0], self.of.0.distance))
                }
            }

            impl Formula<$once> for OfCores<ContactGap> {
                fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; $once]) -> D {
                    height(&vectors(p, 1)[0], self.of.0.distance) - self.of.0.distance
                }
            }

            impl Formula<$twice> for OfCores<ContactForce> {
                const HAS_RATES: bool = false;

                fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; $twice]) -> D {
                    let x = vectors(p, 2);
                    let [force, growth, _] = normal(&self.of.law, [&x[1], &x[0], &x[1]]);
                    force * growth / self.of.unit
                }
            }

            impl Formula<$thrice> for OfCores<ContactDamping> {
                fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; $thrice]) -> D {
                    let x = vectors(p, 3);
                    let [force, growth, lift] = normal(&self.of.0, [&x[0], &x[1], &x[2]]);
                    force * (growth - 1.0) * lift
                }
            }
        )*
    };
}

formulas! { 6 12 18 9 18 27 12 24 36 15 30 45 }

/// Friction of vectors by reading: with a round shape that turns its three directors stand before those of the other one.
fn rubbing<D: DualNum<f64> + Copy, const C: usize>(of: &CoreFriction<C>, p: &[D]) -> D {
    let x = vectors(p, 3);
    let law = &of.friction.law;
    let axes: &[usize] = match (C, x[0].len()) {
        (2, 4) => &[1],
        (2, _) => &[4],
        (3, _) => &[1, 4],
        (4, 4) => &[1, 2, 3],
        (4, _) => &[4, 5, 6],
        _ => &[1, 4, 5, 6],
    };
    let of_form = |x: &[[D; 3]]| -> Vec<[D; 3]> { [0].iter().chain(axes).map(|&v| x[v]).collect() };
    let [varied, at, rates] = [0, 1, 2].map(|m| of_form(&x[m]));
    let [force, growth, _] = normal(law, [&varied, &at, &rates]);
    let (_, feet) = closest(&at, law.distance);
    let held = |motion: &[[D; 3]]| {
        let mut motion = motion.to_vec();
        for (foot, axis) in feet.iter().zip(axes) {
            let along = motion[*axis];
            for (span, along) in motion[0].iter_mut().zip(along) {
                *span -= along * *foot;
            }
        }
        motion
    };
    let [varied, at, rates] = [0, 1, 2].map(|m| held(&x[m]));
    let [along, virtual_along] = [&rates, &varied].map(|motion| slip(&of.friction, &at, motion));
    let speed = (squared_length(along) + of.friction.slip_speed * of.friction.slip_speed).sqrt();
    force * growth * polarised(along, virtual_along) / speed * -of.friction.coefficient
}

macro_rules! frictions {
    ($($of:literal $arguments:literal)*) => {
        $(impl Formula<$arguments> for CoreFriction<$of> {
            fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; $arguments]) -> D {
                rubbing(self, p)
            }
        })*
    };
}

frictions! { 2 36 2 63 3 63 4 36 4 63 5 63 }

/// Bounds of arguments at which axes have small cosines.
const LOW: f64 = 0.12;
const HIGH: f64 = 0.4;

macro_rules! normal_law {
    ($vectors:literal $once:literal $twice:literal $thrice:literal) => {
        for of in laws(Surface::Sphere) {
            let cores = cores($vectors, of.distance);
            // Many names are many points, some of which lie at the ends of axes.
            for number in 0..2 {
                let name = format!("cores of {} vectors, {number}", $vectors);
                let elastic = OfCores {
                    of: ContactElasticity(of),
                    cores,
                };
                law::<_, $once>(&name, &elastic, LOW, HIGH);
                let gap = OfCores {
                    of: ContactGap(of),
                    cores,
                };
                law::<_, $once>(&name, &gap, LOW, HIGH);
                let force = OfCores {
                    of: ContactForce { law: of, unit: 0.3 },
                    cores,
                };
                law::<_, $twice>(&name, &force, LOW, HIGH);
                let damping = OfCores {
                    of: ContactDamping(of),
                    cores,
                };
                law::<_, $thrice>(&name, &damping, LOW, HIGH);
            }
        }
    };
}

#[test]
fn normal_forces_of_cores_have_the_derivatives_of_naive_formulas() {
    normal_law!(2 6 12 18);
    normal_law!(3 9 18 27);
    normal_law!(4 12 24 36);
    normal_law!(5 15 30 45);
}

#[test]
fn friction_of_cores_has_the_derivatives_of_its_naive_formula() {
    for of in laws(Surface::Sphere) {
        let friction = ContactFriction {
            law: of,
            radii: [0.9, 0.4],
            coefficient: 0.3,
            slip_speed: 0.7,
        };
        let cores = |count| cores(count, of.distance);
        let capsule = CoreFriction::<2> {
            friction,
            cores: cores(2),
        };
        law::<_, 36>("capsule", &capsule, LOW, HIGH);
        law::<_, 63>("capsule", &capsule, LOW, HIGH);
        let capsules = CoreFriction::<3> {
            friction,
            cores: cores(3),
        };
        law::<_, 63>("capsules", &capsules, LOW, HIGH);
        let cuboid = CoreFriction::<4> {
            friction,
            cores: cores(4),
        };
        law::<_, 36>("box", &cuboid, LOW, HIGH);
        law::<_, 63>("box", &cuboid, LOW, HIGH);
        let both = CoreFriction::<5> {
            friction,
            cores: cores(5),
        };
        law::<_, 63>("capsule on a box", &both, LOW, HIGH);
    }
}

/// Two or four unit vectors: the axis of the round shape, and three at right angles.
fn axes(random: &mut Random) -> [Vector3<f64>; 4] {
    let mut vector = || Vector3::from_fn(|_, _| random.between(-1.0, 1.0)).normalize();
    let (round, first) = (vector(), vector());
    let second = vector().cross(&first).normalize();
    [round, first, second, first.cross(&second)]
}

/// The least distance of points of both cores: each foot in turn moves to its closest place, until all of them stay.
fn searched(r: &Vector3<f64>, lengths: &[(Vector3<f64>, f64)]) -> f64 {
    let halves: Vec<Vector3<f64>> = lengths.iter().map(|(axis, half)| axis * *half).collect();
    let mut parts = vec![0.0_f64; halves.len()];
    let mut apart = *r;
    for _ in 0..100_000 {
        let before = apart;
        for (part, half) in parts.iter_mut().zip(&halves) {
            let moved = (*part + apart.dot(half) / half.norm_squared()).clamp(-1.0, 1.0);
            apart -= half * (moved - *part);
            *part = moved;
        }
        if (apart - before).norm() < 1e-12 {
            break;
        }
    }
    apart.norm()
}

#[test]
fn gaps_are_the_least_distances_of_points_of_both_cores() {
    let mut random = Random(11);
    let mut largest = [0.0_f64; 2];
    for number in 0..400 {
        let [round, others @ ..] = axes(&mut random);
        let mut r = Vector3::from_fn(|_, _| random.between(-45.0, 45.0));
        // Every tenth pair is parallel.
        let round = if number % 10 == 0 { others[0] } else { round };
        let (distance, lengths) = (4.0, [12.0, 20.0, 6.0]);
        for (is_pair, count) in [(false, 1), (true, 1), (false, 3), (true, 3)] {
            if count == 3 && r.dot(&others[2]).abs() < 30.0 {
                r += others[2] * 40.0;
            }
            let own = [(round, 15.0)].into_iter().filter(|_| is_pair);
            let each: Vec<(Vector3<f64>, f64)> = own
                .chain(others.into_iter().zip(lengths).take(count))
                .collect();
            let searched = searched(&r, &each);
            let cores = Cores::new(is_pair.then_some(15.0), &lengths[..count], distance);
            let of = ContactLaw {
                distance,
                ..laws(Surface::Sphere)[0]
            };
            let x: Vec<Vector3<f64>> = [r]
                .into_iter()
                .chain(each.iter().map(|one| one.0))
                .collect();
            let found = distance - cores.touch(&of, &x, &x).overlap;
            // Widths of ends and thinner ends of segments, which never reach beyond the exact shape: they are a part of the gap at a distance.
            let error = (found - searched) * searched / distance;
            assert!(
                error > -1e-7,
                "{number} {is_pair} {count}: {found} {searched}"
            );
            let largest = &mut largest[usize::from(is_pair)];
            *largest = largest.max(error);
        }
    }
    println!("shapes lie within exact ones by up to {largest:?}");
    assert!(largest[0] < 1e-3 && largest[1] < 1e-2, "{largest:?}");
}

#[test]
fn an_open_contact_of_cores_has_no_force() {
    let of = ContactLaw {
        smoothing: 0.0,
        ..laws(Surface::Sphere)[0]
    };
    let elastic = OfCores {
        of: ContactElasticity(of),
        cores: cores(2, of.distance),
    };
    let p = SVector::<f64, 6>::from([3.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    let jet: Jet<6, 3> = jet_of(&elastic, &p, &p);
    assert_eq!(
        [jet.value, jet.gradient.amax(), jet.hessian_w.amax()],
        [0.0; 3]
    );
}
