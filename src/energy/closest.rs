//! Closest points of two shapes, each within a radius of its core: a point, a segment, or a box that its half lengths along axes span.
//!
//! The span r joins both centres. With unit axes eᵢ the span between the closest points of the cores is ρ = r − Σ γᵢ eᵢ. The foot γᵢ on an axis
//! of the half length l is the clamp γ = G′(y) of y = r·eᵢ to ±l, where
//!
//! ```text
//! G = ½ y² − ½ s(y − l)² − ½ s(−y − l)²
//! ```
//!
//! has the three continuous derivatives of the ramp s, so that q = ½ |r|² − Σ Gᵢ is ½ |ρ|² but within a small width of the ends of an axis, where
//! the shape lies within the exact one.
//!
//! A segment along a of the round shape has y = r·a − Σ cⱼ γⱼ and yⱼ = r·eⱼ − cⱼ γ with cⱼ = a·eⱼ, which is one equation of y, and
//! q = ½ |r|² − γ Σ cⱼ γⱼ − G − Σ Gⱼ. Its clamp has a slope below one, as if the segment were thinner towards its ends, so that the equation has
//! one root even where axes are parallel. By the products of vectors that q reads its derivatives are 1, −γᵢ and γ γⱼ.

use crate::energy::contact::ramp;
use crate::energy::dot_products::OfDotProducts;
use crate::energy::{ContactLaw, Touch};
use crate::math::Jet;
use nalgebra::{Matrix3, SVector, Vector3};

/// Width over which a foot comes to rest at an end of an axis, in half lengths or distances of the cores in touch, whichever is smaller.
const WIDTH: f64 = 0.1;
/// Twice the decrease of the thickness of a segment of the round shape towards its ends, in its half lengths.
const BULGE: f64 = 1e-3;
/// Most axes of both cores.
const MOST: usize = 4;

/// Clamp of the foot on an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Clamp {
    half_length: f64,
    width: f64,
    /// Slope κ within the axis: the clamp of κ y.
    slope: f64,
}

impl Clamp {
    /// G with three derivatives.
    fn at(&self, y: f64) -> [f64; 4] {
        let (x, slope) = (self.slope * y, self.slope);
        if self.half_length == 0.0 {
            return [0.0; 4];
        }
        let mut of = [0.5 * x * x, x, 1.0, 0.0];
        for sign in [1.0, -1.0] {
            let [s, s1, s2, s3] = ramp(sign * x - self.half_length, self.width);
            of[0] -= 0.5 * s * s;
            of[1] -= sign * s * s1;
            of[2] -= s1 * s1 + s * s2;
            of[3] -= sign * (3.0 * s1 * s2 + s * s3);
        }
        [of[0] / slope, of[1], of[2] * slope, of[3] * slope * slope]
    }
}

/// The cores of both shapes by the half lengths in mm of their axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cores {
    axes: [Clamp; MOST],
    /// Number of axes: one or three of the other shape, behind that of the round shape.
    count: usize,
    /// True if the round shape has an axis.
    is_pair: bool,
}

/// The form q and its derivatives by products of vectors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Closest<const D: usize> {
    pub(super) form: Jet<D, 2>,
    pub(super) slopes: [Jet<D, 2>; D],
}

impl Cores {
    /// Those of a round shape with an axis or without, and of another one with one axis or three, at the distance of the cores in touch.
    pub fn new(round: Option<f64>, other: &[f64], distance: f64) -> Self {
        let mut axes = [Clamp::default(); MOST];
        let half_lengths = round.iter().chain(other);
        for (axis, &half_length) in axes.iter_mut().zip(half_lengths) {
            *axis = Clamp {
                half_length,
                width: WIDTH * half_length.min(distance),
                slope: 1.0,
            };
        }
        if let Some(half_length) = round {
            axes[0].slope = half_length / (half_length + BULGE * distance);
        }
        Self {
            axes,
            count: other.len() + usize::from(round.is_some()),
            is_pair: round.is_some(),
        }
    }

    /// Vectors that are multiplied, by number: the span, then the axes. Half of the square of the span comes first, its products with axes
    /// follow, then those of the axis of the round shape.
    pub(super) fn products<const D: usize>(&self) -> [[usize; 2]; D] {
        std::array::from_fn(|k| match k {
            0 => [0, 0],
            _ if k <= self.count => [0, k],
            _ => [1, k + 1 - self.count],
        })
    }

    /// Places of the axes among the vectors of friction: the span, three directors of the round shape where it turns or has an axis, and three
    /// of the other one.
    pub(super) fn places<const N: usize>(&self) -> [Option<usize>; N] {
        let other = usize::from(self.is_pair) + 1;
        let beside = if self.is_pair { Some(1) } else { None };
        std::array::from_fn(|v| {
            let axis = match (v, N.checked_sub(3)) {
                (0, _) => Some(0),
                (1, Some(4)) => beside,
                (_, Some(first)) if v >= first => Some(other + v - first),
                _ => None,
            };
            axis.filter(|&axis| axis <= self.count)
        })
    }

