//! A term of a sum, and the sum.

use crate::functional::{BlockMask, Blocks, Coupling, Couplings, NodeBlocks};
use crate::math::{Matrix, Vector};
use nalgebra::SMatrix;
use std::fmt::Debug;
use std::sync::{Arc, OnceLock};

/// Highest order of the derivatives that are asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Order {
    /// Forces: first derivatives.
    Gradient,
    /// Also second derivatives.
    Hessian,
    /// Also both contracted with a direction.
    Third,
}

/// Input of a term on one interval.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    /// Vectors at t_k and t_{k+1}.
    pub vectors: [&'a [Vector]; 2],
    /// Rates of the vectors along the direction.
    pub along: [&'a [Vector]; 2],
    /// Scalars of the site: voltages and potentials of the interval, multipliers of the instant.
    pub scalars: &'a [f64],
    /// Rates of the scalars along the direction.
    pub scalars_along: &'a [f64],
    /// Interval length in ms.
    pub h: f64,
    /// Interval length as a given number or an argument.
    pub horizon: Horizon,
    /// Blocks that are asked for.
    pub sides: BlockMask,
    /// Functions of the measures of the site that join the contraction at order `Third`.
    pub outer: &'a [Outer],
}

impl<'a> Sample<'a> {
    /// One instant by itself, in an interval of 1 ms that begins and ends there.
    pub fn of_instant(vectors: &'a [Vector], scalars: &'a [f64]) -> Self {
        Self {
            vectors: [vectors, vectors],
            along: [vectors, vectors],
            ..Self::of_interval(scalars, 1.0)
        }
    }

    /// A given interval of h ms with its scalars, all blocks, without the vectors at its ends.
    pub fn of_interval(scalars: &'a [f64], h: f64) -> Self {
        Self {
            vectors: [&[]; 2],
            along: [&[]; 2],
            scalars,
            scalars_along: &[],
            h,
            horizon: Horizon::Given,
            sides: BlockMask::ALL,
            outer: &[],
        }
    }
}

/// Role of the interval length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Horizon {
    /// A given number.
    Given,
    /// An argument: derivatives with respect to it are asked for.
    Free,
}

/// Sums to which a term adds its derivatives.
#[derive(Clone, Debug)]
pub struct Output {
    /// The derivatives.
    pub plain: SumDerivatives,
    /// The derivatives contracted with the direction.
    pub contracted: SumDerivatives,
}

/// Role of a term in the energy balance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TermKind {
    /// Kinetic energy.
    Kinetic,
    /// Potential energy.
    Potential,
    /// Virtual work of loads without a potential: of forces that follow what they act on.
    AppliedWork,
    /// Virtual work of forces that dissipate energy.
    Dissipation,
    /// Constraints times multipliers.
    Constraint,
}

impl TermKind {
    /// Returns true if its forces have no potential.
    pub const fn is_virtual_work(self) -> bool {
        matches!(self, Self::AppliedWork | Self::Dissipation)
    }

    /// Returns true if its forces act at rest.
    pub const fn acts_at_rest(self) -> bool {
        matches!(self, Self::Potential | Self::AppliedWork)
    }
}

/// A term of a sum: all elements of one kind at one site.
pub trait Term: Debug + Send + Sync {
    /// Name for reports.
    fn name(&self) -> &str;

    /// Returns the number of elements.
    fn elements(&self) -> usize;

    /// Visits the coupled argument pairs of all elements, in the order in which `evaluate` reads their slots; `None` for uncoupled pairs.
    fn couple(&self, to: &mut dyn FnMut(Option<Coupling>));

    /// The elements that read one of some vectors as a term; none where there are no such elements.
    fn reading(&self, is_meant: &dyn Fn(usize) -> bool) -> Option<Arc<dyn Term>>;

    /// Returns the role of the term in the energy balance.
    fn kind(&self) -> TermKind;

    /// Returns true if it is the potential of weights: linear in places.
    fn is_weight(&self) -> bool {
        false
    }

    /// Scalars that enter otherwise than by their squares, to the first power.
    fn not_by_squares(&self) -> Vec<usize> {
        Vec::new()
    }

