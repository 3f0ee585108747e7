//! Errors that prevent a call of Ipopt.

use thiserror::Error;

use crate::ipopt::no_stages::NoStages;
use crate::ipopt::option_value::OptionValue;
use crate::sparse::mumps;

/// Reason why Ipopt could not be called.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum IpoptError {
    /// Ipopt does not know the option, or the value is of another kind or out of range.
    ///
    /// Ipopt then writes a line of its own to standard output, where it is silent otherwise.
    #[error("Ipopt rejects the option {name} = {value}{}", hint(.nearest.as_deref()))]
    OptionRejected {
        /// Name of the option.
        name: String,
        /// The value given.
        value: OptionValue,
        /// The known option with the most similar name; none if the name is known, so that the value must be wrong.
        nearest: Option<String>,
    },
    /// This Ipopt takes no linear solver but those that it was built with.
    #[error("{0}: write \"auto\" or \"mumps\"")]
    NoStages(#[from] NoStages),
    /// Ipopt takes no problem without variables, nor constraints without any entry in their Jacobian.
    #[error(
        "Ipopt cannot work on {variables} variables and {constraints} constraints with {entries} entries in their Jacobian"
    )]
    ProblemNotCreated {
        /// Number of variables.
        variables: usize,
        /// Number of constraints.
        constraints: usize,
        /// Number of entries of the Jacobian.
        entries: usize,
    },
    /// OpenBLAS, which MUMPS calls, would wait for memory for ever.
    #[error("{}", mumps::NO_ROOM)]
    NoRoom,
    /// MPI, which a parallel MUMPS needs, would end the process.
    #[error("{}", mumps::NO_THREADS)]
    NoThreads,
}

fn hint(nearest: Option<&str>) -> String {
    nearest.map_or_else(String::new, |nearest| format!("; did you mean {nearest}?"))
}
