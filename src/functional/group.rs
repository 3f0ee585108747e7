//! Elements of one kind as a term of the sum: static inside, one virtual call outside.

use crate::functional::border::{Border, Rates};
use crate::functional::scatter::{ALL, Places, Slots, couple};
use crate::functional::{
    Coupling, Horizon, Kernel, Order, Output, Sample, Scatter, Term, TermKind,
};
use crate::math::{Derivatives, Vector, has_pool, join};
use crate::stop;
use rayon::prelude::*;
use std::fmt;
use std::ops::Range;
use std::sync::{Arc, Mutex};

/// Elements of one kind under one name.
pub struct Group<K: Kernel> {
    name: String,
    pub(super) scale: f64,
    site: Site,
    pub(super) elements: Vec<K>,
    prepared: Batches<K::Storage>,
}

/// Place of a group in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Site {
    Intervals,
    Instants,
}

impl<K: Kernel> fmt::Debug for Group<K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({} elements)", self.name, self.elements.len())
    }
}

impl<K: Kernel> Group<K> {
    /// `scale · h · Σ E` over an interval.
    pub fn intervals(name: &str, scale: f64, elements: Vec<K>) -> Self {
        Self::new(name, scale, Site::Intervals, elements)
    }

    /// `scale · Σ E` at an instant.
    pub fn instants(name: &str, scale: f64, elements: Vec<K>) -> Self {
        Self::new(name, scale, Site::Instants, elements)
    }

    fn new(name: &str, scale: f64, site: Site, elements: Vec<K>) -> Self {
        Self {
            name: name.to_owned(),
            scale,
            site,
            elements,
            prepared: Batches::default(),
        }
    }

    /// Visits the couplings of the elements.
    pub(super) fn hand_over(&self, to: &mut dyn FnMut(Option<Coupling>)) {
        // Multipliers do not meet in second derivatives.
        let has_scalars = self.site == Site::Intervals;
        for element in &self.elements {
            couple(element, has_scalars, to);
        }
    }

    /// Scalars of the site that elements read, each once.
    pub(super) fn scalars_read(&self) -> Vec<usize> {
        let mut scalars = Vec::new();
        for element in &self.elements {
            for s in 0..element.scalars() {
                if let Some((scalar, _)) = element.scalar(s) {
                    scalars.push(scalar);
                }
            }
        }
        scalars.sort_unstable();
        scalars.dedup();
        scalars
    }

    /// Those of them that enter otherwise than by their squares.
    pub(super) fn scalars_not_by_squares(&self) -> Vec<usize> {
        match K::OF_SQUARES {
            true => Vec::new(),
            false => self.scalars_read(),
        }
    }

    /// Hands over the derivatives of each element, with the slots of its couplings, in their order, as long as `goes_on` says so; returns true
    /// if it handed over all.
    #[inline(always)]
    pub(super) fn each(
        &self,
        order: Order,
        sample: &Sample<'_>,
        mut slots: &[u32],
        goes_on: impl Fn() -> bool,
        mut receive: impl FnMut(&K, Places<'_, K>, &K::Storage) + Send,
    ) -> bool {
        self.prepared.each(
            &self.elements,
            goes_on,
            |element, storage| element.prepare(order, sample, storage),
            |element, storage| {
                let own = Slots::take(element, &mut slots);
                receive(element, Places::new(element, own, sample), storage);
            },
        )
    }
}

/// Names of the parts of an energy, or its own.
fn names_of_parts(name: &str, parts: Option<[&str; 2]>) -> Vec<String> {
    match parts {
        Some(parts) => parts.map(|part| format!("{name} {part}")).to_vec(),
        None => vec![name.to_owned()],
    }
}

/// The derivatives of `c E`, the rows of equations and both contracted with the direction.
struct Action<'a, K: Kernel> {
    element: &'a K,
    places: Places<'a, K>,
    /// Factor of E, with the length of the interval.
    c: f64,
    /// Factor without it.
    scale: f64,
    order: Order,
    sample: &'a Sample<'a>,
    /// True if derivatives by the length of the interval are asked for.
    is_free: bool,
    out: &'a mut Output,
}

/// Arguments that give equations.
#[inline(always)]
fn rows<K: Kernel>(element: &K) -> Range<usize> {
    match K::VIRTUAL {
        0 => ALL,
        _ => 0..element.virtuals(),
    }
}

