//! Optimal control through contacts that are open along the whole guess, with limits of their forces and gaps: carts that push each other,
//! integrated once more.

use crate::phases::{read, solved};
use proboscis::control::problem::ControlTask;
use proboscis::tasks::MotionsResult;
use proboscis::workflow::{Iterate, SolveLimits, Stages, optimise};
use serde_json::{Value, json};
use std::ops::ControlFlow;

/// Masses in kg, radii and gap in mm, time in s, intervals, stiffness in N/mm.
const MASSES: [f64; 2] = [0.2, 0.1];
const RADII: f64 = 10.0;
const GAP: f64 = 20.0;
const DURATION: f64 = 0.5;
const INTERVALS: usize = 80;
const STIFFNESS: f64 = 0.5;

/// Two carts on a rail along x: a force drives the first one, which has to push the second one to a place.
fn carts(unit: f64, way: f64) -> Value {
    let mm = |x: f64| format!("{} mm", x * unit);
    let place = [0.0, 2.0 * RADII + GAP];
    let cart = |name: &str, i: usize| {
        json!({
            "name": name, "mass": format!("{} kg", MASSES[i]), "position": [mm(place[i]), 0, 0],
            "sphere": { "radius": mm(RADII) },
        })
    };
    let rail = |name: &str, child: &str, i: usize| {
        json!({
            "name": name, "prismatic": { "axis": [1, 0, 0] }, "parent": "ground", "child": child, "at": [mm(place[i]), 0, 0],
        })
    };
    let sphere = |body: &str, i: usize| json!({ "body": body, "at": [mm(place[i]), 0, 0], "radius": mm(RADII) });
    json!({
        "scene": {
            "name": "carts",
            "bodies": [cart("first", 0), cart("second", 1)],
            "joints": [rail("driven", "first", 0), rail("pushed", "second", 1)],
            "contacts": [{
                "name": "buffer", "sphere": sphere("first", 0), "other": sphere("second", 1),
                "stiffness": format!("{STIFFNESS} N/mm"), "smoothing": mm(0.5),
                "restitution": { "coefficient": 0.5, "speed": format!("{} m/s", 0.1 * unit) },
            }],
            "loads": [{ "name": "drive", "joint": "driven" }],
        },
        "control": {
            "duration": format!("{DURATION} s"),
            "intervals": INTERVALS,
            "start": { "joint_angles": {} },
            "goal": "free",
            "waypoints": [{ "part": 1, "joint_angles": { "pushed": mm(way) } }],
            "load_bounds": { "drive": [format!("{} N", -5.0 * unit), format!("{} N", 5.0 * unit)] },
            "objective": { "effort": 1 },
        },
    })
}

/// The law of the contact, written again.
struct Law {
    unit: f64,
    damping: f64,
    release: f64,
}

impl Law {
    fn new(unit: f64) -> Self {
        // κ (1 + e) = ln[(1 + κ)/(1 − κ e)] by bisection.
        let e = 0.5_f64;
        let excess = |k: f64| ((1.0 + k) / (1.0 - k * e)).ln() - k * (1.0 + e);
        let (mut low, mut high) = (1e-6, 2.0 - 1e-12);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            match excess(middle) > 0.0 {
                true => high = middle,
                false => low = middle,
            }
        }
        Self {
            unit,
            damping: low / (0.1 * unit),
            release: 1.0 - low * e,
        }
    }

    /// Force at a gap and its rate.
    fn force(&self, gap: f64, rate: f64) -> f64 {
        let ramp = |x: f64, w: f64| {
            let t: f64 = x / w + 0.5;
            match t {
                t if t <= 0.0 => [0.0, 0.0],
                t if t >= 1.0 => [x, 1.0],
                t => [
                    w * (t.powi(6) - 3.0 * t.powi(5) + 2.5 * t.powi(4)),
                    6.0 * t.powi(5) - 15.0 * t.powi(4) + 10.0 * t.powi(3),
                ],
            }
        };
        let [s, slope] = ramp(-gap, 0.5 * self.unit);
        let [growth, _] = ramp(1.0 - self.damping * rate, self.release);
        STIFFNESS * s * slope * growth
    }
}

/// Way of the second cart under forces in N, in mm, by many steps of Euler's symplectic method.
fn pushed(forces: &[f64], unit: f64) -> f64 {
    let steps = 4000;
    let h = DURATION * 1e3 / (forces.len() * steps) as f64;
    let law = Law::new(unit);
    let (mut x, mut v) = ([0.0; 2], [0.0; 2]);
    for force in forces {
        for _ in 0..steps {
            let push = law.force(GAP * unit + x[1] - x[0], v[1] - v[0]);
            v[0] += h * (force - push) / (1e3 * MASSES[0]);
            v[1] += h * push / (1e3 * MASSES[1]);
            x[0] += h * v[0];
            x[1] += h * v[1];
        }
    }
    x[1]
}

