//! Viewpoint of figures in space.

use nalgebra::{Matrix3, Rotation3, Vector3};

use crate::dynamics::trajectory::Trajectory;
use crate::model::system::System;
use crate::report::body::extent_points;
use crate::report::skins::{Skins, shown};
use crate::report::view::View;

/// Position of the viewer, who sees x to the right along the z and y axes, z to the left along the x axis and downwards along the y axis; of a
/// system whose gravity acts along another axis than y all of it is turned, so that it stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Viewpoint {
    /// View from the front, right and above.
    #[default]
    Oblique,
    /// Along the z axis, y upwards.
    Front,
    /// Along the x axis, y upwards.
    Side,
    /// Along the y axis, from above.
    Top,
    /// In the direction in which motion and shape of the system together are smallest.
    Auto,
}

impl Viewpoint {
    /// Word on the command line.
    pub fn word(self) -> &'static str {
        match self {
            Self::Oblique => "oblique",
            Self::Front => "front",
            Self::Side => "side",
            Self::Top => "top",
            Self::Auto => "auto",
        }
    }

    /// The view of a motion; of a single instant, of the way there from the reference configuration.
    pub fn view(self, system: &System, trajectory: &Trajectory, skins: &Skins) -> View {
        self.upright(system, || least(system, trajectory, skins))
    }

    /// The axes to the right and upwards of a figure in a plane of the ground frame, where one is asked for.
    pub fn plane(self, system: &System) -> Option<[usize; 2]> {
        let is_of_plane = matches!(self, Self::Front | Self::Side | Self::Top);
        let view = is_of_plane.then(|| self.upright(system, Vector3::z))?;
        Some([view.right, view.up].map(|axis| axis.iamax()))
    }

    fn upright(self, system: &System, least: impl FnOnce() -> Vector3<f64>) -> View {
        let upright = upright(system);
        let view = match self {
            Self::Oblique => View::oblique(),
            Self::Front => View::toward(Vector3::z()),
            Self::Side => View::toward(Vector3::x()),
            Self::Top => View::toward(Vector3::y()),
            Self::Auto => View::toward(towards_reader(upright.inverse() * least())),
        };
        View {
            right: upright * view.right,
            up: upright * view.up,
            toward: upright * view.toward,
            ..view
        }
    }
}

/// Part of gravity along an axis of the ground frame from which on the axis is vertical.
const VERTICAL: f64 = 0.9;

/// The rotation of y to the axis that points upwards: that against gravity, or y where there is none or none along an axis.
pub(super) fn upright(system: &System) -> Rotation3<f64> {
    let up = -system.gravity.unwrap_or_default();
    let axis = Vector3::ith(up.iamax(), 1.0) * up[up.iamax()].signum();
    let is_vertical = up.dot(&axis) > VERTICAL * up.norm();
    let between = Rotation3::rotation_between(&Vector3::y(), &axis);
    between.filter(|_| is_vertical).unwrap_or_default()
}

/// The direction in which motion and shape together are smallest: an eigenvector of the sum of two covariances, both of trace one, of each
/// centre, marker and corner of a surface over time, and of all corners at each time. A trunk that bends both ways moves least along itself,
/// and is longest there.
fn least(system: &System, trajectory: &Trajectory, skins: &Skins) -> Vector3<f64> {
    let mut tracks: Vec<Vec<Vector3<f64>>> = Vec::new();
    for (b, body) in system.bodies.iter().enumerate() {
        let poses = trajectory.poses.iter().map(|poses| poses[b].centre);
        tracks.push([body.pose().centre].into_iter().chain(poses).collect());
    }
    for (m, marker) in system.markers.iter().enumerate() {
        let path = trajectory.path(m);
        tracks.push([marker.point.at].into_iter().chain(path).collect());
    }
    for skin in &skins.list {
        for (c, &reference) in skin.reference.iter().enumerate() {
            let places = skin.places.iter().map(|places| places[c]);
            tracks.push([reference].into_iter().chain(places).collect());
        }
    }
    // A motion begins where it begins.
    let skipped = usize::from(trajectory.times.len() > 1);
    let motion = tracks.iter().map(|track| covariance(&track[skipped..]));
    let shape = shown(&trajectory.times, 1).into_iter().map(|k| {
        let bodies = system.bodies.iter().zip(&trajectory.poses[k]);
        let corners = bodies.flat_map(|(body, pose)| extent_points(&body.shape, pose));
        let centres = trajectory.poses[k].iter().map(|pose| pose.centre);
        let marks = trajectory.marks[k].iter().copied();
        let surfaces = skins.list.iter();
        let surfaces = surfaces.filter_map(|skin| skin.places.get(skins.position(k)));
        let all = corners.chain(centres).chain(marks);
        covariance(&all.chain(surfaces.flatten().copied()).collect::<Vec<_>>())
    });
    let all = (unit(motion.sum()) + unit(shape.sum())).symmetric_eigen();
    all.eigenvectors.column(all.eigenvalues.imin()).into_owned()
}

/// A direction or its opposite: from the front, from the right, or from below, where x is to the right and z upwards.
fn towards_reader(direction: Vector3<f64>) -> Vector3<f64> {
    let main = direction.iamax();
    let sign = if main == 1 { -1.0 } else { 1.0 };
    direction * (sign * direction[main].signum())
}

/// Sum of the products of distances from the mean of finite points.
fn covariance(points: &[Vector3<f64>]) -> Matrix3<f64> {
    let finite = || points.iter().filter(|p| p.iter().all(|x| x.is_finite()));
    let mean = finite().sum::<Vector3<f64>>() / finite().count().max(1) as f64;
    let from_mean = finite().map(|p| p - mean);
    from_mean.map(|d| d * d.transpose()).sum()
}

fn unit(matrix: Matrix3<f64>) -> Matrix3<f64> {
    matrix / matrix.trace().max(f64::MIN_POSITIVE)
}