/// Arguments that are unknowns.
#[inline(always)]
fn unknowns<K: Kernel>(element: &K) -> Range<usize> {
    element.virtuals()..usize::MAX
}

impl<K: Kernel> Scatter for Action<'_, K> {
    const OF_PARAMETERS: bool = false;

    #[inline(always)]
    fn plain<D: Derivatives>(&mut self, d: &D) {
        let part = &mut self.out.plain;
        let rows = || rows(self.element);
        self.places.first(self.c, rows(), d, &mut part.first());
        if const { !D::HAS_SECOND } || self.order < Order::Hessian {
            return;
        }
        if K::DEGREE >= 2 {
            let unknowns = unknowns(self.element);
            self.places.second(self.c, rows(), unknowns, d, part);
        }
        if self.is_free {
            let v = &Rates::<K>::new(self.element, self.sample);
            let along = None::<(_, &D)>;
            let border = Border { of: d, v, along };
            let to = &mut part.by_horizon();
            self.places.first(self.scale, rows(), &border, to);
        }
    }

    #[inline(always)]
    fn along<D: Derivatives, W: Derivatives>(&mut self, d: &D, along: &W) {
        let part = &mut self.out.contracted;
        let unknowns = || unknowns(self.element);
        self.places
            .first(self.c, unknowns(), along, &mut part.first());
        if K::DEGREE >= 3 {
            self.places
                .second(self.c, unknowns(), unknowns(), along, part);
        }
        if !self.is_free {
            return;
        }
        let v = &Rates::<K>::new(self.element, self.sample);
        let w = &Rates::along(self.element, self.sample);
        // At δx = w a virtual work is its own contraction.
        let plain = (K::VIRTUAL == 0).then_some((w, d));
        let mut form = v.form(along, v);
        if plain.is_some() {
            form += 2.0 * w.form(d, v);
        }
        part.horizon += self.scale * form / self.sample.h;
        let border = Border {
            of: along,
            v,
            along: plain,
        };
        let to = &mut part.by_horizon();
        self.places.first(self.scale, unknowns(), &border, to);
    }
}

impl<K: Kernel> Term for Group<K> {
    fn name(&self) -> &str {
        &self.name
    }

    fn elements(&self) -> usize {
        self.elements.len()
    }

    fn couple(&self, to: &mut dyn FnMut(Option<Coupling>)) {
        self.hand_over(to);
    }

    fn reading(&self, is_meant: &dyn Fn(usize) -> bool) -> Option<Arc<dyn Term>> {
        let reads = |element: &&K| {
            let mut vectors = 0..element.vectors();
            vectors.any(|a| is_meant(element.vector(a).vector))
        };
        let elements: Vec<_> = self.elements.iter().filter(reads).cloned().collect();
        let group = |elements| Self::new(&self.name, self.scale, self.site, elements);
        (!elements.is_empty()).then(|| Arc::new(group(elements)) as Arc<dyn Term>)
    }

    fn is_weight(&self) -> bool {
        self.kind() == TermKind::Potential && K::DEGREE == 1
    }

    fn not_by_squares(&self) -> Vec<usize> {
        self.scalars_not_by_squares()
    }

    fn kind(&self) -> TermKind {
        match (self.site, K::VIRTUAL) {
            (Site::Instants, _) => TermKind::Constraint,
            (Site::Intervals, 0) if self.scale > 0.0 => TermKind::Kinetic,
            (Site::Intervals, 0) => TermKind::Potential,
            (Site::Intervals, _) if K::APPLIED => TermKind::AppliedWork,
            (Site::Intervals, _) => TermKind::Dissipation,
        }
    }

    fn energy(&self, sample: &Sample<'_>) -> f64 {
        let elements = self.elements.iter();
        elements.map(|element| element.energy(sample)).sum()
    }

    fn energy_parts(&self) -> Vec<String> {
        names_of_parts(&self.name, K::PARTS)
    }

    fn energies(&self, sample: &Sample<'_>, out: &mut Vec<f64>) {
        let total = self.energy(sample);
        if K::PARTS.is_none() {
            out.push(total);
            return;
        }
        let elements = self.elements.iter();
        let first: f64 = elements.map(|e| e.first_part(sample)).sum();
        out.extend([first, total - first]);
    }