/// Greatest force in the middles of the intervals, and the least gap at the instants.
fn extremes(found: &MotionsResult) -> [f64; 2] {
    let motion = &found.list[0].optimum.motion;
    let gaps: Vec<f64> = motion.joints.iter().map(|x| GAP + x[1] - x[0]).collect();
    let h = motion.times[1] - motion.times[0];
    let law = Law::new(1.0);
    let forces = gaps
        .windows(2)
        .map(|pair| law.force(0.5 * (pair[0] + pair[1]), (pair[1] - pair[0]) / h));
    [
        forces.fold(0.0, f64::max),
        gaps.iter().copied().fold(f64::INFINITY, f64::min),
    ]
}

fn forces(found: &MotionsResult) -> Vec<f64> {
    let rows = found.list[0].optimum.motion.voltages.iter();
    rows.map(|row| row[0]).collect()
}

#[test]
fn a_contact_that_is_open_along_the_guess_is_found_at_every_scale() {
    let mut objectives = Vec::new();
    for (unit, way) in [(1.0, 25.0), (1.0, 60.0), (0.1, 60.0)] {
        let found = solved(&carts(unit, way));
        assert!(found.list[0].optimum.stages.solved > 0);
        let end = pushed(&forces(&found), unit) / unit;
        let apart = (end - way).abs() / way;
        assert!(apart < 0.015, "{unit}: {end} for {way}");
        objectives.push(found.list[0].optimum.solution.objective);
    }
    // Of squared forces.
    let ratio = objectives[1] / objectives[2];
    assert!((ratio - 100.0).abs() < 1e-3, "{ratio}");
}

#[test]
fn limits_hold_normal_forces_and_gaps() {
    let objective = |found: &MotionsResult| found.list[0].optimum.solution.objective;
    let free = solved(&carts(1.0, 60.0));
    let [most, deepest] = extremes(&free);
    assert!(most > 0.1 && deepest < -0.3, "{most} {deepest}");
    let limits = [
        json!({ "contact_force": { "contact": "buffer", "max": 0.7 * most } }),
        json!({ "gap": { "contact": "buffer", "min": format!("{} mm", 0.7 * deepest) } }),
    ];
    for (of, limit) in limits.into_iter().enumerate() {
        let mut problem = carts(1.0, 60.0);
        problem["control"]["limits"] = json!([limit]);
        let limited = solved(&problem);
        let reached = extremes(&limited)[of] / (0.7 * [most, deepest][of]);
        assert!((reached - 1.0).abs() < 1e-6, "{reached}");
        assert!(objective(&limited) > 1.0001 * objective(&free));
        assert!((pushed(&forces(&limited), 1.0) - 60.0).abs() < 1.0);
    }
    let mut unknown = carts(1.0, 60.0);
    unknown["control"]["limits"] = json!([{ "gap": { "contact": "wall", "min": 0 } }]);
    let error = read(&unknown).unwrap_err();
    assert!(error.contains("limits[0].gap.contact"), "{error}");
}

/// Where nothing touches there is nothing to soften.
#[test]
fn a_problem_without_contacts_has_no_stages() {
    let mut problem = carts(1.0, 60.0);
    problem["scene"]["contacts"] = json!([]);
    problem["control"]["waypoints"] = json!([{ "part": 1, "joint_angles": { "driven": "20 mm" } }]);
    let found = solved(&problem);
    assert_eq!(found.list[0].optimum.stages, Stages::default());
}

/// An earlier solution shows which contacts close: the scene's own are tried first, and are enough nearby.
#[test]
fn an_earlier_solution_needs_no_stages() {
    let found = solved(&carts(1.0, 60.0));
    let loaded = read(&carts(1.0, 61.0)).unwrap();
    let task: ControlTask<'_> = loaded.task.motions(&loaded.system).unwrap();
    let go_on = &mut |_: &Iterate<'_>| ControlFlow::Continue(());
    let earlier = &found.list[0].optimum.motion;
    let (limits, control) = (SolveLimits::default(), task.motions[0].control);
    let next = optimise(&loaded.system, control, Some(earlier), limits, go_on).unwrap();
    assert!(next.is_solved() && next.stages == Stages::default());
    let objective = solved(&carts(1.0, 61.0)).list[0].optimum.solution.objective;
    let apart = next.solution.objective / objective - 1.0;
    assert!(apart.abs() < 1e-6, "{apart}");
}

