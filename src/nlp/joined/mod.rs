//! Several programs as one: variables that they share are unknowns once, rows that they share are one equation, all others stand side by side,
//! objectives are added. A sum of variables may have a value of its own.
//!
//! In place of their sum the greatest objective may be minimised, by a bound of all of them that is one more variable.
//!
//! Variables and constraints come program by program, those that are shared behind all others. Stages of a program lie behind those of the one
//! before, so that the matrix is block-diagonal with a common border; where programs share a variable of a stage,
//! such as the input of an interval, it is one stage. One program alone keeps its numbers, bit by bit.

mod places;

use std::fmt;

use crate::nlp::{Bounds, Entries, Nlp, Stage};
use places::{Part, Worst, each};
pub use places::{Places, SharedRow, SharedVariable};

/// Several programs as one.
pub struct Joined<N> {
    parts: Vec<Part<N>>,
    /// Number of programs, the first ones, whose objectives count: the others are equations alone.
    counted: usize,
    places: Places,
    variables: Bounds,
    constraints: Bounds,
    jacobian: Entries,
    hessian: Entries,
    /// The sum of variables that has a value.
    sum: Option<Sum>,
    /// The bound of all objectives, where the greatest of them is minimised.
    worst: Option<Worst>,
}

/// A sum of variables, each with its coefficient, that has a value.
struct Sum {
    name: String,
    terms: Vec<(usize, f64)>,
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
    /// If there is no program, or a shared variable does not say of each whether it has it.
    #[must_use]
    pub fn new(programs: Vec<(String, N)>, shared: &[SharedVariable]) -> Self {
        Self::with_rows(programs, shared, &[])
    }

    /// Joins programs that share rows, too.
    ///
    /// # Panics
    ///
    /// As [`new`](Self::new).
    #[must_use]
    pub fn with_rows(
        programs: Vec<(String, N)>,
        shared: &[SharedVariable],
        shared_rows: &[SharedRow],
    ) -> Self {
        assert!(!programs.is_empty(), "a program");
        let count = programs.len();
        let is_whole = |one: &SharedVariable| one.0.len() == count;
        assert!(
            shared.iter().all(is_whole),
            "a place or none in each program"
        );
        let size = |(_, program): &(String, N)| {
            let bounds = [program.variables(), program.constraints()];
            bounds.map(Bounds::count)
        };
        let sizes: Vec<[usize; 2]> = programs.iter().map(size).collect();
        let mut out = Self {
            parts: Vec::with_capacity(count),
            counted: count,
            places: Places::new(&sizes, shared, shared_rows),
            variables: Bounds::default(),
            constraints: Bounds::default(),
            jacobian: Entries::default(),
            hessian: Entries::default(),
            sum: None,
            worst: None,
        };
        out.constraints = Bounds::none(out.places.row_count);
        for (name, program) in programs {
            out.add(name, program);
        }
        for row in shared_rows.iter().filter_map(|one| one.0.first()) {
            let (row, _) = out.places.rows[row.0][row.1];
            (out.constraints.lower[row], out.constraints.upper[row]) = (0.0, 0.0);
        }
        out.variables = out.joined_variables();
        out
    }

    /// Adds the next program.
    fn add(&mut self, name: String, program: N) {
        let number = self.parts.len();
        let columns = self.places.columns[number].clone();
        let rows = self.places.rows[number].clone();
        let Bounds { lower, upper } = program.constraints();
        for ((&(to, _), lower), upper) in rows.iter().zip(lower).zip(upper) {
            (self.constraints.lower[to], self.constraints.upper[to]) = (*lower, *upper);
        }
        let mut scaled = [Vec::new(), Vec::new()];
        let mut keep = |kind: usize, entry: usize, factor: f64| {
            if factor != 1.0 {
                scaled[kind].push((entry, factor));
            }
        };
        let jacobian = program.jacobian_structure();
        for (entry, (row, col)) in jacobian.places().enumerate() {
            let ((to, factor), (of, by_row)) = (columns[col], rows[row]);
            self.jacobian.push(of, to);
            keep(0, entry, factor * by_row);
        }
        let hessian = program.hessian_structure();
        for (entry, (row, col)) in hessian.places().enumerate() {
            let ((a, by_a), (b, by_b)) = (columns[row], columns[col]);
            self.hessian.push(a.max(b), a.min(b));
            keep(1, entry, by_a * by_b);
        }
        self.parts.push(Part {
            entries: [jacobian.count(), hessian.count()],
            x: vec![f64::NAN; columns.len()],
            gradient: vec![0.0; columns.len()],
            of_rows: vec![0.0; rows.len()],
            objective: 0.0,
            weight: 1.0,
            program,
            name,
            columns,
            rows,
            scaled,
        });
    }

