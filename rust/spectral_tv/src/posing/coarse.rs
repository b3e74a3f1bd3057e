//! The Gauss–Newton matrix of a coarse mesh, factorized.

use nalgebra::{Matrix3, Vector3, Vector6};
use ndarray::Array2;

use crate::error::{Error, Result};
use crate::monitor::Stage;
use crate::posing::blocks::{Block, BlockMatrix};
use crate::posing::field::Field;
use crate::posing::linearized::Linearized;
use crate::posing::model::{Model, Role};
use crate::posing::state::rotated;
use crate::solver::Cholesky;

/// What keeps rotations that nothing asks for where they are, relative to the diagonal, and what
/// to try where that is too little, as without stiffness.
const DAMPINGS: [f64; 4] = [1e-9, 1e-6, 1e-4, 1e-2];
/// The same relative to the largest entry, for what has no diagonal.
const FLOOR: f64 = 1e-6;

/// The matrix of [`Linearized`], its pattern found once.
pub(super) struct CoarseSystem {
    matrix: BlockMatrix,
    /// The node of each vertex; `None` for one that nothing moves.
    node_of: Vec<Option<u32>>,
    /// The first node of a body.
    first_body: usize,
    cholesky: Cholesky,
}

impl CoarseSystem {
    pub fn new(model: &Model, stage: Stage) -> Result<Self> {
        let mut sizes = Vec::new();
        let mut new_node = |size: usize| {
            sizes.push(size);
            sizes.len() as u32 - 1
        };
        let mut node_of: Vec<Option<u32>> = model
            .roles
            .iter()
            .map(|role| match role {
                Role::Free => Some(new_node(6)),
                Role::Pinned => Some(new_node(3)),
                Role::Fixed | Role::Body(_) | Role::Floating => None,
            })
            .collect();
        let bodies: Vec<u32> = (0..model.body_count).map(|_| new_node(3)).collect();
        let first_body = sizes.len() - bodies.len();
        for (node, role) in node_of.iter_mut().zip(&model.roles) {
            if let Role::Body(body) = *role {
                *node = Some(bodies[body as usize]);
            }
        }
        let triangles = model.operators.gradient().triangles().iter();
        let sides = triangles.flat_map(|corners| {
            let [i, j, k] = corners.map(|corner| node_of[corner as usize]);
            [(i, j), (j, k), (k, i)]
        });
        let pulls = node_of.iter().zip(&model.pulled_along);
        let pulls = pulls.map(|(node, body)| (*node, body.map(|body| bodies[body as usize])));
        let couplings = sides.chain(pulls).filter_map(|(a, b)| a.zip(b));
        let matrix = BlockMatrix::new(&sizes, couplings);
        Ok(Self {
            cholesky: Cholesky::analyse(&matrix.lower, stage)?,
            node_of,
            first_body,
            matrix,
        })
    }

