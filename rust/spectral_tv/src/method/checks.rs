//! Checks of settings.

use crate::error::{ArgumentError, Result};
use crate::flow::{Scheme, check_steps};
use crate::method::Base;
use crate::method::facts::{Work, named_where};
use crate::method::options::{OPTIONS, Settings};

impl Settings {
    /// Refuses settings that make no sense, whatever the mesh.
    ///
    /// # Errors
    /// If one is out of range, or differs from its default and the method does not take it.
    pub fn check(&self) -> Result<()> {
        let facts = self.method.facts();
        self.stepping.check()?;
        for option in OPTIONS {
            if let Some((rule, holds)) = option.rule
                && !holds(self)
            {
                return Err(ArgumentError::value(option.name, rule, (option.get)(self)).into());
            }
        }
        if self.stepping.scheme == Scheme::Exact && !facts.has_exact_steps() {
            let methods = named_where(|method| method.facts().has_exact_steps(), "and");
            let message = format!("exact steps exist for {methods} only");
            return Err(ArgumentError::inapplicable("scheme", message).into());
        }
        if self.stepping.scheme == Scheme::Exact && self.total_variation.soft_edges > 0.0 {
            let message =
                "exact steps are those of total variation, so they do not go with soft_edges";
            return Err(ArgumentError::contradiction("scheme", &["soft_edges"], message).into());
        }
        let default = Self::default();
        for option in OPTIONS {
            if !(option.applies)(self.method) && (option.get)(self) != (option.get)(&default) {
                let (name, methods) = (option.name, named_where(option.applies, "and"));
                let message = format!("{name} is an option of {methods} only");
                return Err(ArgumentError::inapplicable(name, message).into());
            }
        }
        if matches!(self.base, Base::Shape(_)) && self.base_time.is_some() {
            let message = "base_time smooths the mesh itself, so it does not go with base";
            return Err(ArgumentError::contradiction("base_time", &["base"], message).into());
        }
        match (self.accuracy, &self.times, facts.work) {
            (None, None, Work::Flow { .. } | Work::Eigenpairs) => check_steps(self.steps),
            _ => Ok(()),
        }
    }
}
