//! Coordinates and rates of states that are given by joints, poses and velocities of bodies.

use crate::coordinates::Configuration;
use crate::energy::{Angle, Capacitance, Energy, Projection};
use crate::kinematics::{MaterialVector, Pose};
use crate::math::{Derivatives, Jet, Local, Matrix, Vector};
use crate::model::analysis::Coordinates;
use crate::model::components::{capacitance, muscle};
use crate::model::layout::internal::InternalKind;
use crate::model::model::Model;
use crate::model::quantities::quantity::MEGAVOLT_PER_METRE;
use crate::model::system::Fidelity;
use crate::model::system::circuit::Circuit;
use crate::model::system::joints::JointCoordinate;
use nalgebra::SVector;
use std::collections::BTreeMap;

impl Model {
    /// Rates of the coordinates of the bodies at joint coordinates (by joint) with given rates, and velocities of the centre and
    /// of rotation of some bodies of the scene, both in the ground frame.
    ///
    /// # Errors
    /// The first of these bodies that is neither free nor on a spherical or floating joint: its motion follows from its joints.
    pub fn rates_at(
        &self,
        joints: &[f64],
        rates: &[f64],
        velocities: &BTreeMap<usize, [Vector; 2]>,
    ) -> Result<Vec<f64>, usize> {
        let instant = self.moving(joints, rates, velocities)?;
        Ok(match self.coordinates {
            Coordinates::Reduced => instant.l[..self.action.map.of_bodies].to_vec(),
            Coordinates::Redundant => instant.w.iter().flat_map(|w| [w.x, w.y, w.z]).collect(),
        })
    }

    /// Returns true if some body turns in ways that joint coordinates in files do not give: it is free, or on a spherical joint.
    pub fn turns_freely(&self) -> bool {
        let mut joints = self.presolved.system.joints.iter();
        !self.graph.free().is_empty() || joints.any(|joint| joint.kind.freedoms() > 1)
    }

    /// Rates of centre and directors of the body that carries a body of the scene, at a placed instant of which `l` holds the rates of
    /// the coordinates; none of one that does not move.
    pub fn rates_of_body(&self, body: usize, instant: &Configuration) -> Vec<f64> {
        let carrier = self.presolved.carrier(Some(body));
        let rates = carrier.map(|body| self.pose_rates(instant).swap_remove(body));
        let numbers = |rate: Pose| [rate.centre.as_slice(), rate.directors.as_slice()].concat();
        rates.map(numbers).unwrap_or_default()
    }

    /// Returns true if joints close loops of bodies.
    pub fn has_loops(&self) -> bool {
        !self.graph.loops().is_empty()
    }

    /// Returns true if no constraint joins the coordinates of joints.
    pub fn has_independent_joints(&self) -> bool {
        self.coordinates.are_independent(&self.graph)
    }

    /// First coordinate and coordinates at poses of the joints of several coordinates without a chart.
    fn several(&self, poses: &[Pose]) -> Vec<(usize, Vec<f64>)> {
        let mut next = 0;
        let mut list = Vec::new();
        for (_, joint) in self.graph.in_order(&self.presolved.system) {
            let values = joint.several(poses, &self.reference);
            list.extend(values.map(|values| (next, values)));
            next += joint.kind.freedoms();
        }
        list
    }

    /// The tree in motion, with the vectors φ, d₁, d₂, d₃ of all bodies.
    fn moving(
        &self,
        joints: &[f64],
        rates: &[f64],
        velocities: &BTreeMap<usize, [Vector; 2]>,
    ) -> Result<Configuration, usize> {
        let [joints, rates] = [joints, rates].map(|values| self.presolved.by_joint(values));
        let (motion, mut instant) =
            self.graph
                .moving(&self.presolved.system, &self.reference, &joints, &rates);
        // A body before those that it carries.
        let mut named: Vec<_> = velocities.iter().collect();
        named.sort_by_key(|&(&body, _)| {
            self.presolved
                .carrier(Some(body))
                .map(|b| motion.tree.carrier(b))
        });
        for (&body, &[velocity, spin]) in named {
            let poses = motion.poses(&instant, self.reference.len());
            let all = self.presolved.poses(&poses, &self.system.bodies);
            let kept = self.presolved.carrier(Some(body)).ok_or(body)?;
            let arm = poses[kept].centre - all[body].centre;
            let velocity = velocity + spin.cross(&arm);
            if !motion.set_in_motion(kept, [velocity, spin], &mut instant) {
                return Err(body);
            }
        }
        Ok(instant)
    }

