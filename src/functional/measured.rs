//! Elements of one kind as a quantity that is read by itself.

use crate::functional::border::{QuantityBorder, Rates};
use crate::functional::scatter::{ALL, FirstSums, Places, Slots};
use crate::functional::{
    Couplings, Group, Horizon, Kernel, Measure, Order, Outer, Sample, Scatter, Stencil,
    SumDerivatives, VectorArg,
};
use crate::math::{Derivatives, Matrix, Vector};

/// The gradient of a quantity.
struct Gradient<'a, K: Kernel> {
    places: Places<'a, K>,
    c: f64,
    to: FirstSums<'a>,
}

impl<K: Kernel> Scatter for Gradient<'_, K> {
    const ORDER: Option<Order> = Some(Order::Gradient);

    fn plain<D: Derivatives>(&mut self, d: &D) {
        self.places.first(self.c, ALL, d, &mut self.to);
    }

    fn along<D: Derivatives, W: Derivatives>(&mut self, _: &D, _: &W) {}
}

/// ∇E·Πv of the rates v that a quantity E reads.
struct AlongRates<'a, K: Kernel> {
    v: Rates<'a, K>,
    sum: f64,
}

impl<K: Kernel> Scatter for AlongRates<'_, K> {
    const ORDER: Option<Order> = Some(Order::Gradient);

    fn plain<D: Derivatives>(&mut self, d: &D) {
        self.sum += self.v.along_gradient(d);
    }

    fn along<D: Derivatives, W: Derivatives>(&mut self, _: &D, _: &W) {}
}

/// The gradient and Hessian of a function of a quantity.
struct Weighted<'a, K: Kernel> {
    places: Places<'a, K>,
    scale: f64,
    outer: Outer,
    /// Rates that the quantity reads, where derivatives by the length of the interval are asked for.
    rates: Option<Rates<'a, K>>,
    h: f64,
    part: &'a mut SumDerivatives,
}

impl<K: Kernel> Weighted<'_, K> {
    fn add<D: Derivatives>(&mut self, c: f64, d: &D) {
        let part = &mut *self.part;
        self.places.first(c, ALL, d, &mut part.first());
        if K::DEGREE >= 2 {
            self.places.second(c, ALL, ALL, d, part);
        }
        if let Some(v) = &self.rates {
            let c = c / self.h;
            let border = QuantityBorder { plain: d, v };
            self.places.first(-c, ALL, &border, &mut part.by_horizon());
            part.horizon += c * (2.0 * v.along_gradient(d) + v.form(d, v)) / self.h;
        }
    }
}

impl<K: Kernel> Group<K> {
    /// All that its elements read of vectors.
    fn read(&self) -> impl Iterator<Item = VectorArg> + '_ {
        self.elements
            .iter()
            .flat_map(|e| (0..e.vectors() * K::READINGS).map(move |i| e.vector(i)))
    }
}

impl<K: Kernel> Scatter for Weighted<'_, K> {
    const ORDER: Option<Order> = Some(Order::Hessian);

    fn plain<D: Derivatives>(&mut self, d: &D) {
        let Outer { slope, curvature } = self.outer;
        if curvature == 0.0 {
            return self.add(self.scale * slope, d);
        }
        let outer = Outer {
            slope: self.scale * slope,
            curvature: self.scale * self.scale * curvature,
        };
        self.add(1.0, &OfQuantity { outer, of: d });
    }

    fn along<D: Derivatives, W: Derivatives>(&mut self, _: &D, _: &W) {}
}

impl<K: Kernel> Measure for Group<K> {
    fn couple(&self, couplings: &mut Couplings, slots: &mut Vec<u32>) {
        self.hand_over(&mut |coupling| slots.push(couplings.add(coupling)));
    }

    fn vectors(&self) -> Vec<usize> {
        let elements = self.elements.iter();
        let read = elements.flat_map(|e| (0..e.vectors()).map(move |a| e.vector(a).vector));
        read.collect()
    }

    fn scalars(&self) -> Vec<usize> {
        self.scalars_read()
    }

    fn not_by_squares(&self) -> Vec<usize> {
        self.scalars_not_by_squares()
    }

    fn reads(&self, side: usize) -> bool {
        self.read().any(|arg| arg.stencil.reads(side))
    }

    fn reads_rates(&self) -> bool {
        self.read().any(|arg| arg.stencil == Stencil::Rate)
    }

