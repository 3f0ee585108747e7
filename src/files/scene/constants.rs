//! Numbers of a scene by their paths, as an optimisation may seek them: the constants of components that follow each.
//!
//! A number is put in its place, and what it changes of the system is compared: constants that are polynomials of third degree in it follow it, as
//! moments of inertia do. So every number of a scene can be sought on which nothing but such constants depends, whatever it is written as.

use serde_json::Value;
use std::fmt::Display;

use crate::files::json::document::Document;
use crate::files::json::error::SceneError;
use crate::files::json::path::{JsonPath, Step};
use crate::files::json::scope::Scope;
use crate::files::json::set::{Override, value_at};
use crate::files::scene::build::build_scene;
use crate::files::scene::expand::{add_named, expanded};
use crate::files::scene::material::named_material;
use crate::files::scene::spec::SceneSpec;
use crate::files::study::ChangesSpec;
use crate::math::Fault;
use crate::model::system::System;
use crate::model::{Constant, Follower};

/// A scene as it is written, and its system.
#[derive(Debug)]
pub(crate) struct WrittenScene<'a> {
    /// As it is written.
    pub(crate) spec: &'a SceneSpec,
    /// The system that it means.
    pub(crate) system: &'a System,
    /// The document in which it stands, beside which its files are.
    pub(crate) document: &'a Document,
    /// Changes for some recordings, of which it is the scene; of the others where there are none.
    pub(crate) changes: &'a ChangesSpec,
}

/// A number of a scene.
#[derive(Debug)]
pub(crate) struct SceneConstant {
    /// Constants of components that follow it.
    pub(crate) followers: Vec<Follower>,
    /// Factor from International units to those of the number, which are those of the first follower where that is the number itself.
    pub(crate) from_si: f64,
    /// The number in the scene.
    pub(crate) value: f64,
}

/// Paths that may be sought.
const OFFERED: &str = "the path of a number of the scene, such as \"materials.NAME.shear_modulus\", \"muscles.NAME.from.at[0]\", \
     \"chain.muscles.arm\", \"springs.NAME.stiffness\", \"joints.NAME.damping\", \"bodies.NAME.mass\"";
/// Numbers that differ by less, relative to their size, are the same.
const SAME: f64 = 1e-9;
/// Part of the way between the bounds that nothing singles out: the lesser part of the golden section.
const BETWEEN: f64 = 0.381_966_011_250_105_1;
/// Parts of the way at which constants are compared with straight lines, through which polynomials go, and at which these are compared. Beside
/// bounds and scene, two of which may coincide.
const PLACES: [f64; 3] = [BETWEEN, 1.0 - BETWEEN, 0.79];
/// A factor that differs by less from one is one.
const ONE: f64 = 1e-12;

/// The fault of a path.
fn of_path(found: impl Display, expected: impl Display) -> Fault {
    Fault::new("", found, expected)
}

/// The fault of a value, called the lower bound.
fn of_value(error: &SceneError) -> Fault {
    Fault::new("min", error.found(), error.expected())
}

