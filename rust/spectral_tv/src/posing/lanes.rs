//! Numbers, vectors and quaternions of several faces beside each other, which a processor takes at
//! once. All is inlined, so that it becomes code for the processor at hand (`pulp::Arch`).

use std::ops::{Add, Div, Mul, Neg, Sub};

use nalgebra::{Quaternion, Vector3};

/// Faces beside each other.
pub(super) const LANES: usize = 4;

/// Where something of each face is.
pub(super) type Places = [usize; LANES];

/// A number of each face.
#[derive(Debug, Clone, Copy)]
#[repr(align(32))]
pub(super) struct Lanes(pub [f64; LANES]);

impl Lanes {
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> f64) -> Self {
        let mut lanes = [0.0; LANES];
        for (lane, to) in lanes.iter_mut().enumerate() {
            *to = value(lane);
        }
        Self(lanes)
    }

    #[inline(always)]
    pub fn all(value: f64) -> Self {
        Self([value; LANES])
    }

    #[inline(always)]
    pub fn map(self, image: impl Fn(f64) -> f64) -> Self {
        Self::of(|lane| image(self.0[lane]))
    }

    #[inline(always)]
    pub fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }

    #[inline(always)]
    pub fn recip(self) -> Self {
        self.map(f64::recip)
    }

    /// Over all faces.
    pub fn sum(self) -> f64 {
        self.0.iter().sum()
    }
}

macro_rules! operator {
    ($trait:ident, $name:ident, $sign:tt) => {
        impl $trait for Lanes {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self::of(|lane| self.0[lane] $sign other.0[lane])
            }
        }

        impl $trait<f64> for Lanes {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: f64) -> Self {
                self.map(|value| value $sign other)
            }
        }
    };
}

operator!(Add, add, +);
operator!(Sub, sub, -);
operator!(Mul, mul, *);
operator!(Div, div, /);

impl Neg for Lanes {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|value| -value)
    }
}

/// A vector of each face.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vectors(pub [Lanes; 3]);

impl Vectors {
    #[inline(always)]
    pub fn of(vectors: &[Vector3<f64>], places: &Places) -> Self {
        let [a, b, c, d] = *places;
        let [a, b, c, d] = [&vectors[a], &vectors[b], &vectors[c], &vectors[d]];
        Self([
            Lanes([a.x, b.x, c.x, d.x]),
            Lanes([a.y, b.y, c.y, d.y]),
            Lanes([a.z, b.z, c.z, d.z]),
        ])
    }

    /// That of one face.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> Vector3<f64> {
        let [x, y, z] = &self.0;
        Vector3::new(x.0[lane], y.0[lane], z.0[lane])
    }

    #[inline(always)]
    pub fn dot(self, other: Self) -> Lanes {
        let ([x, y, z], [u, v, w]) = (self.0, other.0);
        x * u + y * v + z * w
    }

    #[inline(always)]
    pub fn norm_squared(self) -> Lanes {
        self.dot(self)
    }

    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        let ([x, y, z], [u, v, w]) = (self.0, other.0);
        Self([y * w - z * v, z * u - x * w, x * v - y * u])
    }
}

impl Add for Vectors {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let ([x, y, z], [u, v, w]) = (self.0, other.0);
        Self([x + u, y + v, z + w])
    }
}

impl Sub for Vectors {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let ([x, y, z], [u, v, w]) = (self.0, other.0);
        Self([x - u, y - v, z - w])
    }
}

impl Mul<Lanes> for Vectors {
    type Output = Self;

    #[inline(always)]
    fn mul(self, scale: Lanes) -> Self {
        let [x, y, z] = self.0;
        Self([x * scale, y * scale, z * scale])
    }
}

/// A quaternion of each face.
#[derive(Debug, Clone, Copy)]
pub(super) struct Quaternions {
    pub w: Lanes,
    pub v: Vectors,
}

impl Quaternions {
    #[inline(always)]
    pub fn of(quaternions: &[Quaternion<f64>], places: &Places) -> Self {
        let [a, b, c, d] = *places;
        let [a, b, c, d] = [
            &quaternions[a],
            &quaternions[b],
            &quaternions[c],
            &quaternions[d],
        ];
        Self {
            w: Lanes([a.w, b.w, c.w, d.w]),
            v: Vectors([
                Lanes([a.i, b.i, c.i, d.i]),
                Lanes([a.j, b.j, c.j, d.j]),
                Lanes([a.k, b.k, c.k, d.k]),
            ]),
        }
    }

    #[inline(always)]
    pub fn dot(self, other: Self) -> Lanes {
        self.w * other.w + self.v.dot(other.v)
    }

    /// The product with the conjugate of another one.
    #[inline(always)]
    pub fn from(self, other: Self) -> Self {
        Self {
            w: self.dot(other),
            v: self.v * other.w - other.v * self.w - self.v.cross(other.v),
        }
    }

    /// As [`crate::posing::state::aligned`].
    #[inline(always)]
    pub fn aligned(self, other: Self) -> Self {
        let sign = self
            .dot(other)
            .map(|dot| if dot < 0.0 { -1.0 } else { 1.0 });
        self * sign
    }

    /// As [`crate::posing::state::normalized`].
    #[inline(always)]
    pub fn normalized(self) -> Self {
        let norm = self.dot(self).sqrt();
        let is_some = |norm: f64| norm > f64::MIN_POSITIVE;
        let scale = norm.map(|norm| if is_some(norm) { norm.recip() } else { 0.0 });
        let missing = norm.map(|norm| if is_some(norm) { 0.0 } else { 1.0 });
        let scaled = self * scale;
        Self {
            w: scaled.w + missing,
            v: scaled.v,
        }
    }

    /// As [`crate::posing::state::rotated`].
    #[inline(always)]
    pub fn rotated(self, arm: Vectors) -> Vectors {
        let once = self.v.cross(arm);
        let twice = once + once;
        arm + twice * self.w + self.v.cross(twice)
    }
}

impl Add for Quaternions {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            w: self.w + other.w,
            v: self.v + other.v,
        }
    }
}

impl Sub for Quaternions {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            w: self.w - other.w,
            v: self.v - other.v,
        }
    }
}

impl Mul<Lanes> for Quaternions {
    type Output = Self;

    #[inline(always)]
    fn mul(self, scale: Lanes) -> Self {
        Self {
            w: self.w * scale,
            v: self.v * scale,
        }
    }
}
