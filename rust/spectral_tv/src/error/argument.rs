//! Errors about arguments: which argument, which rule it breaks, and by which value.

use std::borrow::Cow;
use std::fmt::{self, Debug, Display, Formatter};

/// An argument that cannot be used.
#[derive(Debug, Clone, PartialEq)]
pub struct ArgumentError {
    /// The name of the argument; with an index where one of its values is at fault: `targets[3]`.
    pub argument: Cow<'static, str>,
    /// What the message calls it, where that is not the name.
    pub subject: Option<Cow<'static, str>>,
    /// What is wrong with it.
    pub fault: Fault,
}

/// What is wrong with an argument.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Fault {
    /// It has a value that breaks a rule.
    Value {
        /// The rule, with its verb: "must be between 0 and 1".
        rule: Cow<'static, str>,
        /// The value.
        value: String,
    },
    /// It has another number of values than a rule asks for.
    Count {
        /// The rule, with its verb.
        rule: Cow<'static, str>,
        /// How many values it has.
        found: usize,
    },
    /// Its values do not increase.
    Order {
        /// The rule, with its verb.
        rule: Cow<'static, str>,
        /// The first index whose value is not above that before it.
        index: usize,
        /// The value there.
        value: f64,
        /// The value before it.
        before: f64,
    },
    /// It is NaN, infinite or too large.
    NonFinite {
        /// Its value.
        value: String,
    },
    /// It refers to a vertex that does not exist.
    OutOfRange {
        /// The index of the vertex.
        index: i64,
        /// The largest valid index.
        last: usize,
    },
    /// It holds nothing that the work could be done on.
    Empty {
        /// What is missing, as a sentence.
        reason: Cow<'static, str>,
    },
    /// It contradicts itself, or other arguments.
    Contradiction {
        /// The names of the other arguments.
        others: &'static [&'static str],
        /// What contradicts what, as a sentence.
        reason: Cow<'static, str>,
    },
    /// It means nothing to the chosen method, algorithm or scheme.
    Inapplicable {
        /// What it is for, as a sentence.
        reason: Cow<'static, str>,
    },
}

impl Display for ArgumentError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let name = &self.argument;
        let subject = self.subject.as_ref().unwrap_or(name);
        match &self.fault {
            Fault::Value { rule, value } => write!(f, "{subject} {rule}, not {value}"),
            Fault::Count { rule, found } => write!(f, "{subject} {rule}, but has {found}"),
            Fault::Order {
                rule,
                index,
                value,
                before,
            } => write!(
                f,
                "{subject} {rule}, but {name}[{index}] is {value} after {before}"
            ),
            Fault::NonFinite { value } => {
                write!(f, "{subject} is not finite, or beyond 1e100: {value}")
            }
            Fault::OutOfRange { index, last } => write!(
                f,
                "{subject} refers to vertex {index}, but the vertices are 0 to {last}"
            ),
            Fault::Empty { reason }
            | Fault::Contradiction { reason, .. }
            | Fault::Inapplicable { reason } => f.write_str(reason),
        }
    }
}

impl std::error::Error for ArgumentError {}

impl ArgumentError {
    /// What is wrong with the argument of that name.
    pub fn new(argument: impl Into<Cow<'static, str>>, fault: Fault) -> Self {
        Self {
            argument: argument.into(),
            subject: None,
            fault,
        }
    }

    /// The same, whose message calls the argument so.
    pub fn called(self, subject: impl Into<Cow<'static, str>>) -> Self {
        Self {
            subject: Some(subject.into()),
            ..self
        }
    }

    /// A value that breaks a rule, which has a verb: "must be between 0 and 1".
    pub fn value(
        argument: impl Into<Cow<'static, str>>,
        rule: impl Into<Cow<'static, str>>,
        value: impl Display,
    ) -> Self {
        let (rule, value) = (rule.into(), value.to_string());
        Self::new(argument, Fault::Value { rule, value })
    }

    /// A wrong number of values; the rule has a verb: "must have one value per vertex (162)".
    pub fn count(
        argument: impl Into<Cow<'static, str>>,
        rule: impl Into<Cow<'static, str>>,
        found: usize,
    ) -> Self {
        let rule = rule.into();
        Self::new(argument, Fault::Count { rule, found })
    }

    /// Values of which that at `index` is not above that before it.
    pub(crate) fn order(
        argument: &'static str,
        rule: &'static str,
        values: &[f64],
        index: usize,
    ) -> Self {
        let fault = Fault::Order {
            rule: rule.into(),
            index,
            value: values[index],
            before: values[index - 1],
        };
        Self::new(argument, fault)
    }

    /// A value that is NaN, infinite or too large.
    pub fn non_finite(argument: impl Into<Cow<'static, str>>, value: impl Debug) -> Self {
        let value = format!("{value:?}");
        Self::new(argument, Fault::NonFinite { value })
    }

    /// Nothing to work on; a sentence says why.
    pub fn empty(
        argument: impl Into<Cow<'static, str>>,
        reason: impl Into<Cow<'static, str>>,
    ) -> Self {
        let reason = reason.into();
        Self::new(argument, Fault::Empty { reason })
    }

    /// A contradiction with itself, or with others; a sentence says which.
    pub fn contradiction(
        argument: impl Into<Cow<'static, str>>,
        others: &'static [&'static str],
        reason: impl Into<Cow<'static, str>>,
    ) -> Self {
        let reason = reason.into();
        Self::new(argument, Fault::Contradiction { others, reason })
    }

    /// An argument that does not apply; a sentence says what it is for.
    pub fn inapplicable(
        argument: impl Into<Cow<'static, str>>,
        reason: impl Into<Cow<'static, str>>,
    ) -> Self {
        let reason = reason.into();
        Self::new(argument, Fault::Inapplicable { reason })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Error;

    #[test]
    fn an_error_tells_the_argument_the_rule_and_the_value() {
        let error = Error::from(ArgumentError::value("weights[2]", "must be in (0, 1]", 1.5));
        assert_eq!(error.to_string(), "weights[2] must be in (0, 1], not 1.5");
        let Error::Argument(found) = error else {
            panic!("{error}");
        };
        assert_eq!(found.argument, "weights[2]");
        assert!(matches!(found.fault, Fault::Value { value, .. } if value == "1.5"));
    }

    #[test]
    fn a_message_may_call_the_argument_otherwise_than_its_name() {
        let error = ArgumentError::order("edges", "must increase", &[0.0, 2.0, 1.0], 2);
        assert_eq!(
            error.called("the edges of the bands").to_string(),
            "the edges of the bands must increase, but edges[2] is 1 after 2"
        );
    }
}
