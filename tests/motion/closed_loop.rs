//! Joints in directors: closed loops against their reduction by hand, and each joint against a motion that is known.

use crate::common::{
    at_reference, bare, body, column, distance, joint, motion, placed, richardson, runge_kutta,
    spin,
};
use nalgebra::{Matrix3, SVector, Vector2, Vector3};
use proboscis::dynamics::trajectory::Trajectory;
use proboscis::dynamics::{Start, energies, observations};
use proboscis::model::system::{Body, JointKind, System};
use proboscis::model::{Coordinates, Model};

/// A right-handed frame whose third axis is along `d3`.
pub(crate) fn frame(d3: &Vector3<f64>) -> Matrix3<f64> {
    let d3 = d3.normalize();
    let d1 = d3
        .cross(&if d3.x.abs() < 0.6 {
            Vector3::x()
        } else {
            Vector3::y()
        })
        .normalize();
    Matrix3::from_columns(&[d1, d3.cross(&d1), d3])
}

/// A round bar from `a` to `b`.
pub(crate) fn bar(name: &str, mass: f64, axial: f64, a: Vector3<f64>, b: Vector3<f64>) -> Body {
    let transverse = mass * (b - a).norm_squared() / 12.0;
    body(
        name,
        mass,
        [transverse, transverse, axial],
        0.5 * (a + b),
        frame(&(b - a)),
    )
}

/// Crank on the ground, coupler on two spherical joints, rocker on the ground.
struct Loop {
    axes: [Vector3<f64>; 2],
    /// Ground, crank–coupler, coupler–rocker, ground.
    points: [Vector3<f64>; 4],
    masses: [f64; 3],
    gravity: Vector3<f64>,
}

pub(crate) const AXIAL: f64 = 0.01;

impl Loop {
    fn scene(&self) -> System {
        let [a, b, c, d] = self.points;
        let [m1, m2, m3] = self.masses;
        let bodies = vec![
            bar("crank", m1, AXIAL, a, b),
            bar("coupler", m2, AXIAL, b, c),
            bar("rocker", m3, AXIAL, d, c),
        ];
        let revolute = |axis| JointKind::Revolute { axis };
        let joints = vec![
            joint("drive", revolute(self.axes[0]), None, 0, a),
            joint("ball1", JointKind::Spherical, Some(0), 1, b),
            joint("ball2", JointKind::Spherical, Some(1), 2, c),
            joint("bearing", revolute(self.axes[1]), None, 2, d),
        ];
        bare(bodies, joints, Some(self.gravity))
    }

    /// Moment of inertia of a bar from `from` to `to` about an axis through `from`.
    fn inertia(
        &self,
        mass: f64,
        from: &Vector3<f64>,
        to: &Vector3<f64>,
        axis: &Vector3<f64>,
    ) -> f64 {
        let span = to - from;
        let along = span.normalize().dot(axis).powi(2);
        mass * span.norm_squared() / 3.0 * (1.0 - along) + AXIAL * along
    }

    fn ends(&self, theta: f64, phi: f64) -> [Vector3<f64>; 2] {
        let turn = |axis: &Vector3<f64>, angle: f64, v: Vector3<f64>| {
            v * angle.cos()
                + axis.cross(&v) * angle.sin()
                + axis * axis.dot(&v) * (1.0 - angle.cos())
        };
        let [a, b, c, d] = self.points;
        [
            a + turn(&self.axes[0], theta, b - a),
            d + turn(&self.axes[1], phi, c - d),
        ]
    }

    /// The angle of the rocker that closes the loop, near `phi`.
    fn close(&self, theta: f64, mut phi: f64) -> f64 {
        let length = (self.points[2] - self.points[1]).norm_squared();
        for _ in 0..20 {
            let [b, c] = self.ends(theta, phi);
            let velocity = self.axes[1].cross(&(c - self.points[3]));
            let step = ((c - b).norm_squared() - length) / (2.0 * (c - b).dot(&velocity));
            phi -= step;
            if step.abs() < 1e-15 {
                break;
            }
        }
        phi
    }

