//! An earlier solution to start from: in memory, or read once the model exists.

use crate::control::identification::Solution;
use crate::model::Model;
use std::borrow::Cow;
use std::error::Error;
use std::fmt::Debug;
use std::path::Path;
use std::sync::Arc;

/// Source of an earlier solution.
pub trait EarlierSolution: Debug + Send + Sync {
    /// The solution, for this model.
    ///
    /// # Errors
    /// It cannot be read, or belongs to another system.
    fn solution(&self, model: &Model) -> Result<Cow<'_, Solution>, Box<dyn Error + Send + Sync>>;

    /// The file that it is read from; none where it is in memory.
    fn file(&self) -> Option<&Path> {
        None
    }
}

/// A shared earlier solution; two are equal where they are the same one.
#[derive(Clone, Debug)]
pub struct Earlier(Arc<dyn EarlierSolution>);

impl Earlier {
    /// Shares it.
    pub fn new(earlier: impl EarlierSolution + 'static) -> Self {
        Self(Arc::new(earlier))
    }

    /// The solution, for this model.
    ///
    /// # Errors
    /// As of [`EarlierSolution::solution`].
    pub fn solution(
        &self,
        model: &Model,
    ) -> Result<Cow<'_, Solution>, Box<dyn Error + Send + Sync>> {
        self.0.solution(model)
    }

    /// The file that it is read from; none where it is in memory.
    pub fn file(&self) -> Option<&Path> {
        self.0.file()
    }
}

impl PartialEq for Earlier {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}
