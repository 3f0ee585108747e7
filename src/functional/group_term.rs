//! A group of elements as an effect, and as a measure.

use crate::energy::Energy;
use crate::functional::group::{Element, Group, Site};
use crate::functional::{Couplings, Kind, Measure, Order, Output, Part, Sample, Stencil, Term};
use crate::math::Vector;
use nalgebra::SVector;

impl<E, const M: usize, const NV: usize, const NS: usize> Term for Group<E, M, NV, NS>
where
    E: Energy<M>,
{
    fn name(&self) -> &str {
        &self.name
    }

    fn elements(&self) -> usize {
        self.elements.len()
    }

    fn couple(&self, couplings: &mut Couplings, slots: &mut Vec<u32>) {
        for element in &self.elements {
            self.couple_element(element, couplings, slots);
        }
    }

    fn kind(&self) -> Kind {
        match (self.site, E::VIRTUAL) {
            (Site::Instants, _) => Kind::Constraint,
            (Site::Intervals, 0) if self.scale > 0.0 => Kind::Kinetic,
            (Site::Intervals, 0) => Kind::Potential,
            (Site::Intervals, _) => Kind::VirtualWork,
        }
    }

    fn energy(&self, frame: &Sample<'_>) -> f64 {
        let energy = |element: &Element<E, NV, NS>| {
            let (mut p, w) = Self::arguments(element, frame, Order::Gradient);
            for (i, arg) in element.vectors.iter().enumerate().take(E::VIRTUAL) {
                let step = frame.vectors[1][arg.vector] - frame.vectors[0][arg.vector];
                p.fixed_rows_mut::<3>(3 * i).copy_from(&step);
            }
            element.energy.jet::<1>(&p, &w).value
        };
        self.elements.iter().map(energy).sum()
    }

    fn momentum(&self, x: &[Vector], v: &[Vector], out: &mut [Vector]) {
        if self.kind() != Kind::Kinetic {
            return;
        }
        for element in &self.elements {
            let mut p = SVector::<f64, M>::zeros();
            for (i, arg) in element.vectors.iter().enumerate() {
                let value = if arg.stencil == Stencil::Rate {
                    v[arg.vector]
                } else {
                    x[arg.vector]
                };
                p.fixed_rows_mut::<3>(3 * i).copy_from(&value);
            }
            let gradient = element.energy.jet::<1>(&p, &SVector::zeros()).gradient;
            for (i, arg) in element
                .vectors
                .iter()
                .enumerate()
                .filter(|(_, arg)| arg.stencil == Stencil::Rate)
            {
                out[arg.vector] += gradient.fixed_rows::<3>(3 * i) * self.scale;
            }
        }
    }

    fn evaluate(&self, level: Order, frame: &Sample<'_>, slots: &[u32], out: &mut Output) {
        for pair in self.with_slots(slots) {
            match (level, E::VIRTUAL) {
                (Order::Gradient, _) => self.evaluate_element::<1>(pair, level, frame, out),
                (Order::Third, 0) => self.evaluate_element::<3>(pair, level, frame, out),
                _ => self.evaluate_element::<2>(pair, level, frame, out),
            }
        }
    }
}

impl<E, const M: usize, const NV: usize, const NS: usize> Measure for Group<E, M, NV, NS>
where
    E: Energy<M>,
{
    fn couple(&self, couplings: &mut Couplings, slots: &mut Vec<u32>) {
        Term::couple(self, couplings, slots);
    }

    fn vectors(&self) -> Vec<usize> {
        self.elements
            .iter()
            .flat_map(|e| e.vectors.iter().map(|v| v.vector))
            .collect()
    }

    fn scalars(&self) -> Vec<usize> {
        self.elements.iter().flat_map(|e| e.scalars).collect()
    }

    fn reads(&self, side: usize) -> bool {
        let mut args = self.elements.iter().flat_map(|e| &e.vectors);
        args.any(|arg| arg.stencil.reads(side))
    }

    fn value(&self, frame: &Sample<'_>) -> f64 {
        let value = |element: &Element<E, NV, NS>| {
            let (p, w) = Self::arguments(element, frame, Order::Gradient);
            element.energy.jet::<1>(&p, &w).value
        };
        self.scale * self.elements.iter().map(value).sum::<f64>()
    }

    fn gradient(&self, frame: &Sample<'_>, forces: &mut [Vec<Vector>; 2], rows: &mut [f64]) {
        for element in &self.elements {
            let (p, w) = Self::arguments(element, frame, Order::Gradient);
            let jet = element.energy.jet::<1>(&p, &w);
            Self::add_gradient(
                element,
                &jet.gradient,
                self.scale,
                frame.h,
                |_| true,
                forces,
                rows,
            );
        }
    }

    fn add_weighted(&self, weight: f64, frame: &Sample<'_>, slots: &[u32], part: &mut Part) {
        for (element, slots) in self.with_slots(slots) {
            let (p, w) = Self::arguments(element, frame, Order::Gradient);
            let jet = element.energy.jet::<2>(&p, &w);
            let c = self.scale * weight;
            Self::add_gradient(
                element,
                &jet.gradient,
                c,
                frame.h,
                |_| true,
                &mut part.forces,
                &mut part.rows,
            );
            if E::DEGREE >= 2 {
                Self::add_hessian((element, slots), &jet.hessian, c, frame, |_, _| true, part);
            }
        }
    }
}