    /// Kinetic or potential energy at the midpoint of an interval in mJ; the work that a virtual work does over it.
    fn energy(&self, sample: &Sample<'_>) -> f64;

    /// Names of the parts of its energy, as reports show them.
    fn energy_parts(&self) -> Vec<String> {
        vec![self.name().to_owned()]
    }

    /// The parts of its energy, in the order of their names.
    fn energies(&self, sample: &Sample<'_>, out: &mut Vec<f64>) {
        out.push(self.energy(sample));
    }

    /// Adds the momenta ∂T/∂ẋ at vectors x with rates v.
    fn momentum(&self, x: &[Vector], v: &[Vector], out: &mut [Vector]);

    /// Adds the derivatives of the momenta at vectors and rates along changes `by` of both.
    fn momentum_along(&self, at: [&[Vector]; 2], by: [&[Vector]; 2], out: &mut [Vector]);

    /// Adds the derivatives; `slots` are those of its couplings, and are not read where no blocks are asked for.
    fn evaluate(&self, order: Order, sample: &Sample<'_>, slots: &[u32], out: &mut Output);
}

/// A quantity at one site that is read by itself: a path limit, a goal.
pub trait Measure: Debug + Send + Sync {
    /// Registers what the quantity couples, and lists the slots in the order in which they are read.
    fn couple(&self, couplings: &mut Couplings, slots: &mut Vec<u32>);

    /// Vectors it reads.
    fn vectors(&self) -> Vec<usize>;

    /// Scalars it reads.
    fn scalars(&self) -> Vec<usize>;

    /// Scalars that enter otherwise than by their squares, to the first power.
    fn not_by_squares(&self) -> Vec<usize>;

    /// Returns true if it reads the instant k + side.
    fn reads(&self, side: usize) -> bool;

    /// Returns true if it reads rates, so that it depends on the length of the interval.
    fn reads_rates(&self) -> bool;

    /// Its value.
    fn value(&self, sample: &Sample<'_>) -> f64;

    /// Its derivative by the length of the interval.
    fn by_duration(&self, sample: &Sample<'_>) -> f64;

    /// Adds its gradient.
    fn gradient(&self, sample: &Sample<'_>, forces: &mut [Vec<Vector>; 2], rows: &mut [f64]);

    /// Adds the gradient and Hessian of a function of it, of which the gradient by the length of the interval is left out; `slots` are those of
    /// its couplings.
    fn add_function(
        &self,
        outer: Outer,
        sample: &Sample<'_>,
        slots: &[u32],
        part: &mut SumDerivatives,
    );
}

/// A sum of terms at one site, and the quantities that are measured there.
#[derive(Debug, Default)]
pub struct Functional {
    /// The terms.
    pub terms: Vec<Arc<dyn Term>>,
    /// The quantities.
    pub measures: Vec<Box<dyn Measure>>,
    laid: OnceLock<Laid>,
    /// Number of vectors.
    pub vectors: usize,
    /// Number of scalars of the site.
    pub scalars: usize,
}

/// Couplings of a sum, laid down where blocks are asked for.
#[derive(Debug)]
struct Laid {
    couplings: Couplings,
    /// Slots of the couplings of each term.
    effect_slots: Vec<Vec<u32>>,
    /// Slots of the couplings of each quantity.
    measure_slots: Vec<Vec<u32>>,
}

impl Functional {
    /// A sum over terms that read `vectors` vectors and `scalars` scalars.
    pub fn new(
        terms: Vec<Arc<dyn Term>>,
        measures: Vec<Box<dyn Measure>>,
        vectors: usize,
        scalars: usize,
    ) -> Self {
        Self {
            terms,
            measures,
            laid: OnceLock::new(),
            vectors,
            scalars,
        }
    }

    fn laid(&self) -> &Laid {
        self.laid.get_or_init(|| {
            let mut couplings = Couplings::default();
            let mut of_term = |term: &Arc<dyn Term>| {
                let mut slots = Vec::new();
                term.couple(&mut |coupling| slots.push(couplings.add(coupling)));
                slots.shrink_to_fit();
                slots
            };
            let effect_slots = self.terms.iter().map(&mut of_term).collect();
            let measures = self.measures.iter().map(|measure| {
                let mut slots = Vec::new();
                measure.couple(&mut couplings, &mut slots);
                slots
            });
            let measure_slots = measures.collect();
            Laid {
                couplings,
                effect_slots,
                measure_slots,
            }
        })
    }

    /// Couplings of vectors and scalars in terms and quantities.
    pub fn couplings(&self) -> &Couplings {
        &self.laid().couplings
    }

    /// The terms with the slots of their couplings.
    pub fn terms(&self) -> impl Iterator<Item = (&dyn Term, &[u32])> {
        self.with_slots(true)
    }

    /// The same, without slots where no blocks are asked for.
    fn with_slots(&self, is_asked: bool) -> impl Iterator<Item = (&dyn Term, &[u32])> {
        let laid = is_asked.then(|| self.laid());
        let slots = move |i: usize| laid.map_or(&[][..], |laid| &laid.effect_slots[i]);
        let terms = self.terms.iter().enumerate();
        terms.map(move |(i, term)| (term.as_ref(), slots(i)))
    }

    /// Storage for the derivatives up to a order.
    pub fn output(&self, order: Order) -> Output {
        let part = |least: Order| {
            let couplings = (order >= least).then(|| self.couplings());
            SumDerivatives::new(self.vectors, self.scalars, couplings)
        };
        Output {
            plain: part(Order::Hessian),
            contracted: if order == Order::Third {
                part(Order::Third)
            } else {
                SumDerivatives::default()
            },
        }
    }

    /// The derivatives of what acts at rest up to the second, on one interval, in place of the contents of `out`.
    pub fn evaluate_at_rest(&self, sample: &Sample<'_>, out: &mut Output) {
        out.plain.clear(true);
        let has_blocks = out.plain.nodes.is_none();
        let at_rest = |(term, _): &(&dyn Term, &[u32])| term.kind().acts_at_rest();
        for (term, slots) in self.with_slots(has_blocks).filter(at_rest) {
            term.evaluate(Order::Hessian, sample, slots, out);
        }
    }

    /// The derivatives on one interval, in place of the contents of `out`.
    pub fn evaluate(&self, order: Order, sample: &Sample<'_>, out: &mut Output) {
        out.plain.clear(order >= Order::Hessian);
        if order == Order::Third {
            out.contracted.clear(true);
        }
        let has_blocks = order >= Order::Hessian && out.plain.nodes.is_none();
        for (term, slots) in self.with_slots(has_blocks) {
            term.evaluate(order, sample, slots, out);
        }
        if order == Order::Third {
            let measures = self.measures.iter().zip(&self.laid().measure_slots);
            for ((measure, slots), &outer) in measures.zip(sample.outer) {
                if !outer.is_zero() {
                    measure.add_function(outer, sample, slots, &mut out.contracted);
                }
            }
        }
    }
}

/// First and second derivatives of a sum on one interval.
#[derive(Clone, Debug, Default)]
pub struct SumDerivatives {
    /// ∂/∂x_k and ∂/∂x_{k+1}.
    pub forces: [Vec<Vector>; 2],
    /// ∂/∂s.
    pub rows: Vec<f64>,
    /// Second derivatives.
    pub blocks: Blocks,
    /// Matrix of nodes on box grids to which second derivatives are added in place of the blocks.
    pub nodes: Option<NodeBlocks>,
    /// ∂²/∂x∂h at both instants.
    pub horizon_forces: [Vec<Vector>; 2],
    /// ∂²/∂s∂h.
    pub horizon_rows: Vec<f64>,
    /// ∂²/∂h².
    pub horizon: f64,
}

impl SumDerivatives {
    /// Zeros for first derivatives, and for second ones at these couplings.
    pub fn new(vectors: usize, scalars: usize, couplings: Option<&Couplings>) -> Self {
        let zeros = || vec![Vector::zeros(); vectors];
        let blocks = |c: &Couplings| Blocks {
            full: vec![[Matrix::zeros(); 4]; c.full.len()],
            isotropic: vec![[0.0; 4]; c.isotropic.len()],
            mixed: vec![[Vector::zeros(); 2]; c.mixed.len()],
            scalars: vec![0.0; c.scalars.len()],
        };
        Self {
            forces: [zeros(), zeros()],
            rows: vec![0.0; scalars],
            blocks: couplings.map(blocks).unwrap_or_default(),
            nodes: None,
            horizon_forces: [zeros(), zeros()],
            horizon_rows: vec![0.0; scalars],
            horizon: 0.0,
        }
    }

    /// Back to zero, first derivatives alone or second ones too.
    pub fn clear(&mut self, second: bool) {
        self.forces.iter_mut().for_each(|side| clear(side));
        self.rows.fill(0.0);
        if !second {
            return;
        }
        clear(self.blocks.full.as_flattened_mut());
        self.blocks.isotropic.as_flattened_mut().fill(0.0);
        clear(self.blocks.mixed.as_flattened_mut());
        self.blocks.scalars.fill(0.0);
        self.horizon_forces.iter_mut().for_each(|side| clear(side));
        self.horizon_rows.fill(0.0);
        self.horizon = 0.0;
    }
}

/// Number by number, which is one call for all bytes.
fn clear<const R: usize, const C: usize>(list: &mut [SMatrix<f64, R, C>]) {
    for one in list {
        one.as_mut_slice().fill(0.0);
    }
}

/// Derivatives of a function c of a quantity m by its value: `∇²c(m) = c′ ∇²m + c″ ∇m ∇mᵀ`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outer {
    /// c′: the costate of a constraint, the slope of a cost.
    pub slope: f64,
    /// c″: zero of a constraint.
    pub curvature: f64,
}

impl Outer {
    /// A function that is linear in the quantity.
    pub fn linear(slope: f64) -> Self {
        Self {
            slope,
            curvature: 0.0,
        }
    }

    /// Returns true if nothing depends on the quantity.
    pub fn is_zero(self) -> bool {
        self.slope == 0.0 && self.curvature == 0.0
    }
}