    /// Excess of y over the value that follows from it, and its slope.
    fn excess(&self, y: f64, products: &[f64]) -> [f64; 2] {
        let [_, foot, rise, _] = self.axes[0].at(y);
        let mut excess = [y - products[1], 1.0];
        for j in 1..self.count {
            let cosine = products[self.count + j];
            let [_, other, steep, _] = self.axes[j].at(products[1 + j] - cosine * foot);
            excess[0] += cosine * other;
            excess[1] -= cosine * cosine * steep * rise;
        }
        excess
    }

    /// The root y, by steps of Newton's method that stay within bounds; the excess rises everywhere.
    fn root(&self, products: &[f64]) -> f64 {
        // Feet come to rest a little beyond the ends.
        let reach = |j: usize| {
            let axis = &self.axes[j];
            products[self.count + j].abs() * (axis.half_length + axis.width)
        };
        let farthest: f64 = (1..self.count).map(reach).sum();
        let [mut low, mut high] = [products[1] - farthest, products[1] + farthest];
        let mut y = products[1];
        for _ in 0..200 {
            let [excess, slope] = self.excess(y, products);
            match excess > 0.0 {
                true => high = y,
                false => low = y,
            }
            let next = y - excess / slope;
            let next = match next > low && next < high {
                true => next,
                false => 0.5 * (low + high),
            };
            let rounding = 4.0 * f64::EPSILON * (farthest + y.abs());
            if (next - y).abs() <= rounding || next.is_nan() {
                return next;
            }
            y = next;
        }
        y
    }

    /// The form of products.
    pub(super) fn closest<const D: usize>(&self, p: &[Jet<D, 2>; D]) -> Closest<D> {
        let on = |axis: usize, y: &Jet<D, 2>| {
            let [of, foot, rise, bend] = self.axes[axis].at(y.value);
            [
                y.map([of, foot, rise, bend]),
                y.map([foot, rise, bend, 0.0]),
            ]
        };
        let count = self.count;
        let mut slopes = [Jet::constant(0.0); D];
        slopes[0] = Jet::constant(1.0);
        let mut form = p[0];
        let mut round = None;
        if self.is_pair {
            let values = p.map(|product| product.value);
            let root = self.root(&values);
            let [_, slope] = self.excess(root, &values);
            let mut y = Jet::constant(root);
            // Each step adds an order of derivatives.
            for _ in 0..2 {
                let [_, foot] = on(0, &y);
                let mut excess = y - p[1];
                for j in 1..count {
                    let [_, other] = on(j, &(p[1 + j] - p[count + j] * foot));
                    excess = excess + p[count + j] * other;
                }
                y = y - excess.scaled(slope.recip());
            }
            let [of, foot] = on(0, &y);
            form = form - of;
            slopes[1] = -foot;
            round = Some(foot);
        }
        for j in usize::from(self.is_pair)..count {
            let y = match &round {
                Some(foot) => p[1 + j] - p[count + j] * *foot,
                None => p[1 + j],
            };
            let [of, other] = on(j, &y);
            form = form - of;
            slopes[1 + j] = -other;
            if let Some(foot) = round {
                slopes[count + j] = foot * other;
                form = form - slopes[count + j] * p[count + j];
            }
        }
        Closest { form, slopes }
    }

    /// Values of the form and of its derivatives by products.
    fn values<const D: usize>(&self, x: &[Vector3<f64>]) -> Vec<f64> {
        let product = |[i, j]: [usize; 2]| x[i].dot(&x[j]) * if i == j { 0.5 } else { 1.0 };
        let at = SVector::from(self.products::<D>().map(product));
        let arguments = std::array::from_fn(|k| Jet::argument(k, &at, &SVector::zeros()));
        let closest = self.closest::<D>(&arguments);
        let slopes = closest.slopes.iter().map(|slope| slope.value);
        [closest.form.value].into_iter().chain(slopes).collect()
    }

    /// The form, and its derivatives by products, at the span and the axes.
    fn at(&self, x: &[Vector3<f64>]) -> Vec<f64> {
        match (self.count, self.is_pair) {
            (1, _) => self.values::<2>(x),
            (4, true) => self.values::<8>(x),
            _ => self.values::<4>(x),
        }
    }

