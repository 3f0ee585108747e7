//! "solved" means that no smaller objective is near, whatever its size, and similar problems have similar optima.

use crate::common::similar::{Scales, problem_of};
use crate::limits::run;
use proboscis::math::Random;
use serde_json::{Value, json};

/// Objectives of "solved" optima may lie this part above the least one: that of the product, and what its bounds are relaxed by.
const NEAR: f64 = 2e-6;

/// A motion of a cart from a speed to a place at rest, under a motor whose bounds are so many times what the least effort needs.
struct Cart {
    mass: f64,
    speed: f64,
    place: f64,
    duration: f64,
    intervals: usize,
    weight: f64,
}

impl Cart {
    fn random(random: &mut Random) -> Self {
        let mut power = |low: f64, high: f64| 10_f64.powf(random.between(low, high));
        let (mass, place, duration) = (power(-6.0, 1.0), power(-6.0, 0.0), power(-3.0, 2.0));
        let (weight, intervals) = (power(-6.0, 12.0), power(0.8, 2.0) as usize);
        Self {
            mass,
            speed: random.between(-2.0, 2.0) * place / duration,
            place,
            duration,
            intervals,
            weight,
        }
    }

    /// The forces of least effort: the shortest vector u of A u = r, with the rows of momentum and place of the midpoint rule.
    fn forces(&self) -> Vec<f64> {
        let (n, h) = (self.intervals, self.duration / self.intervals as f64);
        let of_momentum = vec![h; n];
        let of_place: Vec<f64> = (0..n)
            .map(|k| h * h / self.mass * ((n - k) as f64 - 0.5))
            .collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (aa, ab, bb) = (
            dot(&of_momentum, &of_momentum),
            dot(&of_momentum, &of_place),
            dot(&of_place, &of_place),
        );
        let r = [
            -self.mass * self.speed,
            self.place - self.duration * self.speed,
        ];
        let det = aa * bb - ab * ab;
        let y = [(bb * r[0] - ab * r[1]) / det, (aa * r[1] - ab * r[0]) / det];
        let each = of_momentum.iter().zip(&of_place);
        each.map(|(a, b)| a * y[0] + b * y[1]).collect()
    }

    fn least(&self) -> f64 {
        let h = self.duration / self.intervals as f64;
        self.weight * h * self.forces().iter().map(|u| u * u).sum::<f64>()
    }

    fn problem(&self, bound: f64) -> Value {
        json!({
            "scene": {
                "name": "cart",
                "bodies": [ {
                    "name": "cart", "mass": self.mass, "position": [0, 0, 0], "inertia": [self.mass, self.mass, self.mass]
                } ],
                "joints": [ {
                    "name": "x", "prismatic": { "axis": [1, 0, 0] }, "parent": "ground", "child": "cart", "at": [0, 0, 0]
                } ],
                "loads": [ { "name": "motor", "joint": "x" } ]
            },
            "control": {
                "duration": self.duration, "intervals": self.intervals,
                "start": { "joint_rates": { "x": self.speed } },
                "goal": { "joint_angles": { "x": self.place }, "hold": "none" },
                "load_bounds": { "motor": [-bound, bound] },
                "objective": { "effort": self.weight }
            }
        })
    }
}

#[test]
fn the_least_effort_is_found_under_bounds_of_any_width() {
    let mut random = Random::new(62);
    for number in 0..40 {
        let cart = Cart::random(&mut random);
        let largest = cart.forces().iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        let width = 10_f64.powf(random.between(0.2, 7.0));
        let ran = run("solve", &cart.problem(width * largest), &[]);
        let summary = ran.read("summary.json");
        let found = summary["objective"].as_f64().unwrap();
        let (status, least) = (&summary["status"], cart.least());
        assert!(
            found >= least * (1.0 - NEAR),
            "{number}: {found} below {least}"
        );
        assert_eq!(status, "solved", "{number}: {found} for {least}");
        assert!(
            found <= least * (1.0 + NEAR),
            "{number}: {found} for {least}, bounds {width}"
        );
    }
}

#[test]
fn an_effort_that_a_final_cost_hides_is_the_least_one() {
    // The second one has two minima; which one is met depends on the version of Ipopt.
    for (path, minima) in [
        (
            "tests/trust/final_cost_hides_effort.json",
            &[1.084_63e-9][..],
        ),
        (
            "tests/trust/limits_tiny_objective_gap.json",
            &[1.122_21e-8, 1.127_55e-8],
        ),
    ] {
        let ran = run("solve", &problem_of(path), &[]);
        let summary = ran.read("summary.json");
        let found = summary["objective"].as_f64().unwrap();
        let is_met = |least: &f64| (found / least - 1.0).abs() < 1e-4;
        assert!(minima.iter().any(is_met), "{path}: {found}");
        let gap = summary["gap"].as_f64().unwrap();
        let is_told = summary["status"] == "acceptable";
        assert!(is_told || gap <= 1e-6 * found, "{path}: {gap} of {found}");
    }
}

#[test]
fn similar_problems_have_similar_optima() {
    let scales = [
        Scales::in_vacuum(2e-4, 0.03, 0.02),
        Scales::in_vacuum(3e2, 11.0, 40.0),
        Scales::in_vacuum(0.7, 1.3, 1.9),
    ];
    for path in [
        "problems/pair.json",
        "problems/pair_rate.json",
        "problems/pair_time.json",
        "problems/pair_tension.json",
        "problems/pair_energy.json",
        "tests/trust/final_cost_hides_effort.json",
    ] {
        let problem = problem_of(path);
        let outcome = |problem: &Value| {
            let ran = run("solve", problem, &[]);
            let summary = ran.read("summary.json");
            let warnings = summary["warnings"].as_array().map_or(0, Vec::len);
            let objective = summary["objective"].as_f64().unwrap();
            let counts = (
                summary["status"].clone(),
                warnings,
                summary["iterations"].clone(),
            );
            (objective, counts)
        };
        let (objective, counts) = outcome(&problem);
        assert!(objective > 0.0);
        for scales in &scales {
            let (similar, other) = outcome(&scales.problem(&problem));
            assert_eq!(counts, other, "{path} {scales:?}");
            assert!(
                (similar / objective - 1.0).abs() < 1e-9,
                "{path} {scales:?}: {similar:e} for {objective:e}"
            );
        }
    }
}
