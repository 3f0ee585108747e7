//! Measure of the tension of a lumped muscle: the sum of the forces of all its energies along its span, and of its viscosity.

use crate::energy::{Energy, FlowingCharge, GivenCharge, NeoHooke, ViscousTension};
use crate::functional::{
    CurvedSum, Element, Formulas, Group, Kernel, Law, Measure, SpanForces, Stencil, Sum, VectorArg,
};
use crate::kinematics::Vectors;
use crate::model::components::capacitance;
use crate::model::components::muscle_constants::MuscleConstants;
use crate::model::components::muscle_laws::ElasticConstants;
use crate::model::internal::InternalKind;
use crate::model::measures::{Known, Shape};
use crate::model::system::{Fidelity, Muscle};

/// The parts of a tension in a unit in N.
struct Parts {
    unit: f64,
    list: Vec<Box<dyn Measure>>,
}

impl Parts {
    fn add<K: Kernel>(&mut self, element: K::Element) {
        let group = Group::<K>::intervals("tension", 1.0 / self.unit, vec![element]);
        self.list.push(Box::new(group));
    }

    /// Adds the force of an energy along its first vector, in the middle of the interval.
    fn add_energy<E: Energy<M> + 'static, const M: usize, const NV: usize, const NS: usize>(
        &mut self,
        energy: E,
        vectors: [usize; NV],
        scalars: [usize; NS],
    ) {
        self.add::<SpanForces<E, M, NV, NS>>(Element {
            energy,
            vectors: vectors.map(|vector| read(vector, Stencil::Mid)),
            scalars,
        });
    }

    /// Adds the force of elasticity, with that of a voltage, by a law of elasticity.
    fn add_cell<L: ElasticConstants>(
        &mut self,
        (muscle, law): (&Muscle, L),
        span: usize,
        voltage: Option<usize>,
    ) {
        let mut of = MuscleConstants::given(muscle);
        match (muscle.material.electric, voltage) {
            (Some(electric), Some(voltage)) => {
                let energy = of.driven(electric, law).formula(&[]);
                self.add_energy::<_, 4, 1, 1>(energy, [span], [voltage]);
            }
            _ => self.add_energy::<_, 3, 1, 0>(of.elastic(law).formula(&[]), [span], []),
        }
    }
}

fn read(vector: usize, stencil: Stencil) -> VectorArg {
    VectorArg { vector, stencil }
}

impl Known<'_> {
    /// Tension of a lumped muscle that moves or has a voltage, in a unit in N, in the middle of the intervals.
    pub(super) fn tension(
        &self,
        index: usize,
        (unit, shape): (f64, Shape),
        vectors: &mut Vectors,
    ) -> Option<Box<dyn Measure>> {
        let muscle = &self.presolved.system.muscles[index];
        let charge = self.internals.vector(InternalKind::Charge(index));
        let given = self.system.charge_of(index);
        let given = given.and_then(|source| self.variables.input(source));
        let voltage = self.variables.input(index).filter(|_| charge.is_none());
        let is_changed = charge.is_some() || given.is_some() || voltage.is_some();
        if muscle.fidelity != Fidelity::Lumped || !(is_changed || self.presolved.moves(muscle)) {
            return None;
        }
        let span = self.span(index, vectors);
        let mut parts = Parts {
            unit,
            list: Vec::new(),
        };
        let mut of = MuscleConstants::given(muscle);
        match muscle.material.law {
            None => parts.add_cell((muscle, NeoHooke), span, voltage),
            Some(law) => parts.add_cell((muscle, of.law(law)), span, voltage),
        }
        if let Some((charge, capacitance)) = charge.zip(capacitance(muscle)) {
            let energy = FlowingCharge {
                capacitance,
                unit: capacitance.unit_of_charge(),
            };
            parts.add_energy::<_, 6, 2, 0>(energy, [span, vectors.index(charge)], []);
        }
        if let Some((charge, capacitance)) = given.zip(capacitance(muscle)) {
            parts.add_energy(GivenCharge { capacitance }, [span], [charge]);
        }
        for (branch, constants) in muscle.material.maxwell.list().iter().enumerate() {
            let kind = InternalKind::Branch {
                muscle: index,
                branch,
            };
            if let Some(viscous) = self.internals.vector(kind) {
                let energy = of.branch_spring(branch, constants).formula(&[]);
                parts.add_energy::<_, 6, 2, 0>(energy, [span, vectors.index(viscous)], []);
            }
        }
        if let Some(viscosity) = muscle.material.viscosity {
            parts.add::<Formulas<ViscousTension, 6, 2, 0>>(Element {
                energy: ViscousTension(of.viscous(viscosity).formula(&[])),
                vectors: [Stencil::Mid, Stencil::Rate].map(|stencil| read(span, stencil)),
                scalars: [],
            });
        }
        Some(match shape {
            Shape::Linear => Box::new(Sum::new(parts.list)),
            Shape::Curved => Box::new(CurvedSum::new(parts.list)),
        })
    }
}
