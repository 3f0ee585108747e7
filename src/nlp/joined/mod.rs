//! Several programs as one: variables that they share are unknowns once, all others and all constraints stand side by side, objectives are added.
//!
//! Variables and constraints come program by program, those that are shared behind all others. Stages of a program lie behind those of the one
//! before, so that the linear systems stay one chain that falls into pieces but for the border; where programs share variables of stages,
//! such as the inputs of one interval, equal stages are one. One program alone keeps its numbers, bit by bit.

mod places;

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use crate::math::join_if;
use crate::nlp::{Bounds, Entries, Nlp, Stage};
pub use places::{Places, SharedVariable};

/// A program and its part of the whole.
struct Part<N> {
    program: N,
    name: String,
    /// Variable of the whole that each of its variables is, and the factor by which its value is larger.
    columns: Arc<[(usize, f64)]>,
    rows: Range<usize>,
    /// Numbers of entries of Jacobian and Hessian.
    entries: [usize; 2],
    /// Entries of Jacobian and Hessian whose value is larger in the whole, and the factors.
    scaled: [Vec<(usize, f64)>; 2],
    x: Vec<f64>,
    objective: f64,
    gradient: Vec<f64>,
}

/// Several programs as one.
pub struct Joined<N> {
    parts: Vec<Part<N>>,
    places: Places,
    variables: Bounds,
    constraints: Bounds,
    jacobian: Entries,
    hessian: Entries,
}

impl<N> fmt::Debug for Joined<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<&str> = self.parts.iter().map(|part| &*part.name).collect();
        f.debug_struct("Joined").field("parts", &names).finish()
    }
}

impl<N: Nlp> Joined<N> {
    /// Joins programs, by their names; a single one needs none.
    ///
    /// # Panics
    ///
    /// If there is no program, or a shared variable is not one of each.
    #[must_use]
    pub fn new(programs: Vec<(String, N)>, shared: &[SharedVariable]) -> Self {
        assert!(!programs.is_empty(), "a program");
        let count = programs.len();
        let is_whole = |one: &SharedVariable| one.0.len() == count;
        assert!(shared.iter().all(is_whole), "a variable of each program");
        let size = |(_, program): &(String, N)| {
            let bounds = [program.variables(), program.constraints()];
            bounds.map(|bounds| bounds.lower.len())
        };
        let sizes: Vec<[usize; 2]> = programs.iter().map(size).collect();
        let mut out = Self {
            parts: Vec::with_capacity(count),
            places: Places::new(&sizes, shared),
            variables: Bounds::default(),
            constraints: Bounds::default(),
            jacobian: Entries::default(),
            hessian: Entries::default(),
        };
        for (name, program) in programs {
            out.add(name, program);
        }
        out.variables = out.joined_variables();
        out
    }

    /// Adds the next program.
    fn add(&mut self, name: String, program: N) {
        let number = self.parts.len();
        let (columns, rows) = (
            self.places.columns[number].clone(),
            self.places.rows(number),
        );
        let Bounds { lower, upper } = program.constraints();
        self.constraints.lower.extend(lower);
        self.constraints.upper.extend(upper);
        let mut scaled = [Vec::new(), Vec::new()];
        let mut keep = |kind: usize, entry: usize, factor: f64| {
            if factor != 1.0 {
                scaled[kind].push((entry, factor));
            }
        };
        let jacobian = program.jacobian_structure();
        for (entry, (&row, &col)) in jacobian.rows.iter().zip(&jacobian.cols).enumerate() {
            let (to, factor) = columns[col as usize];
            self.jacobian.rows.push(rows.start as u32 + row);
            self.jacobian.cols.push(to as u32);
            keep(0, entry, factor);
        }
        let hessian = program.hessian_structure();
        for (entry, (&row, &col)) in hessian.rows.iter().zip(&hessian.cols).enumerate() {
            let ((a, by_a), (b, by_b)) = (columns[row as usize], columns[col as usize]);
            self.hessian.rows.push(a.max(b) as u32);
            self.hessian.cols.push(a.min(b) as u32);
            keep(1, entry, by_a * by_b);
        }
        self.parts.push(Part {
            entries: [jacobian.rows.len(), hessian.rows.len()],
            x: vec![f64::NAN; columns.len()],
            gradient: vec![0.0; columns.len()],
            objective: 0.0,
            program,
            name,
            columns,
            rows,
            scaled,
        });
    }

