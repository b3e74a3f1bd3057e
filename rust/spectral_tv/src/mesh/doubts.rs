//! Doubts about a mesh: what is probably a mistake.

use std::fmt::{self, Display, Formatter};

use rayon::prelude::*;

use crate::mesh::TriangleMesh;
use crate::mesh::findings::grouped;
use crate::mesh::intrinsic::repeats_an_index;
use crate::mesh::open_edges::{OpenEdge, edges_of, open_edges, vertices_of};
use crate::mesh::weld::Patch;
use crate::parallel;

/// Gaps up to this share of the size, the root of the area, are taken for mistakes.
const GAP: f64 = 1e-5;
/// The same where hardly any triangle is joined to another, if it joins most of them.
const WIDE_GAP: f64 = 1e-2;
/// The least length to weld with that is named, unless it is 0, relative to the size.
const LEAST_WELD: f64 = 1e-7;
/// From this share of open edges on, hardly any triangle is joined to another.
const ALONE: f64 = 0.9;
/// Shares of open edges beyond which it is most, and many, that would close.
const MOST: f64 = 0.5;
const MANY: f64 = 0.1;
/// Fewer triangles may well be meant to be alone.
const FEW_TRIANGLES: usize = 16;
/// So many corners at the same places, of which no edge would close, are those of two borders with
/// other vertices.
const SEAM: usize = 4;
/// About how many triangles are compared with one another.
const SAMPLE: usize = 1 << 15;
/// The most open edges among which gaps are looked for; of more, it is those of a slab.
const MOST_EDGES: usize = 1 << 17;
/// What is probably a mistake, and matters for what is made of a mesh.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Doubt {
    /// Open edges lie on one another or nearly so: the surface is torn there.
    Torn {
        /// Open edges.
        open_edges: usize,
        /// All edges, where most of them are open and most of these would close.
        edges: Option<usize>,
        /// The share of the open edges that would close.
        share: f64,
        /// Their corners that are at the same place as others.
        coincident: usize,
        /// What to weld with, a length; 0 where they lie on one another exactly.
        weld: f64,
    },
    /// Hardly any triangle is joined to another, nor near to one.
    Alone {
        /// Open edges.
        open_edges: usize,
        /// All edges.
        edges: usize,
    },
    /// Triangles with the same corners as others.
    Repeated {
        /// Their share.
        share: f64,
    },
    /// Most vertices are in no triangle.
    Unused {
        /// How many are in none.
        unused: usize,
        /// How many there are.
        vertices: usize,
    },
}

impl Display for Doubt {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Torn {
                open_edges,
                edges,
                share,
                coincident,
                weld,
            } => {
                let open = grouped(*open_edges);
                let share = percent(*share);
                match (edges, *weld == 0.0) {
                    (Some(edges), true) => write!(
                        f,
                        "{open} of {} edges are open and {} corners coincide with others: the \
                         triangles are not joined, so they will drift apart; weld with 0",
                        grouped(*edges),
                        grouped(*coincident)
                    ),
                    (Some(edges), false) => write!(
                        f,
                        "{open} of {} edges are open and {share} of these nearly touch others: the \
                         triangles are not joined, so they will drift apart; weld with {weld:e}",
                        grouped(*edges)
                    ),
                    (None, true) => write!(
                        f,
                        "{share} of {open} open edges lie on one another: the surface is torn \
                         there and will come apart; weld with 0"
                    ),
                    (None, false) => write!(
                        f,
                        "{share} of {open} open edges nearly touch one another: the surface is torn \
                         there and will come apart; weld with {weld:e}"
                    ),
                }
            }
            Self::Alone { open_edges, edges } => write!(
                f,
                "{} of {} edges are open: hardly any triangle is joined to another, so they will \
                 drift apart; weld with a length beyond the gaps between them",
                grouped(*open_edges),
                grouped(*edges)
            ),
            Self::Repeated { share } => write!(
                f,
                "{} of the triangles have the same corners as others: their area counts twice",
                percent(*share)
            ),
            Self::Unused { unused, vertices } => write!(
                f,
                "{} of {} vertices are in no triangle: they will stay where they are",
                grouped(*unused),
                grouped(*vertices)
            ),
        }
    }
}

