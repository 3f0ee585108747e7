//! Options of a solve: tolerance, limits, kind of start, and any option of Ipopt by name.

use crate::ipopt::ma57_adapter;
use crate::ipopt::solution::{NoStages, OptionValue};
use std::collections::BTreeMap;

/// Ordering of the linear solver's elimination unless `mumps_pivot_order` says otherwise: approximate minimum fill.
///
/// Measured on the trunk, as time inside Ipopt against this one. In joint coordinates AMD (0) takes 0.8 to 0.95. With
/// multipliers AMD takes 0.65 for a given duration and 1.5 for a free one, whose column borders the system. PORD (4)
/// takes 0.57 and 1.4 but ends the whole process on systems of a few unknowns, so it is nothing to begin with.
pub const MUMPS_ORDERING: i32 = 2;
/// Greatest tolerance of pivots. Ipopt asks for better factors by a greater tolerance, τ ← τ^¾ from 1e-8: up to this one 18 times, in place of 3
/// times up to its default.
const MOST_PIVOT_TOLERANCE: f64 = 0.9;

/// Distance kept from bounds, and fraction of their gap, when a warm start is pushed inside them.
const PUSH: f64 = 1e-9;

/// `bound_relax_factor` where nothing else is asked for.
const RELAXED: f64 = 1e-8;

/// Quality of the starting point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Start {
    /// A guess: Ipopt moves it well inside the bounds.
    Cold,
    /// A motion that keeps the equations but misses the goal: moved well inside the bounds too, but the barrier parameter is
    /// chosen in each iteration (`mu_strategy adaptive`).
    ///
    /// Median iterations of 24 random rests of the trunk: 25.5, as a guess like any other 28, interpolated 28.5. The bending block
    /// of finite elements: 28 in place of 50.
    Simulated,
    /// Variables close to a solution: they are hardly moved; the multipliers are estimated.
    Primal {
        /// First barrier parameter; [`Start::PRIMAL`] suits the same problem, 1e-4 one with another goal.
        mu_init: f64,
    },
    /// Variables and multipliers close to a solution, of the same problem or of another goal on the same grid: both are hardly
    /// moved, and the barrier parameter follows from their complementarity (`mu_strategy adaptive`).
    ///
    /// Median and sum of the iterations to 32 moved goals of the trunk (N = 20) whose voltages of rest change by up to 20, 100, 300 V: 4 and 247,
    /// 10 and 674, 39 and 1323; [`Start::Centred`] takes 10 and 430, 11 and 451, 19 and 613, a cold start about 21 each: with voltages as unknowns. The many
    /// iterations of a few come from voltages that leave zero, where neither effort nor force has a slope, and go where the squares are the unknowns
    /// ([`Nlp::squares`](crate::nlp::Nlp::squares)): at most 8 in place of 46 where a goal moves by up to 5 %.
    PrimalDual,
    /// Variables and multipliers where another solve of the same problem was stopped, and its barrier parameter: the solve is resumed.
    Resumed {
        /// The barrier parameter.
        mu_init: f64,
    },
    /// Variables and multipliers of a solution on another grid or of another duration: bounded variables and the multipliers of
    /// their bounds are moved to the barrier's path at a parameter from their complementarity, which is then chosen in each
    /// iteration. `results/gallery/warm_starts.md` shows the savings.
    Centred,
}

impl Start {
    /// [`Start::Primal`] for a problem that hardly changed.
    ///
    /// Iterations from nodes and voltages of the five reference optima: 1e-6 takes 5 to 14, 1e-7 2 to 13, 1e-8 2 to 13;
    /// with noise of 1e-3 on them 1e-8 takes up to 27 where 1e-7 takes 23.
    pub const PRIMAL: Self = Self::Primal { mu_init: 1e-7 };

    /// Returns true if the multipliers of the starting point are read.
    pub(super) fn is_dual(self) -> bool {
        matches!(
            self,
            Self::PrimalDual | Self::Centred | Self::Resumed { .. }
        )
    }

    /// Returns true if the barrier parameter is chosen in each iteration.
    fn is_adaptive(self) -> bool {
        matches!(self, Self::PrimalDual | Self::Centred | Self::Simulated)
    }
}

/// Options of a solve.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Scaled optimality error at which a point counts as solution (`tol`).
    pub tolerance: f64,
    /// Iterations allowed (`max_iter`).
    pub max_iterations: usize,
    /// Wall time allowed in seconds, checked once per iteration.
    pub max_seconds: Option<f64>,
    /// Quality of the starting point.
    pub start: Start,
    /// Solver of the linear systems, unless `extra` names another one.
    pub linear_solver: LinearSolver,
    /// Factor of the objective in place of the program's own ([`Nlp::objective_scale`](crate::nlp::Nlp::objective_scale)).
    pub objective_scale: Option<f64>,
    /// Further options of Ipopt by name; they override all others.
    pub extra: BTreeMap<String, OptionValue>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            tolerance: 1e-8,
            max_iterations: 500,
            max_seconds: None,
            start: Start::Cold,
            linear_solver: LinearSolver::Auto,
            objective_scale: None,
            extra: BTreeMap::new(),
        }
    }
}