    /// Bounds of all variables; a shared one keeps those of all programs.
    fn joined_variables(&self) -> Bounds {
        let count = self.places.count;
        let mut bounds = Bounds {
            lower: vec![f64::NEG_INFINITY; count],
            upper: vec![f64::INFINITY; count],
        };
        for part in &self.parts {
            let of = part.program.variables();
            let both = of.lower.iter().zip(&of.upper);
            for (&(to, factor), (lower, upper)) in part.columns.iter().zip(both) {
                bounds.lower[to] = bounds.lower[to].max(lower / factor);
                bounds.upper[to] = bounds.upper[to].min(upper / factor);
            }
        }
        bounds
    }

    /// Places of the variables and constraints of the programs.
    #[must_use]
    pub const fn places(&self) -> &Places {
        &self.places
    }

    /// The programs.
    pub fn parts(&self) -> impl Iterator<Item = &N> {
        self.parts.iter().map(|part| &part.program)
    }

    /// The programs.
    #[must_use]
    pub fn into_parts(self) -> Vec<N> {
        self.parts.into_iter().map(|part| part.program).collect()
    }
}

impl<N: Nlp + Send> Nlp for Joined<N> {
    fn variables(&self) -> &Bounds {
        &self.variables
    }

    fn constraints(&self) -> &Bounds {
        &self.constraints
    }

    fn jacobian_structure(&self) -> Entries {
        self.jacobian.clone()
    }

    fn hessian_structure(&self) -> Entries {
        self.hessian.clone()
    }

    fn objective(&mut self, x: &[f64]) -> f64 {
        each(&mut self.parts, &mut [], &|_| 0, &|part, _| {
            part.read(x);
            part.objective = part.program.objective(&part.x);
        });
        // −0 + f is f, bit by bit.
        let values = self.parts.iter().map(|part| part.objective);
        values.fold(-0.0, |sum, value| sum + value)
    }

    fn gradient(&mut self, x: &[f64], grad: &mut [f64]) {
        each(&mut self.parts, &mut [], &|_| 0, &|part, _| {
            part.read(x);
            part.program.gradient(&part.x, &mut part.gradient);
        });
        grad.fill(-0.0);
        for part in &self.parts {
            for (&(to, factor), value) in part.columns.iter().zip(&part.gradient) {
                grad[to] += factor * value;
            }
        }
    }

    fn constraint(&mut self, x: &[f64], g: &mut [f64]) {
        each(&mut self.parts, g, &|part| part.rows.len(), &|part, g| {
            part.read(x);
            part.program.constraint(&part.x, g);
        });
    }

    fn jacobian(&mut self, x: &[f64], values: &mut [f64]) {
        each(&mut self.parts, values, &|p| p.entries[0], &|part, own| {
            part.read(x);
            part.program.jacobian(&part.x, own);
            part.scale(0, own);
        });
    }

    fn hessian(&mut self, x: &[f64], sigma: f64, costates: &[f64], values: &mut [f64]) {
        each(&mut self.parts, values, &|p| p.entries[1], &|part, own| {
            part.read(x);
            let y = &costates[part.rows.clone()];
            part.program.hessian(&part.x, sigma, y, own);
            part.scale(1, own);
        });
    }

    fn objective_scale(&self) -> f64 {
        let scales = self.parts.iter().map(|part| part.program.objective_scale());
        scales.fold(f64::INFINITY, f64::min)
    }

