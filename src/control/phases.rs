//! Phases: motions of one robot, one after another.

use crate::control::problem::{BoundaryState, Combined, Control, Motion, Motions};
use crate::math::{Fault, Key, refuse, shortest};
use crate::model::system::Joint;

/// Part of the whole duration by which a sum may differ from it.
const SAME: f64 = 1e-9;
/// Key of the list in a control problem.
const PHASES: &str = "phases";

impl Motions {
    /// Motions of which each goes on where the one before ended; all but the last have a free goal. A `whole` duration in ms is that of all together.
    ///
    /// # Errors
    /// What makes no phases: the place by the keys of a control problem.
    pub fn in_sequence(mut list: Vec<Motion>, whole: Option<f64>) -> Result<Self, Fault> {
        let count = list.len();
        refuse!(if count < 2, Key(PHASES); found "one phase", expected "a list of two phases or more");
        for (number, phase) in list.iter_mut().enumerate() {
            phase.control.continues = [number > 0, number + 1 < count];
            check(phase, &format!("{PHASES}[{number}]"))?;
        }
        if let Some(whole) = whole {
            check_sum(&list, whole)?;
        }
        Ok(Self {
            list,
            shared_inputs: Vec::new(),
            combined: Combined::InSequence(whole),
        })
    }
}

impl Control {
    /// Key of the list of motions or phases in which it stands.
    pub fn list(&self) -> &'static str {
        match self.continues {
            [false, false] => "motions",
            _ => PHASES,
        }
    }
}

/// Refuses goals of all phases but the last, one that is periodic, and functions of time of all but the first.
fn check(phase: &Motion, at: &str) -> Result<(), Fault> {
    let Motion {
        system, control, ..
    } = phase;
    let [goes_on, is_continued] = control.continues;
    let is_open = control.goal == BoundaryState::Free;
    refuse!(if is_continued && !is_open, Key(format!("{at}.goal"));
        found "a goal", expected "that of the last phase alone");
    refuse!(if control.goal == BoundaryState::Periodic, Key(format!("{at}.goal"));
        found "a periodic motion", expected "a goal of the last phase");
    if !goes_on {
        return Ok(());
    }
    let sources = system.sources();
    let mut timed = (0..sources.len()).filter(|&source| control.function(source).is_some());
    let input = timed
        .next()
        .map(|source| format!("the input of {:?}", sources[source].name));
    let moving = |joint: &&Joint| joint.motion.as_ref().is_some_and(|one| !one.is_constant());
    let joint = system.joints.iter().find(moving);
    let joint = joint.map(|joint| format!("the motion of joint {:?}", joint.name));
    refuse!(if let Some(what) = input.or(joint), Key(at);
        found format!("{what} as a function of time"),
        expected "constants: functions of time begin with the first phase");
    Ok(())
}

/// Checks that phases can last a time together.
fn check_sum(list: &[Motion], whole: f64) -> Result<(), Fault> {
    let [least, most] = [0.0, f64::INFINITY].map(|time| {
        let each = list
            .iter()
            .map(|phase| phase.control.duration.nearest(time));
        each.sum::<f64>()
    });
    let seconds = |time: f64| format!("{} s", shortest(time / 1e3, 6));
    let expected = match least < most {
        true => format!(
            "a time from {} to {}, as its phases can last",
            seconds(least),
            seconds(most)
        ),
        false => format!("the sum of the durations of its phases, {}", seconds(least)),
    };
    let room = SAME * whole;
    refuse!(unless least - room <= whole && whole <= most + room, Key("duration");
        found seconds(whole), expected expected);
    Ok(())
}
