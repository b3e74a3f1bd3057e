//! Values of options, whatever their types.

use std::fmt;

use ndarray::Array2;

use crate::error::{ArgumentError, Error, Result};
use crate::method::Base;
use crate::named::Named;

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

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("none"),
            Self::Count(count) => count.fmt(f),
            Self::Number(number) => write!(f, "{number:?}"),
            Self::Name(name) => write!(f, "{name:?}"),
            Self::List(numbers) => write!(f, "{numbers:?}"),
            Self::Shape(shape) => write!(f, "positions of {} vertices", shape.ncols()),
        }
    }
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
    /// [`Value::Name`] or [`Value::Shape`].
    NameOrShape,
}

/// A type that an option can have.
pub(super) trait Held: Sized {
    /// What its values are.
    const KIND: Kind;
    /// Whether it can be [`Value::None`].
    const IS_OPTIONAL: bool = false;

    /// The value.
    fn to_value(&self) -> Value;

    /// A value of the option of this name.
    ///
    /// # Errors
    /// If it is of another kind, or names no choice.
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

held!(usize = Count, f64 = Number, Vec<f64> = List);

/// The name of the base that keeps limbs.
const LIMBS: &str = "limbs";

impl Held for Base {
    const KIND: Kind = Kind::NameOrShape;
    const IS_OPTIONAL: bool = true;

    fn to_value(&self) -> Value {
        match self {
            Self::ConformalFlow => Value::None,
            Self::Limbs => Value::Name(LIMBS.into()),
            Self::Shape(shape) => Value::Shape(shape.clone()),
        }
    }

    fn from_value(name: &'static str, value: Value) -> Result<Self> {
        match value {
            Value::None => Ok(Self::ConformalFlow),
            Value::Name(text) if text == LIMBS => Ok(Self::Limbs),
            Value::Name(text) => {
                let rule = format!("must be {LIMBS:?} or a shape");
                Err(ArgumentError::value(name, rule, format_args!("{text:?}")).into())
            }
            Value::Shape(shape) => Ok(Self::Shape(shape)),
            other => Err(other_kind(name, Self::KIND, &other)),
        }
    }
}

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
    ArgumentError::value(name, rule, found).into()
}
