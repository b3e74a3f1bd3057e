//! The symbolic factorization of a pattern: the order of elimination, and supernodes, columns with
//! like patterns that are treated together.

use faer::Side;
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{FaerError, SymbolicSparseColMatRef};
use sprs::CsMatI;

use crate::error::{Error, Result};
use crate::monitor::Stage;
use crate::solver::cholesky::dissection;

/// No supernode.
pub(super) const NONE: u32 = u32::MAX;

/// Runs of columns of L that have the same rows below their diagonal block.
#[derive(Debug, Clone)]
pub(super) struct Supernodes {
    /// The caller's index of each column.
    pub order: Vec<u32>,
    /// The column of each of the caller's indices.
    pub places: Vec<u32>,
    /// First column of each, and the number of columns at the end.
    pub begins: Vec<u32>,
    /// First entry of each in `rows`.
    starts: Vec<u32>,
    rows: Vec<u32>,
    /// The one that holds the first row of each, or [`NONE`].
    pub parents: Vec<u32>,
}

impl Supernodes {
    /// In an order of approximate minimum degree: the quickest to find, and as good as any where
    /// a shape falls apart by itself. Parents come after all that is below them, and what is
    /// below them stands together.
    ///
    /// # Errors
    /// [`Error::Solver`] if the index range does not suffice.
    pub fn by_degree(lower: &CsMatI<f64, u32>) -> Result<Self> {
        Ok(Self::with_ordering(lower, SymmetricOrdering::Amd)?.in_postorder())
    }

    /// In an order of nested dissection, likewise; parts of up to `smallest` vertices are ordered
    /// by degree.
    ///
    /// # Errors
    /// [`Error::Solver`] if the index range does not suffice, or [`Error::Cancelled`].
    pub fn by_dissection(lower: &CsMatI<f64, u32>, smallest: usize, stage: Stage) -> Result<Self> {
        let order = dissection::order(lower, smallest, stage)?;
        let nodes = stage.pass(|| Self::with_order(lower, &order))??;
        Ok(nodes.in_postorder())
    }

    fn with_order(lower: &CsMatI<f64, u32>, order: &[u32]) -> Result<Self> {
        let mut places = vec![0; order.len()];
        for (place, &vertex) in order.iter().enumerate() {
            places[vertex as usize] = place as u32;
        }
        let order = PermRef::new_checked(order, &places, order.len());
        Self::with_ordering(lower, SymmetricOrdering::Custom(order))
    }

    fn with_ordering(lower: &CsMatI<f64, u32>, order: SymmetricOrdering<u32>) -> Result<Self> {
        let params = CholeskySymbolicParams {
            // Below 0, which a matrix without couplings has.
            supernodal_flop_ratio_threshold: SupernodalThreshold(-1.0),
            ..Default::default()
        };
        let (size, starts) = (lower.cols(), lower.proper_indptr());
        let pattern =
            SymbolicSparseColMatRef::new_checked(size, size, &starts, None, lower.indices());
        let symbolic =
            factorize_symbolic_cholesky(pattern, Side::Lower, order, params).map_err(|error| {
                match error {
                    FaerError::OutOfMemory => Error::Memory(
                        "the analysis of the mesh's matrix takes more memory than there is".into(),
                    ),
                    error => Error::Solver(format!("analysis failed: {error:?}")),
                }
            })?;
        Self::of(&symbolic)
    }

    fn of(symbolic: &SymbolicCholesky<u32>) -> Result<Self> {
        let (SymbolicCholeskyRaw::Supernodal(nodes), Some(order)) =
            (symbolic.raw(), symbolic.perm())
        else {
            return Err(Error::Solver("analysis found no supernodes".into()));
        };
        let mut begins = nodes.supernode_begin().to_vec();
        begins.push(nodes.ncols() as u32);
        let mut owners = vec![0; nodes.ncols()];
        for (node, ends) in begins.windows(2).enumerate() {
            owners[ends[0] as usize..ends[1] as usize].fill(node as u32);
        }
        let parent = |node| {
            let first_row = nodes.supernode(node).pattern().first();
            first_row.map_or(NONE, |&row| owners[row as usize])
        };
        Ok(Self {
            order: order.arrays().0.to_vec(),
            places: order.arrays().1.to_vec(),
            begins,
            starts: nodes.col_ptr_for_row_idx().to_vec(),
            rows: nodes.row_idx().to_vec(),
            parents: (0..nodes.n_supernodes()).map(parent).collect(),
        })
    }

