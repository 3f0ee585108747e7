//! Numbers of a scene by their paths, as an optimisation may seek them: the constants of components that follow each.
//!
//! A number is put in its place, and what it changes of the system is compared: constants that are linear in it follow it. So every number
//! of a scene can be sought on which nothing but such constants depends, whatever it is written as.

use serde_json::Value;

use crate::files::json::document::Document;
use crate::files::json::error::SceneError;
use crate::files::json::locate::{JsonPath, Step};
use crate::files::json::scope::Scope;
use crate::files::json::set::Override;
use crate::files::scene::build::build_scene;
use crate::files::scene::expand::{add_named, expanded};
use crate::files::scene::named_materials::named_material;
use crate::files::scene::spec::SceneSpec;
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

/// Reason why a path names no number that can be sought.
#[derive(Debug)]
pub(crate) struct NoConstant {
    /// The bound, 0 or 1, that is wrong; none where it is the path.
    pub(crate) value: Option<usize>,
    /// Value or path that was found.
    pub(crate) found: String,
    /// Value or path that is expected.
    pub(crate) expected: String,
}

/// Paths that may be sought.
const OFFERED: &str = "the path of a number of the scene, such as \"materials.NAME.shear_modulus\", \"muscles.NAME.from.at[0]\", \
     \"chain.muscles.arm\", \"springs.NAME.stiffness\", \"joints.NAME.damping\", \"bodies.NAME.mass\"";
/// Numbers that differ by less, relative to their size, are the same.
const SAME: f64 = 1e-9;
/// Part of the way between the bounds at which constants are linear too: the lesser part of the golden section.
const BETWEEN: f64 = 0.381_966_011_250_105_1;
/// A factor that differs by less from one is one.
const ONE: f64 = 1e-12;

impl NoConstant {
    fn of_path(found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self {
            value: None,
            found: found.into(),
            expected: expected.into(),
        }
    }

    fn of_value(error: &SceneError) -> Self {
        Self {
            value: Some(0),
            ..Self::of_path(error.found(), error.expected())
        }
    }

    /// The same, where it is the upper bound that is wrong.
    fn of_upper(self) -> Self {
        Self {
            value: self.value.map(|_| 1),
            ..self
        }
    }
}