    /// Inertia m(θ) and potential V(θ) of the one degree of freedom: T = ½ m θ̇², the coupler a uniform bar that does
    /// not spin about itself.
    fn reduced(&self, theta: f64, near: f64) -> (f64, f64) {
        let phi = self.close(theta, near);
        let [a, b0, c0, d] = self.points;
        let [b, c] = self.ends(theta, phi);
        let vb = self.axes[0].cross(&(b - a));
        let turning = self.axes[1].cross(&(c - d));
        // (c − b)·(ċ − ḃ) = 0.
        let ratio = (c - b).dot(&vb) / (c - b).dot(&turning);
        let vc = turning * ratio;
        let [m1, m2, m3] = self.masses;
        let inertia = self.inertia(m1, &a, &b0, &self.axes[0])
            + m2 / 3.0 * (vb.norm_squared() + vb.dot(&vc) + vc.norm_squared())
            + ratio * ratio * self.inertia(m3, &d, &c0, &self.axes[1]);
        let weight = (a + b) * (0.5 * m1) + (b + c) * (0.5 * m2) + (c + d) * (0.5 * m3);
        (inertia, -self.gravity.dot(&weight))
    }

    /// θ at `time` from rest at zero: m θ̈ + ½ m′ θ̇² + V′ = 0 with differences of fourth order.
    fn exact(&self, time: f64, steps: usize) -> f64 {
        let rate = |y: &Vector2<f64>| {
            let d = 5e-4;
            let at = |k: f64| self.reduced(y.x + k * d, self.branch(y.x));
            let (m, _) = at(0.0);
            let [a, b, c, e] = [-2.0, -1.0, 1.0, 2.0].map(at);
            let slope = |f: &dyn Fn((f64, f64)) -> f64| {
                (f(a) - 8.0 * f(b) + 8.0 * f(c) - f(e)) / (12.0 * d)
            };
            let (dm, dv) = (slope(&|x| x.0), slope(&|x| x.1));
            Vector2::new(y.y, -(0.5 * dm * y.y * y.y + dv) / m)
        };
        let mut y = SVector::<f64, 2>::zeros();
        for _ in 0..steps {
            y = runge_kutta(&rate, &y, time / steps as f64);
        }
        y.x
    }

    /// An angle of the rocker in the branch of the assembly.
    fn branch(&self, theta: f64) -> f64 {
        let steps = 8;
        (1..=steps).fold(0.0, |phi, k| {
            self.close(theta * f64::from(k) / f64::from(steps), phi)
        })
    }

    fn angle(&self, h: f64, steps: usize) -> f64 {
        let model = Model::new(self.scene(), None, h, &[]).unwrap();
        assert_eq!(model.coordinates, Coordinates::Reduced);
        let start = Start::at_rest(&model, at_reference(&model));
        let discrete = motion(&model, &start, h, steps, &[]);
        let seen = observations(&model, &discrete);
        let violation = column(&seen, "constraint_violation")
            .iter()
            .fold(0.0_f64, |m, &v| m.max(v));
        assert!(violation < 1e-13, "{violation:e}");
        column(&seen, "drive")[steps]
    }
}

fn check_loop(linkage: &Loop, exact: f64, time: f64, n: usize, tolerance: f64) {
    let angles = [n, 2 * n, 4 * n].map(|n| linkage.angle(time / n as f64, n));
    let errors = angles.map(|a| (a - exact).abs());
    let limit = richardson(&angles);
    println!(
        "loop: {exact} by {errors:?}, limit {:e}",
        (limit - exact).abs()
    );
    assert!(exact.abs() > 0.3);
    assert!(errors[0] > 1e-6);
    for pair in errors.windows(2) {
        assert!(((pair[0] / pair[1]).log2() - 2.0).abs() < 0.1);
    }
    assert!((limit - exact).abs() < tolerance, "{limit} against {exact}");
}

