//! The variables of a model in one table: name, role and position of each.
//!
//! The role determines if a variable belongs to an instant or an interval, has an equation, or is prescribed from outside.
//! Each role has one range of places in the list of its time, so that evaluations index and never search.

use crate::model::system::circuit::InputKind;
use std::fmt;
use std::ops::Range;

/// Part of the horizon to which a variable belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Time {
    /// It has a value at each instant.
    Instant,
    /// It has a value in each interval: a scalar that terms read.
    Interval,
    /// It has one value.
    Horizon,
}

/// Role of a variable. Roles of one time stand in this order in its list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// Coordinate of the motion, with a momentum balance.
    Coordinate,
    /// Multiplier λ of a constraint, which is its equation.
    Multiplier,
    /// Voltage of a source, in V: an input.
    Voltage,
    /// Size of a load, in N or N mm: an input.
    Load,
    /// Constant of the system that is free, in its unit: an input with one value for all intervals, in each of which terms read it.
    Parameter,
    /// Electric potential of a node or a floating electrode, with Gauss's law.
    Potential,
    /// Length of the intervals, in ms.
    Duration,
}

/// All roles, in order.
const ROLES: [Role; 7] = [
    Role::Coordinate,
    Role::Multiplier,
    Role::Voltage,
    Role::Load,
    Role::Parameter,
    Role::Potential,
    Role::Duration,
];

impl Role {
    /// Returns the part of the horizon to which a variable of this role belongs.
    pub const fn time(self) -> Time {
        match self {
            Self::Parameter => Time::Horizon,
            other => other.list(),
        }
    }

    /// Returns the list in which it stands: a parameter in that of the scalars that terms read.
    const fn list(self) -> Time {
        match self {
            Self::Coordinate | Self::Multiplier => Time::Instant,
            Self::Voltage | Self::Load | Self::Parameter | Self::Potential => Time::Interval,
            Self::Duration => Time::Horizon,
        }
    }

    /// Returns true if a variable of this role has an equation of its own, so that a step forward and an equilibrium solve for it; others
    /// are inputs.
    pub const fn has_equation(self) -> bool {
        match self {
            Self::Coordinate | Self::Multiplier | Self::Potential => true,
            Self::Voltage | Self::Load | Self::Parameter | Self::Duration => false,
        }
    }
}

/// Typical size of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// One: an angle in rad, or a component of a direction.
    One,
    /// The length of the system.
    Length,
    /// Not known by the model.
    Unknown,
}

/// A variable. Its `Display` is its full name, such as `voltage of muscle1`.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Its role.
    pub role: Role,
    /// Name of the part to which it belongs; of a coordinate and the duration the full name.
    pub name: String,
    /// Size of one, in rad, mm, ms, V, N or N mm: potentials are counted in a unit of their own.
    pub unit: f64,
    /// Typical size of its value.
    pub size: Size,
    /// Source of a voltage or load (see [`System::sources`](crate::model::System::sources)).
    pub source: Option<usize>,
}

impl Variable {
    /// The input of a source: a voltage or a load.
    pub fn input(source: usize, kind: InputKind, name: String) -> Self {
        let role = match kind {
            InputKind::Voltage => Role::Voltage,
            _ => Role::Load,
        };
        Self {
            source: Some(source),
            ..Self::with_role(role, name, Size::Unknown)
        }
    }

    /// A free parameter.
    pub(crate) fn parameter(name: String) -> Self {
        Self::with_role(Role::Parameter, name, Size::Unknown)
    }

    /// A potential, counted in `unit` V, in which it is as large as a length.
    pub(crate) fn potential(name: String, unit: f64) -> Self {
        Self {
            unit,
            ..Self::with_role(Role::Potential, name, Size::Length)
        }
    }

    /// A variable that is counted in rad, mm, ms or V.
    pub(crate) fn with_role(role: Role, name: String, size: Size) -> Self {
        Self {
            role,
            name,
            unit: 1.0,
            size,
            source: None,
        }
    }
}

impl fmt::Display for Variable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let of = match self.role {
            Role::Coordinate | Role::Parameter | Role::Duration => "",
            Role::Multiplier => "multiplier of ",
            Role::Voltage => "voltage of ",
            Role::Load => "load ",
            Role::Potential => "potential of ",
        };
        write!(f, "{of}{}", self.name)
    }
}

/// All variables of a model.
///
/// The unknowns of a step are those of an instant, then those scalars of an interval that have an equation.
#[derive(Clone, Debug)]
pub struct Variables {
    instant: Vec<Variable>,
    interval: Vec<Variable>,
    horizon: Vec<Variable>,
    ranges: [Range<usize>; ROLES.len()],
    /// Number of scalars of an interval without an equation, which come first.
    inputs: usize,
}

impl Default for Variables {
    /// The duration alone.
    fn default() -> Self {
        let mut variables = Self {
            instant: Vec::new(),
            interval: Vec::new(),
            horizon: Vec::new(),
            ranges: [const { 0..0 }; ROLES.len()],
            inputs: 0,
        };
        let name = "interval length".to_owned();
        variables.add(Variable::with_role(Role::Duration, name, Size::Unknown));
        variables
    }
}

