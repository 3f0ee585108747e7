//! What a scene calls for, effect by effect. This is the only place that makes effects: what is absent makes none.

use crate::energy::{
    AngularDamper, CoordinateDamper, DielectricCell, ElasticCell, Gravity, LinearDamper,
    SectionInertia, ViscousCell,
};
use crate::functional::{Effect, Element, Group, Inertia, Mass};
use crate::kinematics::{MaterialVector, Pose, Vectors};
use crate::math::Vector;
use crate::model::Coordinates;
use crate::model::continua::Continua;
use crate::model::joints::{JointGauge, Measure};
use crate::model::system::{Attachment, Fidelity, Muscle, System};
use crate::model::terms::{mid, rate};

/// A list of effects on its way to a sum.
pub(super) type Effects = Vec<Box<dyn Effect>>;

/// Makes the effects of a system and collects the vectors they read.
#[derive(Debug)]
pub(super) struct Builder<'a> {
    pub(super) system: &'a System,
    pub(super) reference: &'a [Pose],
    pub(super) coordinates: Coordinates,
    pub(super) vectors: &'a mut Vectors,
    /// Source of each voltage.
    pub(super) voltages: &'a [usize],
    /// Elastic blocks.
    pub(super) continua: &'a Continua,
    /// Vector of the span of each muscle.
    pub(super) spans: Vec<usize>,
}

/// Whether a muscle is one stretch that may change, or is driven: between two points of the ground nothing is left of it.
fn is_lumped(muscle: &Muscle) -> bool {
    let is_still = muscle.from.body.is_none() && muscle.to.body.is_none();
    muscle.fidelity == Fidelity::Lumped && (!is_still || muscle.material.electric.is_some())
}

/// A group of elements as an effect, unless there are none.
macro_rules! group {
    ($effects:expr, $site:ident, $m:literal, $name:expr, $scale:expr, $elements:expr) => {
        let elements = $elements;
        if !elements.is_empty() {
            $effects.push(
                Box::new(Group::<_, $m, _, _>::$site($name, $scale, elements)) as Box<dyn Effect>,
            );
        }
    };
}
pub(super) use group;

impl<'a> Builder<'a> {
    pub(super) fn new(
        system: &'a System,
        reference: &'a [Pose],
        coordinates: Coordinates,
        voltages: &'a [usize],
        continua: &'a Continua,
        vectors: &'a mut Vectors,
    ) -> Self {
        let mut builder = Self {
            system,
            reference,
            coordinates,
            vectors,
            voltages,
            continua,
            spans: Vec::new(),
        };
        for muscle in &system.muscles {
            let span =
                MaterialVector::span(&builder.point(&muscle.from), &builder.point(&muscle.to));
            let span = builder.vectors.index(span);
            builder.spans.push(span);
        }
        builder
    }