impl WrittenScene<'_> {
    /// The text of the scene as it is written, with all that a path may name.
    fn text_for(&self, path: &JsonPath) -> Result<String, Fault> {
        let mut spec = self.spec.clone();
        add_named(&mut spec);
        let is_of_chain = matches!(path.0.first(), Some(Step::Key(key)) if key == "chain");
        if let [Step::Key(list), Step::Key(name), ..] = path.0.as_slice()
            && list == "materials"
            && !spec.materials.contains_key(name)
        {
            let material = named_material(name).ok_or_else(|| {
                let found = format!("{name:?}, which is no material of the scene");
                of_path(found, "the name of a material")
            })?;
            spec.materials.insert(name.clone(), material);
        }
        if !is_of_chain {
            spec = expanded(spec);
        }
        Ok(serde_json::to_string(&spec).expect("a scene is JSON"))
    }

    /// The value at a path as it is written; none where nothing is.
    pub(crate) fn written(&self, path: &JsonPath) -> Option<Value> {
        value_at(&self.text_for(path).ok()?, path)
    }

    /// The system of the scene with a value in the place of a path; a value that is wrong is the lower bound, `min`, by its place.
    pub(crate) fn with(&self, path: &JsonPath, value: &Value) -> Result<System, Fault> {
        let mut document = Document::of_text(&self.document.path, self.text_for(path)?)
            .map_err(|error| of_value(&error))?;
        let change = Override::new(path.clone(), value.clone());
        let applied = change.apply(&mut document);
        applied.map_err(|error| of_path(error.found(), error.expected()))?;
        let changed = document.parse();
        let system = changed.and_then(|spec| build_scene(&spec, &Scope::of(&document)));
        system.map_err(|error| of_value(&error))
    }

    /// The number at a path, of which both bounds are given as they are written, and in units of the International System.
    pub(crate) fn constant(
        &self,
        path: &str,
        written: [&Value; 2],
        [lower, upper]: [f64; 2],
    ) -> Result<SceneConstant, Fault> {
        let place = JsonPath::parse(path)
            .ok_or_else(|| of_path("no number of the scene that can be sought", OFFERED))?;
        // What is wrong of the path is found with the lower bound.
        let of_upper = |fault: Fault| Fault {
            at: "max".to_owned(),
            ..fault
        };
        let [mut low, mut high] = [
            self.with(&place, written[0])?,
            self.with(&place, written[1]).map_err(of_upper)?,
        ];
        let mut base = self.system.clone();
        let mut changes = Vec::new();
        for constant in Constant::all(&high) {
            let ends = [constant.value(&mut low), constant.value(&mut high)];
            let [Some(a), Some(b)] = ends else { continue };
            if a == b {
                continue;
            }
            let given = constant.value(&mut base).ok_or_else(|| {
                let found = format!("{}, which the scene has to name", constant.lacking());
                of_path(found, OFFERED)
            })?;
            changes.push(Change {
                constant,
                given,
                ends: [a, b],
            });
        }
        self.check_rest(base, &changes, &high)?;
        let followers = self.followers(&place, &changes, [lower, upper])?;
        in_own_units(followers, lower, upper, self.system).ok_or_else(no_polynomial)
    }

    /// The straight lines through the values of constants at both bounds; where one is none, polynomials of third degree. Each with the value
    /// of its constant in the scene.
    fn followers(
        &self,
        place: &JsonPath,
        changes: &[Change],
        [lower, upper]: [f64; 2],
    ) -> Result<Vec<(Follower, f64)>, Fault> {
        let at = PLACES.map(|part| lower + part * (upper - lower));
        let values = |at: f64| -> Result<Vec<f64>, Fault> {
            let mut system = self.with(place, &Value::from(at))?;
            let value = |change: &Change| change.constant.value(&mut system).unwrap_or(f64::NAN);
            Ok(changes.iter().map(value).collect())
        };
        let lines = changes.iter().map(|change| change.line([lower, upper]));
        let mut followers: Vec<Follower> = lines.collect();
        let first = values(at[0])?;
        let mut all = changes.iter().zip(&followers).zip(&first);
        if !all.all(|((change, line), &value)| change.is_on(line, at[0], value)) {
            let [second, third] = [values(at[1])?, values(at[2])?];
            for (i, change) in changes.iter().enumerate() {
                let inside = [first[i], second[i]];
                let one = change.polynomial(followers[i], [lower, upper], [at[0], at[1]], inside);
                let differs = (one.at(at[2]) - third[i]).abs();
                let is_met = differs <= SAME * third[i].abs().max(change.given.abs());
                if !one.is_linear() && !is_met {
                    return Err(no_polynomial());
                }
                followers[i] = one;
            }
        }
        let given = changes.iter().map(|change| change.given);
        Ok(followers.into_iter().zip(given).collect())
    }

    /// That nothing of the system depends on the number but the followers.
    fn check_rest(&self, mut base: System, changes: &[Change], high: &System) -> Result<(), Fault> {
        for change in changes {
            change.constant.set(change.ends[1], &mut base);
        }
        let found = match (base == *high, changes.is_empty()) {
            (true, false) => return Ok(()),
            (true, true) => "a number of the scene on which nothing depends",
            (false, true) => "no number of the scene that can be sought",
            (false, false) => {
                "a number of the scene on which more depends than constants of energies"
            }
        };
        Err(of_path(found, OFFERED))
    }
}

/// The reason of a number by which constants curve otherwise.
fn no_polynomial() -> Fault {
    let found = "a number of the scene of which a constant is no polynomial of third degree";
    of_path(found, OFFERED)
}

