//! Friction of a contact: Coulomb's law, regularised over a speed of slip.
//!
//! Its virtual work is `−μ f φ (u·δu)/√(|u|² + ε²)` of the normal force f φ and the slip u, the relative velocity of both surfaces along
//! them, where δu is the same expression of variations. With the spin `½ Σ d̄ × ḋ` of the directors d of a body, which the midpoint
//! rule makes (sin θ/h) times its axis, the slip is a polynomial of vectors. S is the sum of the spins, each times the radius of its body:
//!
//! - along a plane with the tangents t₁, t₂: u₁ = t₁·ṙ − S·t₂ and u₂ = t₂·ṙ + S·t₁;
//! - along a plane of a body, whose tangents and normal n turn: uₖ = ṫₖ·r + tₖ·ṙ + R ṅ·tₖ in place of tₖ·ṙ, R being the radius;
//! - between spheres: u = ṙ − S × r/(R₁ + R₂), of which the part across r counts. Both forces act at the point that divides the span r as the
//!   radii do, so that friction exerts no couple on a free pair.

use crate::energy::contact::{curved, vector, virtual_work};
use crate::energy::{ContactLaw, Energy, Surface, Touch};
use crate::math::{Derivatives, Jet, Local};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

/// Virtual work of the friction of a contact; arguments: variations of the span r, of t₁, t₂, n of a plane of a body, and of three directors of
/// each body that spins, then their midpoints, then their rates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactFriction {
    /// The normal force.
    pub law: ContactLaw,
    /// Tangents of a plane that does not turn; zero of other surfaces.
    pub tangents: [Vector3<f64>; 2],
    /// Radii in mm of the bodies that spin, in their order.
    pub radii: [f64; 2],
    /// Radius R in mm of the shape on a plane, or the sum of those of two spheres.
    pub size: f64,
    /// Coefficient μ.
    pub coefficient: f64,
    /// Speed ε in mm/ms.
    pub slip_speed: f64,
}

/// Scalars of which the work is a function: the three components of u, those of δu, then the form q, its rate and its variation.
const SCALARS: usize = 9;
/// Derivatives of these scalars by a vector.
type Row = SMatrix<f64, 3, SCALARS>;
/// Places of the tangents and the normal of a plane of a body.
const TANGENTS: [usize; 2] = [1, 2];
const NORMAL: usize = 3;

impl ContactFriction {
    /// Place of the first director of a body that spins.
    fn first(&self) -> usize {
        match self.law.surface {
            Surface::MovingPlane => 4,
            Surface::Plane(_) | Surface::Sphere => 1,
        }
    }

    /// Half of the radius of the body of a director; `None` for other vectors.
    fn half_radius(&self, v: usize) -> Option<f64> {
        let director = v.checked_sub(self.first())?;
        Some(0.5 * self.radii[director / 3])
    }

    /// The normal among the vectors, where it is one.
    fn normal(&self, x: &[Vector3<f64>]) -> Vector3<f64> {
        match self.law.surface {
            Surface::MovingPlane => x[NORMAL],
            Surface::Plane(_) | Surface::Sphere => Vector3::zeros(),
        }
    }

    /// S of rates or variations.
    fn spin(&self, x: &[Vector3<f64>], motion: &[Vector3<f64>]) -> Vector3<f64> {
        let directors = self.first()..x.len();
        let spins = directors.map(|v| {
            let half = self.half_radius(v).unwrap_or_default();
            x[v].cross(&motion[v]) * half
        });
        spins.sum()
    }

    /// Derivatives of u by S, column by column.
    fn lever(&self, x: &[Vector3<f64>]) -> Matrix3<f64> {
        let columns = |[first, second]: [Vector3<f64>; 2]| {
            Matrix3::from_columns(&[-second, first, Vector3::zeros()])
        };
        match self.law.surface {
            Surface::Plane(_) => columns(self.tangents),
            Surface::MovingPlane => columns(TANGENTS.map(|t| x[t])),
            Surface::Sphere => x[0].cross_matrix() / -self.size,
        }
    }

