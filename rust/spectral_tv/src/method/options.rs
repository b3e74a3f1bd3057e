//! The options of a decomposition by their names, as front ends and files have them.

use ndarray::Array2;

use crate::error::{ArgumentError, Error, Result};
use crate::flow::Scheme;
use crate::method::{Method, Metric, Settings};
use crate::named::Named;
use crate::solver::Solver;

/// The value of an option.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// What the method chooses.
    None,
    /// An integer from 0.
    Count(usize),
    /// A number.
    Number(f64),
    /// The name of a choice.
    Name(String),
    /// A list of numbers.
    List(Vec<f64>),
    /// Positions, (3, V).
    Shape(Array2<f64>),
}

/// What kind of value an option has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// [`Value::Count`].
    Count,
    /// [`Value::Number`].
    Number,
    /// [`Value::Name`].
    Name,
    /// [`Value::List`].
    List,
    /// [`Value::Shape`].
    Shape,
}

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
    /// Its value.
    pub get: fn(&Settings) -> Value,
    set: fn(&mut Settings, Value) -> Result<()>,
}

/// A row of the table: the name, the field and its type, and which methods take it.
macro_rules! choice {
    ($name:literal, $($field:ident).+: $type:ty, $applies:expr) => {
        Choice {
            name: $name,
            kind: <$type>::KIND,
            is_optional: <$type>::IS_OPTIONAL,
            applies: $applies,
            get: |settings| settings.$($field).+.to_value(),
            set: |settings, value| {
                settings.$($field).+ = <$type>::from_value($name, value)?;
                Ok(())
            },
        }
    };
}

/// Every option besides the method, with the methods that take it. Its default is that of
/// [`Settings`].
pub const OPTIONS: &[Choice] = &[
    choice!("times", times: Option<Vec<f64>>, |method| method != Method::Displacement),
    choice!("steps", steps: usize, |_| true),
    choice!("accuracy", accuracy: Option<f64>, |method| method.facts().takes_steps()),
    choice!("scheme", stepping.scheme: Scheme, |method| method.facts().takes_steps()),
    choice!("tolerance", stepping.tolerance: f64, |_| true),
    choice!("solver", stepping.solver: Solver, |_| true),
    choice!("p", p: u32, |method| method == Method::ConformalLaplace),
    choice!("base", base: Option<Array2<f64>>, |method| method.facts().takes_base),
    choice!("base_time", base_time: Option<f64>, |method| method.facts().takes_base),
    choice!("metric", metric: Metric, |method| method == Method::DirectionalTv),
    choice!("eigenpairs", eigenpairs: usize, |method| method == Method::LaplaceBeltrami),
];

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

/// A type that an option can have.
trait Held: Sized {
    const KIND: Kind;
    const IS_OPTIONAL: bool = false;

    fn to_value(&self) -> Value;

    fn from_value(name: &'static str, value: Value) -> Result<Self>;
}

/// A type whose values are held as they are.
macro_rules! held {
    ($($type:ty = $kind:ident),+) => {
        $(impl Held for $type {
            const KIND: Kind = Kind::$kind;

            fn to_value(&self) -> Value {
                Value::$kind(self.clone())
            }

            fn from_value(name: &'static str, value: Value) -> Result<Self> {
                match value {
                    Value::$kind(value) => Ok(value),
                    other => Err(other_kind(name, Self::KIND, &other)),
                }
            }
        })+
    };
}

held!(usize = Count, f64 = Number, Vec<f64> = List, Array2<f64> = Shape);

impl Held for u32 {
    const KIND: Kind = Kind::Count;

    fn to_value(&self) -> Value {
        Value::Count(*self as usize)
    }

    fn from_value(name: &'static str, value: Value) -> Result<Self> {
        let count = usize::from_value(name, value)?;
        let refuse = |_| {
            let rule = format!("must be an integer from 0 to {}", Self::MAX);
            ArgumentError::value(name, rule, count).into()
        };
        Self::try_from(count).map_err(refuse)
    }
}

impl<T: Named> Held for T {
    const KIND: Kind = Kind::Name;

    fn to_value(&self) -> Value {
        Value::Name(self.name().into())
    }

    fn from_value(name: &'static str, value: Value) -> Result<Self> {
        match value {
            Value::Name(text) => Self::named(&text),
            other => Err(other_kind(name, Self::KIND, &other)),
        }
    }
}

impl<T: Held> Held for Option<T> {
    const KIND: Kind = T::KIND;
    const IS_OPTIONAL: bool = true;

    fn to_value(&self) -> Value {
        self.as_ref().map_or(Value::None, Held::to_value)
    }

    fn from_value(name: &'static str, value: Value) -> Result<Self> {
        match value {
            Value::None => Ok(None),
            value => T::from_value(name, value).map(Some),
        }
    }
}

fn other_kind(name: &'static str, kind: Kind, found: &Value) -> Error {
    let rule = format!("must be a {kind:?}").to_lowercase();
    ArgumentError::value(name, rule, format_args!("{found:?}")).into()
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
