//! The matrix of the next level, PᵀKP. The places of all entries are found once for a pattern.
//! Later matrices of the pattern then take two passes of multiply and add.

use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::monitor::Stage;
use crate::parallel;
use crate::solver::multigrid::galerkin_pattern::{Part, Place, Product};
use crate::solver::multigrid::matrix::{Matrix, chunk_length, split_at_rows};
use crate::solver::multigrid::prolongation::{Prolongation, WIDTH};

/// The maps from a matrix K and a prolongation P to KP, and from there to PᵀKP.
pub(super) enum Galerkin {
    /// Where rows are short.
    Narrow(Maps<u8>),
    /// Where there are hubs.
    Wide(Maps<u16>),
}

impl Galerkin {
    /// The maps, and a coarse matrix of their pattern without values.
    ///
    /// # Errors
    /// [`Error::Cancelled`], or [`Error::Solver`] if a vertex has too many neighbours.
    pub fn new(
        matrix: &Matrix,
        prolongation: &Prolongation,
        stage: Stage,
    ) -> Result<(Self, Matrix)> {
        match Maps::new(matrix, prolongation, stage) {
            Err(Error::Solver(_)) => {
                let (maps, coarse) = Maps::new(matrix, prolongation, stage)?;
                Ok((Self::Wide(maps), coarse))
            }
            outcome => outcome.map(|(maps, coarse)| (Self::Narrow(maps), coarse)),
        }
    }

    /// `coarse` ← PᵀKP.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn refresh(
        &self,
        matrix: &Matrix,
        prolongation: &Prolongation,
        coarse: &mut Matrix,
        stage: Stage,
    ) -> Result<()> {
        match self {
            Self::Narrow(maps) => maps.refresh(matrix, prolongation, coarse, stage),
            Self::Wide(maps) => maps.refresh(matrix, prolongation, coarse, stage),
        }
    }
}

/// The same with places of one size.
pub(super) struct Maps<S> {
    /// First entry of each row of KP, and their number at the end.
    starts: Vec<u32>,
    /// Where each row's own weights go in its row of KP, and those of its neighbours.
    own_slots: Vec<[S; WIDTH]>,
    slots: Vec<[[S; WIDTH]; 8]>,
    /// First of each coarse row's `places`, and their number at the end.
    place_starts: Vec<u64>,
    /// Where every entry of KP that a coarse row gathers goes in it: its neighbours first, then
    /// itself.
    places: Vec<S>,
}

/// KP, made anew for each matrix: it is not needed while systems are solved.
struct Values {
    entries: Vec<f32>,
    /// What of each row's mass and of its couplings to rows that do not take part remains.
    masses: Vec<f32>,
}

impl<S: Place> Maps<S> {
    fn new(matrix: &Matrix, prolongation: &Prolongation, stage: Stage) -> Result<(Self, Matrix)> {
        let product = Product::new(matrix, prolongation, stage)?;
        let size = prolongation.coarse_size();
        let chunk = chunk_length(size);
        let parts: Vec<Part<S>> = (0..size.div_ceil(chunk))
            .into_par_iter()
            .with_max_len(1)
            .map(|part| {
                stage.check()?;
                let rows = part * chunk..((part + 1) * chunk).min(size);
                Part::new(rows, size, &product, prolongation)
            })
            .collect::<Result<_>>()?;
        let mut place_starts = vec![0];
        let mut places = Vec::with_capacity(parts.iter().map(|part| part.places.len()).sum());
        for part in &parts {
            let first = places.len() as u64;
            place_starts.extend(part.place_ends.iter().map(|end| first + end));
            stage.pass(|| places.extend_from_slice(&part.places))?;
        }
        let rows = parts.iter().flat_map(|part| {
            let bounds = part.neighbour_starts.windows(2);
            bounds.map(|bound| part.neighbours[bound[0]..bound[1]].iter().copied())
        });
        let coarse = Matrix::with_pattern(rows, stage)?;
        let maps = Self {
            starts: product.starts,
            own_slots: product.own_slots,
            slots: product.slots,
            place_starts,
            places,
        };
        Ok((maps, coarse))
    }

    fn refresh(
        &self,
        matrix: &Matrix,
        prolongation: &Prolongation,
        coarse: &mut Matrix,
        stage: Stage,
    ) -> Result<()> {
        let product = stage.pass(|| self.multiply(matrix, prolongation))?;
        stage.pass(|| self.gather(&product, prolongation, coarse))
    }