    /// Derivative by vector `v` of the lever times a vector of derivatives by u.
    fn lean(&self, v: usize, by_slip: &Vector3<f64>) -> Option<Matrix3<f64>> {
        match (self.law.surface, v) {
            (Surface::Sphere, 0) => Some(by_slip.cross_matrix() / self.size),
            (Surface::MovingPlane, 1) => Some(Matrix3::from_diagonal_element(by_slip[1])),
            (Surface::MovingPlane, 2) => Some(Matrix3::from_diagonal_element(-by_slip[0])),
            _ => None,
        }
    }

    /// Slip, or virtual slip, of rates or variations of the vectors.
    fn of_motion(&self, x: &[Vector3<f64>], motion: &[Vector3<f64>]) -> Vector3<f64> {
        let direct = match self.law.surface {
            Surface::Plane(_) => {
                let [u, v] = self.tangents.map(|t| t.dot(&motion[0]));
                Vector3::new(u, v, 0.0)
            }
            Surface::MovingPlane => {
                let [u, v] = TANGENTS.map(|t| {
                    let turned = motion[0] + motion[NORMAL] * self.size;
                    motion[t].dot(&x[0]) + x[t].dot(&turned)
                });
                Vector3::new(u, v, 0.0)
            }
            Surface::Sphere => motion[0],
        };
        direct + self.lever(x).tr_mul(&self.spin(x, motion))
    }

    /// Derivatives of the slip by the motion of a vector, column by column.
    fn by_motion(&self, v: usize, x: &[Vector3<f64>], lever: &Matrix3<f64>) -> Matrix3<f64> {
        if let Some(half) = self.half_radius(v) {
            return x[v].cross_matrix() * lever * -half;
        }
        let tangents = |[first, second]: [Vector3<f64>; 2], by: f64| {
            Matrix3::from_columns(&[first * by, second * by, Vector3::zeros()])
        };
        let mut columns = Matrix3::zeros();
        match (self.law.surface, v) {
            (Surface::Plane(_), _) => columns = tangents(self.tangents, 1.0),
            (Surface::MovingPlane, 0) => columns = tangents(TANGENTS.map(|t| x[t]), 1.0),
            (Surface::MovingPlane, NORMAL) => columns = tangents(TANGENTS.map(|t| x[t]), self.size),
            (Surface::MovingPlane, _) => columns.set_column(v - TANGENTS[0], &x[0]),
            (Surface::Sphere, _) => columns.fill_with_identity(),
        }
        columns
    }

    /// Derivatives of the slip of a motion by a vector, column by column.
    fn by_place(
        &self,
        v: usize,
        motion: &[Vector3<f64>],
        lever: &Matrix3<f64>,
        spin: &Vector3<f64>,
    ) -> Matrix3<f64> {
        if let Some(half) = self.half_radius(v) {
            return motion[v].cross_matrix() * lever * half;
        }
        let mut columns = match self.lean(v, &Vector3::x()) {
            None => Matrix3::zeros(),
            Some(_) => Matrix3::from_fn(|row, k| {
                let lean = self.lean(v, &Vector3::ith(k, 1.0)).unwrap_or_default();
                lean.column(row).dot(spin)
            }),
        };
        if self.law.surface == Surface::MovingPlane {
            for (k, t) in TANGENTS.into_iter().enumerate() {
                let direct = match v {
                    0 => motion[t],
                    _ if v == t => motion[0] + motion[NORMAL] * self.size,
                    _ => continue,
                };
                columns.set_column(k, &(columns.column(k) + direct));
            }
        }
        columns
    }

    /// Second derivatives by the motion of `v` and the place of `w` of the slip times derivatives by it.
    fn mixed(&self, v: usize, w: usize, x: &[Vector3<f64>], by: &BySlip) -> Matrix3<f64> {
        let BySlip { slip, spin } = by;
        if let Some(half) = self.half_radius(v) {
            return match self.lean(w, slip) {
                Some(lean) => x[v].cross_matrix() * lean * -half,
                None if v == w => spin.cross_matrix() * half,
                None => Matrix3::zeros(),
            };
        }
        let factor = match (self.law.surface, v, w) {
            (Surface::MovingPlane, 1 | 2, 0) => slip[v - TANGENTS[0]],
            (Surface::MovingPlane, 0, 1 | 2) => slip[w - TANGENTS[0]],
            (Surface::MovingPlane, NORMAL, 1 | 2) => slip[w - TANGENTS[0]] * self.size,
            _ => 0.0,
        };
        Matrix3::from_diagonal_element(factor)
    }

