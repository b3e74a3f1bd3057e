//! Smallest separators of a graph. By Menger's theorem a smallest separator has as many vertices as
//! there are paths without a common vertex. Paths are found depth first, towards the other side
//! (Pothen and Fan 1990, for matchings).

use crate::error::Result;
use crate::monitor::Stage;
use crate::solver::cholesky::part::{Part, Side};

/// No vertex, and the ends of paths.
const NONE: u32 = u32::MAX;
const START: u32 = NONE - 1;
const END: u32 = NONE - 2;

/// Of the vertices `Between` leaves a smallest set that separates the others: the one nearest to
/// the first side. Where the sides touch, the first one's vertices are part of it.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub(super) fn separate(part: &Part, sides: &mut [Side], stage: Stage) -> Result<()> {
    let mut band = Vec::new();
    let mut direct = Vec::new();
    let mut places = vec![NONE; part.len()];
    for vertex in 0..part.len() {
        match sides[vertex] {
            Side::Between => {
                places[vertex] = band.len() as u32;
                band.push(vertex as u32);
            }
            Side::First if part.touches(vertex, Side::Second, sides) => direct.push(vertex),
            _ => {}
        }
    }
    let mut paths = Paths::new(part, &band, &places, sides);
    while paths.add_some() {
        stage.check()?;
    }
    for (place, &vertex) in band.iter().enumerate() {
        let [entered, left] = [0, 1].map(|end| paths.is_reached[2 * place + end]);
        sides[vertex as usize] = match (entered, left) {
            (_, true) => Side::First,
            (true, false) => Side::Between,
            (false, false) => Side::Second,
        };
    }
    for vertex in direct {
        sides[vertex] = Side::Between;
    }
    Ok(())
}

/// Paths through a band from its first side to its second, and the search for a further one.
///
/// The search enters vertex v (state 2 v). If no path goes through v, it leaves v for any neighbour
/// (state 2 v + 1). If a path goes through v, the search goes back along that path to the vertex
/// before v, and leaves that one another way.
struct Paths {
    starts: Vec<u32>,
    /// Of each vertex, those near to the second side first.
    neighbours: Vec<u32>,
    /// The vertices at the first side, and which are at the second one.
    firsts: Vec<u32>,
    is_last: Vec<bool>,
    /// The vertices before and after each on its path.
    before: Vec<u32>,
    after: Vec<u32>,
    /// The states that were reached since paths last changed for good, and ways on from each that
    /// were tried.
    is_reached: Vec<bool>,
    tried: Vec<u32>,
}

impl Paths {
    /// No paths through the `band` of a part, whose vertices are at `places` in it.
    fn new(part: &Part, band: &[u32], places: &[u32], sides: &[Side]) -> Self {
        let mut starts = Vec::with_capacity(band.len() + 1);
        let mut neighbours = Vec::new();
        let (mut firsts, mut is_last) = (Vec::new(), vec![false; band.len()]);
        starts.push(0);
        for (place, &vertex) in band.iter().enumerate() {
            let mut is_first = false;
            for &other in part.neighbours_of(vertex as usize) {
                match sides[other as usize] {
                    Side::First => is_first = true,
                    Side::Second => is_last[place] = true,
                    Side::Between => neighbours.push(places[other as usize]),
                }
            }
            if is_first {
                firsts.push(place as u32);
            }
            starts.push(neighbours.len() as u32);
        }
        let mut paths = Self {
            starts,
            neighbours,
            firsts,
            is_last,
            before: vec![NONE; band.len()],
            after: vec![NONE; band.len()],
            is_reached: vec![false; 2 * band.len()],
            tried: vec![0; 2 * band.len()],
        };
        paths.sort_neighbours();
        paths
    }

    fn sort_neighbours(&mut self) {
        let mut distances = vec![NONE; self.is_last.len()];
        let mut queue: Vec<u32> = (0..self.is_last.len() as u32)
            .filter(|&vertex| self.is_last[vertex as usize])
            .collect();
        for &vertex in &queue {
            distances[vertex as usize] = 0;
        }
        let mut next = 0;
        while let Some(&vertex) = queue.get(next) {
            next += 1;
            for &other in self.neighbours_of(vertex) {
                if distances[other as usize] == NONE {
                    distances[other as usize] = distances[vertex as usize] + 1;
                    queue.push(other);
                }
            }
        }
        for vertex in 0..self.is_last.len() {
            let range = self.starts[vertex] as usize..self.starts[vertex + 1] as usize;
            self.neighbours[range].sort_by_key(|&other| distances[other as usize]);
        }
    }

    fn neighbours_of(&self, vertex: u32) -> &[u32] {
        let ends = [0, 1].map(|end| self.starts[vertex as usize + end] as usize);
        &self.neighbours[ends[0]..ends[1]]
    }