    /// Bounds of all variables; a shared one keeps those of all programs.
    fn joined_variables(&self) -> Bounds {
        let mut bounds = Bounds::none(self.places.count);
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

    /// The same where the first programs alone have an objective.
    #[must_use]
    pub fn with_objectives_of(mut self, count: usize) -> Self {
        self.counted = count;
        self
    }

    /// Places of the variables and constraints of the programs.
    #[must_use]
    pub const fn places(&self) -> &Places {
        &self.places
    }

    /// The same with a row that gives a sum of variables, each with its coefficient, a value.
    #[must_use]
    pub fn with_sum(mut self, name: &str, terms: Vec<(usize, f64)>, value: f64) -> Self {
        for &(column, _) in &terms {
            self.jacobian.push(self.constraints.count(), column);
        }
        self.constraints.push(value, value);
        let name = name.to_owned();
        self.sum = Some(Sum { name, terms });
        self
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

impl<N: Nlp + Send> Joined<N> {
    /// The program whose objective is the greatest one of several programs, in place of their sum.
    #[must_use]
    pub fn with_worst(mut self) -> Self {
        if self.counted < 2 {
            return self;
        }
        let (column, first_row) = (self.places.count, self.constraints.count());
        self.worst = Some(Worst {
            column,
            first_row,
            scale: self.objective_scale(),
        });
        self.places.count += 1;
        self.variables.push(f64::NEG_INFINITY, f64::INFINITY);
        for (number, part) in self.parts[..self.counted].iter().enumerate() {
            let own = part.columns.iter().map(|&(to, _)| to);
            for to in own.chain([column]) {
                self.jacobian.push(first_row + number, to);
            }
            self.constraints.push(f64::NEG_INFINITY, 0.0);
        }
        self
    }

    /// Completes a point of the variables of programs, and multipliers of their rows, by what the greatest objective adds to them.
    pub fn complete(&mut self, x: &mut [f64], mut multipliers: Option<&mut Vec<f64>>) {
        if let Some(multipliers) = multipliers.as_deref_mut().filter(|_| self.sum.is_some()) {
            multipliers.push(0.0);
        }
        if let Some(worst) = &self.worst {
            worst.complete(&mut self.parts[..self.counted], x, multipliers);
        }
    }

    /// Weights of the objectives at an optimum with these multipliers of rows, where the greatest one is minimised.
    #[must_use]
    pub fn weights(&self, costates: &[f64]) -> Option<Vec<f64>> {
        let worst = self.worst.as_ref()?;
        let all = 0..self.counted;
        Some(all.map(|number| worst.weight(number, costates)).collect())
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
        if let Some(worst) = &self.worst {
            return worst.objective(x);
        }
        let parts = &mut self.parts[..self.counted];
        each(parts, &mut [], &|_| 0, &|part, _| part.evaluate(x));
        // −0 + f is f, bit by bit.
        let values = parts.iter().map(|part| part.objective);
        values.fold(-0.0, |sum, value| sum + value)
    }

    fn gradient(&mut self, x: &[f64], grad: &mut [f64]) {
        if let Some(worst) = &self.worst {
            return worst.gradient(grad);
        }
        let parts = &mut self.parts[..self.counted];
        each(parts, &mut [], &|_| 0, &|part, _| part.differentiate(x));
        grad.fill(-0.0);
        for part in parts {
            for (&(to, factor), value) in part.columns.iter().zip(&part.gradient) {
                grad[to] += factor * value;
            }
        }
    }

    fn constraint(&mut self, x: &[f64], g: &mut [f64]) {
        let (g, further) = g.split_at_mut(self.places.row_count);
        each(&mut self.parts, &mut [], &|_| 0, &|part, _| {
            part.read(x);
            part.program.constraint(&part.x, &mut part.of_rows);
        });
        // −0 + g is g, bit by bit.
        g.fill(-0.0);
        for part in &self.parts {
            for (&(to, factor), value) in part.rows.iter().zip(&part.of_rows) {
                g[to] += factor * value;
            }
        }
        let (of_sum, of_worst) = further.split_at_mut(usize::from(self.sum.is_some()));
        for (row, sum) in of_sum.iter_mut().zip(&self.sum) {
            *row = sum.terms.iter().map(|&(column, of)| of * x[column]).sum();
        }
        if let Some(worst) = &self.worst {
            worst.rows(&mut self.parts[..self.counted], x, of_worst);
        }
    }

    fn jacobian(&mut self, x: &[f64], values: &mut [f64]) {
        let own = self.parts.iter().map(|part| part.entries[0]).sum();
        let (values, further) = values.split_at_mut(own);
        let terms = self.sum.as_ref().map_or(&[][..], |sum| &sum.terms);
        let (of_sum, of_worst) = further.split_at_mut(terms.len());
        for (value, &(_, coefficient)) in of_sum.iter_mut().zip(terms) {
            *value = coefficient;
        }
        each(&mut self.parts, values, &|p| p.entries[0], &|part, own| {
            part.read(x);
            part.program.jacobian(&part.x, own);
            part.scale(0, own);
        });
        if let Some(worst) = &self.worst {
            worst.entries(&mut self.parts[..self.counted], x, of_worst);
        }
    }

    fn hessian(&mut self, x: &[f64], sigma: f64, costates: &[f64], values: &mut [f64]) {
        for (number, part) in self.parts.iter_mut().enumerate() {
            part.weight = match &self.worst {
                _ if number >= self.counted => 0.0,
                Some(worst) => worst.weight(number, costates),
                None => sigma,
            };
        }
        each(&mut self.parts, values, &|p| p.entries[1], &|part, own| {
            part.read(x);
            for (own, &(from, factor)) in part.of_rows.iter_mut().zip(part.rows.iter()) {
                *own = factor * costates[from];
            }
            part.program
                .hessian(&part.x, part.weight, &part.of_rows, own);
            part.scale(1, own);
        });
    }

    fn objective_scale(&self) -> f64 {
        let parts = self.parts[..self.counted].iter();
        let scales = parts.map(|part| part.program.objective_scale());
        scales.fold(f64::INFINITY, f64::min)
    }

    fn stages(&self) -> Option<Vec<Stage>> {
        let of_parts = self.parts.iter().map(|part| part.program.stages());
        let of_parts: Vec<Vec<Stage>> = of_parts.collect::<Option<_>>()?;
        let in_stage = |stage: &Stage| match stage {
            Stage::Of(stage) | Stage::Multiplier(stage) => Some(*stage),
            Stage::Border => None,
        };
        // A variable that is one of the border in a program is one of that of the whole.
        let mut is_of_border = vec![false; self.variables.count()];
        for (part, stages) in self.parts.iter().zip(&of_parts) {
            for (&(to, _), stage) in part.columns.iter().zip(stages) {
                is_of_border[to] |= *stage == Stage::Border;
            }
        }
        let mut all = vec![Stage::Border; self.variables.count()];
        let mut behind = 0;
        for (part, stages) in self.parts.iter().zip(&of_parts) {
            let mut own = part.columns.iter().zip(stages);
            let shared = own.find_map(|(&(to, _), stage)| {
                let placed = in_stage(&all[to]).filter(|_| !is_of_border[to])?;
                placed.checked_sub(in_stage(stage)?)
            });
            let first = shared.unwrap_or(behind);
            for (&(to, _), stage) in part.columns.iter().zip(stages) {
                all[to] = match *stage {
                    _ if is_of_border[to] => Stage::Border,
                    Stage::Of(stage) => Stage::Of(first + stage),
                    Stage::Multiplier(stage) => Stage::Multiplier(first + stage),
                    Stage::Border => Stage::Border,
                };
            }
            let last = stages.iter().filter_map(in_stage).max();
            behind = behind.max(last.map_or(0, |last| first + last + 1));
        }
        Some(all)
    }

    fn squares(&self) -> Vec<usize> {
        let mut times = vec![0; self.variables.count()];
        for part in &self.parts {
            let squares = part.program.squares().into_iter();
            squares.for_each(|own| times[part.columns[own].0] += 1);
        }
        let count = self.places.count.min(times.len());
        let all = (0..count).filter(|&i| times[i] == self.places.programs_of(i));
        all.collect()
    }

    fn variable_name(&self, i: usize) -> String {
        if self.worst.as_ref().is_some_and(|worst| worst.column == i) {
            return "the greatest objective".to_owned();
        }
        let place = |part: &Part<N>| part.columns.iter().position(|&(to, _)| to == i);
        let mut found = self.parts.iter().filter_map(|p| Some((p, place(p)?)));
        let (part, own) = found.next().expect("a variable of a program");
        match i >= self.places.first_shared {
            true => part.program.variable_name(own),
            false => part.named(part.program.variable_name(own)),
        }
    }

    fn constraint_name(&self, i: usize) -> String {
        let place = |part: &Part<N>| part.rows.iter().position(|&(to, _)| to == i);
        let mut found = self.parts.iter().filter_map(|p| Some((p, place(p)?)));
        if let Some((part, own)) = found.next() {
            return part.named(part.program.constraint_name(own));
        }
        match &self.worst {
            Some(worst) if i >= worst.first_row => {
                let of = "its objective, below the greatest one".to_owned();
                self.parts[i - worst.first_row].named(of)
            }
            _ => self
                .sum
                .as_ref()
                .map_or_else(String::new, |sum| sum.name.clone()),
        }
    }
}