    /// Second derivatives by the places of `v` and `w` of the slip of a motion times derivatives by it.
    fn placed(&self, v: usize, w: usize, motion: &[Vector3<f64>], by: &BySlip) -> Matrix3<f64> {
        let of_director = |v: usize, w: usize| {
            let (half, lean) = (self.half_radius(v)?, self.lean(w, &by.slip)?);
            Some(motion[v].cross_matrix() * lean * half)
        };
        let turned = || of_director(w, v).map(|block| block.transpose());
        of_director(v, w).or_else(turned).unwrap_or_default()
    }

    /// Sizes of friction in N and slip in mm/ms at vectors and rates.
    pub fn of_rates(&self, x: &[Vector3<f64>], rates: &[Vector3<f64>]) -> [f64; 2] {
        let slip = self.of_motion(x, rates);
        let across = match self.law.surface {
            Surface::Plane(_) | Surface::MovingPlane => slip,
            Surface::Sphere => slip - x[0] * (x[0].dot(&slip) / x[0].norm_squared()),
        };
        let ends = [x, rates].map(|of| [of[0], self.normal(of)]);
        let Touch { force, .. } = self.law.touch(ends);
        let speed = across.norm();
        [
            self.coefficient * force * speed / speed.hypot(self.slip_speed),
            speed,
        ]
    }

    /// The work as a function of its scalars.
    fn work(&self, y: &SVector<f64, SCALARS>) -> Jet<SCALARS, 2> {
        let [a, b, c, va, vb, vc, q, alpha, beta] =
            std::array::from_fn(|i| Jet::<SCALARS, 2>::argument(i, y, &SVector::zeros()));
        let [_, force, growth] = self.law.force(&q, &alpha);
        if force.value == 0.0 {
            return Jet::constant(0.0);
        }
        let mut product = a * va + b * vb;
        let mut square = a.squared() + b.squared();
        if self.law.surface == Surface::Sphere {
            // Without the parts along the span, of which the square is 2 q.
            let along = alpha * q.scaled(2.0).recip();
            product = product + c * vc - along * beta;
            square = square + c.squared() - along * alpha;
        }
        let speed = square.shifted(self.slip_speed * self.slip_speed).sqrt();
        (force * growth * product * speed.recip()).scaled(-self.coefficient)
    }

    fn local<const N: usize, const M: usize>(&self, p: &SVector<f64, M>) -> FrictionLocal<N> {
        let read = |reading: usize| std::array::from_fn(|v| vector(p, reading * N + v));
        let [varied, at, rates]: [[Vector3<f64>; N]; 3] = [0, 1, 2].map(read);
        let surface = self.law.surface;
        let ends = |of: &[Vector3<f64>; N]| [of[0], self.normal(of)];
        let gradient = surface.gradient(ends(&at));
        let along = |of: &[Vector3<f64>; N]| {
            let [r, n] = ends(of);
            gradient[0].dot(&r) + gradient[1].dot(&n)
        };
        let slips = [&rates, &varied].map(|motion| self.of_motion(&at, motion));
        let mut y = SVector::<f64, SCALARS>::zeros();
        y.fixed_rows_mut::<3>(0).copy_from(&slips[0]);
        y.fixed_rows_mut::<3>(3).copy_from(&slips[1]);
        y[6] = surface.form(ends(&at));
        y[7] = along(&rates);
        y[8] = along(&varied);
        let work = self.work(&y);
        let lever = self.lever(&at);
        let spins = [&rates, &varied].map(|motion| self.spin(&at, motion));
        let bends = [&rates, &varied].map(|motion| surface.bend(ends(motion)));
        let mut rows = [[Row::zeros(); N]; 3];
        let motions = [&rates, &varied];
        let [of_variations, of_places, of_rates] = &mut rows;
        let each = of_variations.iter_mut().zip(of_places).zip(of_rates);
        for (v, ((varied, placed), moved)) in each.enumerate() {
            let by_motion = self.by_motion(v, &at, &lever);
            varied.fixed_columns_mut::<3>(3).copy_from(&by_motion);
            moved.fixed_columns_mut::<3>(0).copy_from(&by_motion);
            for (k, motion) in motions.into_iter().enumerate() {
                let by_place = self.by_place(v, motion, &lever, &spins[k]);
                placed.fixed_columns_mut::<3>(3 * k).copy_from(&by_place);
            }
            if let Some(place) = self.of_form(v) {
                varied.set_column(8, &gradient[place]);
                moved.set_column(7, &gradient[place]);
                placed.set_column(6, &gradient[place]);
                placed.set_column(7, &bends[0][place]);
                placed.set_column(8, &bends[1][place]);
            }
        }
        let by = [0, 1].map(|k| {
            let slip: Vector3<f64> = work.gradient.fixed_rows::<3>(3 * k).into();
            let spin = lever * slip;
            BySlip { slip, spin }
        });
        let weighted = rows.map(|of| of.map(|row| row * work.hessian));
        FrictionLocal {
            of: *self,
            work,
            rows,
            weighted,
            readings: [varied, at, rates],
            by,
        }
    }