impl TriangleMesh {
    /// What is probably a mistake about the mesh. What was welded with `weld`, as
    /// [`crate::mesh::Repair`] has it, is meant to be open where it is, beyond that length; of 0
    /// that is not taken for granted.
    pub fn doubts(&self, weld: Option<f64>) -> Vec<Doubt> {
        let scan = Scan::of(self.triangles());
        let mut doubts = Vec::new();
        if scan.may_be_open && weld.is_none_or(|weld| weld == 0.0) {
            doubts.extend(self.torn());
        }
        let share = scan.repeated_share();
        if share > 0.0 {
            doubts.push(Doubt::Repeated { share });
        }
        let unused = self.vertex_areas().iter().filter(|&&area| area == 0.0);
        let (unused, vertices) = (unused.count(), self.vertex_count());
        if 2 * unused > vertices {
            doubts.push(Doubt::Unused { unused, vertices });
        }
        doubts
    }

    /// Whether and how the surface seems to be torn.
    fn torn(&self) -> Option<Doubt> {
        let triangles = self.triangles();
        let border = open_edges(self.vertex_count(), triangles);
        if border.is_empty() {
            return None;
        }
        let open = border.len();
        // Where two triangles are at every other edge, there are (3 F + open) / 2 edges.
        let edges = (open > triangles.len()).then(|| edge_count(triangles));
        let size = self.area().sqrt();
        let mut whole = self.patch(&border).surface;
        whole.join_coincident();
        let torn = |share: f64, coincident: usize, weld: f64| Doubt::Torn {
            open_edges: open,
            edges: edges.filter(|_| share > MOST),
            share,
            coincident,
            weld,
        };
        let exact = whole.closed_edges() as f64 / open as f64;
        let coincident = whole.joined_count();
        let part = match open > MOST_EDGES {
            true => {
                let mut part = self.patch(&slab(&border, self.vertices())).surface;
                part.join_coincident();
                part
            }
            false => whole.clone(),
        };
        let nearly = |gap: f64| {
            let mut surface = part.clone();
            surface.join_within(gap * size);
            let (exact, closed) = (part.closed_edges(), surface.closed_edges());
            // A corner may be on an edge to the last digit.
            let weld = rounded_up(surface.widest_gap().max(LEAST_WELD * size));
            let share = closed as f64 / part.border_length() as f64;
            (closed > exact).then(|| torn(share, 0, weld))
        };
        let closes = |least: f64| move |doubt: &Doubt| matches!(doubt, Doubt::Torn { share, .. } if *share > least);
        let exactly = (exact > 0.0).then(|| torn(exact, coincident, 0.0));
        let near = match whole.border() {
            [] => None,
            _ => nearly(GAP),
        };
        let seam = || (coincident >= SEAM).then(|| nearly(WIDE_GAP)).flatten();
        let found = near.or(exactly).or_else(seam);
        let Some(edges) = edges.filter(|_| !found.as_ref().is_some_and(closes(MOST))) else {
            return found;
        };
        let is_alone = open as f64 > ALONE * edges as f64 && triangles.len() >= FEW_TRIANGLES;
        if !is_alone {
            return found;
        }
        let wide = nearly(WIDE_GAP).filter(closes(MOST));
        wide.or(found.filter(closes(MANY))).or(Some(Doubt::Alone {
            open_edges: open,
            edges,
        }))
    }

    fn patch(&self, border: &[OpenEdge]) -> Patch {
        Patch::at(&vertices_of(border), self.vertices(), self.triangles())
    }
}

/// What one look at every triangle tells.
#[derive(Default)]
struct Scan {
    /// Whether an edge may have one triangle only.
    may_be_open: bool,
    /// Some triangles, with all that have the same corners; the corners in order.
    sample: Vec<[u32; 3]>,
}

impl Scan {
    fn of(triangles: &[[u32; 3]]) -> Self {
        let rarity = (triangles.len() / SAMPLE).checked_ilog2().unwrap_or(0);
        let parts = parallel::parts(triangles.len(), |part| {
            let mut odd = 0;
            let mut sample = Vec::new();
            let part = triangles[part].iter();
            for &corners in part.filter(|corners| !repeats_an_index(corners)) {
                let [a, b, c] = corners.map(spread);
                odd ^= a.wrapping_mul(b) ^ b.wrapping_mul(c) ^ c.wrapping_mul(a);
                // The same for all triangles with these corners.
                if (a ^ b ^ c).leading_zeros() >= rarity {
                    let mut corners = corners;
                    corners.sort_unstable();
                    sample.push(corners);
                }
            }
            (odd, sample)
        });
        Self {
            // Two triangles at an edge cancel; that others do so is as good as impossible.
            may_be_open: parts.iter().fold(0, |odd, part| odd ^ part.0) != 0,
            sample: parts.into_iter().flat_map(|part| part.1).collect(),
        }
    }