impl Variables {
    /// Adds a variable behind those of its time, and returns its place there.
    ///
    /// # Panics
    /// A variable of a later role stands there already.
    pub fn add(&mut self, variable: Variable) -> usize {
        let role = variable.role;
        let list = match role.list() {
            Time::Instant => &mut self.instant,
            Time::Interval => &mut self.interval,
            Time::Horizon => &mut self.horizon,
        };
        let place = list.len();
        assert!(
            list.last().is_none_or(|last| last.role <= role),
            "variables come in the order of their roles"
        );
        list.push(variable);
        let range = &mut self.ranges[role as usize];
        if range.end == 0 {
            *range = place..place;
        }
        range.end += 1;
        if role.list() == Time::Interval && !role.has_equation() {
            self.inputs = self.interval.len();
        }
        place
    }

    /// Variables of an instant, scalars that terms read in an interval, or other variables of the horizon, in order.
    pub fn of(&self, time: Time) -> &[Variable] {
        match time {
            Time::Instant => &self.instant,
            Time::Interval => &self.interval,
            Time::Horizon => &self.horizon,
        }
    }

    /// Places of the variables of a role in the list of its time.
    pub fn range(&self, role: Role) -> Range<usize> {
        self.ranges[role as usize].clone()
    }

    /// The variables of a role.
    pub fn with(&self, role: Role) -> &[Variable] {
        &self.of(role.list())[self.range(role)]
    }

    /// Number of variables of a role.
    pub fn count(&self, role: Role) -> usize {
        self.ranges[role as usize].len()
    }

    /// Places of the scalars of an interval that are voltages or loads.
    pub fn sources_range(&self) -> Range<usize> {
        0..self.count(Role::Voltage) + self.count(Role::Load)
    }

    /// Inputs with their roles.
    pub fn with_roles<'s>(&'s self, inputs: &'s [f64]) -> impl Iterator<Item = (f64, Role)> + 's {
        let inputs = inputs.iter().zip(&self.interval);
        inputs.map(|(&value, variable)| (value, variable.role))
    }

    /// Inputs, zero where `keeps` does not hold for their role.
    pub fn inputs_where(&self, inputs: &[f64], keeps: impl Fn(Role) -> bool) -> Vec<f64> {
        let kept = self.with_roles(inputs);
        kept.map(|(value, role)| if keeps(role) { value } else { 0.0 })
            .collect()
    }

    /// Places of the scalars of an interval that are prescribed from outside or sought by an optimisation.
    pub fn inputs(&self) -> Range<usize> {
        0..self.inputs
    }

    /// Places of the scalars of an interval that have an equation.
    pub fn algebraic(&self) -> Range<usize> {
        self.inputs..self.interval.len()
    }

    /// Scalars of an interval as inputs and those with an equation.
    pub fn split<'s>(&self, scalars: &'s [f64]) -> [&'s [f64]; 2] {
        [&scalars[self.inputs()], &scalars[self.algebraic()]]
    }

    /// Scalars of an interval with these inputs, the others zero.
    pub fn scalars(&self, inputs: &[f64]) -> Vec<f64> {
        let mut scalars = vec![0.0; self.interval.len()];
        scalars[self.inputs()].copy_from_slice(inputs);
        scalars
    }

    /// Place of the voltage or load of a source among the scalars of an interval; `None` where it does nothing.
    pub fn input(&self, source: usize) -> Option<usize> {
        let is_of = |variable: &Variable| variable.source == Some(source);
        self.interval.iter().position(is_of)
    }

    /// Source of each voltage and load.
    pub fn sources(&self) -> impl Iterator<Item = usize> + '_ {
        self.interval.iter().filter_map(|variable| variable.source)
    }

    /// The unknowns of a step.
    pub fn unknowns(&self) -> impl Iterator<Item = &Variable> {
        self.instant.iter().chain(&self.interval[self.algebraic()])
    }

    /// Number of unknowns of a step.
    pub fn unknown_count(&self) -> usize {
        self.instant.len() + self.algebraic().len()
    }

    /// Unknown `i` of a step.
    pub fn unknown(&self, i: usize) -> &Variable {
        self.unknown_of(1, i)
    }

    /// Unknown `i` of a step of several points, which come first, and the scalars of several samples.
    pub fn unknown_of(&self, points: usize, i: usize) -> &Variable {
        match i.checked_sub(points * self.instant.len()) {
            None => &self.instant[i % self.instant.len()],
            Some(place) => &self.interval[self.inputs + place % self.algebraic().len()],
        }
    }

    /// Place among the unknowns of a step of scalar `s` of an interval; `None` for an input.
    pub fn place(&self, s: usize) -> Option<usize> {
        self.place_of(1, 0, s)
    }

    /// Place of scalar `s` of a sample among the unknowns of a step of several points, which come first, and the scalars of several
    /// samples; `None` for an input.
    pub fn place_of(&self, points: usize, sample: usize, s: usize) -> Option<usize> {
        let place = s.checked_sub(self.inputs)?;
        Some(points * self.instant.len() + sample * self.algebraic().len() + place)
    }
}