    /// Place among r and n of a vector that the form of the contact reads.
    fn of_form(&self, v: usize) -> Option<usize> {
        match v {
            0 => Some(0),
            NORMAL if self.law.surface == Surface::MovingPlane => Some(1),
            _ => None,
        }
    }
}

/// Derivatives of the work by the slip or the virtual slip, and by S through it.
#[derive(Clone, Copy, Debug)]
struct BySlip {
    slip: Vector3<f64>,
    spin: Vector3<f64>,
}

/// Derivatives of the work of friction, block by block.
#[derive(Clone, Copy, Debug)]
pub struct FrictionLocal<const N: usize> {
    of: ContactFriction,
    work: Jet<SCALARS, 2>,
    /// Derivatives of the scalars by variations, midpoints and rates.
    rows: [[Row; N]; 3],
    /// The same times the second derivatives of the work.
    weighted: [[Row; N]; 3],
    /// Variations, midpoints and rates.
    readings: [[Vector3<f64>; N]; 3],
    /// Of slip and virtual slip.
    by: [BySlip; 2],
}

impl<const N: usize> FrictionLocal<N> {
    /// Second derivatives of the scalars by two arguments, times the derivatives of the work by them.
    fn curved(&self, [a, b]: [usize; 2], [v, w]: [usize; 2]) -> Matrix3<f64> {
        let [varied, at, rates] = &self.readings;
        let [by_slip, by_virtual] = &self.by;
        let mixed = |v, w, by| self.of.mixed(v, w, at, by);
        let of_slip = match (a, b) {
            (0, 1) => mixed(v, w, by_virtual),
            (1, 0) => mixed(w, v, by_virtual).transpose(),
            (2, 1) => mixed(v, w, by_slip),
            (1, 2) => mixed(w, v, by_slip).transpose(),
            (1, 1) => {
                self.of.placed(v, w, rates, by_slip) + self.of.placed(v, w, varied, by_virtual)
            }
            _ => Matrix3::zeros(),
        };
        let form = self.of.of_form(v).zip(self.of.of_form(w));
        let curvature = form.map_or(0.0, |(v, w)| self.of.law.surface.curvature(v, w));
        of_slip + Matrix3::from_diagonal_element(curvature * curved(a, b, &self.work.gradient))
    }
}

impl<const N: usize> Derivatives for FrictionLocal<N> {
    fn force(&self, i: usize) -> Vector3<f64> {
        self.rows[i / N][i % N] * self.work.gradient
    }

    fn block(&self, i: usize, j: usize) -> Matrix3<f64> {
        let (row, column) = (&self.weighted[i / N][i % N], &self.rows[j / N][j % N]);
        row * column.transpose() + self.curved([i / N, j / N], [i % N, j % N])
    }
}

virtual_work! { ContactFriction as FrictionLocal: 1 of 9, 4 of 36, 7 of 63 }