impl Options {
    /// The linear solver; an error if this Ipopt does not take it.
    pub(super) fn taken(&self) -> Result<Taken<'_>, NoStages> {
        match self.extra.get("linear_solver") {
            Some(OptionValue::Text(name)) => Ok(Taken {
                name,
                is_along: false,
                why_not: None,
            }),
            _ => self.linear_solver.taken(),
        }
    }

    /// Returns the relaxation of bounds by Ipopt, relative to their magnitude and at least to one.
    pub(super) fn relaxed(&self) -> f64 {
        match self.extra.get("bound_relax_factor") {
            Some(&OptionValue::Number(factor)) => factor,
            Some(&OptionValue::Integer(factor)) => f64::from(factor),
            _ => RELAXED,
        }
    }

    /// Returns true if solves with these options run in several threads in parallel: those with the linear solver along the horizon.
    #[must_use]
    pub fn run_at_once(&self) -> bool {
        self.taken().is_ok_and(|taken| taken.is_along)
    }

    /// All options that Ipopt is given, by name.
    ///
    /// Ipopt is silent, reads no options file from the working directory, and leaves the scaling and the point that it returns, which may
    /// leave the bounds by what they are relaxed, to the problem.
    pub(super) fn settings(&self, solver: Taken<'_>) -> BTreeMap<String, OptionValue> {
        let mut settings = BTreeMap::new();
        let mut text = |name: &str, value: &str| {
            settings.insert(name.to_owned(), OptionValue::Text(value.to_owned()))
        };
        text("sb", "yes");
        text("option_file_name", "");
        text("linear_solver", solver.name);
        if solver.is_along {
            // An Ipopt that has MC19 would scale systems for MA57.
            text("linear_system_scaling", "none");
        }
        text("nlp_scaling_method", "none");
        text("honor_original_bounds", "no");
        text("fixed_variable_treatment", "make_parameter");
        if self.start.is_dual() {
            text("warm_start_init_point", "yes");
        }
        if self.start.is_adaptive() {
            text("mu_strategy", "adaptive");
        }

        let mut integer =
            |name: &str, value: i32| settings.insert(name.to_owned(), OptionValue::Integer(value));
        integer("print_level", 0);
        let iterations = i32::try_from(self.max_iterations).unwrap_or(i32::MAX);
        integer("max_iter", iterations);
        if solver.name == MUMPS {
            integer("mumps_pivot_order", MUMPS_ORDERING);
        }

        let mut number =
            |name: &str, value: f64| settings.insert(name.to_owned(), OptionValue::Number(value));
        number("tol", self.tolerance);
        if solver.is_along {
            number("ma57_pivtolmax", MOST_PIVOT_TOLERANCE);
        }
        let pushes: &[&str] = match self.start {
            Start::Cold | Start::Simulated => &[],
            Start::Primal { .. } => &[
                "bound_push",
                "bound_frac",
                "slack_bound_push",
                "slack_bound_frac",
            ],
            Start::PrimalDual | Start::Centred | Start::Resumed { .. } => &[
                "warm_start_bound_push",
                "warm_start_bound_frac",
                "warm_start_slack_bound_push",
                "warm_start_slack_bound_frac",
                "warm_start_mult_bound_push",
            ],
        };
        for name in pushes {
            number(name, PUSH);
        }
        if let Start::Primal { mu_init } | Start::Resumed { mu_init } = self.start {
            number("mu_init", mu_init);
        }

        for (name, value) in &self.extra {
            settings.insert(name.clone(), of_the_right_kind(name, value));
        }
        settings
    }
}

/// A whole number written for a real option, made real.
fn of_the_right_kind(name: &str, value: &OptionValue) -> OptionValue {
    match value {
        OptionValue::Integer(value) if REAL.contains(&name) => {
            OptionValue::Number(f64::from(*value))
        }
        value => value.clone(),
    }
}

/// The option of Ipopt whose name resembles `name` most, if any does and `name` itself is none.
pub(super) fn nearest(name: &str) -> Option<&'static str> {
    let known = || REAL.iter().chain(INTEGER).chain(TEXT).copied();
    if known().any(|option| option == name) {
        return None;
    }
    known()
        .map(|option| (strsim::normalized_damerau_levenshtein(name, option), option))
        .filter(|(similarity, _)| *similarity > 0.5)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, option)| option)
}

