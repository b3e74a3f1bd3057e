//! Groups the vertices of a level into those of the next: small clusters of strongly coupled ones.
//!
//! Greedy aggregation (Vaněk, Mandel and Brezina 1996, "Algebraic multigrid by smoothed aggregation
//! for second and fourth order elliptic problems"). The rows are divided into parts, and each part
//! is aggregated by itself, so that threads work on parts side by side.

use rayon::prelude::*;

use crate::parallel;
use crate::solver::multigrid::matrix::Matrix;

/// In no aggregate.
pub(super) const NONE: u32 = u32::MAX;

/// A vertex whose mass outweighs its couplings this many times needs no coarser level: sweeps
/// alone reduce its error.
const MASS_DOMINANCE: f32 = 2.0;

/// The clusters of one level.
pub(super) struct Aggregates {
    /// Aggregate of every vertex, or [`NONE`].
    pub of_vertex: Vec<u32>,
    /// Number of aggregates.
    pub count: usize,
}

/// Which couplings of a matrix are strong: c_ij > θ √(max_k c_ik max_k c_jk).
///
/// Compared with the largest couplings rather than with the diagonals, rows with many couplings
/// are not taken for weakly coupled; on surfaces with weights that jump by 1000 that saves a
/// sixth of the iterations.
pub(super) struct Strength {
    bounds: Vec<f32>,
}

impl Strength {
    /// For the threshold θ = `threshold`.
    pub fn new(matrix: &Matrix, threshold: f32) -> Self {
        let bounds = parallel::values(matrix.size(), |row| {
            let couplings = matrix.row(row).iter().flat_map(|octet| octet.couplings);
            let (mut sum, mut largest) = (0.0, 0.0);
            for coupling in couplings {
                sum += coupling;
                largest = coupling.max(largest);
            }
            match MASS_DOMINANCE * sum > matrix.masses[row] {
                true => threshold * largest,
                // Nothing is strong for it.
                false => f32::INFINITY,
            }
        });
        Self { bounds }
    }

    /// Whether the coupling c of two vertices is strong.
    #[inline]
    pub fn is_strong(&self, row: usize, column: usize, coupling: f32) -> bool {
        coupling > 0.0 && coupling * coupling > self.bounds[row] * self.bounds[column]
    }
}

impl Aggregates {
    /// Clusters the vertices of `matrix`.
    pub fn new(matrix: &Matrix, strength: &Strength) -> Self {
        let chunk = matrix.chunk();
        let mut of_vertex = vec![NONE; matrix.size()];
        let chunks = of_vertex.par_chunks_mut(chunk).enumerate().with_max_len(1);
        let counts: Vec<u32> = chunks
            .map(|(part, of_vertex)| {
                Part {
                    matrix,
                    strength,
                    first: part * chunk,
                    of_vertex,
                }
                .run()
            })
            .collect();
        let mut firsts = Vec::with_capacity(counts.len());
        let mut count = 0;
        for in_part in counts {
            firsts.push(count);
            count += in_part;
        }
        let chunks = of_vertex.par_chunks_mut(chunk).zip(&firsts).with_max_len(1);
        chunks.for_each(|(of_vertex, first)| {
            for aggregate in of_vertex.iter_mut().filter(|aggregate| **aggregate != NONE) {
                *aggregate += first;
            }
        });
        Self {
            of_vertex,
            count: count as usize,
        }
    }
}

/// Rows from `first` on, whose aggregates are numbered from 0.
struct Part<'a> {
    matrix: &'a Matrix,
    strength: &'a Strength,
    first: usize,
    of_vertex: &'a mut [u32],
}