    fn value(&self, sample: &Sample<'_>) -> f64 {
        let value = |element: &K| element.energy(sample);
        self.scale * self.elements.iter().map(value).sum::<f64>()
    }

    fn by_duration(&self, sample: &Sample<'_>) -> f64 {
        let mut sum = 0.0;
        for element in &self.elements {
            let mut storage = K::Storage::default();
            element.prepare(Order::Gradient, sample, &mut storage);
            let v = Rates::new(element, sample);
            let mut along = AlongRates::<K> { v, sum };
            element.derivatives(Order::Gradient, sample, &storage, &mut along);
            sum = along.sum;
        }
        -self.scale * sum / sample.h
    }

    fn gradient(&self, sample: &Sample<'_>, forces: &mut [Vec<Vector>; 2], rows: &mut [f64]) {
        let order = Order::Gradient;
        for element in &self.elements {
            let mut storage = K::Storage::default();
            element.prepare(order, sample, &mut storage);
            let mut gradient = Gradient::<K> {
                places: Places::new(element, Slots::default(), sample),
                c: self.scale,
                to: FirstSums {
                    forces: &mut *forces,
                    rows: &mut *rows,
                },
            };
            element.derivatives(order, sample, &storage, &mut gradient);
        }
    }

    fn add_function(
        &self,
        outer: Outer,
        sample: &Sample<'_>,
        slots: &[u32],
        part: &mut SumDerivatives,
    ) {
        let is_one = self.elements.len() == 1;
        debug_assert!(outer.curvature == 0.0 || is_one, "a sum has one square");
        let order = Order::Hessian;
        let is_free = sample.horizon == Horizon::Free && self.reads_rates();
        self.each(
            order,
            sample,
            slots,
            || true,
            |element, places, storage| {
                let mut weighted = Weighted {
                    places,
                    scale: self.scale,
                    outer,
                    rates: is_free.then(|| Rates::new(element, sample)),
                    h: sample.h,
                    part: &mut *part,
                };
                element.derivatives(order, sample, storage, &mut weighted);
            },
        );
    }
}

/// Derivatives of c(m) from those of m.
pub(super) struct OfQuantity<'a, D> {
    pub(super) outer: Outer,
    pub(super) of: &'a D,
}

impl<D: Derivatives> Derivatives for OfQuantity<'_, D> {
    fn force(&self, i: usize) -> Vector {
        self.of.force(i) * self.outer.slope
    }

    fn row(&self, s: usize) -> f64 {
        self.of.row(s) * self.outer.slope
    }

    fn block(&self, i: usize, j: usize) -> Matrix {
        let square = self.of.force(i) * self.of.force(j).transpose();
        self.of.block(i, j) * self.outer.slope + square * self.outer.curvature
    }

    fn column(&self, i: usize, s: usize) -> Vector {
        let square = self.of.force(i) * self.of.row(s);
        self.of.column(i, s) * self.outer.slope + square * self.outer.curvature
    }

    fn entry(&self, s: usize, t: usize) -> f64 {
        let square = self.of.row(s) * self.of.row(t);
        self.of.entry(s, t) * self.outer.slope + square * self.outer.curvature
    }
}

/// An element of which a curved function is taken: all its arguments couple.
#[derive(Clone, Debug)]
pub struct Curved<K>(pub K);

impl<K: Kernel> Kernel for Curved<K> {
    type Storage = K::Storage;

    const READINGS: usize = K::READINGS;

    fn vectors(&self) -> usize {
        self.0.vectors()
    }

    fn scalars(&self) -> usize {
        self.0.scalars()
    }

    fn vector(&self, i: usize) -> VectorArg {
        self.0.vector(i)
    }

    fn scalar(&self, s: usize) -> Option<(usize, f64)> {
        self.0.scalar(s)
    }

    fn energy(&self, sample: &Sample<'_>) -> f64 {
        self.0.energy(sample)
    }

    fn prepare(&self, order: Order, sample: &Sample<'_>, storage: &mut K::Storage) {
        self.0.prepare(order, sample, storage);
    }

    fn derivatives<S: Scatter>(
        &self,
        order: Order,
        sample: &Sample<'_>,
        storage: &K::Storage,
        to: &mut S,
    ) {
        self.0.derivatives(order, sample, storage, to);
    }
}