#[test]
fn a_parallelogram_swings_like_its_pendulum() {
    // Two bars upright, one across (IFToMM A02 with N = 1, hung up): θ̈ = −[((N+1)/2 + N)/((N+1)/3 + N)] g sin θ.
    let (sin, cos) = 0.9_f64.sin_cos();
    let down = Vector3::new(sin, -cos, 0.0);
    let linkage = Loop {
        axes: [Vector3::z(); 2],
        points: [Vector3::zeros(), down, down + Vector3::x(), Vector3::x()],
        masses: [1.0; 3],
        gravity: Vector3::new(0.0, -9.81, 0.0),
    };
    let time = 1.0;
    // The bars stand 0.9 rad from the vertical at the start, where the angle of the joint is zero.
    let pendulum = |y: &Vector2<f64>| Vector2::new(y.y, -1.2 * 9.81 * y.x.sin());
    let mut y = Vector2::new(0.9, 0.0);
    for _ in 0..4000 {
        y = runge_kutta(&pendulum, &y, time / 4000.0);
    }
    let exact = y.x - 0.9;
    // The reduction below is the same pendulum, but for the axial inertia that the pendulum lacks (none about z).
    assert!((linkage.exact(time, 250) - exact).abs() < 1e-9);
    check_loop(&linkage, exact, time, 100, 1e-9);
}

#[test]
fn a_spatial_four_bar_moves_like_its_one_degree_of_freedom() {
    let linkage = Loop {
        axes: [
            Vector3::new(0.0, 0.1, 1.0).normalize(),
            Vector3::new(0.3, 1.0, 0.2).normalize(),
        ],
        points: [
            Vector3::zeros(),
            Vector3::new(0.5, 0.3, 0.0),
            Vector3::new(1.6, 0.9, 0.8),
            Vector3::new(1.5, 0.2, 0.0),
        ],
        masses: [1.0, 0.8, 1.5],
        gravity: Vector3::new(0.0, -9.81, 0.0),
    };
    let (time, n) = (0.4, 80);
    let exact = linkage.exact(time, 400);
    assert!((exact - linkage.exact(time, 200)).abs() < 1e-9);
    check_loop(&linkage, exact, time, n, 1e-8);

    // Energy at midpoints: bounded by O(h²).
    let errors = [n, 2 * n, 4 * n].map(|n| {
        let h = time / n as f64;
        let model = Model::new(linkage.scene(), None, h, &[]).unwrap();
        let start = Start::at_rest(&model, at_reference(&model));
        let discrete = motion(&model, &start, h, n, &[]);
        let rest = placed(&model, &start.z);
        let initial = energies(&model, &rest, &rest, &[], h).total();
        let energy = |k: usize| {
            let [a, b] = [k, k + 1].map(|k| placed(&model, &discrete.z[k]));
            energies(&model, &a, &b, &[], h)
        };
        let kinetic = (0..n).map(|k| energy(k).kinetic).fold(0.0, f64::max);
        assert!(kinetic > 1.0);
        (0..n)
            .map(|k| (energy(k).total() - initial).abs())
            .fold(0.0, f64::max)
    });
    println!("energy of the loop: {errors:?}");
    for pair in errors.windows(2) {
        assert!(((pair[0] / pair[1]).log2() - 2.0).abs() < 0.2);
    }
}

#[test]
fn a_spherical_joint_in_its_plane_is_a_hinge() {
    let bob = body(
        "bob",
        2.0,
        [0.3, 0.5, 0.7],
        Vector3::new(0.8, -0.4, 0.0),
        Matrix3::identity(),
    );
    let gravity = Some(Vector3::new(0.0, -9.81, 0.0));
    let run = |kind| {
        let pivot = joint("pivot", kind, None, 0, Vector3::zeros());
        let model = Model::new(
            bare(vec![bob.clone()], vec![pivot], gravity),
            Some(Coordinates::Redundant),
            0.01,
            &[],
        );
        let model = model.unwrap();
        let omega = Vector3::z() * 2.0;
        let rates = spin(&model.reference[0], omega.cross(&bob.centre), omega);
        let start = Start::with_rates(&model, at_reference(&model), &rates);
        let discrete = motion(&model, &start, 0.01, 300, &[]);
        Trajectory::from_discrete(&model, &discrete)
    };
    let hinge = run(JointKind::Revolute { axis: Vector3::z() });
    let ball = run(JointKind::Spherical);
    // It swung, and went round or back.
    assert!(hinge.joints.iter().any(|u| u[0].abs() > 1.0));
    let difference = distance(&hinge, &ball, 1.0);
    println!("ball against hinge: {difference:e}");
    assert!(difference < 1e-10, "{difference:e}");
}