    /// Coordinates of an instant at given poses of the bodies of the scene and joint coordinates (by joint), as these are known
    /// without whole turns; nodes at their reference places.
    pub fn coordinates_of_poses(&self, poses: &[Pose], joints: &[f64]) -> Vec<f64> {
        let z = self.coordinates_at(joints);
        if self
            .graph
            .has_one_coordinate_a_joint(&self.presolved.system)
        {
            return z;
        }
        let poses = self.presolved.condense(poses, &self.reference);
        let map = &self.action.map;
        if !map.is_articulated() {
            return self.coordinates_of(&poses, joints);
        }
        let mut instant = map.placed(&z);
        map.follow(&poses, &mut instant);
        for (first, values) in self.several(&poses) {
            instant.z[first..first + values.len()].copy_from_slice(&values);
        }
        map.place(&mut instant);
        self.place_internals(&mut instant.z, joints);
        instant.z
    }
}

impl Model {
    /// Joints of the scene with exactly one coordinate, which can change.
    pub fn moving_joints(&self) -> Vec<usize> {
        let joints = self.system.joints.iter().enumerate();
        let moving = joints
            .filter(|(j, joint)| joint.has_coordinate() && self.presolved.joint(*j).is_some());
        moving.map(|(j, _)| j).collect()
    }

    /// Markers that can move, each with its vector.
    pub fn moving_markers(&self) -> Vec<(usize, usize)> {
        let markers = self.markers.iter().copied().enumerate();
        let moves = |&(_, vector): &(usize, usize)| !self.action.map.support(vector).is_empty();
        markers.filter(moves).collect()
    }

    /// Rate of the coordinate of a [moving joint](Self::moving_joints) in rad/ms or mm/ms, at a placed instant of which `l` holds the
    /// rates of the coordinates.
    pub fn joint_rate(&self, joint: usize, instant: &Configuration) -> f64 {
        let index = self.presolved.joint(joint).expect("a joint that moves");
        let in_tree = self.internals.in_tree(index);
        if let Some(coordinate) = in_tree {
            return instant.l[coordinate];
        }
        let joint = &self.presolved.system.joints[index];
        let coordinate = JointCoordinate::new(joint, &self.reference);
        let poses = || self.condensed_poses(instant);
        coordinate.map_or(0.0, |of| of.rate(&poses(), &self.pose_rates(instant)))
    }

    /// Rates of centres and directors of the presolved bodies, at a placed instant of which `l` holds the rates of the coordinates.
    fn pose_rates(&self, instant: &Configuration) -> Vec<Pose> {
        let count = self.presolved.system.bodies.len();
        match self.coordinates {
            Coordinates::Reduced => {
                let mut moving = instant.clone();
                self.action.map.along(&mut moving);
                let tree = &moving.tree;
                let bodies = tree.poses.iter().zip(&tree.twists).take(count);
                let rate = |(at, [spin, origin]): (&Pose, &[Vector; 2])| Pose {
                    centre: origin + spin.cross(&at.centre),
                    directors: spin.cross_matrix() * at.directors,
                };
                bodies.map(rate).collect()
            }
            Coordinates::Redundant => instant.l.chunks_exact(12).take(count).map(pose).collect(),
        }
    }
}

/// Centre and directors, or their rates, of twelve numbers.
fn pose(q: &[f64]) -> Pose {
    Pose {
        centre: Vector::from_column_slice(&q[..3]),
        directors: Matrix::from_column_slice(&q[3..]),
    }
}

impl JointCoordinate {
    /// Its rate at poses with these rates.
    fn rate(&self, poses: &[Pose], rates: &[Pose]) -> f64 {
        match self {
            Self::Angle { vectors } => {
                let [p, w] = at_and_rates::<9>(vectors, poses, rates);
                let angle: Jet<9, 3> = Angle { near: 0.0 }.at(&p, &w);
                angle.value_w
            }
            Self::Displacement { axis, span } => {
                let [p, w] = at_and_rates::<6>([axis, span], poses, rates);
                let displacement: Jet<6, 3> = Projection.at(&p, &w);
                displacement.value_w
            }
        }
    }
}

