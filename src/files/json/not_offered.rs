//! Words for features that are not offered, and the messages about them.

/// Place of the list of the limits.
const LIMITS: &str = "docs/accuracy.md#limits-of-validity";

/// Words that stand for one thing, and the message about it.
struct NotOffered {
    /// Singular, in lower case with underscores.
    words: &'static [&'static str],
    /// Message: the features offered, and the way to use them instead.
    said: &'static str,
}

/// Words for which users look.
const TABLE: &[NotOffered] = &[
    NotOffered {
        words: &[
            "contact",
            "contact_pair",
            "collision",
            "collider",
            "impact",
            "self_contact",
            "floor",
            "wall",
            "ground_plane",
            "restitution",
        ],
        said: "there is no contact: bodies and blocks pass through each other; a marker of a control problem is kept out of a region by \"limits\"",
    },
    NotOffered {
        words: &["obstacle"],
        said: "there is no contact; a marker of a control problem is kept out of a region by \"limits\": { \"marker\": { \"marker\": …, \"outside\": … } }",
    },
    NotOffered {
        words: &[
            "friction",
            "coulomb_friction",
            "friction_coefficient",
            "dry_friction",
            "stiction",
        ],
        said: "there is no friction; \"damping\" of joints and springs and \"viscosity\" of materials are viscous",
    },
    NotOffered {
        words: &[
            "motor",
            "torque",
            "joint_torque",
            "servo",
            "actuator",
            "drive",
            "force",
            "load",
            "external_force",
            "wrench",
            "pressure",
            "pneumatic",
            "traction",
            "body_force",
            "surface_charge",
        ],
        said: "a motor, force, torque, pressure, traction or surface charge is an entry of \"loads\" of a scene; a servo that prescribes a motion is \"motion\" of a joint",
    },
    NotOffered {
        words: &[
            "fluid",
            "drag",
            "air_resistance",
            "aerodynamics",
            "buoyancy",
            "hydraulic",
        ],
        said: "there is no fluid; a pressure on a solid is an entry of \"loads\" of a scene",
    },
    NotOffered {
        words: &[
            "circuit",
            "current",
            "resistance",
            "resistor",
            "inductance",
            "electronics",
            "amplifier",
            "leakage",
            "conductivity",
            "power_supply",
        ],
        said: "the electronics are a resistor and a leak, \"circuit\": { \"resistance\": …, \"leakage\": … } of a lumped muscle; limits of \"current\" and \"power\" are \"limits\" of a \"control\"",
    },
    NotOffered {
        words: &[
            "temperature",
            "thermal",
            "thermal_expansion",
            "heat",
            "heat_capacity",
        ],
        said: "there is no temperature",
    },
    NotOffered {
        words: &[
            "plasticity",
            "yield_stress",
            "hardening",
            "damage",
            "fatigue",
            "fracture",
            "mullins",
        ],
        said: "materials are elastic and viscous; they neither yield nor break",
    },
    NotOffered {
        words: &[
            "arruda_boyce",
            "hyperelastic",
            "constitutive_law",
            "prony",
            "creep",
            "maxwell",
            "relaxation_time",
            "youngs_modulus",
            "young_modulus",
            "elastic_modulus",
        ],
        said: "materials are neo-Hookean, given by \"shear_modulus\" with \"lame_lambda\" or \"poisson_ratio\", or follow a \"law\": \"gent\", \"mooney_rivlin\", \"yeoh\" or \"ogden\"; \"viscosity\" is of Kelvin–Voigt kind, and \"maxwell\" lists Maxwell branches",
    },
    NotOffered {
        words: &[
            "cardan", "hooke", "screw", "helical", "hinge", "ball", "pin", "slider", "weld",
            "rigid",
        ],
        said: "joints are \"revolute\" (a hinge), \"prismatic\" (a slider), \"universal\" (a Cardan or Hooke joint), \"cylindrical\", \"planar\", \"spherical\" (a ball joint), \"floating\" and \"fixed\" (a weld)",
    },
    NotOffered {
        words: &[
            "feedback",
            "controller",
            "pid",
            "mpc",
            "gain",
            "policy",
            "noise",
            "sensor",
            "observer",
            "disturbance",
        ],
        said: "gains and an observer follow from \"feedback\" beside \"control\"; the \"controller\" of \"simulate\" reads them, or plans anew over a \"horizon\", and has the \"noise\" of what it measures",
    },
    NotOffered {
        words: &[
            "urdf", "mjcf", "stl", "obj", "cad", "visual", "colour", "color", "texture",
        ],
        said: "shapes are cylinders, boxes and spheres, and meshes of blocks are Gmsh files",
    },
    NotOffered {
        words: &[
            "shell",
            "membrane",
            "beam",
            "cloth",
            "rope",
            "tet4",
            "tet10",
            "tetrahedra",
            "hex20",
            "hex27",
            "c3d8",
            "c3d8h",
            "c3d10",
        ],
        said: "elements are hexahedra, \"hex8\" and \"hex8_q1p0\"; a cable is one of \"tendons\"",
    },
    NotOffered {
        words: &[
            "rk4",
            "runge_kutta",
            "rk45",
            "ode45",
            "dopri5",
            "radau",
            "radau5",
            "bdf",
            "gauss",
            "gauss_legendre",
            "lobatto",
            "dop853",
            "adams",
            "lsoda",
        ],
        said: "of order 4 is { \"galerkin\": 2 }, of order 6 { \"galerkin\": 3 }: variational integrators",
    },
    NotOffered {
        words: &[
            "euler",
            "explicit_euler",
            "forward_euler",
            "symplectic_euler",
            "semi_implicit_euler",
            "verlet",
            "leapfrog",
            "stormer_verlet",
            "velocity_verlet",
        ],
        said: "of these kinds are \"midpoint\", of order 2 and symplectic, and \"implicit_euler\", of order 1",
    },
    NotOffered {
        words: &[
            "newmark",
            "hht",
            "hht_alpha",
            "wbz",
            "bathe",
            "trapezoidal",
            "crank_nicolson",
        ],
        said: "of this kind is \"generalised_alpha\", of order 2",
    },
];

/// Returns the message about a word that stands for a feature that is not offered.
pub(super) fn not_offered(word: &str) -> Option<String> {
    let word = word.to_lowercase().replace([' ', '-'], "_");
    let one = TABLE.iter().find(|entry| {
        let is_meant = |known: &&str| *known == word || word.strip_suffix('s') == Some(known);
        entry.words.iter().any(is_meant)
    })?;
    Some(format!("which is not offered ({}: {LIMITS})", one.said))
}