    /// Lumped muscles with their vector of the span.
    fn lumped(&self) -> impl Iterator<Item = (&'a Muscle, usize)> + '_ {
        let muscles = self.system.muscles.iter().zip(self.spans.iter().copied());
        muscles.filter(|(muscle, _)| is_lumped(muscle))
    }

    fn point(&self, a: &Attachment) -> MaterialVector {
        MaterialVector::point(a.body, &a.at, self.reference)
    }

    /// Effects of the intervals, of a motion or of a state of rest.
    pub(super) fn intervals(&mut self, of_motion: bool) -> Effects {
        let mut effects = Effects::new();
        if of_motion {
            self.add_inertia(&mut effects);
        }
        group!(effects, intervals, 3, "gravity", -1.0, self.gravity());
        self.continua.add_elements(&mut effects);
        group!(
            effects,
            intervals,
            3,
            "muscle elasticity",
            -1.0,
            self.elastic()
        );
        group!(
            effects,
            intervals,
            4,
            "muscle electroelasticity",
            -1.0,
            self.dielectric()
        );
        if of_motion {
            self.add_friction(&mut effects);
        }
        effects
    }

    /// Kinetic energies.
    fn add_inertia(&mut self, effects: &mut Effects) {
        let inertia = |name: &str, masses: Vec<Mass>, effects: &mut Effects| {
            if !masses.is_empty() {
                effects.push(Box::new(Inertia::new(name, masses)));
            }
        };
        inertia("body inertia", self.body_masses(), effects);
        inertia("muscle inertia", self.muscle_masses(), effects);
        inertia("block inertia", self.continua.masses(), effects);
        group!(
            effects,
            intervals,
            6,
            "section inertia",
            1.0,
            self.section_inertia()
        );
    }

    /// Forces that dissipate.
    fn add_friction(&mut self, effects: &mut Effects) {
        self.continua.add_viscosity(effects);
        group!(
            effects,
            intervals,
            9,
            "muscle viscosity",
            1.0,
            self.viscous()
        );
        match self.coordinates {
            Coordinates::Reduced => {
                let dampers = self.coordinate_dampers();
                group!(effects, intervals, 6, "joint damping", 1.0, dampers);
            }
            Coordinates::Redundant => {
                let dampers = self.angular_dampers();
                group!(effects, intervals, 27, "joint damping", 1.0, dampers);
                let dampers = self.linear_dampers();
                group!(effects, intervals, 18, "joint damping", 1.0, dampers);
            }
        }
    }

    fn coordinate_dampers(&mut self) -> Vec<Element<CoordinateDamper, 2, 0>> {
        let mut elements = Vec::new();
        let coordinates = self.system.joint_coordinates();
        for (joint, coordinate) in self.system.joints.iter().zip(coordinates) {
            if let (Some(coefficient), Some(coordinate)) = (joint.damping, coordinate) {
                let vector = self.vectors.index(MaterialVector::joint(coordinate));
                elements.push(Element {
                    energy: CoordinateDamper { coefficient },
                    vectors: [mid(vector), rate(vector)],
                    scalars: [],
                });
            }
        }
        elements
    }

    fn angular_dampers(&mut self) -> Vec<Element<AngularDamper, 9, 0>> {
        let mut elements = Vec::new();
        for joint in &self.system.joints {
            let Some(coefficient) = joint.damping else {
                continue;
            };
            if let Measure::Angle { vectors } = JointGauge::new(joint, None, self.reference).measure
            {
                let [a, b, x] = vectors.map(|v| self.vectors.index(v));
                let args = [
                    mid(a),
                    mid(b),
                    mid(x),
                    mid(a),
                    mid(b),
                    mid(x),
                    rate(a),
                    rate(b),
                    rate(x),
                ];
                elements.push(Element {
                    energy: AngularDamper { coefficient },
                    vectors: args,
                    scalars: [],
                });
            }
        }
        elements
    }

    fn linear_dampers(&mut self) -> Vec<Element<LinearDamper, 6, 0>> {
        let mut elements = Vec::new();
        for joint in &self.system.joints {
            let Some(coefficient) = joint.damping else {
                continue;
            };
            if let Measure::Displacement { axis, span } =
                JointGauge::new(joint, None, self.reference).measure
            {
                let [n, r] = [axis, span].map(|v| self.vectors.index(v));
                let args = [mid(n), mid(r), mid(n), mid(r), rate(n), rate(r)];
                elements.push(Element {
                    energy: LinearDamper { coefficient },
                    vectors: args,
                    scalars: [],
                });
            }
        }
        elements
    }

    fn body_masses(&mut self) -> Vec<Mass> {
        let mut masses = Vec::new();
        for (b, body) in self.system.bodies.iter().enumerate() {
            let centre = MaterialVector::point(Some(b), &body.centre, self.reference);
            masses.push(Mass::point(self.vectors.index(centre), body.mass));
            let [j1, j2, j3] = body.inertia;
            for (i, euler) in [j2 + j3 - j1, j3 + j1 - j2, j1 + j2 - j3]
                .into_iter()
                .enumerate()
            {
                if euler != 0.0 {
                    let axis: Vector = body.directors.column(i).into();
                    let director = MaterialVector::direction(Some(b), &axis, self.reference);
                    masses.push(Mass::point(self.vectors.index(director), 0.5 * euler));
                }
            }
        }
        masses
    }

    /// Midpoint of a muscle.
    fn middle(&mut self, muscle: &Muscle) -> usize {
        let middle =
            MaterialVector::combine(0.5, &self.point(&muscle.from), 0.5, &self.point(&muscle.to));
        self.vectors.index(middle)
    }

    /// A uniform rod: m/6 (|va|² + va·vb + |vb|²) = m/2 |v_mid|² + m/24 |ṙ|².
    fn muscle_masses(&mut self) -> Vec<Mass> {
        let mut masses = Vec::new();
        for (m, muscle) in self.system.muscles.iter().enumerate() {
            if let (Some(mass), true) = (muscle.mass(), is_lumped(muscle)) {
                masses.push(Mass::point(self.middle(muscle), mass));
                masses.push(Mass::point(self.spans[m], mass / 12.0));
            }
        }
        masses
    }

    fn section_inertia(&self) -> Vec<Element<SectionInertia, 2, 0>> {
        let element = |(muscle, span): (&Muscle, usize)| {
            let mass = muscle.section_inertia.then(|| muscle.mass()).flatten()?;
            let [x, y] = muscle.cross_section;
            let energy = SectionInertia {
                length: muscle.length(),
                moment: mass * (x * x + y * y) / 192.0,
            };
            Some(Element {
                energy,
                vectors: [mid(span), rate(span)],
                scalars: [],
            })
        };
        self.lumped().filter_map(element).collect()
    }

    fn gravity(&mut self) -> Vec<Element<Gravity, 1, 0>> {
        let Some(g) = self.system.gravity else {
            return Vec::new();
        };
        let mut elements = Vec::new();
        let mut add = |vector: usize, mass: f64| {
            elements.push(Element {
                energy: Gravity { weight: g * mass },
                vectors: [mid(vector)],
                scalars: [],
            });
        };
        for (b, body) in self.system.bodies.iter().enumerate() {
            let centre = MaterialVector::point(Some(b), &body.centre, self.reference);
            add(self.vectors.index(centre), body.mass);
        }
        for muscle in &self.system.muscles {
            if let (Some(mass), true) = (muscle.mass(), is_lumped(muscle)) {
                add(self.middle(muscle), mass);
            }
        }
        for (vector, mass) in self.continua.loads() {
            add(vector, mass);
        }
        elements
    }

    fn elastic_cell(muscle: &Muscle) -> ElasticCell {
        ElasticCell {
            length: muscle.length(),
            volume: muscle.volume(),
            shear_modulus: muscle.material.shear_modulus,
        }
    }

    fn elastic(&self) -> Vec<Element<ElasticCell, 1, 0>> {
        let passive = |(muscle, _): &(&Muscle, usize)| muscle.material.electric.is_none();
        let element = |(muscle, span): (&Muscle, usize)| Element {
            energy: Self::elastic_cell(muscle),
            vectors: [mid(span)],
            scalars: [],
        };
        self.lumped().filter(passive).map(element).collect()
    }

    fn dielectric(&self) -> Vec<Element<DielectricCell, 1, 1>> {
        let element = |(v, &m): (usize, &usize)| {
            let muscle = self.system.muscles.get(m)?;
            if muscle.fidelity != Fidelity::Lumped {
                return None;
            }
            let electric = muscle.material.electric?;
            let energy = DielectricCell {
                elastic: Self::elastic_cell(muscle),
                c1: electric.c1,
                c2: electric.c2,
                permittivity: electric.permittivity,
                layer: muscle.layer_thickness,
            };
            Some(Element {
                energy,
                vectors: [mid(self.spans[m])],
                scalars: [v],
            })
        };
        self.voltages
            .iter()
            .enumerate()
            .filter_map(element)
            .collect()
    }

    fn viscous(&self) -> Vec<Element<ViscousCell, 3, 0>> {
        let element = |(muscle, span): (&Muscle, usize)| {
            let energy = ViscousCell {
                coefficient: 1.5 * muscle.material.viscosity? * muscle.volume(),
            };
            Some(Element {
                energy,
                vectors: [mid(span), mid(span), rate(span)],
                scalars: [],
            })
        };
        self.lumped().filter_map(element).collect()
    }
}