    /// Number of supernodes.
    pub fn len(&self) -> usize {
        self.parents.len()
    }

    /// Number of columns of one.
    pub fn width(&self, node: usize) -> usize {
        (self.begins[node + 1] - self.begins[node]) as usize
    }

    /// Rows of one below its diagonal block, ascending.
    pub fn rows(&self, node: usize) -> &[u32] {
        &self.rows[self.starts[node] as usize..self.starts[node + 1] as usize]
    }

    /// Multiplications that one takes, more or less.
    pub fn work(&self, node: usize) -> f64 {
        let height = (self.width(node) + self.rows(node).len()) as f64;
        self.width(node) as f64 * height * height
    }

    /// Entries that L will have in each row, on average.
    pub fn fill(&self) -> f64 {
        let entries = |node| self.width(node) * (self.width(node) + self.rows(node).len());
        let total: usize = (0..self.len()).map(entries).sum();
        total as f64 / self.order.len().max(1) as f64
    }

    /// The first supernode of everything at or below each.
    pub fn first_descendants(&self) -> Vec<u32> {
        let mut firsts: Vec<u32> = (0..self.len() as u32).collect();
        for node in 0..self.len() {
            if let Some(first) = firsts.get(self.parents[node] as usize) {
                let first = (*first).min(firsts[node]);
                firsts[self.parents[node] as usize] = first;
            }
        }
        firsts
    }

    /// The same in an order in which what is below a supernode stands together, right before it.
    fn in_postorder(self) -> Self {
        let Some(sequence) = self.postorder() else {
            return self;
        };
        let mut columns = vec![0; self.order.len()];
        let mut indices = vec![0; self.len()];
        let (mut begins, mut order) = (vec![0], Vec::with_capacity(self.order.len()));
        for (index, &node) in sequence.iter().enumerate() {
            indices[node] = index as u32;
            for column in self.begins[node]..self.begins[node + 1] {
                columns[column as usize] = order.len() as u32;
                order.push(self.order[column as usize]);
            }
            begins.push(order.len() as u32);
        }
        let (mut starts, mut rows) = (vec![0], Vec::with_capacity(self.rows.len()));
        for &node in &sequence {
            let first = rows.len();
            rows.extend(self.rows(node).iter().map(|&row| columns[row as usize]));
            rows[first..].sort_unstable();
            starts.push(rows.len() as u32);
        }
        let above = |&node: &usize| match self.parents[node] {
            NONE => NONE,
            parent => indices[parent as usize],
        };
        Self {
            places: self
                .places
                .iter()
                .map(|&place| columns[place as usize])
                .collect(),
            parents: sequence.iter().map(above).collect(),
            order,
            begins,
            starts,
            rows,
        }
    }

    /// The supernodes in such an order; `None` if the one at hand is one.
    fn postorder(&self) -> Option<Vec<usize>> {
        let mut sizes = vec![1_u32; self.len()];
        for node in 0..self.len() {
            if self.parents[node] != NONE {
                sizes[self.parents[node] as usize] += sizes[node];
            }
        }
        let firsts = self.first_descendants();
        let stands_together = |node: usize| node as u32 - firsts[node] + 1 == sizes[node];
        if (0..self.len()).all(stands_together) {
            return None;
        }
        // Where each subtree ends: the last children end where their parents begin.
        let mut roots_end = self.len() as u32;
        let mut ends = vec![0; self.len()];
        let mut free: Vec<u32> = vec![0; self.len()];
        for node in (0..self.len()).rev() {
            let end = match self.parents[node] {
                NONE => &mut roots_end,
                parent => &mut free[parent as usize],
            };
            ends[node] = *end;
            *end -= sizes[node];
            free[node] = ends[node] - 1;
        }
        let mut sequence: Vec<usize> = (0..self.len()).collect();
        sequence.sort_unstable_by_key(|&node| ends[node]);
        Some(sequence)
    }
}