    fn momentum(&self, x: &[Vector], v: &[Vector], out: &mut [Vector]) {
        if self.kind() == TermKind::Kinetic {
            for element in &self.elements {
                element.momentum(self.scale, x, v, out);
            }
        }
    }

    fn momentum_along(&self, at: [&[Vector]; 2], by: [&[Vector]; 2], out: &mut [Vector]) {
        if self.kind() == TermKind::Kinetic {
            for element in &self.elements {
                element.momentum_along(self.scale, at, by, out);
            }
        }
    }

    fn evaluate(&self, order: Order, sample: &Sample<'_>, slots: &[u32], out: &mut Output) {
        let c = match self.site {
            Site::Intervals => self.scale * sample.h,
            Site::Instants => self.scale,
        };
        let is_free =
            K::BY_DURATION && sample.horizon == Horizon::Free && self.site == Site::Intervals;
        let is_at_nodes = out.plain.nodes.is_some();
        let goes_on = || !(is_at_nodes && stop::reason().is_some());
        let is_whole = self.each(order, sample, slots, goes_on, |element, places, storage| {
            if let Some(nodes) = out
                .plain
                .nodes
                .as_mut()
                .filter(|nodes| nodes.pressures.is_some())
            {
                places.volume(c, sample, nodes);
            }
            let mut action = Action {
                element,
                places,
                c,
                scale: self.scale,
                order,
                sample,
                is_free,
                out: &mut *out,
            };
            element.derivatives(order, sample, storage, &mut action);
        });
        if let Some(nodes) = out.plain.nodes.as_mut() {
            nodes.is_whole &= is_whole;
        }
    }
}

/// Number of elements from which on they are evaluated on all cores.
const PARALLEL: usize = 256;
/// Elements of a stretch: the derivatives of two are kept, those that are computed and those that are added.
const STRETCH: usize = 128;
/// Elements that one thread takes at least.
const LEAST: usize = 16;

/// Derivatives of the elements of two stretches, kept for the next evaluation.
#[derive(Debug)]
pub(super) struct Batches<L>(Mutex<Vec<L>>);

impl<L> Default for Batches<L> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<L: Default + Send + Sync> Batches<L> {
    /// `add` takes each element with what `compute` makes of it, in their order, as long as `goes_on` says so before each stretch; returns
    /// true if it took all. Where nothing is kept there is nothing to compute ahead.
    #[inline(always)]
    pub(super) fn each<E: Sync>(
        &self,
        elements: &[E],
        goes_on: impl Fn() -> bool,
        compute: impl Fn(&E, &mut L) + Sync,
        mut add: impl FnMut(&E, &L) + Send,
    ) -> bool {
        // A constant, so that loops over threads are compiled only for what is kept.
        if const { size_of::<L>() > 0 }
            && elements.len() >= PARALLEL
            && has_pool()
            && let Ok(mut locals) = self.0.try_lock()
        {
            return Self::each_on_all_cores(&mut locals, elements, goes_on, compute, add);
        }
        let mut local = L::default();
        for stretch in elements.chunks(STRETCH) {
            if !goes_on() {
                return false;
            }
            for element in stretch {
                compute(element, &mut local);
                add(element, &local);
            }
        }
        true
    }

    /// One thread adds a stretch while the others compute the next one.
    fn each_on_all_cores<E: Sync>(
        locals: &mut Vec<L>,
        elements: &[E],
        goes_on: impl Fn() -> bool,
        compute: impl Fn(&E, &mut L) + Sync,
        mut add: impl FnMut(&E, &L) + Send,
    ) -> bool {
        locals.resize_with(2 * STRETCH, L::default);
        let (mut computed, mut free) = locals.split_at_mut(STRETCH);
        let fill = |stretch: &[E], locals: &mut [L]| {
            let pairs = stretch.par_iter().with_min_len(LEAST);
            pairs
                .zip(locals.par_iter_mut())
                .for_each(|(element, local)| compute(element, local));
        };
        let mut stretches = elements.chunks(STRETCH);
        let mut next = stretches.next();
        let mut now: &[E] = &[];
        while goes_on() {
            let mut add_all = || {
                for (element, local) in now.iter().zip(computed.iter()) {
                    add(element, local);
                }
            };
            let Some(stretch) = next else {
                add_all();
                return true;
            };
            join(add_all, || fill(stretch, free));
            std::mem::swap(&mut computed, &mut free);
            (now, next) = (stretch, stretches.next());
        }
        false
    }
}