    fn stages(&self) -> Option<Vec<Stage>> {
        let of_parts = self.parts.iter().map(|part| part.program.stages());
        let of_parts: Vec<Vec<Stage>> = of_parts.collect::<Option<_>>()?;
        let in_stage = |stage: &Stage| match stage {
            Stage::Of(stage) | Stage::Multiplier(stage) => Some(*stage),
            Stage::Border => None,
        };
        let is_shared = |number: usize| number >= self.places.first_shared;
        let shared = self.parts[0].columns.iter().zip(&of_parts[0]);
        let are_one = shared
            .filter(|((to, _), _)| is_shared(*to))
            .any(|(_, stage)| in_stage(stage).is_some());
        let mut all = vec![Stage::Border; self.variables.lower.len()];
        let mut behind = 0;
        for (part, stages) in self.parts.iter().zip(&of_parts) {
            for (&(to, _), stage) in part.columns.iter().zip(stages) {
                all[to] = match *stage {
                    Stage::Of(stage) => Stage::Of(behind + stage),
                    Stage::Multiplier(stage) => Stage::Multiplier(behind + stage),
                    Stage::Border => Stage::Border,
                };
            }
            let last = stages.iter().filter_map(in_stage).max();
            if !are_one {
                behind += last.map_or(0, |last| last + 1);
            }
        }
        Some(all)
    }

    fn squares(&self) -> Vec<usize> {
        let mut times = vec![0; self.variables.lower.len()];
        for part in &self.parts {
            let squares = part.program.squares().into_iter();
            squares.for_each(|own| times[part.columns[own].0] += 1);
        }
        let needed = |i: usize| match i >= self.places.first_shared {
            true => self.parts.len(),
            false => 1,
        };
        (0..times.len())
            .filter(|&i| times[i] == needed(i))
            .collect()
    }

    fn variable_name(&self, i: usize) -> String {
        let place = |part: &Part<N>| part.columns.iter().position(|&(to, _)| to == i);
        let mut found = self.parts.iter().filter_map(|p| Some((p, place(p)?)));
        let (part, own) = found.next().expect("a variable of a program");
        match i >= self.places.first_shared {
            true => part.program.variable_name(own),
            false => part.named(part.program.variable_name(own)),
        }
    }

    fn constraint_name(&self, i: usize) -> String {
        let mut parts = self.parts.iter();
        let part = parts.find(|part| part.rows.contains(&i));
        let part = part.expect("a constraint of a program");
        part.named(part.program.constraint_name(i - part.rows.start))
    }
}

impl<N> Part<N> {
    /// Reads its variables of a point.
    fn read(&mut self, x: &[f64]) {
        for (value, &(from, factor)) in self.x.iter_mut().zip(self.columns.iter()) {
            *value = factor * x[from];
        }
    }

    /// Scales entries of Jacobian or Hessian as the whole reads them.
    fn scale(&self, kind: usize, values: &mut [f64]) {
        for &(entry, factor) in &self.scaled[kind] {
            values[entry] *= factor;
        }
    }

    fn named(&self, name: String) -> String {
        match self.name.is_empty() {
            true => name,
            false => format!("{}: {name}", self.name),
        }
    }
}

/// Does work on each part and its share of some values, the halves of a list at once: what is computed does not depend on threads.
fn each<N: Send>(
    parts: &mut [Part<N>],
    values: &mut [f64],
    count: &(dyn Fn(&Part<N>) -> usize + Sync),
    work: &(dyn Fn(&mut Part<N>, &mut [f64]) + Sync),
) {
    match parts {
        [part] => work(part, values),
        _ => {
            let (first, second) = parts.split_at_mut(parts.len() / 2);
            let (a, b) = values.split_at_mut(first.iter().map(count).sum());
            let halves = [(first, a), (second, b)]
                .map(|(parts, values)| move || each(parts, values, count, work));
            let [first, second] = halves;
            join_if(true, first, second);
        }
    }
}
