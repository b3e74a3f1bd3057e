//! Eigenfunctions of the Laplace–Beltrami operator, and the flow that fades them one by one.

use ndarray::{Array1, Array2, Axis, Slice, aview1};

use crate::discretization::Discretization;
use crate::error::{ArgumentError, Result};
use crate::flow::origin::{origin_of, without};
use crate::flow::times::check_steps;
use crate::flow::trajectory::Trajectory;
use crate::memory::needs;
use crate::mesh::{TriangleMesh, component_count, components_of};
use crate::monitor::{Monitor, Stage};
use crate::operators::element_stiffness;
use crate::solver::{Cholesky, Operator, largest_eigenpairs};

/// λ below which the inverse is not taken, × area: far below the first eigenvalue of any shape
/// that is not a thread.
const SHIFT: f64 = 1.0;
/// Right-hand sides that are solved before looking whether to go on.
const TOGETHER: usize = 4;

/// The lowest eigenpairs of L u = λ M u, λ rising from 0, with ⟨u_i, u_j⟩_M = δ_ij.
#[derive(Debug, Clone)]
pub struct Eigenpairs {
    /// λ, K, 1/length².
    pub eigenvalues: Vec<f64>,
    /// u, (K, V), 1/length.
    pub eigenfunctions: Array2<f64>,
}

impl Eigenpairs {
    /// The `count` lowest of `mesh`, or all V if it has no more; those of λ = 0, the constants
    /// of each component, first.
    ///
    /// By inverse block Lanczos iteration with one factorization. Takes time with the square of
    /// `count`, and memory for about twice as many functions.
    ///
    /// ```
    /// use spectral_tv::discretization::Discretization;
    /// use spectral_tv::flow::Eigenpairs;
    ///
    /// # use spectral_tv::mesh::TriangleMesh;
    /// # let vertices = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0.3, 0.3, 1.]];
    /// # let triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    /// # let mesh = TriangleMesh::new(vertices, &triangles)?;
    /// let pairs = Eigenpairs::lowest(&mesh, &Discretization::new(&mesh)?, 2)?;
    /// assert!(pairs.eigenvalues[0].abs() < 1e-9 && pairs.eigenvalues[1] > 0.0);
    /// # Ok::<(), spectral_tv::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`crate::Error::Argument`] if `count` is 0, [`crate::Error::Memory`],
    /// [`crate::Error::Solver`].
    pub fn lowest(mesh: &TriangleMesh, operators: &Discretization, count: usize) -> Result<Self> {
        Self::lowest_with(mesh, operators, count, Monitor::new().whole())
    }

    /// [`Self::lowest`], watched: `stage` tells how far it is, and cancels it.
    ///
    /// # Errors
    /// As [`Self::lowest`], or [`crate::Error::Cancelled`].
    pub fn lowest_with(
        mesh: &TriangleMesh,
        operators: &Discretization,
        count: usize,
        stage: Stage,
    ) -> Result<Self> {
        if count == 0 {
            return Err(ArgumentError::value("eigenpairs", "must be at least 1", count).into());
        }
        let count = count.min(mesh.vertex_count());
        stage.require(
            needs::eigenpairs(needs::Size::of(mesh), count),
            &format!(
                "finding {count} eigenpairs on {} vertices",
                mesh.vertex_count()
            ),
            "take fewer eigenpairs, or a mesh of fewer vertices",
        )?;
        let mut inverse = Inverse::new(mesh, operators, stage)?;
        let constants = inverse.component_masses.len().min(count);
        let others = (count - constants).min(inverse.dimension());
        let (values, vectors) = largest_eigenpairs(&mut inverse, others, stage)?;
        let mut eigenfunctions = Array2::zeros((constants + others, inverse.size()));
        for (vertex, &component) in inverse.components.iter().enumerate() {
            let component = component as usize;
            if component < constants {
                let mass = inverse.component_masses[component];
                eigenfunctions[[component, vertex]] = 1.0 / mass.sqrt();
            }
        }
        let mut rest = eigenfunctions.slice_axis_mut(Axis(0), Slice::from(constants..));
        rest.assign(&vectors);
        rest /= &inverse.roots;
        let mut eigenvalues = vec![0.0; constants];
        // What is lost in rounding belongs to the highest, far beyond any time that matters.
        let least = f64::EPSILON * values.first().copied().unwrap_or(0.0);
        let eigenvalue = |of: &f64| (1.0 / of.max(least) - inverse.shift).max(0.0);
        eigenvalues.extend(values.iter().map(eigenvalue));
        Ok(Self {
            eigenvalues,
            eigenfunctions,
        })
    }

