//! Elastic and dielectric hexahedra: energies of finite elements as terms of the sum.
//!
//! Nodes are read at the midpoint of an interval, potentials are scalars of the interval: `−h W(x̄, φ)`. A large mesh is
//! evaluated on all cores.

use crate::element::{Dielectric, Elastomer, ElementGeometry, Field, Local, Passive};
use crate::functional::batches::Batches;
use crate::functional::{Couplings, Horizon, Kind, Order, Output, Part, Sample, Term};
use crate::math::Vector;
use std::fmt;

/// No slot.
const NONE: u32 = u32::MAX;

/// One hexahedron: its geometry, its law, and what it reads.
#[derive(Clone, Debug)]
pub struct Hexahedron<F: Electrical> {
    /// Gradients of the shape functions.
    pub shape: ElementGeometry,
    /// The law.
    pub law: Elastomer<F>,
    /// Vectors of the nodes.
    pub nodes: [usize; 8],
    /// Where the potentials of the nodes come from; nothing for a passive element.
    pub terminals: F::Terminals,
}

/// Where the potential of a node comes from: a constant plus a factor times a scalar of the interval.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ScalarArg {
    /// The constant in V.
    pub constant: f64,
    /// Scalar and factor.
    pub scalar: Option<(usize, f64)>,
}

/// How the potentials of an element are wired to the scalars of an interval.
pub trait Electrical: Field {
    /// Whether the nodes have potentials.
    const HAS_POTENTIALS: bool;
    /// One terminal a node, or nothing.
    type Terminals: Clone + fmt::Debug + Send + Sync;

    /// The terminals; none for a passive element.
    fn wires(terminals: &Self::Terminals) -> &[ScalarArg];

    /// Potentials of the nodes.
    fn potentials(potential: impl Fn(usize) -> f64) -> Self::Potentials;

    /// The law without the field.
    fn passive(law: &Elastomer<Self>) -> Elastomer<Passive> {
        Elastomer {
            shear_modulus: law.shear_modulus,
            lame_lambda: law.lame_lambda,
            volume: law.volume,
            field: Passive,
        }
    }
}

impl Electrical for Passive {
    const HAS_POTENTIALS: bool = false;
    type Terminals = ();

    fn wires((): &()) -> &[ScalarArg] {
        &[]
    }

    fn potentials(_: impl Fn(usize) -> f64) {}
}

impl Electrical for Dielectric {
    const HAS_POTENTIALS: bool = true;
    type Terminals = [ScalarArg; 8];

    fn wires(terminals: &[ScalarArg; 8]) -> &[ScalarArg] {
        terminals
    }

    fn potentials(potential: impl Fn(usize) -> f64) -> [f64; 8] {
        std::array::from_fn(potential)
    }
}

/// Slots of a table of all pairs of the eight nodes of an element.
const PAIRS: usize = 64;

/// Hexahedra of one kind.
pub struct Hexahedra<F: Electrical> {
    name: String,
    elements: Vec<Hexahedron<F>>,
    locals: Batches<Local<F>>,
}

impl<F: Electrical> fmt::Debug for Hexahedra<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({} elements)", self.name, self.elements.len())
    }
}

/// Half the sum of both instants.
pub(super) fn middle(vectors: [&[Vector]; 2], nodes: &[usize; 8]) -> [Vector; 8] {
    nodes.map(|v| (vectors[0][v] + vectors[1][v]) * 0.5)
}

impl<F: Electrical> Hexahedra<F> {
    /// Hexahedra under one name.
    pub fn new(name: &str, elements: Vec<Hexahedron<F>>) -> Self {
        Self {
            name: name.to_owned(),
            elements,
            locals: Batches::default(),
        }
    }

    /// Number of slots of an element: pairs of nodes, and of nodes and potentials, and of potentials.
    const fn slots() -> usize {
        if F::HAS_POTENTIALS { 3 * PAIRS } else { PAIRS }
    }

