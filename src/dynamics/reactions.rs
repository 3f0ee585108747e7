//! Forces and torques that joints transmit, from the balance of momentum of the bodies on one side of each.
//!
//! The midpoint rule changes the momentum of these bodies at instant k by the impulses of the forces in the halves of the intervals
//! beside it; what is missing is the impulse of the joint during that time, and its mean the reaction at the instant, of second order.
//! First and last row are extrapolated linearly. Motors, springs, stops and dampers of a joint act through it and are included.

use crate::dynamics::discrete_trajectory::{DiscreteTrajectory, Reading};
use crate::dynamics::trajectory::Column;
use crate::functional::{Order, Output, Sample};
use crate::model::{JOINT_DAMPING, JointSection, Model};

/// Columns of the reactions of all joints outside of loops; none of methods whose energies are those at instants.
pub(super) fn reactions(model: &Model, discrete: &DiscreteTrajectory) -> Vec<Column> {
    let sections = match discrete.reading {
        Reading::Intervals => model.joint_sections(),
        Reading::Instants | Reading::States => Vec::new(),
    };
    if sections.is_empty() {
        return Vec::new();
    }
    let mut columns = columns(model, &sections);
    let rows = match discrete.intervals() {
        0 => return Vec::new(),
        _ if discrete.times.len() == 1 => {
            let [before, after] = Impulses::new(model, &sections).between([0, 0], discrete, 1.0);
            vec![sum(&before, &after)]
        }
        _ => of_motion(model, &sections, discrete),
    };
    for (i, column) in columns.iter_mut().enumerate() {
        column.values = rows.iter().map(|row| row[i]).collect();
    }
    columns
}

fn columns(model: &Model, sections: &[JointSection]) -> Vec<Column> {
    let of_section = |section: &JointSection| {
        let name = &model.system.joints[section.joint].name;
        let torque = section.has_torque.then_some(("torque", "N mm"));
        let quantities = [("force", "N")].into_iter().chain(torque);
        let column = |(quantity, unit): (&str, &'static str), axis: &str| Column {
            name: format!("{name}_{quantity}_{axis}"),
            unit,
            values: Vec::new(),
        };
        let all = quantities.flat_map(|of| ["x", "y", "z"].map(|axis| column(of, axis)));
        all.collect::<Vec<_>>()
    };
    sections.iter().flat_map(of_section).collect()
}

/// Reactions at all instants.
fn of_motion(
    model: &Model,
    sections: &[JointSection],
    discrete: &DiscreteTrajectory,
) -> Vec<Vec<f64>> {
    let times = &discrete.times;
    let end = discrete.intervals();
    let mut impulses = Impulses::new(model, sections);
    let mut halves = Vec::with_capacity(end);
    for k in 0..end {
        let h = times[k + 1] - times[k];
        halves.push(impulses.between([k, k + 1], discrete, h));
    }
    let inner = (1..end).map(|k| {
        let time = 0.5 * (times[k + 1] - times[k - 1]);
        let impulse = sum(&halves[k - 1][1], &halves[k][0]);
        impulse.iter().map(|value| value / time).collect()
    });
    let inner: Vec<Vec<f64>> = inner.collect();
    let ends = match inner.as_slice() {
        // One interval: the mean over it.
        [] => {
            let mean = sum(&halves[0][0], &halves[0][1]);
            let mean: Vec<f64> = mean
                .iter()
                .map(|value| value / (times[1] - times[0]))
                .collect();
            [mean.clone(), mean]
        }
        [only] => [only.clone(), only.clone()],
        [first, second, ..] => {
            let [before, last] = [&inner[end - 3], &inner[end - 2]];
            let part = |a: usize, b: usize, c: usize| (times[a] - times[b]) / (times[b] - times[c]);
            [
                beyond(first, second, part(0, 1, 2)),
                beyond(last, before, part(end, end - 1, end - 2)),
            ]
        }
    };
    let [first, last] = ends;
    [first].into_iter().chain(inner).chain([last]).collect()
}

fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

/// `a + part (a − b)`.
fn beyond(a: &[f64], b: &[f64], part: f64) -> Vec<f64> {
    let pairs = a.iter().zip(b);
    pairs.map(|(a, b)| a + part * (a - b)).collect()
}

/// The storage of impulses of an interval.
struct Impulses<'m> {
    model: &'m Model,
    sections: &'m [JointSection],
    out: Output,
}

impl<'m> Impulses<'m> {
    fn new(model: &'m Model, sections: &'m [JointSection]) -> Self {
        let out = model.action.intervals.output(Order::Gradient);
        Self {
            model,
            sections,
            out,
        }
    }

    /// Impulses of the joints at both ends of an interval of h ms that balance its forces.
    fn between(
        &mut self,
        ends: [usize; 2],
        discrete: &DiscreteTrajectory,
        h: f64,
    ) -> [Vec<f64>; 2] {
        let Self {
            model,
            sections,
            out,
        } = self;
        let action = &model.action;
        let scalars = &discrete.scalars[ends[0]];
        let placed = ends.map(|k| action.map.placed(&discrete.z[k]));
        let sample = Sample {
            vectors: [&placed[0].x, &placed[1].x],
            h,
            ..Sample::of_instant(&placed[0].x, scalars)
        };
        out.plain.clear(false);
        for (term, slots) in action.intervals.terms() {
            if term.name() != JOINT_DAMPING {
                term.evaluate(Order::Gradient, &sample, slots, out);
            }
        }
        [0, 1].map(|side| {
            let poses = model.condensed_poses(&placed[side]);
            let wrenches = model.wrenches(&poses, &out.plain.forces[side]);
            let reaction = |section: &JointSection| {
                let [force, torque] = section.reaction(&wrenches, &poses);
                let torque = section.has_torque.then_some(torque);
                let parts = [force].into_iter().chain(torque);
                parts.flat_map(|v| [v.x, v.y, v.z]).collect::<Vec<_>>()
            };
            sections.iter().flat_map(reaction).collect()
        })
    }
}
