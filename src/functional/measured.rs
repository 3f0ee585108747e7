//! Elements of one kind as a quantity that is read by itself.

use crate::functional::border::{QuantityBorder, Rates};
use crate::functional::scatter::{ALL, FirstSums, Places, Slots};
use crate::functional::{
    Couplings, Group, Horizon, Kernel, Measure, Order, Outer, Sample, Scatter, Stencil,
    SumDerivatives, VectorArg,
};
use crate::math::{Derivatives, Vector};

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

/// The gradient and Hessian of a quantity times a factor.
struct Weighted<'a, K: Kernel> {
    places: Places<'a, K>,
    c: f64,
    /// Rates that the quantity reads, where derivatives by the length of the interval are asked for.
    rates: Option<Rates<'a, K>>,
    h: f64,
    part: &'a mut SumDerivatives,
}

impl<K: Kernel> Scatter for Weighted<'_, K> {
    const ORDER: Option<Order> = Some(Order::Hessian);

    fn plain<D: Derivatives>(&mut self, d: &D) {
        let (c, part) = (self.c, &mut *self.part);
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

    fn along<D: Derivatives, W: Derivatives>(&mut self, _: &D, _: &W) {}
}

impl<K: Kernel> Group<K> {
    /// All that its elements read of vectors.
    fn read(&self) -> impl Iterator<Item = VectorArg> + '_ {
        self.elements
            .iter()
            .flat_map(|e| (0..e.vectors() * K::READINGS).map(move |i| e.vector(i)))
    }
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
        debug_assert!(outer.curvature == 0.0, "a sum takes curved functions");
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
                    c: self.scale * outer.slope,
                    rates: is_free.then(|| Rates::new(element, sample)),
                    h: sample.h,
                    part: &mut *part,
                };
                element.derivatives(order, sample, storage, &mut weighted);
            },
        );
    }
}
