//! What was found in a mesh, and what was done about it.

use std::fmt::{self, Display, Formatter};

use crate::error::{ArgumentError, Result};
use crate::mesh::open_edges::{OpenEdge, vertices_of};

/// Counts of what was found in a mesh, and done about it, when it was read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Findings {
    /// Vertices on open edges, as they were handed in.
    pub border_corners: usize,
    /// Those of them that were joined to another.
    pub joined_corners: usize,
    /// Corners at which an open edge was split, each edge counted.
    pub closed_junctions: usize,
    /// Vertices that are not finite and were dropped.
    pub dropped_vertices: usize,
    /// Triangles that were dropped with them.
    pub dropped_triangles: usize,
    /// Edges of one triangle only, as they were handed in.
    pub open_edges_before: usize,
    /// Edges of one triangle only, in the mesh.
    pub open_edges: usize,
    /// Connected components of the mesh, without vertices in no triangle.
    pub components: usize,
}

type Count = (&'static str, fn(&mut Findings) -> &mut usize);

const COUNTS: [Count; 8] = [
    ("border_corners", |found| &mut found.border_corners),
    ("joined_corners", |found| &mut found.joined_corners),
    ("closed_junctions", |found| &mut found.closed_junctions),
    ("dropped_vertices", |found| &mut found.dropped_vertices),
    ("dropped_triangles", |found| &mut found.dropped_triangles),
    ("open_edges_before", |found| &mut found.open_edges_before),
    ("open_edges", |found| &mut found.open_edges),
    ("components", |found| &mut found.components),
];

impl Findings {
    /// What is found at these open edges, as long as nothing is done about them.
    pub(super) fn of_border(border: &[OpenEdge]) -> Self {
        Self {
            border_corners: vertices_of(border).len(),
            open_edges_before: border.len(),
            open_edges: border.len(),
            ..Self::default()
        }
    }

    /// Whether anything was done.
    pub fn is_repaired(&self) -> bool {
        self.joined_corners + self.closed_junctions + self.dropped_vertices > 0
    }

    /// All counts with their names.
    pub fn counts(&self) -> [(&'static str, usize); 8] {
        let mut counts = *self;
        COUNTS.map(|(name, of)| (name, *of(&mut counts)))
    }

    /// Findings with these counts, by their names.
    ///
    /// # Errors
    /// If one is missing.
    pub fn of_counts(count: impl Fn(&str) -> Option<usize>) -> Result<Self> {
        let mut found = Self::default();
        for (name, of) in COUNTS {
            let missing = || {
                let reason = format!("findings must have a count {name:?}");
                ArgumentError::empty("findings", reason)
            };
            *of(&mut found) = count(name).ok_or_else(missing)?;
        }
        Ok(found)
    }

    /// What was dropped, as a part of a sentence.
    pub fn dropped(&self) -> String {
        format!(
            "dropped {} not finite, and {} there",
            counted_as(self.dropped_vertices, "vertex that is", "vertices that are"),
            counted(self.dropped_triangles, "triangle")
        )
    }
}

impl Display for Findings {
    /// What was done, in one line.
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let mut done = Vec::new();
        if self.joined_corners > 0 {
            done.push(format!(
                "joined {} of {} corners at open edges",
                grouped(self.joined_corners),
                grouped(self.border_corners)
            ));
        }
        if self.closed_junctions > 0 {
            done.push(format!(
                "closed {}",
                counted(self.closed_junctions, "T-junction")
            ));
        }
        if self.dropped_vertices > 0 {
            done.push(self.dropped());
        }
        match done.is_empty() {
            true => write!(f, "nothing joined, closed or dropped"),
            false => write!(f, "{}", done.join("; ")),
        }
    }
}

/// A number with a space between its thousands.
pub(super) fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// So many things, in the singular for one.
pub(super) fn counted(number: usize, one: &str) -> String {
    counted_as(number, one, &format!("{one}s"))
}

/// The same where the plural is another word.
pub(super) fn counted_as(number: usize, one: &str, many: &str) -> String {
    format!(
        "{} {}",
        grouped(number),
        if number == 1 { one } else { many }
    )
}