/// A constant that the bounds of a number change.
struct Change {
    constant: Constant,
    /// Its value in the scene.
    given: f64,
    /// Its values at the bounds.
    ends: [f64; 2],
}

impl Change {
    /// The straight line through its values at the bounds.
    fn line(&self, [lower, upper]: [f64; 2]) -> Follower {
        let [a, b] = self.ends;
        let factor = (b - a) / (upper - lower);
        Follower {
            constant: self.constant,
            factor,
            offset: a - factor * lower,
            higher: [0.0; 2],
        }
    }

    /// Returns true if a value at a place is that of its straight line.
    fn is_on(&self, line: &Follower, at: f64, value: f64) -> bool {
        let [a, b] = self.ends;
        let size = a.abs().max(b.abs());
        (line.at(at) - value).abs() <= SAME * (b - a).abs().max(ONE * size)
    }

    /// The polynomial of third degree through its values at the bounds and at two places between them; its straight line where it is one.
    fn polynomial(
        &self,
        line: Follower,
        [lower, upper]: [f64; 2],
        at: [f64; 2],
        inside: [f64; 2],
    ) -> Follower {
        if (0..2).all(|i| self.is_on(&line, at[i], inside[i])) {
            return line;
        }
        let width = upper - lower;
        // Of what the values between have more than the line: t (1 − t) (p + q t) of t = (π − lower)/width.
        let t = at.map(|x| (x - lower) / width);
        let more = [0, 1].map(|i| (inside[i] - line.at(at[i])) / (t[i] * (1.0 - t[i])));
        let q = (more[1] - more[0]) / (t[1] - t[0]);
        let p = more[0] - q * t[0];
        let q = if q.abs() <= SAME * p.abs() { 0.0 } else { q };
        // p t + (q − p) t² − q t³ in powers of π.
        let [c1, c2, c3] = [p / width, (q - p) / (width * width), -q / width.powi(3)];
        Follower {
            offset: line.offset - lower * (c1 - lower * (c2 - lower * c3)),
            factor: line.factor + c1 - lower * (2.0 * c2 - 3.0 * lower * c3),
            higher: [c2 - 3.0 * lower * c3, c3],
            ..line
        }
    }
}

/// Followers and value in the units of a follower that is the number itself, which comes first, where there is one; none where no follower
/// is linear, or one misses its value in the scene.
fn in_own_units(
    mut followers: Vec<(Follower, f64)>,
    lower: f64,
    upper: f64,
    system: &System,
) -> Option<SceneConstant> {
    let is_itself = |one: &Follower| {
        let factor = one.factor.abs() * one.constant.unit(system).factor;
        one.is_linear() && (factor - 1.0).abs() <= ONE
    };
    followers.sort_by_key(|(one, _)| (!is_itself(one), !one.is_linear()));
    let &(first, given) = followers.first().filter(|(one, _)| one.is_linear())?;
    let si = (given - first.offset) / first.factor;
    let is_met = |(one, value): &(Follower, f64)| {
        let slope = one.factor + si * (2.0 * one.higher[0] + 3.0 * si * one.higher[1]);
        let size = (upper - lower).abs().max(si.abs());
        (one.at(si) - value).abs() <= SAME * (slope.abs() * size).max(ONE * value.abs())
    };
    if !followers.iter().all(is_met) {
        return None;
    }
    let from_si = if is_itself(&first) {
        1.0 / first.constant.unit(system).factor
    } else {
        1.0
    };
    let ends = [lower, upper].map(|bound| first.at(bound).abs());
    let followers = followers.into_iter().map(|(one, _)| {
        let mut one = one.of_multiple(1.0 / from_si);
        let nearest = one.factor.round();
        if (one.factor - nearest).abs() <= ONE * nearest.abs() {
            one.factor = nearest;
        }
        let size = if one.is_linear() {
            ends[0] + ends[1]
        } else {
            0.0
        };
        if one.offset.abs() <= ONE * size {
            one.offset = 0.0;
        }
        one
    });
    let followers: Vec<Follower> = followers.collect();
    let is_same = followers[0].factor == 1.0 && followers[0].offset == 0.0;
    Some(SceneConstant {
        followers,
        from_si,
        value: if is_same { given } else { si * from_si },
    })
}