    fn potentials(element: &Hexahedron<F>, scalars: &[f64]) -> F::Potentials {
        let wires = F::wires(&element.terminals);
        F::potentials(|i| {
            let ScalarArg { constant, scalar } = wires[i];
            constant + scalar.map_or(0.0, |(s, factor)| factor * scalars[s])
        })
    }

    fn rates(element: &Hexahedron<F>, along: &[f64]) -> F::Potentials {
        let wires = F::wires(&element.terminals);
        F::potentials(|i| wires[i].scalar.map_or(0.0, |(s, f)| f * along[s]))
    }

    /// Derivatives of one element, up to `Hessian`.
    fn local(element: &Hexahedron<F>, level: Order, frame: &Sample<'_>, local: &mut Local<F>) {
        let x = middle(frame.vectors, &element.nodes);
        let potentials = Self::potentials(element, frame.scalars);
        match level {
            Order::Gradient => element.law.gradient(&element.shape, &x, &potentials, local),
            _ => element.law.tangent(&element.shape, &x, &potentials, local),
        }
    }

    /// Adds `−h` times first derivatives, and by the length of the interval.
    fn add_first(
        element: &Hexahedron<F>,
        local: &mut Local<F>,
        frame: &Sample<'_>,
        part: &mut Part,
    ) {
        let c = -0.5 * frame.h;
        for (&v, force) in element.nodes.iter().zip(&local.forces) {
            part.forces[0][v] += force * c;
            part.forces[1][v] += force * c;
        }
        let free = frame.horizon == Horizon::Free;
        if free {
            for (&v, force) in element.nodes.iter().zip(&local.forces) {
                part.horizon_forces[0][v] -= force * 0.5;
                part.horizon_forces[1][v] -= force * 0.5;
            }
        }
        if let Some(electric) = F::electric(&mut local.electric) {
            let wires = F::wires(&element.terminals).iter();
            for (wire, charge) in wires.zip(&electric.charges) {
                if let Some((s, factor)) = wire.scalar {
                    part.rows[s] -= frame.h * factor * charge;
                    if free {
                        part.horizon_rows[s] -= factor * charge;
                    }
                }
            }
        }
    }

    /// Adds `−h` times second derivatives.
    fn add_second(
        (element, slots): (&Hexahedron<F>, &[u32]),
        local: &mut Local<F>,
        frame: &Sample<'_>,
        part: &mut Part,
    ) {
        let c = -0.25 * frame.h;
        let sides = || (0..4).filter(|&side| frame.sides.blocks[side]);
        let (vectors, electric_slots) = slots.split_at(PAIRS);
        for (row, stiffness) in vectors.chunks_exact(8).zip(&local.stiffness) {
            for (&slot, k) in row.iter().zip(stiffness) {
                let block = &mut part.blocks.full[slot as usize];
                for side in sides() {
                    block[side] += k * c;
                }
            }
        }
        let Some(electric) = F::electric(&mut local.electric) else {
            return;
        };
        let (mixed, scalars) = electric_slots.split_at(PAIRS);
        let wires = F::wires(&element.terminals);
        for (j, wire) in wires.iter().enumerate() {
            let Some((s, factor)) = wire.scalar else {
                continue;
            };
            for i in 0..8 {
                let column = electric.coupling[i][j] * (-0.5 * frame.h * factor);
                let block = &mut part.blocks.mixed[mixed[8 * i + j] as usize];
                block[0] += column;
                block[1] += column;
            }
            for (i, other) in wires.iter().enumerate() {
                // Pairs of different scalars are met twice, once in each order, and kept once.
                if let Some((t, other)) = other.scalar
                    && t <= s
                {
                    part.blocks.scalars[scalars[8 * j + i] as usize] -=
                        frame.h * factor * other * electric.permittivity[i][j];
                }
            }
        }
    }

