//! The options of a decomposition: each is declared once, with its default and the methods it is for.

use crate::error::Result;
use crate::flow::{Scheme, Stepping, TotalVariation};
use crate::method::facts::Work;
use crate::method::value::{Held, Kind, Value};
use crate::method::{Base, Flowing, Method, Metric};
use crate::solver::Solver;

/// An option: its name, for which methods it is, and its place in [`Settings`].
pub struct Choice {
    /// The name, the same everywhere.
    pub name: &'static str,
    /// What its values are.
    pub kind: Kind,
    /// Whether it can be [`Value::None`].
    pub is_optional: bool,
    /// Whether a method takes it.
    pub applies: fn(Method) -> bool,
    /// What a value has to be, and whether that of settings is so; `None` if all are fit.
    pub(super) rule: Option<Rule>,
    /// Its value.
    pub get: fn(&Settings) -> Value,
    set: fn(&mut Settings, Value) -> Result<()>,
}

/// "must be at least 1", and whether it is.
pub(super) type Rule = (&'static str, fn(&Settings) -> bool);

/// A rule of a row.
macro_rules! rule {
    ($type:ty, $($place:ident).+) => {
        None
    };
    ($type:ty, $($place:ident).+, $rule:literal: $holds:expr) => {
        Some(($rule, |settings| {
            let holds: fn(&$type) -> bool = $holds;
            holds(&settings.$($place).+)
        }))
    };
}

/// A row of the table of options.
macro_rules! choice {
    ($name:ident, $type:ty, $applies:expr, $rule:expr, $($place:ident).+) => {
        Choice {
            rule: $rule,
            name: stringify!($name),
            kind: <$type>::KIND,
            is_optional: <$type>::IS_OPTIONAL,
            applies: $applies,
            get: |settings| settings.$($place).+.to_value(),
            set: |settings, value| {
                settings.$($place).+ = <$type>::from_value(stringify!($name), value)?;
                Ok(())
            },
        }
    };
}

/// Makes [`Settings`], its defaults and [`OPTIONS`] of lines `name: type = default, applies`, with
/// `, "rule": holds` where not all values are fit. What other types hold, with the defaults that they
/// have, is in groups of their own.
macro_rules! options {
    (
        settings {
            $($(#[$doc:meta])* $field:ident: $type:ty = $default:expr, $applies:expr
                $(, $rule:literal: $holds:expr)?;)+
        }
        $($(#[$group_doc:meta])* $group:ident: $group_type:ty {
            $($inner:ident: $inner_type:ty, $inner_applies:expr
                $(, $inner_rule:literal: $inner_holds:expr)?;)*
        })+
    ) => {
        /// The settings of a decomposition. An option that the method does not take has to have its
        /// default; else it is refused. See [`OPTIONS`].
        #[derive(Debug, Clone, PartialEq)]
        pub struct Settings {
            /// The method.
            pub method: Method,
            $($(#[$group_doc])* pub $group: $group_type,)+
            $($(#[$doc])* pub $field: $type,)+
        }

        impl Default for Settings {
            fn default() -> Self {
                Self {
                    method: Method::default(),
                    $($group: <$group_type>::default(),)+
                    $($field: $default,)+
                }
            }
        }

        /// Every option besides the method.
        pub const OPTIONS: &[Choice] = &[
            $(choice!(
                $field, $type, $applies, rule!($type, $field $(, $rule: $holds)?), $field
            ),)+
            $($(choice!(
                $inner, $inner_type, $inner_applies,
                rule!($inner_type, $group.$inner $(, $inner_rule: $inner_holds)?), $group.$inner
            ),)*)+
        ];
    };
}

options! {
    settings {
        /// N + 1 times from 0, length²; `None`: [`Settings::default_times`], or
        /// [`crate::flow::Eigenpairs::times`].
        times: Option<Vec<f64>> = None, |method| method.facts().work != Work::Base;
        /// The number of steps N, if no times are given.
        steps: usize = 32, |_| true;
        /// The mean error of five even bands, relative to the bands: as many steps are taken as it
        /// needs, and given times are subdivided.
        accuracy: Option<f64> = None, |method| method.facts().takes_steps(),
            "must be above 0, the relative error of bands":
                |given| given.is_none_or(|accuracy| accuracy > 0.0 && accuracy.is_finite());
        /// P of M2: 1, 2 or 3. Only P = 3 is zero-homogeneous.
        p: u32 = 3, |method| method == Method::ConformalLaplace,
            "must be 1, 2 or 3": |p| (1..=3).contains(p);
        /// The smooth base Ŝ.
        base: Base = Base::default(), |method| method.facts().takes_base;
        /// How long the flow to it is, length²; `None`: 5e-3 of the area, or 3e-3 where limbs are kept.
        base_time: Option<f64> = None, |method| method.facts().takes_base;
        /// What M3 flows of the displacement from its base.
        displacement: Flowing = Flowing::default(), |method| method == Method::DirectionalTv;
        /// The metric in which M3 flows: that of the shape or of its base.
        metric: Metric = Metric::default(), |method| method == Method::DirectionalTv;
        /// Number of the lowest eigenpairs that are used.
        eigenpairs: usize = 300, |method| method.facts().work == Work::Eigenpairs,
            "must be at least 1": |&count| count > 0;
    }
    /// How steps are taken.
    stepping: Stepping {
        scheme: Scheme, |method| method.facts().takes_steps();
        tolerance: f64, |_| true;
        solver: Solver, |_| true;
    }
    /// The law of methods that flow by total variation, before it knows the function.
    total_variation: TotalVariation {
        soft_edges: f64, |method| method == Method::ShapeTv,
            "must be from 0 to 1": |softness| (0.0..=1.0).contains(softness);
    }
}

impl Choice {
    /// The option of a name.
    pub fn named(name: &str) -> Option<&'static Self> {
        OPTIONS.iter().find(|option| option.name == name)
    }

    /// Gives the option a value; whether it makes sense tells [`Settings::check`].
    ///
    /// # Errors
    /// If it is of another kind, or names no choice.
    pub fn set(&self, settings: &mut Settings, value: Value) -> Result<()> {
        (self.set)(settings, value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_take_what_they_give_and_nothing_of_another_kind() {
        for option in OPTIONS {
            let mut settings = Settings::default();
            let value = (option.get)(&settings);
            option.set(&mut settings, value).unwrap();
            assert_eq!(settings, Settings::default());
            let taken = [
                Value::None,
                Value::Count(1),
                Value::Number(1.0),
                Value::List(vec![]),
            ]
            .map(|value| option.set(&mut settings.clone(), value).is_ok());
            let kinds = [Kind::Count, Kind::Number, Kind::List];
            assert_eq!(taken[0], option.is_optional);
            assert_eq!(taken[1..], kinds.map(|kind| kind == option.kind));
        }
    }

    #[test]
    fn a_value_that_breaks_the_rule_of_its_option_is_told_with_the_rule() {
        let refusal = |name: &str, value: Value| {
            let mut settings = Settings::default();
            let option = Choice::named(name).unwrap();
            option.set(&mut settings, value).unwrap();
            settings.check().unwrap_err().to_string()
        };
        let p = refusal("p", Value::Count(4));
        assert_eq!(p, "p must be 1, 2 or 3, not 4");
        let count = refusal("eigenpairs", Value::Count(0));
        assert_eq!(count, "eigenpairs must be at least 1, not 0");
        let accuracy = refusal("accuracy", Value::Number(f64::NAN));
        assert!(
            accuracy.starts_with("accuracy must be above 0, "),
            "{accuracy}"
        );
    }

    #[test]
    fn an_option_that_a_method_does_not_take_is_refused_unless_it_is_as_by_default() {
        let mut settings = Settings::m1();
        assert!(settings.check().is_ok());
        let p = Choice::named("p").unwrap();
        p.set(&mut settings, Value::Count(2)).unwrap();
        let error = settings.check().unwrap_err().to_string();
        assert_eq!(error, "p is an option of the method \"m2\" only");
        settings.method = Method::ConformalLaplace;
        assert!(settings.check().is_ok());
    }
}