    /// The share of triangles with the same corners as an earlier one.
    fn repeated_share(mut self) -> f64 {
        let count = self.sample.len().max(1);
        self.sample.par_sort_unstable();
        self.sample.dedup();
        1.0 - self.sample.len().max(1) as f64 / count as f64
    }
}

/// An odd number for an index, of which products tell edges from one another.
fn spread(index: u32) -> u64 {
    let bits = (u64::from(index) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (bits ^ (bits >> 32)) | 1
}

/// How many edges the triangles have.
fn edge_count(triangles: &[[u32; 3]]) -> usize {
    let edges = triangles
        .par_iter()
        .flat_map_iter(|&corners| edges_of(corners));
    let mut edges: Vec<_> = edges.map(|(ends, _)| ends).collect();
    edges.par_sort_unstable();
    edges.dedup();
    edges.len()
}

/// The edges of a longer `border` that are in a slab across the axis along which they extend
/// farthest.
fn slab(border: &[OpenEdge], vertices: &[[f64; 3]]) -> Vec<OpenEdge> {
    let at = |axis: usize, edge: &OpenEdge| vertices[edge.ends[0] as usize][axis];
    let extent = |axis: usize| {
        let range = border
            .iter()
            .fold([f64::MAX, f64::MIN], |[least, most], edge| {
                let x = at(axis, edge);
                [least.min(x), most.max(x)]
            });
        range[1] - range[0]
    };
    let axis = (0..3).max_by(|&a, &b| extent(a).total_cmp(&extent(b)));
    let axis = axis.expect("there are three");
    let mut edges = border.to_vec();
    let start = (edges.len() - MOST_EDGES) / 2;
    let order = |a: &OpenEdge, b: &OpenEdge| at(axis, a).total_cmp(&at(axis, b));
    edges.select_nth_unstable_by(start, order);
    edges[start..].select_nth_unstable_by(MOST_EDGES, order);
    edges[start..start + MOST_EDGES].to_vec()
}

/// A little more, in one digit.
fn rounded_up(length: f64) -> f64 {
    let length = length * (1.0 + 1e-9);
    let exponent = length.log10().floor();
    let digit = (length / 10.0_f64.powf(exponent)).ceil();
    // By way of text, as powers of ten have many digits.
    format!("{digit}e{exponent}").parse().unwrap_or(length)
}

fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent {
        99.5..100.0 => "over 99 %".into(),
        9.95.. => format!("{percent:.0} %"),
        0.05.. => format!("{percent:.1} %"),
        _ => "under 0.1 %".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_rounded_up_to_a_digit() {
        for (length, expected) in [(3e-7, 4e-7), (1.2e-5, 2e-5), (9.5, 10.0), (0.25, 0.3)] {
            assert_eq!(rounded_up(length), expected);
        }
    }

    #[test]
    fn shares_are_told_as_percentages() {
        let texts = [0.0001, 0.012, 0.1, 0.333, 0.9999, 1.0].map(percent);
        let expected = ["under 0.1 %", "1.2 %", "10 %", "33 %", "over 99 %", "100 %"];
        assert_eq!(texts, expected);
    }

    #[test]
    fn gaps_are_found_among_more_edges_than_are_looked_at() {
        // Pairs of triangles in a long row, each pair with a gap.
        let pairs = 30_000;
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for pair in 0..pairs {
            let x = 1e3 * f64::from(pair);
            let first = vertices.len() as i64;
            let corners = [[0., 0., 0.], [9., 0., 0.], [0., 9., 0.]];
            let others = [[9., 0., 1e-4], [9., 9., 0.], [0., 9., 1e-4]];
            vertices.extend(
                corners
                    .iter()
                    .chain(&others)
                    .map(|p| [x + p[0], p[1], p[2]]),
            );
            triangles.extend([
                [first, first + 1, first + 2],
                [first + 3, first + 4, first + 5],
            ]);
        }
        let mesh = TriangleMesh::new(vertices, &triangles).unwrap();
        let doubts = mesh.doubts(None);
        assert!(matches!(
            doubts[..],
            [Doubt::Torn { share, weld, .. }] if (share - 1.0 / 3.0).abs() < 1e-3 && weld == 2e-4
        ));
        assert_eq!(mesh.doubts(Some(2e-4)), []);
    }
}