/// Components of vectors at poses, and of their rates.
fn at_and_rates<'v, const N: usize>(
    vectors: impl IntoIterator<Item = &'v MaterialVector>,
    poses: &[Pose],
    rates: &[Pose],
) -> [SVector<f64, N>; 2] {
    let mut both = [SVector::<f64, N>::zeros(); 2];
    for (i, vector) in vectors.into_iter().enumerate() {
        for (all, own) in both
            .iter_mut()
            .zip([vector.at(poses, &[]), vector.rate(rates)])
        {
            all.fixed_rows_mut::<3>(3 * i).copy_from(&own);
        }
    }
    both
}

/// A lumped muscle whose state is read at times: a placed configuration with rates `w` of the vectors, and the scalars there.
#[derive(Clone, Debug)]
pub struct MuscleReading {
    /// Index of the muscle.
    pub muscle: usize,
    /// Coordinates of its Maxwell branches.
    branches: Vec<usize>,
    /// Its charge, where it has one instead of the voltage of a source.
    charge: Option<ChargePlace>,
    capacitance: Option<Capacitance>,
    /// The scalar of its source, where that is ever other than zero.
    input: Option<usize>,
}

/// Place of a charge.
#[derive(Clone, Copy, Debug)]
enum ChargePlace {
    /// A coordinate, in the unit of the muscle: behind a resistor.
    Coordinate(usize),
    /// A scalar of the intervals: an input.
    Input(usize),
}

impl Model {
    /// The lumped muscles.
    pub fn muscle_readings(&self) -> Vec<MuscleReading> {
        let muscles = 0..self.system.muscles.len();
        muscles.filter_map(|m| self.muscle_reading(m)).collect()
    }

    fn muscle_reading(&self, index: usize) -> Option<MuscleReading> {
        let muscle = &self.system.muscles[index];
        let capacitance = capacitance(muscle);
        (muscle.fidelity == Fidelity::Lumped).then(|| MuscleReading {
            muscle: index,
            branches: self.branches_of(index),
            charge: capacitance.and_then(|_| self.charge_place(index)),
            capacitance,
            input: self.variables.input(index),
        })
    }

    fn charge_place(&self, muscle: usize) -> Option<ChargePlace> {
        let mut internals = self.internal_kinds();
        let behind = internals.find(|(_, kind)| *kind == InternalKind::Charge(muscle));
        let given = || self.variables.input(self.system.charge_of(muscle)?);
        match behind {
            Some((coordinate, _)) => Some(ChargePlace::Coordinate(coordinate)),
            None => given().map(ChargePlace::Input),
        }
    }

    /// Muscles behind resistors, then those whose charge is given.
    fn charged(&self) -> impl Iterator<Item = MuscleReading> {
        let is_given = |one: &MuscleReading| matches!(one.charge, Some(ChargePlace::Input(_)));
        let muscles = 0..self.system.muscles.len();
        let charged = muscles.filter(|&m| self.charge_place(m).is_some());
        let readings = charged.filter_map(|m| self.muscle_reading(m));
        let readings = readings.filter(|reading| reading.charge.is_some());
        let mut readings: Vec<_> = readings.collect();
        readings.sort_by_key(is_given);
        readings.into_iter()
    }

    /// Names of the columns of [`electrode_voltages`](Self::electrode_voltages).
    pub fn electrodes(&self) -> impl Iterator<Item = String> + '_ {
        let name = |of: MuscleReading| format!("{}_voltage", self.system.muscles[of.muscle].name);
        self.charged().map(name)
    }

    /// Voltage Q/C in V of each muscle with a charge Q instead of the voltage of a source, at an instant and under the scalars of an
    /// interval beside it.
    pub fn electrode_voltages(&self, instant: &Configuration, scalars: &[f64]) -> Vec<f64> {
        let voltage = |of: MuscleReading| of.voltage(self, instant, scalars);
        self.charged().filter_map(voltage).collect()
    }
}

impl MuscleReading {
    /// Returns true if there is a voltage between its electrodes, so that it has a field.
    pub fn has_voltage(&self) -> bool {
        self.charge.is_some() || self.input.is_some()
    }

    /// Returns true if a source supplies its charge.
    pub fn has_source(&self) -> bool {
        match self.charge {
            Some(place) => matches!(place, ChargePlace::Coordinate(_)),
            None => self.input.is_some(),
        }
    }

    /// The scalar of its source, whose voltage its electrodes have.
    fn direct(&self) -> Option<usize> {
        self.input.filter(|_| self.charge.is_none())
    }

