//! Messages about a simulation.

use crate::control::problem::{Afterwards, Simulation, Voltages};
use crate::math::significant;

/// Notes the voltages after the end of the solution from which a simulation takes them, where it goes on for longer.
pub(super) fn afterwards(task: &Simulation) -> Option<String> {
    let Voltages::Sampled {
        ends,
        afterwards,
        solution,
        ..
    } = &task.voltages
    else {
        return None;
    };
    let end = ends[ends.len() - 1];
    let named = solution.as_ref().map(|path| path.display().to_string());
    let of_solution = named.is_some();
    let source = named.unwrap_or_else(|| "the table".to_owned());
    (task.duration > end * (1.0 + 1e-9)).then(|| match afterwards {
        Afterwards::Held if of_solution => {
            format!("after {} s the voltages that hold the goal of {source} are held", end / 1e3)
        }
        Afterwards::Held => format!("after {} s the voltages of \"hold\" are held", end / 1e3),
        Afterwards::OfLastInterval if of_solution => format!(
            "after {} s the voltages of the last interval are held: {source} has no \"hold\", voltages that hold its goal",
            end / 1e3
        ),
        Afterwards::OfLastInterval => format!(
            "after {} s the voltages of the last interval are held: {source} has no \"hold\"",
            end / 1e3
        ),
    })
}

/// Warnings that a controller samples or acts in other times than those for which its gains are.
pub(super) fn timing(task: &Simulation) -> Vec<String> {
    // What plans anew does so in its own times.
    let controller = task.controller.as_ref();
    let Some(controller) = controller.filter(|one| one.ahead.is_none()) else {
        return Vec::new();
    };
    let law = &controller.law;
    let predicted = law.delay as f64 * law.h;
    let of = |what: &str, time: f64, of_gains: f64| {
        let seconds = |ms: f64| significant(1e-3 * ms, 4);
        let differs = (time - of_gains).abs() > 1e-9 * law.h;
        differs.then(|| {
            format!(
                "the {what} of the controller is {} s, and that of its gains {} s: nothing says that the loop is stable",
                seconds(time),
                seconds(of_gains)
            )
        })
    };
    let both = [
        of("time between samples", controller.sample, law.h),
        of("delay", controller.delay, predicted),
    ];
    both.into_iter().flatten().collect()
}