/// Common options that take a real number.
const REAL: &[&str] = &[
    "acceptable_compl_inf_tol",
    "acceptable_constr_viol_tol",
    "acceptable_dual_inf_tol",
    "acceptable_obj_change_tol",
    "acceptable_tol",
    "alpha_for_y_tol",
    "barrier_tol_factor",
    "bound_frac",
    "bound_mult_init_val",
    "bound_push",
    "bound_relax_factor",
    "compl_inf_tol",
    "constr_mult_init_max",
    "constr_viol_tol",
    "diverging_iterates_tol",
    "dual_inf_tol",
    "first_hessian_perturbation",
    "jacobian_regularization_value",
    "kappa_sigma",
    "max_cpu_time",
    "max_hessian_perturbation",
    "max_wall_time",
    "min_hessian_perturbation",
    "mu_init",
    "mu_linear_decrease_factor",
    "mu_max",
    "mu_max_fact",
    "mu_min",
    "mu_superlinear_decrease_power",
    "mu_target",
    "mumps_dep_tol",
    "mumps_pivtol",
    "mumps_pivtolmax",
    "nlp_lower_bound_inf",
    "nlp_scaling_max_gradient",
    "nlp_upper_bound_inf",
    "obj_scaling_factor",
    "resto_penalty_parameter",
    "resto_proximity_weight",
    "required_infeasibility_reduction",
    "slack_bound_frac",
    "slack_bound_push",
    "tau_min",
    "theta_max_fact",
    "theta_min_fact",
    "tol",
    "warm_start_bound_frac",
    "warm_start_bound_push",
    "warm_start_mult_bound_push",
    "warm_start_mult_init_max",
    "warm_start_slack_bound_frac",
    "warm_start_slack_bound_push",
    "warm_start_target_mu",
];

/// Common options that take an integer.
const INTEGER: &[&str] = &[
    "acceptable_iter",
    "accept_after_max_steps",
    "file_print_level",
    "limited_memory_max_history",
    "max_filter_resets",
    "max_iter",
    "max_refinement_steps",
    "max_resto_iter",
    "max_soc",
    "max_soft_resto_iters",
    "min_refinement_steps",
    "mumps_mem_percent",
    "mumps_permuting_scaling",
    "mumps_pivot_order",
    "mumps_print_level",
    "mumps_scaling",
    "print_frequency_iter",
    "print_level",
    "quality_function_max_section_steps",
    "watchdog_shortened_iter_trigger",
    "watchdog_trial_iter_max",
];

/// Common options that take a text.
const TEXT: &[&str] = &[
    "accept_every_trial_step",
    "adaptive_mu_globalization",
    "alpha_for_y",
    "bound_mult_init_method",
    "check_derivatives_for_naninf",
    "derivative_test",
    "evaluate_orig_obj_at_resto_trial",
    "expect_infeasible_problem",
    "fixed_mu_oracle",
    "fixed_variable_treatment",
    "hessian_approximation",
    "hessian_constant",
    "honor_original_bounds",
    "jac_c_constant",
    "jac_d_constant",
    "least_square_init_duals",
    "least_square_init_primal",
    "line_search_method",
    "linear_scaling_on_demand",
    "linear_solver",
    "linear_system_scaling",
    "mehrotra_algorithm",
    "mu_allow_fast_monotone_decrease",
    "mu_oracle",
    "mu_strategy",
    "nlp_scaling_method",
    "option_file_name",
    "output_file",
    "print_info_string",
    "print_timing_statistics",
    "print_user_options",
    "recalc_y",
    "sb",
    "skip_corr_if_neg_curv",
    "start_with_resto",
    "warm_start_init_point",
    "warm_start_same_structure",
];

/// Name of MUMPS in Ipopt.
pub(super) const MUMPS: &str = "mumps";

/// Solver of the linear systems of Ipopt.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LinearSolver {
    /// [`LinearSolver::Stages`] where Ipopt takes it, else [`LinearSolver::Mumps`].
    #[default]
    Auto,
    /// [`kkt`](crate::kkt), in the order of the horizon.
    Stages,
    /// MUMPS, one solve at a time in a process.
    Mumps,
}

/// The linear solver that a solve takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Taken<'o> {
    /// Name of the solver in Ipopt.
    pub(super) name: &'o str,
    /// True if it is the one along the horizon.
    pub(super) is_along: bool,
    /// Reason why it is another one, where nothing else was asked for.
    pub(super) why_not: Option<NoStages>,
}

impl LinearSolver {
    /// Returns the solver that is taken: an error if this Ipopt does not take it.
    pub(super) fn taken(self) -> Result<Taken<'static>, NoStages> {
        let stages = Taken {
            name: "ma57",
            is_along: true,
            why_not: None,
        };
        let mumps = |why_not| Taken {
            name: MUMPS,
            is_along: false,
            why_not,
        };
        match self {
            Self::Auto => {
                Ok(ma57_adapter::install().map_or_else(|why| mumps(Some(why)), |()| stages))
            }
            Self::Stages => ma57_adapter::install().map(|()| stages),
            Self::Mumps => Ok(mumps(None)),
        }
    }
}