impl WrittenScene<'_> {
    /// The system of the scene with a value in the place of a path.
    pub(crate) fn with(&self, path: &JsonPath, value: &Value) -> Result<System, NoConstant> {
        let mut spec = self.spec.clone();
        add_named(&mut spec);
        let is_of_chain = matches!(path.0.first(), Some(Step::Key(key)) if key == "chain");
        if let [Step::Key(list), Step::Key(name), ..] = path.0.as_slice()
            && list == "materials"
            && !spec.materials.contains_key(name)
        {
            let material = named_material(name).ok_or_else(|| {
                let found = format!("{name:?}, which is no material of the scene");
                NoConstant::of_path(found, "the name of a material")
            })?;
            spec.materials.insert(name.clone(), material);
        }
        let spec = match is_of_chain {
            true => spec,
            false => expanded(spec),
        };
        let text = serde_json::to_string(&spec).expect("a scene is JSON");
        let mut document = Document::of_text(&self.document.path, text)
            .map_err(|error| NoConstant::of_value(&error))?;
        let change = Override::new(path.clone(), value.clone());
        let not_there = |error: &SceneError| NoConstant::of_path(error.found(), error.expected());
        change
            .apply(&mut document)
            .map_err(|error| not_there(&error))?;
        let changed: SceneSpec = document
            .parse()
            .map_err(|error| NoConstant::of_value(&error))?;
        let system = build_scene(&changed, &Scope::of(&document));
        system.map_err(|error| NoConstant::of_value(&error))
    }

    /// The number at a path, of which both bounds are given as they are written, and in units of the International System.
    pub(crate) fn constant(
        &self,
        path: &str,
        written: [&Value; 2],
        [lower, upper]: [f64; 2],
    ) -> Result<SceneConstant, NoConstant> {
        let place = JsonPath::parse(path).ok_or_else(|| {
            NoConstant::of_path("no number of the scene that can be sought", OFFERED)
        })?;
        let [mut low, mut high] = [
            self.with(&place, written[0])?,
            self.with(&place, written[1])
                .map_err(NoConstant::of_upper)?,
        ];
        let mut base = self.system.clone();
        let mut followers = Vec::new();
        let mut values = Vec::new();
        for constant in Constant::all(&high) {
            let [a, b] = [constant.value(&mut low), constant.value(&mut high)];
            let (Some(a), Some(b)) = (a, b) else { continue };
            if a == b {
                continue;
            }
            let given = constant.value(&mut base).ok_or_else(|| {
                let found = format!("{}, which the scene has to name", constant.lacking());
                NoConstant::of_path(found, OFFERED)
            })?;
            let factor = (b - a) / (upper - lower);
            let offset = a - factor * lower;
            followers.push(Follower {
                constant,
                factor,
                offset,
            });
            values.push((given, a, b));
        }
        self.check_rest(base, &followers, &values, &high)?;
        let si = (values[0].0 - followers[0].offset) / followers[0].factor;
        // Beside bounds and scene, two of which may coincide, at a place that nothing singles out.
        let between = lower + BETWEEN * (upper - lower);
        let mut other = self.with(&place, &Value::from(between))?;
        let is_linear = |(follower, &(given, ..)): (&Follower, &(f64, f64, f64))| {
            let between_them = follower.constant.value(&mut other);
            let pairs = [(si, given), (between, between_them.unwrap_or(f64::NAN))];
            let is_on_line = |(number, found): (f64, f64)| {
                let at = (found - follower.offset) / follower.factor;
                (at - number).abs() <= SAME * (upper - lower).abs().max(si.abs())
            };
            pairs.into_iter().all(is_on_line)
        };
        if !followers.iter().zip(&values).all(is_linear) {
            let found = "a number of the scene in which a constant is not linear";
            return Err(NoConstant::of_path(found, OFFERED));
        }
        Ok(in_own_units(followers, values[0], si, self.system))
    }

    /// That nothing of the system depends on the number but the followers.
    fn check_rest(
        &self,
        mut base: System,
        followers: &[Follower],
        values: &[(f64, f64, f64)],
        high: &System,
    ) -> Result<(), NoConstant> {
        if followers.is_empty() {
            let found = match base == *high {
                true => "a number of the scene on which nothing depends",
                false => "no number of the scene that can be sought",
            };
            return Err(NoConstant::of_path(found, OFFERED));
        }
        for (follower, &(_, _, b)) in followers.iter().zip(values) {
            follower.constant.set(b, &mut base);
        }
        match base == *high {
            true => Ok(()),
            false => {
                let found =
                    "a number of the scene on which more depends than constants of energies";
                Err(NoConstant::of_path(found, OFFERED))
            }
        }
    }
}

/// Followers and value in the units of the first follower, where that is the number itself.
fn in_own_units(
    mut followers: Vec<Follower>,
    (given, low, high): (f64, f64, f64),
    si: f64,
    system: &System,
) -> SceneConstant {
    let first = followers[0];
    let from_si = 1.0 / first.constant.unit(system).factor;
    let is_itself = (first.factor.abs() / from_si - 1.0).abs() <= ONE;
    let from_si = if is_itself { from_si } else { 1.0 };
    for follower in &mut followers {
        follower.factor /= from_si;
        let nearest = follower.factor.round();
        if (follower.factor - nearest).abs() <= ONE * nearest.abs() {
            follower.factor = nearest;
        }
        if follower.offset.abs() <= ONE * (low.abs() + high.abs()) {
            follower.offset = 0.0;
        }
    }
    let is_same = followers[0].factor == 1.0 && followers[0].offset == 0.0;
    SceneConstant {
        followers,
        from_si,
        value: if is_same { given } else { si * from_si },
    }
}