    /// Adds paths that do not share a state with each other; whether there were any.
    fn add_some(&mut self) -> bool {
        self.is_reached.fill(false);
        self.tried.fill(0);
        let mut path = Vec::new();
        let mut is_any = false;
        for index in 0..self.firsts.len() {
            is_any |= self.add_from(self.firsts[index], &mut path);
        }
        is_any
    }

    /// Adds a path that begins at a vertex, if there is one through states not yet reached.
    fn add_from(&mut self, first: u32, path: &mut Vec<u32>) -> bool {
        path.clear();
        if !std::mem::replace(&mut self.is_reached[2 * first as usize], true) {
            path.push(2 * first);
        }
        while let Some(&state) = path.last() {
            match self.next(state) {
                Some(END) => {
                    self.add(path);
                    return true;
                }
                Some(next) => {
                    self.is_reached[next as usize] = true;
                    path.push(next);
                }
                None => {
                    path.pop();
                }
            }
        }
        false
    }

    /// A state not yet reached that follows on `state`, or [`END`].
    fn next(&mut self, state: u32) -> Option<u32> {
        let vertex = state / 2;
        let (before, after) = (self.before[vertex as usize], self.after[vertex as usize]);
        let is_used = after != NONE;
        let is_new = |next: u32| !self.is_reached[next as usize];
        if state.is_multiple_of(2) {
            return match (is_used, before) {
                (false, _) => Some(state + 1),
                (true, START) => None,
                (true, before) => Some(2 * before + 1),
            }
            .filter(|&next| is_new(next));
        }
        if self.is_last[vertex as usize] {
            return Some(END);
        }
        if is_used && is_new(state - 1) {
            return Some(state - 1);
        }
        let end = self.starts[vertex as usize + 1];
        let mut place = self.starts[vertex as usize] + self.tried[vertex as usize];
        let mut next = None;
        while place < end && next.is_none() {
            next = Some(2 * self.neighbours[place as usize]).filter(|&next| is_new(next));
            place += 1;
        }
        self.tried[vertex as usize] = place - self.starts[vertex as usize];
        next
    }

    fn add(&mut self, path: &[u32]) {
        let mut from = START;
        for &state in path {
            let vertex = state / 2;
            if state.is_multiple_of(2) {
                if from == vertex {
                    // The path through it goes another way before it gets here.
                    self.before[vertex as usize] = NONE;
                    self.after[vertex as usize] = NONE;
                } else {
                    self.before[vertex as usize] = from;
                    if from != START {
                        self.after[from as usize] = vertex;
                    }
                }
            }
            from = vertex;
        }
        self.after[from as usize] = END;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::Graph;
    use crate::monitor::Monitor;
    use crate::solver::examples::{irregular, lattice};

    fn part(lower: &sprs::CsMatI<f64, u32>) -> Part {
        Part::whole(Graph::new(lower, Monitor::new().whole()).unwrap())
    }

    fn is_separated(part: &Part, sides: &[Side]) -> bool {
        let is_first = |&vertex: &usize| sides[vertex] == Side::First;
        let mut firsts = (0..part.len()).filter(is_first);
        firsts.all(|vertex| !part.touches(vertex, Side::Second, sides))
    }

    #[test]
    fn a_lattice_is_cut_where_it_is_narrow() {
        // 40 by 30 vertices, all but the outermost columns free.
        let part = part(&lattice(40, 30, 1.0).0);
        let side = |vertex: usize| match vertex % 40 {
            0 => Side::First,
            39 => Side::Second,
            _ => Side::Between,
        };
        let mut sides: Vec<Side> = (0..1200).map(side).collect();
        separate(&part, &mut sides, Monitor::new().whole()).unwrap();
        let count = |side: Side| sides.iter().filter(|&&other| other == side).count();
        assert!(is_separated(&part, &sides));
        assert_eq!(count(Side::Between), 30);
        assert_eq!(count(Side::First), 30);
    }

    #[test]
    fn paths_that_are_in_the_way_of_others_give_way() {
        // Two corners of a lattice: whatever way the first path takes, there are three.
        let part = part(&lattice(12, 12, 1.0).0);
        let mut sides = vec![Side::Between; 144];
        (sides[0], sides[143]) = (Side::First, Side::Second);
        separate(&part, &mut sides, Monitor::new().whole()).unwrap();
        let between = sides.iter().filter(|&&side| side == Side::Between).count();
        assert!(is_separated(&part, &sides));
        assert_eq!(between, 3);
    }

    #[test]
    fn sides_that_touch_are_separated_too() {
        let part = part(&irregular(500).0);
        for modulus in [2, 3, 7] {
            let side = |vertex: usize| match vertex % modulus {
                0 => Side::First,
                1 => Side::Second,
                _ => Side::Between,
            };
            let mut sides: Vec<Side> = (0..part.len()).map(side).collect();
            separate(&part, &mut sides, Monitor::new().whole()).unwrap();
            assert!(is_separated(&part, &sides));
        }
    }
}