impl Part<'_> {
    /// Aggregates the part and returns the number of aggregates.
    fn run(mut self) -> u32 {
        let mut count = 0;
        // First whole neighbourhoods, then what is left to the neighbour coupled best …
        for offset in 0..self.of_vertex.len() {
            let is_free = |other: usize| self.of_vertex[other] == NONE;
            let mut strong = self.strong_neighbours(offset).peekable();
            if is_free(offset) && strong.peek().is_some() && strong.all(|(j, _)| is_free(j)) {
                drop(strong);
                self.gather(offset, count);
                count += 1;
            }
        }
        let mut joining = Vec::new();
        for offset in 0..self.of_vertex.len() {
            if self.of_vertex[offset] == NONE {
                let best = self
                    .strong_neighbours(offset)
                    .filter(|(other, _)| self.of_vertex[*other] != NONE)
                    .max_by(|a, b| a.1.total_cmp(&b.1));
                if let Some((other, _)) = best {
                    joining.push((offset, self.of_vertex[other]));
                }
            }
        }
        for (offset, aggregate) in joining {
            self.of_vertex[offset] = aggregate;
        }
        // … and last what is left among itself, single where it is coupled to other parts only.
        for offset in 0..self.of_vertex.len() {
            if self.of_vertex[offset] == NONE && self.has_strong_neighbour(offset) {
                self.gather(offset, count);
                count += 1;
            }
        }
        count
    }

    /// Makes an aggregate of a vertex and its strong neighbours that are in none.
    fn gather(&mut self, offset: usize, aggregate: u32) {
        self.of_vertex[offset] = aggregate;
        let row = self.first + offset;
        for octet in self.matrix.row(row) {
            for (column, coupling) in octet.columns.iter().zip(octet.couplings) {
                let column = *column as usize;
                if self.strength.is_strong(row, column, coupling)
                    && let Some(other) = self.of_vertex.get_mut(column.wrapping_sub(self.first))
                    && *other == NONE
                {
                    *other = aggregate;
                }
            }
        }
    }

    /// The strong neighbours in this part, with their couplings.
    fn strong_neighbours(&self, offset: usize) -> impl Iterator<Item = (usize, f32)> + '_ {
        let row = self.first + offset;
        let octets = self.matrix.row(row).iter();
        let entries = octets.flat_map(|octet| octet.columns.into_iter().zip(octet.couplings));
        entries.filter_map(move |(column, coupling)| {
            let column = column as usize;
            let other = column.wrapping_sub(self.first);
            let is_here = other < self.of_vertex.len();
            (is_here && self.strength.is_strong(row, column, coupling)).then_some((other, coupling))
        })
    }

    fn has_strong_neighbour(&self, offset: usize) -> bool {
        let row = self.first + offset;
        self.matrix.row(row).iter().any(|octet| {
            let mut entries = octet.columns.iter().zip(octet.couplings);
            entries.any(|(column, c)| self.strength.is_strong(row, *column as usize, c))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::multigrid::examples::{hierarchy_of, lattice};

    #[test]
    fn aggregates_are_strongly_connected_and_cover_all_that_is_coupled() {
        let (lower, masses) = lattice(90, 100, 1e-4);
        let hierarchy = hierarchy_of(&lower, &masses);
        let matrix = &hierarchy.levels[0].matrix;
        let strength = Strength::new(matrix, 0.1);
        let aggregates = Aggregates::new(matrix, &strength);
        assert!(aggregates.count > 0 && 3 * aggregates.count < matrix.size());
        let mut sizes = vec![0; aggregates.count];
        for (row, &aggregate) in aggregates.of_vertex.iter().enumerate() {
            assert_ne!(aggregate, NONE);
            sizes[aggregate as usize] += 1;
            let is_connected = matrix.row(row).iter().any(|octet| {
                octet.columns.iter().any(|&column| {
                    column as usize != row && aggregates.of_vertex[column as usize] == aggregate
                })
            });
            assert!(is_connected);
        }
        assert!(sizes.iter().all(|&size| size >= 2));
    }

    #[test]
    fn vertices_of_dominant_mass_are_left_to_the_sweeps() {
        let (lower, masses) = lattice(20, 20, 100.0);
        let hierarchy = hierarchy_of(&lower, &masses);
        assert_eq!(hierarchy.levels.len(), 1);
    }
}