    /// Runs the flow from `initial` (C, V) through `times` in which every eigenfunction falls in
    /// a straight line and is extinct at t = 1/λ, as eigenfunctions of a zero-homogeneous flow
    /// do; what the eigenpairs do not hold is gone at t₁. Its spectral transform is the filtering
    /// by eigenfunctions of Vallet and Lévy 2008, ordered by 1/λ: all-pass is exact, and without
    /// the components up to the last eigenvalue it is the projection onto the eigenpairs.
    ///
    /// # Errors
    /// As [`Trajectory::sampled`].
    pub fn flow(
        &self,
        operators: &Discretization,
        initial: Array2<f64>,
        times: &[f64],
    ) -> Result<Trajectory> {
        self.flow_with(operators, initial, times, Monitor::new().whole())
    }

    /// [`Self::flow`], watched: `stage` tells how far it is, and cancels it.
    ///
    /// # Errors
    /// As [`Self::flow`], or [`crate::Error::Cancelled`].
    pub fn flow_with(
        &self,
        operators: &Discretization,
        initial: Array2<f64>,
        times: &[f64],
        stage: Stage,
    ) -> Result<Trajectory> {
        operators.check_values(initial.view())?;
        // Constants stay as they are.
        let is_held = self.has_constants(operators);
        let rest = match is_held {
            true => without(initial.clone(), &origin_of(initial.view())),
            false => initial.clone(),
        };
        let coefficients = (rest * aview1(operators.masses())).dot(&self.eigenfunctions.t());
        let state = |k: usize, origin: &Array1<f64>| {
            let left = |lambda: &f64| (1.0 - lambda * times[k]).max(0.0);
            let left: Vec<f64> = self.eigenvalues.iter().map(left).collect();
            // The sum only over what is left of it.
            let alive = left
                .iter()
                .rposition(|&share| share > 0.0)
                .map_or(0, |k| k + 1);
            let coefficients = coefficients.slice_axis(Axis(1), Slice::from(..alive));
            let functions = self
                .eigenfunctions
                .slice_axis(Axis(0), Slice::from(..alive));
            let state = (&coefficients * &aview1(&left[..alive])).dot(&functions);
            match is_held {
                true => state,
                false => without(state, origin),
            }
        };
        let flow = Trajectory::sampled_with(operators, times, initial, state, stage)?;
        Ok(flow.piecewise_linear())
    }

    /// Whether the constants of all components are among the eigenfunctions.
    fn has_constants(&self, operators: &Discretization) -> bool {
        let gradient = operators.gradient();
        let vertices = operators.masses().len();
        let components = components_of(vertices, gradient.triangles(), gradient.face_areas());
        let constants = self.eigenvalues.iter().filter(|&&value| value == 0.0);
        constants.count() >= component_count(&components)
    }

