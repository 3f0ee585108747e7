//! A robot of two links from URDF: the motion of the same scene written by hand.

use proboscis::control::problem::Task;
use proboscis::dynamics::trajectory::Trajectory;
use proboscis::files::read_problem;
use proboscis::files::urdf::parse_urdf;
use proboscis::workflow::integrate;
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

/// The frame of `upper` is turned by 90° about z, that of `lower` by 90° about x of that.
const URDF: &str = include_str!("../../problems/urdf/two_links.urdf");

/// The same in the ground frame: x, y, z of `upper` are along y, −x, z; those of `lower` along y, z, x.
const SCENE: &str = r#"{
  "name": "two links",
  "bodies": [
    { "name": "upper", "mass": 1.5, "position": [0.07, 0.22, 0.75], "inertia": [0.018, 0.02, 0.006],
      "products_of_inertia": [-0.001, -0.0015, -0.002] },
    { "name": "lower", "mass": 0.8, "position": [-0.01, 0.25, 0.64], "inertia": [0.0012, 0.003, 0.0035],
      "products_of_inertia": [0.0004, 0, 0], "cylinder": { "length": 0.2, "radius": 0.02, "axis": [1, 0, 0] } }
  ],
  "joints": [
    { "name": "shoulder", "revolute": { "axis": [-1, 0, 0] }, "parent": "ground", "child": "upper", "at": [0.1, 0.2, 0.9], "damping": 0.02 },
    { "name": "elbow", "revolute": { "axis": [0, 1, 0] }, "parent": "upper", "child": "lower", "at": [0.09, 0.25, 0.6] }
  ],
  "markers": [ { "name": "tool", "body": "lower", "at": [-0.11, 0.25, 0.6] } ],
  "gravity": [0, 0, "-9.81 m/s^2"]
}"#;

const PROBLEM: &str =
    r#"{ "scene": "scene.json", "simulate": { "duration": "0.5 s", "step": "1 ms" } }"#;

fn motion(scene: &str) -> Trajectory {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.json"), scene).unwrap();
    let path = folder.path().join("problem.json");
    fs::write(&path, PROBLEM).unwrap();
    let loaded = read_problem(&path, &[]).unwrap();
    let Task::Simulate(task) = &loaded.task else {
        panic!("a simulation")
    };
    let run = integrate(&loaded.system, task, |_, _| ControlFlow::Continue(())).unwrap();
    assert_eq!(run.failure, None);
    Trajectory::from_discrete(&run.model, &run.discrete)
}

#[test]
fn two_links_move_as_the_scene_by_hand() {
    let found = parse_urdf(Path::new("robot.urdf"), URDF).unwrap();
    assert!(found.meshes.is_empty());
    let [ours, theirs] = [found.scene.as_str(), SCENE].map(motion);
    assert_eq!(ours.times.len(), 501);
    let way = (ours.marks[500][0] - ours.marks[0][0]).norm();
    let turned = (ours.marks[500][0] - ours.poses[500][1].centre).normalize();
    assert!(way > 100.0 && turned.x.abs() < 0.9, "{way} {turned}");
    // Lengths are about 1 m = 1000 mm.
    for (k, (a, b)) in ours.marks.iter().zip(&theirs.marks).enumerate() {
        let distance = (a[0] - b[0]).norm();
        assert!(distance < 1e-12 * 1e3, "{distance} at {k}");
        for (a, b) in ours.poses[k].iter().zip(&theirs.poses[k]) {
            assert!((a.centre - b.centre).norm() < 1e-12 * 1e3, "at {k}");
        }
    }
}
