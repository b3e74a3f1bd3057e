//! How far a point is from the planes of some triangles (Garland and Heckbert 1997, "Surface
//! Simplification Using Quadric Error Metrics").

use nalgebra::{Matrix3, Vector3};

/// Σ A (n · (x − p))², as a polynomial of x.
#[derive(Debug, Clone, Copy)]
pub(super) struct Quadric {
    quadratic: Matrix3<f64>,
    linear: Vector3<f64>,
    constant: f64,
}

impl Quadric {
    pub fn zero() -> Self {
        Self {
            quadratic: Matrix3::zeros(),
            linear: Vector3::zeros(),
            constant: 0.0,
        }
    }

    /// That of a triangle; nothing where it has no area.
    pub fn of_triangle([p, q, r]: [Vector3<f64>; 3]) -> Self {
        let cross = (q - p).cross(&(r - p));
        let twice = cross.norm();
        if twice == 0.0 {
            return Self::zero();
        }
        let normal = cross / twice;
        let (area, height) = (0.5 * twice, normal.dot(&p));
        Self {
            quadratic: area * normal * normal.transpose(),
            linear: -area * height * normal,
            constant: area * height * height,
        }
    }

    pub fn add(&mut self, other: &Self) {
        self.quadratic += other.quadratic;
        self.linear += other.linear;
        self.constant += other.constant;
    }

    /// At a point; length⁴.
    pub fn at(&self, x: &Vector3<f64>) -> f64 {
        (x.dot(&(self.quadratic * x)) + 2.0 * self.linear.dot(x) + self.constant).max(0.0)
    }
}