    /// Takes the matrix of a quadratic model.
    ///
    /// # Errors
    /// [`crate::Error::Solver`] if it is far from positive definite, or
    /// [`crate::Error::Cancelled`].
    pub fn factorize(&mut self, linearized: &Linearized, stage: Stage) -> Result<()> {
        self.matrix.lower.data_mut().fill(0.0);
        let model = linearized.model;
        let gradient = model.operators.gradient();
        let state = linearized.state;
        // δx and ω of a vertex by the unknowns of its node.
        let map = |vertex: usize| -> Block {
            let mut map = Block::zeros();
            match model.roles[vertex] {
                Role::Free => map = Block::identity(),
                Role::Pinned => map.fixed_view_mut::<3, 3>(3, 0).fill_with_identity(),
                Role::Body(body) => {
                    let arm = rotated(&state.bodies[body as usize], &model.arms[vertex]);
                    map.fixed_view_mut::<3, 3>(0, 0)
                        .copy_from(&-arm.cross_matrix());
                    map.fixed_view_mut::<3, 3>(3, 0).fill_with_identity();
                }
                Role::Fixed | Role::Floating => {}
            }
            map
        };
        for (face, corners) in gradient.triangles().iter().enumerate() {
            let term = linearized.numbers.face(face);
            if term.weight == 0.0 {
                continue;
            }
            let hats = &gradient.hats(face);
            let basis = &term.basis;
            let spin: Matrix3<f64> = basis
                .iter()
                .map(|column| {
                    Matrix3::from_diagonal_element(column.norm_squared())
                        - column * column.transpose()
                })
                .sum::<Matrix3<f64>>()
                / 9.0;
            let corners = corners.map(|corner| corner as usize);
            let maps = corners.map(map);
            let lean = [0, 1, 2]
                .map(|i| ((hats[i][0] * basis[0] + hats[i][1] * basis[1]) / 3.0).cross_matrix());
            let crushed = term.crushed.as_ref().map(|crushed| {
                [0, 1, 2].map(|i| {
                    let by_columns = &crushed.by_columns;
                    let moved = hats[i][0] * by_columns[0] + hats[i][1] * by_columns[1];
                    let turned = crushed.by_turn / 3.0;
                    let derivative = Vector6::from_iterator(moved.iter().chain(&turned).copied());
                    crushed.firmness.sqrt() * derivative
                })
            });
            for i in 0..3 {
                for j in 0..3 {
                    let (Some(a), Some(b)) = (self.node_of[corners[i]], self.node_of[corners[j]])
                    else {
                        continue;
                    };
                    if a < b {
                        continue; // its transpose is added
                    }
                    let product = hats[i][0] * hats[j][0] + hats[i][1] * hats[j][1];
                    let mut block = Block::zeros();
                    block.fixed_view_mut::<3, 3>(0, 0).fill_diagonal(product);
                    block.fixed_view_mut::<3, 3>(0, 3).copy_from(&lean[i]);
                    block
                        .fixed_view_mut::<3, 3>(3, 0)
                        .copy_from(&lean[j].transpose());
                    let turning = model.parameters.stiffness * product;
                    block
                        .fixed_view_mut::<3, 3>(3, 3)
                        .copy_from(&(spin + Matrix3::from_diagonal_element(turning)));
                    if let Some(derivatives) = &crushed {
                        block += derivatives[i] * derivatives[j].transpose();
                    }
                    let block = maps[i].transpose() * block * maps[j] * term.weight;
                    self.matrix.add(a, b, &block);
                }
            }
        }
        for vertex in 0..model.rest.len() {
            let Some(node) = self.node_of[vertex] else {
                continue;
            };
            let (spring, body) = linearized.spring(vertex);
            let own = linearized.diagonal(vertex);
            let map = map(vertex);
            let mut block = Block::zeros();
            block.fixed_view_mut::<3, 3>(0, 0).fill_diagonal(own);
            self.matrix
                .add(node, node, &(map.transpose() * block * map));
            if let (true, Some(body)) = (spring > 0.0, body) {
                let arm = rotated(&state.bodies[body as usize], &model.arms[vertex]);
                let lever = arm.cross_matrix();
                let mut own = Block::zeros();
                own.fixed_view_mut::<3, 3>(0, 0)
                    .copy_from(&(lever.transpose() * lever * spring));
                let body_node = (self.first_body + body as usize) as u32;
                self.matrix.add(body_node, body_node, &own);
                // −⟨ω × arm, δx⟩ = ⟨ω, [arm] … ⟩: rows of the body, columns of the vertex.
                let mut between = Block::zeros();
                between
                    .fixed_view_mut::<3, 3>(0, 0)
                    .copy_from(&(-lever * spring));
                let between = between * map;
                self.matrix.add(body_node, node, &between);
            }
        }
        let entries = self.matrix.lower.data().iter();
        let largest = entries.fold(f64::MIN_POSITIVE, |most, x| most.max(x.abs()));
        let mut outcome = Ok(());
        for damping in DAMPINGS {
            for (column, mut entries) in self.matrix.lower.outer_iterator_mut().enumerate() {
                if let Some(diagonal) = entries.get_mut(column) {
                    *diagonal += damping * (*diagonal + FLOOR * largest);
                }
            }
            outcome = self.cholesky.factorize(&self.matrix.lower, stage);
            if !matches!(outcome, Err(Error::Solver(_))) {
                break;
            }
        }
        outcome
    }

    /// Solves for a field of what moves freely.
    pub fn solve(&mut self, field: &Field, model: &Model) -> Field {
        let mut values = Array2::zeros((1, self.matrix.lower.cols()));
        let mut found = field.clone();
        self.visit(model, &mut found, |first, vector| {
            for axis in 0..3 {
                values[[0, first + axis]] = vector[axis];
            }
        });
        self.cholesky.solve_in_place(&mut values);
        self.visit(model, &mut found, |first, vector| {
            *vector = Vector3::from_fn(|axis, _| values[[0, first + axis]]);
        });
        model.mask(&mut found);
        found
    }

    /// Goes through the vectors of a field that are solved for, each with its first unknown.
    fn visit(
        &self,
        model: &Model,
        field: &mut Field,
        mut each: impl FnMut(usize, &mut Vector3<f64>),
    ) {
        for (vertex, role) in model.roles.iter().enumerate() {
            let Some(node) = self.node_of[vertex] else {
                continue;
            };
            let first = self.matrix.nodes[node as usize].first;
            match role {
                Role::Free => {
                    each(first, &mut field.moves[vertex]);
                    each(first + 3, &mut field.turns[vertex]);
                }
                Role::Pinned => each(first, &mut field.turns[vertex]),
                Role::Fixed | Role::Body(_) | Role::Floating => {}
            }
        }
        for (body, turn) in field.bodies.iter_mut().enumerate() {
            each(self.matrix.nodes[self.first_body + body].first, turn);
        }
    }
}
