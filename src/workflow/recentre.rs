//! A motion with charts of its rotations where its bodies are.

use crate::control::{Carried, InitialGuess};
use crate::dynamics::DiscreteTrajectory;
use crate::model::Model;

/// A rotation that ends farther from its chart, in rad, is solved again with a chart where it ended.
const FAR: f64 = std::f64::consts::FRAC_PI_3;

/// The motion with charts where its bodies are, where it ends far from those that it has.
pub(crate) fn recentred(model: &Model, discrete: &DiscreteTrajectory) -> Option<InitialGuess> {
    let map = &model.action.map;
    let is_far = |z: &Vec<f64>| map.angle_from_charts(z) > FAR;
    discrete.z.iter().any(is_far).then(|| {
        let z = discrete.z.iter().map(|z| {
            let mut instant = map.placed(z);
            map.recentre(&mut instant);
            instant.z
        });
        InitialGuess {
            discrete: DiscreteTrajectory {
                z: z.collect(),
                ..discrete.clone()
            },
            h: discrete.times[1],
            costates: None,
            carried: Carried::default(),
        }
    })
}
