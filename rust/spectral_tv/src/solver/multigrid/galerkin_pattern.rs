//! The patterns of KP and of PᵀKP, and the place of every product of entries in them.

use std::ops::Range;

use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::monitor::Stage;
use crate::solver::multigrid::matrix::Matrix;
use crate::solver::multigrid::prolongation::{Prolongation, WIDTH};

/// A place among the entries of a row. Most rows are short: single bytes halve what is kept.
pub(super) trait Place: Copy + Default + Eq + Into<usize> + Send + Sync {
    /// Entries of a row that it can tell apart, and no place of any.
    const MOST: Self;

    /// That place, of those that are not too many.
    fn of(place: usize) -> Self;
}

impl Place for u8 {
    const MOST: Self = Self::MAX;

    fn of(place: usize) -> Self {
        place as Self
    }
}

/// A mesh beyond that is for another solver.
impl Place for u16 {
    const MOST: Self = Self::MAX;

    fn of(place: usize) -> Self {
        place as Self
    }
}

/// The pattern of KP.
pub(super) struct Product<S> {
    /// First entry of each row, and their number at the end.
    pub starts: Vec<u32>,
    pub columns: Vec<u32>,
    /// Where each row's own weights go in its row, and those of its neighbours.
    pub own_slots: Vec<[S; WIDTH]>,
    pub slots: Vec<[[S; WIDTH]; 8]>,
}

impl<S: Place> Product<S> {
    /// # Errors
    /// [`Error::Cancelled`], or [`Error::Solver`] if a vertex has too many neighbours.
    pub fn new(matrix: &Matrix, prolongation: &Prolongation, stage: Stage) -> Result<Self> {
        let (size, chunk) = (matrix.size(), matrix.chunk());
        let mut own_slots = vec![[S::default(); WIDTH]; size];
        let mut slots = vec![[[S::default(); WIDTH]; 8]; matrix.octets.len()];
        let slot_parts = matrix.parts_of_octets(&mut slots);
        let parts = own_slots.par_chunks_mut(chunk).zip(slot_parts).enumerate();
        let lists: Vec<(Vec<u32>, Vec<u32>)> = parts
            .with_max_len(1)
            .map(|(part, (own_slots, slots))| {
                stage.check()?;
                let first = part * chunk;
                let mut seen = Seen::new(prolongation.coarse_size());
                let (mut ends, mut columns) = (Vec::new(), Vec::new());
                for (offset, own) in own_slots.iter_mut().enumerate() {
                    let row = first + offset;
                    let start = columns.len();
                    let octets = matrix.starts[row] as usize..matrix.starts[row + 1] as usize;
                    let local = octets.start - matrix.starts[first] as usize;
                    let mut place = |fine: usize| -> [S; WIDTH] {
                        let mut places = [S::default(); WIDTH];
                        if prolongation.reaches(fine) {
                            for (place, &column) in
                                places.iter_mut().zip(&prolongation.columns[fine])
                            {
                                *place = S::of(seen.place(row, column, start, &mut columns));
                            }
                        }
                        places
                    };
                    *own = place(row);
                    for (octet, slots) in matrix.octets[octets].iter().zip(&mut slots[local..]) {
                        for (slots, &column) in slots.iter_mut().zip(&octet.columns) {
                            *slots = place(column as usize);
                        }
                    }
                    // Weights of 0 of rows that do not take part are added somewhere, too.
                    if columns.len() == start {
                        columns.push(0);
                    }
                    check_width::<S>(columns.len() - start)?;
                    ends.push(columns.len() as u32);
                }
                Ok((ends, columns))
            })
            .collect::<Result<_>>()?;
        let mut starts = vec![0];
        let mut columns = Vec::new();
        for (ends, of_part) in &lists {
            let first = columns.len() as u32;
            starts.extend(ends.iter().map(|end| first + end));
            columns.extend_from_slice(of_part);
        }
        Ok(Self {
            starts,
            columns,
            own_slots,
            slots,
        })
    }
}

/// The pattern of some rows of PᵀKP.
pub(super) struct Part<S> {
    /// First of each row's `neighbours`, and their number at the end.
    pub neighbour_starts: Vec<usize>,
    pub neighbours: Vec<u32>,
    /// End of each row's `places`.
    pub place_ends: Vec<u64>,
    /// Where every entry of KP that a row gathers goes in it: its neighbours first, then itself.
    pub places: Vec<S>,
}

impl<S: Place> Part<S> {
    /// # Errors
    /// [`Error::Solver`] if a row has too many neighbours.
    pub fn new(
        rows: Range<usize>,
        size: usize,
        product: &Product<S>,
        prolongation: &Prolongation,
    ) -> Result<Self> {
        let mut part = Self {
            neighbour_starts: vec![0],
            neighbours: Vec::new(),
            place_ends: Vec::new(),
            places: Vec::new(),
        };
        let mut seen = Seen::new(size);
        for row in rows {
            let start = part.neighbours.len();
            let first = part.places.len();
            for &entry in prolongation.entries(row) {
                let fine = entry as usize / WIDTH;
                let columns = product.starts[fine] as usize..product.starts[fine + 1] as usize;
                for &column in &product.columns[columns] {
                    part.places.push(match column as usize == row {
                        true => S::MOST,
                        false => S::of(seen.place(row, column, start, &mut part.neighbours)),
                    });
                }
            }
            let width = (part.neighbours.len() - start).next_multiple_of(8);
            check_width::<S>(width + 1)?;
            // A row's own entry stands at the end, which is known only now.
            let places = part.places[first..].iter_mut();
            for place in places.filter(|place| **place == S::MOST) {
                *place = S::of(width);
            }
            part.neighbour_starts.push(part.neighbours.len());
            part.place_ends.push(part.places.len() as u64);
        }
        Ok(part)
    }
}

fn check_width<S: Place>(width: usize) -> Result<()> {
    match width < S::MOST.into() {
        true => Ok(()),
        false => Err(Error::Solver("a vertex has too many neighbours".into())),
    }
}

/// Where columns were listed in the row at work.
struct Seen {
    /// The last row + 1 that listed each column, and where.
    listed: Vec<(u32, u32)>,
}

impl Seen {
    fn new(columns: usize) -> Self {
        Self {
            listed: vec![(0, 0); columns],
        }
    }

    /// The place of `column` in the list of `row`, which begins at `start` of `columns`.
    #[inline]
    fn place(&mut self, row: usize, column: u32, start: usize, columns: &mut Vec<u32>) -> usize {
        let listed = &mut self.listed[column as usize];
        if listed.0 != row as u32 + 1 {
            // Rows that overflow are refused once they are whole.
            *listed = (row as u32 + 1, (columns.len() - start) as u32);
            columns.push(column);
        }
        listed.1 as usize
    }
}
