//! Finite elements by laws of elasticity whose constants are sought.

use crate::common::sought::{elements, parameter};

use proboscis::energy::ElasticLaw;
use proboscis::model::{Constant, Follower, MaterialConstant as M, Parameter, System};

/// The muscle and the block of `elements`, by Yeoh's law, that of Mooney and Rivlin, and Gent's, and constants of all of them.
pub(crate) fn by_laws() -> (System, Vec<Parameter>) {
    let (mut system, _) = elements();
    system.muscles[0].material.law = Some(ElasticLaw::Yeoh { c2: 0.02, c3: 0.01 });
    let solid = &mut system.solids[0];
    solid.materials[0].law = Some(ElasticLaw::Gent { limit: 9.0 });
    solid.materials[1].law = Some(ElasticLaw::MooneyRivlin { share: 0.3 });
    let of_muscle = |name| M::Law(name).of_muscle(0);
    let [gent, rivlin] = [0, 1].map(|k| move |constant: M| constant.of_block(0, k));
    // The limit is no straight line in a parameter that the modulus follows too.
    let limit = Follower {
        constant: gent(M::Law("limit")),
        factor: 40.0,
        offset: 3.0,
        higher: [60.0, 20.0],
    };
    let modulus = |constant: Constant| (constant, 1.0);
    let mut both = parameter("gent", &[modulus(gent(M::ShearModulus))], 0.12);
    both.constants.push(limit);
    let parameters = vec![
        both,
        parameter("share", &[(rivlin(M::Law("share")), 1.0)], 0.3),
        parameter(
            "modulus",
            &[
                modulus(rivlin(M::ShearModulus)),
                (M::ShearModulus.of_muscle(0), 0.8),
            ],
            0.15,
        ),
        parameter("c2", &[(of_muscle("c2"), 1.0)], 0.02),
        parameter("c3", &[(of_muscle("c3"), 1.0)], 0.01),
        parameter("lambda", &[(gent(M::LameLambda), 1.0)], 0.6),
        parameter("permittivity", &[(gent(M::Permittivity), 1e-12)], 9.0),
    ];
    (system, parameters)
}