    /// Voltage of its electrodes: Q/C of a charge Q.
    fn voltage(&self, model: &Model, at: &Configuration, scalars: &[f64]) -> Option<f64> {
        let charge = match self.charge {
            None => {
                let of = &model.system.muscles[self.muscle];
                return Some(of.voltage_at_rest(scalars[self.input?]));
            }
            Some(ChargePlace::Coordinate(coordinate)) => {
                at.z[coordinate] * self.capacitance?.unit_of_charge()
            }
            Some(ChargePlace::Input(scalar)) => scalars[scalar],
        };
        let length = at.x[model.spans[self.muscle]].norm();
        Some(charge / self.capacitance?.at_length(length))
    }

    /// Force in N with which it pulls its ends together: of elasticity, voltage, viscosity and Maxwell branches.
    pub fn tension(&self, model: &Model, at: &Configuration, scalars: &[f64]) -> f64 {
        let (of, span) = (&model.system.muscles[self.muscle], model.spans[self.muscle]);
        let voltage = self.voltage(model, at, scalars);
        let viscous = self.branches.iter().map(|&coordinate| at.z[coordinate]);
        muscle::tension(of, [&at.x[span], &at.w[span]], voltage, viscous)
    }

    /// True electric field |V|/(t Λ) in V/µm; zero without a voltage.
    pub fn field(&self, model: &Model, at: &Configuration, scalars: &[f64]) -> f64 {
        let of = &model.system.muscles[self.muscle];
        let stretch = at.x[model.spans[self.muscle]].norm() / of.length();
        let voltage = self.voltage(model, at, scalars).unwrap_or(0.0);
        voltage.abs() / (of.layer_thickness * stretch) / MEGAVOLT_PER_METRE
    }

    /// Current in A and power in W of its source while the voltage of the source is constant: `V ∂C/∂r·ṙ` with that through a leak, or
    /// `(V − Q/C)/R` through a resistor.
    pub fn flow(&self, model: &Model, at: &Configuration, scalars: &[f64]) -> Option<[f64; 2]> {
        let of = &model.system.muscles[self.muscle];
        let span = model.spans[self.muscle];
        let (voltage, current) = match self.charge {
            None => {
                let voltage = scalars[self.input?];
                let [r, rate] = [&at.x[span], &at.w[span]];
                let capacitance = self.capacitance?.at::<1>(r, &SVector::zeros());
                let charging = voltage * capacitance.plain::<1>().force(0).dot(rate);
                let leak = of.circuit.as_ref().and_then(Circuit::leak_conductance);
                (voltage, leak.map_or(charging, |g| charging + g * voltage))
            }
            Some(ChargePlace::Input(_)) => return None,
            Some(ChargePlace::Coordinate(_)) => {
                let voltage = self.input.map_or(0.0, |scalar| scalars[scalar]);
                let across = self.voltage(model, at, scalars)?;
                (voltage, (voltage - across) / of.circuit?.resistance?)
            }
        };
        Some([current, voltage * current])
    }

    /// Current in A and power in W that charge it while its voltage changes at a rate, at a placed instant: `C V̇` and `C V V̇`; none through
    /// a resistor.
    pub fn charging(
        &self,
        model: &Model,
        at: &Configuration,
        [scalars, rates]: [&[f64]; 2],
    ) -> [f64; 2] {
        let Some(scalar) = self.direct() else {
            return [0.0; 2];
        };
        let current = self.capacitance(model, at) * rates[scalar];
        [current, scalars[scalar] * current]
    }

    /// Charge and energy that the source supplies where its voltage switches, in mC and mJ, at a placed instant: `C (V₂ − V₁)` and
    /// `½ C (V₂² − V₁²)`; none through a resistor.
    pub fn switched(&self, model: &Model, at: &Configuration, scalars: [&[f64]; 2]) -> [f64; 2] {
        let Some(scalar) = self.direct() else {
            return [0.0; 2];
        };
        let [before, after] = scalars.map(|scalars| scalars[scalar]);
        let charge = self.capacitance(model, at) * (after - before);
        [charge, 0.5 * charge * (after + before)]
    }

    fn capacitance(&self, model: &Model, at: &Configuration) -> f64 {
        let length = at.x[model.spans[self.muscle]].norm();
        self.capacitance.map_or(0.0, |of| of.at_length(length))
    }
}