    /// N + 1 times for that flow, length²: t₁ before and t₂ at the extinction of the finest
    /// eigenfunction, so that the first component is what the eigenpairs do not hold, and from
    /// there on evenly spaced in log t to `largest`, or to eight times t₂ if that is more.
    ///
    /// # Errors
    /// If `steps` is 0.
    pub fn times(&self, largest: f64, steps: usize) -> Result<Vec<f64>> {
        check_steps(steps)?;
        let highest = self
            .eigenvalues
            .iter()
            .fold(0.0_f64, |most, &l| most.max(l));
        let finest = match highest > 0.0 {
            true => 1.0 / highest,
            false => largest / 8.0,
        };
        let ratio = (largest / finest).max(8.0);
        let time = |k: usize| match k {
            0 => 0.0,
            k if k == steps => finest * ratio,
            1 => 0.5 * finest,
            k => finest * ratio.powf((k - 2) as f64 / (steps - 2) as f64),
        };
        Ok((0..=steps).map(time).collect())
    }
}

/// √M (L + σM)⁻¹ √M without the constants of each component, whose eigenvalues are 1/(λ + σ).
struct Inverse {
    factor: Cholesky,
    /// √M.
    roots: Array1<f64>,
    shift: f64,
    /// The component of every vertex, from 0, and the area of each.
    components: Vec<u32>,
    component_masses: Vec<f64>,
}

impl Inverse {
    fn new(mesh: &TriangleMesh, operators: &Discretization, stage: Stage) -> Result<Self> {
        let (gradient, masses) = (operators.gradient(), operators.masses());
        let shift = SHIFT / operators.area();
        let diagonal: Vec<f64> = masses.iter().map(|mass| shift * mass).collect();
        let stiffness =
            |face: usize| element_stiffness(&gradient.hats(face), gradient.face_areas()[face]);
        let mut system = operators.pattern().zeros();
        let mut factor = operators.cholesky(stage)?;
        let pattern = operators.pattern();
        stage.pass(|| pattern.assemble(gradient, &diagonal, stiffness, &mut system))?;
        factor.factorize(&system, stage)?;
        let components = stage.pass(|| mesh.connected_components())?;
        let mut component_masses = vec![0.0; component_count(&components)];
        for (&component, mass) in components.iter().zip(masses) {
            component_masses[component as usize] += mass;
        }
        Ok(Self {
            factor,
            roots: masses.iter().map(|mass| mass.sqrt()).collect(),
            shift,
            components,
            component_masses,
        })
    }
}

impl Operator for Inverse {
    fn size(&self) -> usize {
        self.roots.len()
    }

    fn dimension(&self) -> usize {
        self.size() - self.component_masses.len()
    }

    fn project(&self, block: &mut Array2<f64>) {
        for mut row in block.axis_iter_mut(Axis(0)) {
            let mut means = vec![0.0; self.component_masses.len()];
            for ((value, root), &component) in row.iter().zip(&self.roots).zip(&self.components) {
                means[component as usize] +=
                    root * value / self.component_masses[component as usize];
            }
            for ((value, root), &component) in row.iter_mut().zip(&self.roots).zip(&self.components)
            {
                *value -= root * means[component as usize];
            }
        }
    }

    fn apply(&mut self, block: &mut Array2<f64>, stage: Stage) -> Result<()> {
        for mut rows in block.axis_chunks_iter_mut(Axis(0), TOGETHER) {
            let mut solutions = &rows * &self.roots;
            stage.pass(|| self.factor.solve_in_place(&mut solutions))?;
            rows.assign(&(solutions * &self.roots));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_own_times_increase_from_0() {
        let pairs = Eigenpairs {
            eigenvalues: vec![0.0, 2.0, 40.0],
            eigenfunctions: Array2::zeros((3, 1)),
        };
        for steps in [1, 2, 3, 32] {
            let times = pairs.times(0.5, steps).unwrap();
            assert_eq!(times.len(), steps + 1);
            assert!(times[0] == 0.0 && times.windows(2).all(|pair| pair[0] < pair[1]));
            assert!((times[steps] - 0.5).abs() < 1e-12);
        }
        assert!((pairs.times(0.5, 32).unwrap()[2] - 1.0 / 40.0).abs() < 1e-15);
        assert!(pairs.times(0.5, 0).is_err());
    }
}