    /// KP, and the row sums of K over the rows that take part.
    fn multiply(&self, matrix: &Matrix, prolongation: &Prolongation) -> Values {
        let count = self.starts.last().map_or(0, |&count| count as usize);
        let mut product = Values {
            entries: parallel::filled(0.0, count),
            masses: parallel::filled(0.0, matrix.size()),
        };
        let chunk = matrix.chunk();
        let (starts, slots, own_slots) = (&self.starts, &self.slots, &self.own_slots);
        let parts = split_at_rows(&mut product.entries, starts, chunk);
        let masses = product.masses.par_chunks_mut(chunk);
        let parts = parts.into_par_iter().zip(masses);
        parts
            .enumerate()
            .with_max_len(1)
            .for_each(|(part, (values, masses))| {
                let first = part * chunk;
                for (offset, mass) in masses.iter_mut().enumerate() {
                    let row = first + offset;
                    let start = (starts[row] - starts[first]) as usize;
                    let end = (starts[row + 1] - starts[first]) as usize;
                    let values = &mut values[start..end];
                    *mass = matrix.masses[row];
                    let mut diagonal = *mass;
                    let octets = matrix.starts[row] as usize..matrix.starts[row + 1] as usize;
                    for (octet, slots) in matrix.octets[octets.clone()].iter().zip(&slots[octets]) {
                        let entries = octet.couplings.iter().zip(octet.columns).zip(slots);
                        for ((&coupling, column), slots) in entries {
                            let weights = &prolongation.weights[column as usize];
                            diagonal += coupling;
                            if weights[0] == 0.0 {
                                *mass += coupling;
                            }
                            for (slot, weight) in slots.iter().zip(weights) {
                                values[(*slot).into()] -= coupling * weight;
                            }
                        }
                    }
                    for (slot, weight) in own_slots[row].iter().zip(&prolongation.weights[row]) {
                        values[(*slot).into()] += diagonal * weight;
                    }
                }
            });
        product
    }

    /// Pᵀ(KP).
    fn gather(&self, product: &Values, prolongation: &Prolongation, coarse: &mut Matrix) {
        let chunk = coarse.chunk();
        let weights = prolongation.weights.as_flattened();
        let starts = &coarse.starts;
        let parts = split_at_rows(&mut coarse.octets, starts, chunk);
        let parts = parts
            .into_par_iter()
            .zip(coarse.masses.par_chunks_mut(chunk));
        parts
            .enumerate()
            .with_max_len(1)
            .for_each(|(part, (octets, masses))| {
                let first = part * chunk;
                let mut sums = Vec::new();
                for (offset, mass) in masses.iter_mut().enumerate() {
                    let row = first + offset;
                    let start = (starts[row] - starts[first]) as usize;
                    let end = (starts[row + 1] - starts[first]) as usize;
                    let octets = &mut octets[start..end];
                    // A row's own entry follows those of its neighbours.
                    sums.clear();
                    sums.resize(8 * octets.len() + 1, 0.0);
                    let mut places = self.places[self.place_starts[row] as usize..].iter();
                    *mass = 0.0;
                    for &entry in prolongation.entries(row) {
                        let (fine, weight) = (entry as usize / WIDTH, weights[entry as usize]);
                        *mass += weight * product.masses[fine];
                        let values = self.starts[fine] as usize..self.starts[fine + 1] as usize;
                        for (value, place) in product.entries[values].iter().zip(&mut places) {
                            sums[(*place).into()] -= weight * value;
                        }
                    }
                    for (octet, sums) in octets.iter_mut().zip(sums.chunks_exact(8)) {
                        for ((coupling, column), sum) in
                            octet.couplings.iter_mut().zip(octet.columns).zip(sums)
                        {
                            *coupling = if column as usize == row { 0.0 } else { *sum };
                        }
                    }
                }
            });
    }
}

#[cfg(test)]
mod tests {
    use crate::solver::multigrid::examples::{dense, hierarchy_of, irregular, lattice};
    use crate::solver::multigrid::hierarchy::Hierarchy;
    use crate::solver::multigrid::prolongation::WIDTH;
    use ndarray::Array2;

    fn check(hierarchy: &Hierarchy) {
        assert!(hierarchy.levels.len() > 1);
        for pair in hierarchy.levels.windows(2) {
            let (fine, coarse) = (&pair[0].matrix, &pair[1].matrix);
            let prolongation = &pair[0].coarsening.as_ref().unwrap().prolongation;
            let mut p = Array2::<f64>::zeros((fine.size(), coarse.size()));
            for row in 0..fine.size() {
                for slot in 0..WIDTH {
                    let column = prolongation.columns[row][slot] as usize;
                    p[[row, column]] += f64::from(prolongation.weights[row][slot]);
                }
            }
            let expected = p.t().dot(&dense(fine)).dot(&p);
            let scale = expected.diag().fold(0.0_f64, |a, b| a.max(*b));
            let difference = &expected - &dense(coarse);
            assert!(difference.iter().all(|d| d.abs() < 1e-5 * scale));
        }
    }

    #[test]
    fn the_coarse_matrix_is_the_product() {
        for mass in [1e-3, 1.0] {
            let (lower, masses) = lattice(40, 30, mass);
            check(&hierarchy_of(&lower, &masses));
        }
    }

    #[test]
    fn so_it_is_on_irregular_graphs_with_couplings_of_either_sign() {
        let (lower, masses) = irregular(1500);
        check(&hierarchy_of(&lower, &masses));
    }
}
