//! A symmetric matrix of blocks, as the Cholesky factorization reads it.

use nalgebra::SMatrix;
use sprs::CsMatI;

/// A block, of which a node of three unknowns has the first three rows or columns.
pub(super) type Block = SMatrix<f64, 6, 6>;

/// A group of unknowns that are coupled to the same others: a vertex's, or a body's.
#[derive(Debug, Clone)]
pub(super) struct Node {
    /// Its first unknown.
    pub first: usize,
    /// 6 for a free vertex, 3 for a pinned one or a body.
    pub size: usize,
    /// The nodes after it that it is coupled with, and where their rows begin behind its own.
    pub others: Vec<(u32, u32)>,
}

/// The lower triangle in compressed columns, a node's one after the other.
pub(super) struct BlockMatrix {
    pub nodes: Vec<Node>,
    pub lower: CsMatI<f64, u32>,
}

impl BlockMatrix {
    /// Nodes of the given `sizes`, coupled by `couplings`; all entries are 0.
    pub fn new(sizes: &[usize], couplings: impl Iterator<Item = (u32, u32)>) -> Self {
        let mut size = 0;
        let node = |own: &usize| {
            size += own;
            Node {
                first: size - own,
                size: *own,
                others: Vec::new(),
            }
        };
        let mut nodes: Vec<Node> = sizes.iter().map(node).collect();
        for (a, b) in couplings.filter(|(a, b)| a != b) {
            nodes[a.min(b) as usize].others.push((a.max(b), 0));
        }
        let (mut starts, mut rows) = (vec![0_u32], Vec::new());
        let firsts: Vec<usize> = nodes.iter().map(|node| node.first).collect();
        for node in &mut nodes {
            node.others.sort_unstable();
            node.others.dedup();
            let mut place = 0;
            for (other, offset) in &mut node.others {
                *offset = place;
                place += sizes[*other as usize] as u32;
            }
            for column in 0..node.size {
                rows.extend((column..node.size).map(|row| (node.first + row) as u32));
                for &(other, _) in &node.others {
                    let first = firsts[other as usize];
                    rows.extend((first..first + sizes[other as usize]).map(|row| row as u32));
                }
                starts.push(rows.len() as u32);
            }
        }
        let values = vec![0.0; rows.len()];
        let lower = CsMatI::new_csc((size, size), starts, rows, values);
        Self { nodes, lower }
    }

    /// Adds a block at the rows of node `a` and the columns of `b`, a ≥ b.
    pub fn add(&mut self, a: u32, b: u32, block: &Block) {
        let node = &self.nodes[b as usize];
        let (rows, columns) = (self.nodes[a as usize].size, node.size);
        let starts = self.lower.proper_indptr();
        let starts = &starts[node.first..node.first + columns];
        let offset = match a == b {
            true => None,
            false => {
                let found = node.others.binary_search_by_key(&a, |other| other.0);
                Some(node.others[found.expect("every coupling is in the pattern")].1 as usize)
            }
        };
        let starts: Vec<usize> = starts.iter().map(|&start| start as usize).collect();
        let values = self.lower.data_mut();
        for (column, start) in starts.into_iter().enumerate() {
            match offset {
                None => {
                    for row in column..rows {
                        values[start + row - column] += block[(row, column)];
                    }
                }
                Some(offset) => {
                    for row in 0..rows {
                        values[start + columns - column + offset + row] += block[(row, column)];
                    }
                }
            }
        }
    }
}