/// Height of the middle of the ball above that of the arm on which it rests, in mm.
const HEIGHT: f64 = 12.75;
const GRAVITY: f64 = 9.81e-3;

/// An arm on a hinge between two muscles throws a ball that rests in a notch at its end to a place in the air.
fn thrown() -> Value {
    let mm = |x: f64| format!("{x} mm");
    let muscle = |name: &str, side: f64| {
        json!({
            "name": name, "material": "silicone", "cross_section": ["10 mm", "10 mm"], "layer_thickness": "50 um",
            "from": { "body": "ground", "at": ["20 mm", mm(45.0 * side), 0] },
            "to": { "body": "arm", "at": ["20 mm", mm(5.0 * side), 0] },
        })
    };
    let edge = |name: &str, x: f64| {
        json!({
            "name": name, "sphere": { "body": "arm", "at": [mm(x), "3 mm", 0], "radius": "4 mm" },
            "other": { "body": "ball", "at": ["50 mm", mm(HEIGHT), 0], "radius": "8 mm" },
            "stiffness": "1 N/mm", "restitution": { "coefficient": 0.5, "speed": "0.2 m/s" }, "smoothing": "0.5 mm",
            "friction": 0.201, "slip_speed": "20 mm/s",
        })
    };
    let silicone = json!({
        "density": "1000 kg/m^3", "shear_modulus": "100 kPa", "relative_permittivity": 3.0, "viscosity": "1000 Pa s",
    });
    json!({
        "scene": {
            "name": "throw",
            "materials": { "silicone": silicone },
            "bodies": [
                { "name": "arm", "mass": "20 g", "box": { "size": ["60 mm", "6 mm", "10 mm"] }, "position": ["30 mm", 0, 0] },
                { "name": "ball", "mass": "8.97 g", "sphere": { "radius": "8 mm" }, "position": ["50 mm", mm(HEIGHT), 0] },
            ],
            "joints": [
                { "name": "hinge", "revolute": { "axis": [0, 0, 1] }, "parent": "ground", "child": "arm", "at": [0, 0, 0] },
                {
                    "name": "plane", "planar": { "normal": [0, 0, 1] }, "parent": "ground", "child": "ball",
                    "at": ["50 mm", mm(HEIGHT), 0],
                },
            ],
            "muscles": [muscle("up", 1.0), muscle("down", -1.0)],
            "contacts": [edge("back", 43.0), edge("front", 57.0)],
            "markers": [{ "name": "ball", "body": "ball", "at": ["50 mm", mm(HEIGHT), 0] }],
            "gravity": [0, "-9.81 m/s^2", 0],
        },
        "control": {
            "duration": "218.8 ms",
            "intervals": 30,
            "start": { "joint_angles": {} },
            "goal": "free",
            "waypoints": [{ "part": 1, "markers": { "ball": ["14.27 mm", "63.26 mm", null] } }],
            "voltage_bounds": ["0 V", "3 kV"],
            "objective": { "effort": 1.0, "rate": 0.0005 },
        },
    })
}

/// Steps of a solver do not open a contact that is closed along the whole guess; simulations do. Once in the air the ball falls freely, and its
/// parabola leads to the place.
#[test]
fn a_ball_is_thrown_to_a_place_in_the_air() {
    let found = solved(&thrown());
    let optimum = &found.list[0].optimum;
    assert!(optimum.stages.is_simulated, "{:?}", optimum.stages);
    let ball: Vec<_> = optimum
        .motion
        .poses
        .iter()
        .map(|poses| poses[1].centre)
        .collect();
    let last = ball.len() - 1;
    let h = optimum.motion.times[1];
    let falls = |k: &usize| {
        let bend = ball[k + 1] - ball[*k] * 2.0 + ball[k - 1];
        bend.x.abs() < 1e-6 && (bend.y / (h * h) + GRAVITY).abs() < 1e-6
    };
    let free = (1..last).rev().take_while(falls).count();
    assert!(free >= last / 5, "{free}");
    let (k, after) = (last - free, (free as f64 + 0.5) * h);
    // From a middle between two instants, whose velocity the method has.
    let velocity = (ball[k] - ball[k - 1]) / h;
    let middle = (ball[k] + ball[k - 1]) / 2.0 + nalgebra::Vector3::y() * GRAVITY * h * h / 8.0;
    let mut end = middle + velocity * after;
    end.y -= 0.5 * GRAVITY * after.powi(2);
    let place = nalgebra::Vector3::new(14.27, 63.26, 0.0);
    assert!((end - place).norm() < 1e-4, "{end} after {after}");
}