    /// Overlap and normal force of a law at the span and the axes and their rates.
    pub fn touch(&self, law: &ContactLaw, x: &[Vector3<f64>], rates: &[Vector3<f64>]) -> Touch {
        let at = self.at(x);
        let pairs: [[usize; 2]; 2 * MOST] = self.products();
        let rate = at[1..].iter().zip(pairs).map(|(slope, [i, j])| {
            let rate = rates[i].dot(&x[j]) + if i == j { 0.0 } else { x[i].dot(&rates[j]) };
            slope * rate
        });
        law.touch_at(at[0], rate.sum())
    }

    /// The span between the closest points at the vectors of friction and its rate or that of a variation, with both feet held.
    pub fn span<const C: usize>(
        &self,
        x: &[Vector3<f64>],
        motions: [&[Vector3<f64>]; C],
    ) -> [Vector3<f64>; C] {
        let places: Vec<usize> = match x.len() {
            4 => named(self.places::<4>()),
            _ => named(self.places::<7>()),
        };
        let read: Vec<Vector3<f64>> = places.iter().map(|&v| x[v]).collect();
        let at = self.at(&read);
        motions.map(|of| {
            let feet = places.iter().zip(&at[1..]).skip(1);
            of[0]
                + feet
                    .map(|(&v, weight)| of[v] * *weight)
                    .sum::<Vector3<f64>>()
        })
    }
}

/// The places of the span and the axes in their order.
fn named<const N: usize>(places: [Option<usize>; N]) -> Vec<usize> {
    let mut found: Vec<(usize, usize)> = (0..N).filter_map(|v| Some((places[v]?, v))).collect();
    found.sort_unstable();
    found.into_iter().map(|(_, v)| v).collect()
}

/// The form of the span and the axes, `N` vectors with `D` products, and what changes along rates of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Form<const N: usize, const D: usize, const K: usize> {
    cores: Cores,
    vectors: [Vector3<f64>; N],
    pub(super) closest: Closest<D>,
}

/// Rate of a form along rates of its vectors, with that of its first and second derivatives.
#[derive(Clone, Copy, Debug)]
pub(super) struct AlongForm<const N: usize> {
    pub(super) rate: f64,
    pub(super) gradient: [Vector3<f64>; N],
    pub(super) hessian: [[Matrix3<f64>; N]; N],
}

impl<const N: usize> AlongForm<N> {
    /// Along nothing.
    pub(super) const NONE: Self = Self {
        rate: 0.0,
        gradient: [Vector3::new(0.0, 0.0, 0.0); N],
        hessian: [[Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0); N]; N],
    };
}

impl<const N: usize, const D: usize, const K: usize> Form<N, D, K> {
    pub(super) fn new(cores: &Cores, vectors: [Vector3<f64>; N]) -> Self {
        let pairs = cores.products::<D>().map(|pair| [pair]);
        let arguments = OfDotProducts::new(vectors).arguments(pairs.each_ref().map(|p| &p[..]));
        Self {
            cores: *cores,
            vectors,
            closest: cores.closest(&arguments),
        }
    }

    /// A function of products with its derivatives by the vectors.
    pub(super) fn of(&self, function: Jet<D, 2>) -> OfDotProducts<N> {
        let pairs = self.cores.products::<D>().map(|pair| [pair]);
        let mut of = OfDotProducts::new(self.vectors);
        of.add_function(pairs.each_ref().map(|p| &p[..]), function);
        of
    }

    /// Derivatives by the vectors of a function of products from those by products.
    pub(super) fn gradient(&self, slopes: &SVector<f64, D>) -> [Vector3<f64>; N] {
        let pairs = self.cores.products::<D>().map(|pair| [pair]);
        OfDotProducts::new(self.vectors).turned(pairs.each_ref().map(|p| &p[..]), slopes)
    }

    /// The form itself.
    pub(super) fn form(&self) -> OfDotProducts<N> {
        self.of(self.closest.form)
    }

    /// Its change along rates of the vectors: the sum of the rates of products, each times a derivative by it.
    pub(super) fn along(&self, rates: [Vector3<f64>; N]) -> AlongForm<N> {
        let both = std::array::from_fn(|i| match i < N {
            true => self.vectors[i],
            false => rates[i - N],
        });
        let pairs = self.cores.products::<D>();
        let products = pairs.map(|pair| [pair]);
        let moving = pairs.map(|[i, j]| [[N + i, j], [i, N + j]]);
        let moving = std::array::from_fn(|k: usize| match pairs[k][0] == pairs[k][1] {
            true => &moving[k][..1],
            false => &moving[k][..],
        });
        let mut sum = OfDotProducts::<K>::new(both);
        sum.add(moving, products.each_ref().map(|p| &p[..]), |_| {
            self.closest.slopes
        });
        AlongForm {
            rate: sum.value,
            gradient: std::array::from_fn(|i| sum.gradient[i]),
            hessian: std::array::from_fn(|i| std::array::from_fn(|j| sum.hessian[i][j])),
        }
    }
}