    fn add(
        &self,
        index: usize,
        local: &mut Local<F>,
        level: Order,
        frame: &Sample<'_>,
        slots: &[u32],
        part: &mut Part,
    ) {
        let element = &self.elements[index];
        Self::add_first(element, local, frame, part);
        if level >= Order::Hessian {
            let count = Self::slots();
            let slots = &slots[count * index..count * (index + 1)];
            Self::add_second((element, slots), local, frame, part);
        }
    }

    fn energy_of(
        &self,
        frame: &Sample<'_>,
        energy: impl Fn(&Hexahedron<F>, &[Vector; 8]) -> f64 + Sync,
    ) -> f64 {
        let of = |element: &Hexahedron<F>| energy(element, &middle(frame.vectors, &element.nodes));
        self.elements.iter().map(of).sum()
    }
}

impl<F: Electrical> Term for Hexahedra<F> {
    fn name(&self) -> &str {
        &self.name
    }

    fn elements(&self) -> usize {
        self.elements.len()
    }

    fn couple(&self, couplings: &mut Couplings, slots: &mut Vec<u32>) {
        for element in &self.elements {
            for &a in &element.nodes {
                slots.extend(element.nodes.map(|b| couplings.add_full(a, b) as u32));
            }
            if !F::HAS_POTENTIALS {
                continue;
            }
            let wires = F::wires(&element.terminals);
            let scalar = |i: usize| wires[i].scalar.map(|(s, _)| s);
            let (mut mixed, mut scalars) = ([NONE; PAIRS], [NONE; PAIRS]);
            for j in 0..8 {
                let Some(s) = scalar(j) else { continue };
                for (i, &node) in element.nodes.iter().enumerate() {
                    mixed[8 * i + j] = couplings.add_mixed(node, s) as u32;
                    if let Some(t) = scalar(i).filter(|&t| t <= s) {
                        scalars[8 * j + i] = couplings.add_scalars(s, t) as u32;
                    }
                }
            }
            slots.extend(mixed);
            slots.extend(scalars);
        }
    }

    fn kind(&self) -> Kind {
        Kind::Potential
    }

    fn energy(&self, frame: &Sample<'_>) -> f64 {
        self.energy_of(frame, |element, x| {
            let potentials = Self::potentials(element, frame.scalars);
            element.law.energy(&element.shape, x, &potentials)
        })
    }

    fn energy_parts(&self) -> Vec<String> {
        match F::HAS_POTENTIALS {
            true => ["elastic", "electric"]
                .map(|part| format!("{} {part}", self.name))
                .to_vec(),
            false => vec![self.name.clone()],
        }
    }

    fn energies(&self, frame: &Sample<'_>, out: &mut Vec<f64>) {
        let total = self.energy(frame);
        if self.energy_parts().len() == 1 {
            out.push(total);
            return;
        }
        let elastic = self.energy_of(frame, |element, x| {
            F::passive(&element.law).energy(&element.shape, x, &())
        });
        out.extend([elastic, total - elastic]);
    }

    fn momentum(&self, _x: &[Vector], _v: &[Vector], _out: &mut [Vector]) {}

    fn evaluate(&self, level: Order, frame: &Sample<'_>, slots: &[u32], out: &mut Output) {
        if level < Order::Third {
            let compute = |element: &Hexahedron<F>, local: &mut Local<F>| {
                Self::local(element, level, frame, local);
            };
            self.locals.each(&self.elements, compute, |index, local| {
                self.add(index, local, level, frame, slots, &mut out.plain);
            });
            return;
        }
        let (mut plain, mut along) = (Local::default(), Local::default());
        for (index, element) in self.elements.iter().enumerate() {
            let x = middle(frame.vectors, &element.nodes);
            let w = middle(frame.along, &element.nodes);
            let potentials = Self::potentials(element, frame.scalars);
            let rates = Self::rates(element, frame.scalars_along);
            let shape = &element.shape;
            element
                .law
                .third(shape, &x, &potentials, &w, &rates, &mut plain, &mut along);
            self.add(index, &mut plain, level, frame, slots, &mut out.plain);
            self.add(index, &mut along, level, frame, slots, &mut out.contracted);
        }
    }
}
