//! Choices by the names that arguments, files and front ends have for them.

use crate::error::{ArgumentError, Result};

/// A choice between variants with names.
pub trait Named: Copy + PartialEq + 'static {
    /// The argument that takes the choice.
    const ARGUMENT: &'static str;
    /// Every variant with its name.
    const NAMES: &'static [(Self, &'static str)];

    /// The name of this variant.
    fn name(self) -> &'static str {
        let found = Self::NAMES.iter().find(|(variant, _)| *variant == self);
        found.map_or("", |(_, name)| name)
    }

    /// The variant of a name.
    ///
    /// # Errors
    /// If there is none; the names are told.
    fn named(name: &str) -> Result<Self> {
        let found = Self::NAMES.iter().find(|(_, known)| *known == name);
        found.map(|(variant, _)| *variant).ok_or_else(|| {
            let names: Vec<_> = Self::NAMES.iter().map(|(_, known)| *known).collect();
            let rule = format!("must be {}", quoted(&names, "or"));
            ArgumentError::value(Self::ARGUMENT, rule, format_args!("{name:?}")).into()
        })
    }
}

/// `"a", "b" or "c"`; `link` is "or".
pub(crate) fn quoted(names: &[&str], link: &str) -> String {
    let quoted: Vec<_> = names.iter().map(|name| format!("{name:?}")).collect();
    match quoted.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} {link} {last}", others.join(", ")),
        None => String::new(),
    }
}

/// An enum whose variants have names: each stands with its name, for an argument of that name, and
/// with what a function gives for it, if there is one.
macro_rules! named {
    (
        $(#[$meta:meta])*
        pub enum $type:ident: $argument:literal {
            $($(#[$variant_meta:meta])* $variant:ident = $name:literal => $value:expr,)+
        }
        $(#[$function_meta:meta])*
        $visibility:vis fn $function:ident(self $(, $given:ident: $kind:ty)*) -> $returned:ty;
    ) => {
        crate::named::named! {
            $(#[$meta])*
            pub enum $type: $argument {
                $($(#[$variant_meta])* $variant = $name,)+
            }
        }

        impl $type {
            $(#[$function_meta])*
            $visibility fn $function(self $(, $given: $kind)*) -> $returned {
                match self {
                    $(Self::$variant => $value,)+
                }
            }
        }
    };
    (
        $(#[$meta:meta])*
        pub enum $type:ident: $argument:literal {
            $($(#[$variant_meta:meta])* $variant:ident = $name:literal,)+
        }
    ) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
        pub enum $type {
            $($(#[$variant_meta])* $variant,)+
        }

        impl crate::named::Named for $type {
            const ARGUMENT: &'static str = $argument;
            const NAMES: &'static [(Self, &'static str)] = &[$((Self::$variant, $name)),+];
        }
    };
}
pub(crate) use named;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::Solver;

    #[test]
    fn names_lead_there_and_back_and_others_are_refused() {
        for &(solver, name) in Solver::NAMES {
            assert_eq!(Solver::named(name).unwrap(), solver);
            assert_eq!(solver.name(), name);
        }
        let error = Solver::named("magic").unwrap_err().to_string();
        assert_eq!(
            error,
            "solver must be \"auto\", \"cholesky\", \"single\" or \"multigrid\", not \"magic\""
        );
    }
}
