//! A membrane in the model: points of its triangles, and their stresses and fields.

use crate::element::{COORDINATES, Fields, SHEET_POINTS, SheetPoint, sheet_masses};
use crate::energy::{
    DielectricMembrane, ElasticMembrane, Elasticity, Energy, MaxwellMembrane, NeoHooke,
    ViscousMembrane,
};
use crate::functional::POINTS;
use crate::kinematics::MaterialVector;
use crate::math::{Derivatives, Local, Matrix, Vector};
use crate::model::layout::solid_block::SolidBlock;
use nalgebra::SVector;

/// Coordinates z₁, z₂ and a of the viscous strain at a point.
const SHEET_COORDINATES: usize = 3;

/// Forces ∂W/∂f of a formula on both tangents, which begin at an argument.
fn forces<F: Energy<M>, const M: usize>(law: &F, at: [f64; M]) -> [Vector; 2] {
    let local = law.at::<1>(&SVector::from(at), &SVector::zeros());
    let plain = local.plain::<1>();
    [plain.force(0), plain.force(1)]
}

/// σ = Σ P_α ⊗ f_α: across the membrane there is no stress.
fn stress(forces: [Vector; 2], [a, b]: &[Vector; 2]) -> Matrix {
    forces[0] * a.transpose() + forces[1] * b.transpose()
}

/// Tangents as arguments, before others.
fn arguments<const M: usize>([a, b]: &[Vector; 2], others: &[f64]) -> [f64; M] {
    let mut all = a.iter().chain(b.iter()).chain(others).copied();
    std::array::from_fn(|_| all.next().unwrap_or(0.0))
}

impl SheetPoint {
    /// The tangents as sums of material vectors of the nodes.
    pub(crate) fn sums<'v>(
        &self,
        node: impl Fn(usize) -> &'v MaterialVector,
    ) -> [MaterialVector; 2] {
        [0, 1].map(|direction| {
            let mut sum = MaterialVector::default();
            for (i, gradient) in self.gradients.iter().enumerate() {
                sum = MaterialVector::combine(1.0, &sum, gradient[direction], node(i));
            }
            sum
        })
    }
}

impl SolidBlock {
    /// Points of an element, and coordinates of the viscous strain of a branch there.
    pub(crate) fn strains(&self) -> [usize; 2] {
        match self.sheets.is_empty() {
            true => [POINTS, COORDINATES],
            false => [SHEET_POINTS, SHEET_COORDINATES],
        }
    }

    /// Thickness of a membrane without stress in mm.
    pub(crate) fn thickness(&self) -> f64 {
        self.solid.thickness.unwrap_or(f64::NAN)
    }

    /// Mean over the points of a triangle.
    fn mean(&self, element: usize, of: impl Fn(&SheetPoint) -> Matrix) -> Matrix {
        let points = &self.sheets[element];
        let area: f64 = points.iter().map(|point| point.area).sum();
        points.iter().map(|p| of(p) * (p.area / area)).sum()
    }

    /// Integrals of products of shape functions over the volume of a triangle of a membrane in mm³.
    pub(crate) fn sheet_masses(&self, element: usize) -> [[f64; 6]; 6] {
        let masses = sheet_masses(&self.unstretched(element));
        masses.map(|row| row.map(|mass| mass * self.thickness()))
    }

    /// Elastic stress of a unit of volume.
    fn sheet_elasticity(&self, element: usize, tangents: &[Vector; 2]) -> [Vector; 2] {
        fn of<L: Elasticity>(law: L, shear_modulus: f64, tangents: &[Vector; 2]) -> [Vector; 2] {
            let volume = 1.0;
            let cell = ElasticMembrane {
                volume,
                shear_modulus,
                law,
            };
            forces::<_, 6>(&cell, arguments(tangents, &[]))
        }
        let material = self.material(element);
        match material.law {
            None => of(NeoHooke, material.shear_modulus, tangents),
            Some(law) => of(law, material.shear_modulus, tangents),
        }
    }

    /// The electric energy of a volume of a membrane with electric constants.
    fn sheet_field(&self, element: usize, volume: f64) -> DielectricMembrane {
        let electric = self.material(element).electric;
        let electric = electric.expect("a dielectric element has electric constants");
        DielectricMembrane {
            volume,
            c1: electric.c1,
            c2: electric.c2,
            permittivity: electric.permittivity,
            thickness: self.thickness(),
        }
    }

    /// Voltage across a triangle.
    fn voltage_across(&self, element: usize, potentials: &[f64]) -> f64 {
        match self.is_dielectric[element] {
            true => potentials[self.solid.mesh.element(element)[0]],
            false => 0.0,
        }
    }

    /// Charge −∂W/∂V in mC of a triangle with a field.
    pub(crate) fn sheet_charge(
        &self,
        element: usize,
        places: &[Vector],
        potentials: &[f64],
    ) -> f64 {
        let (x, voltage) = (
            self.of_nodes(element, places),
            self.voltage_across(element, potentials),
        );
        let charge = |point: &SheetPoint| {
            let law = self.sheet_field(element, point.area * self.thickness());
            let at = arguments::<7>(&point.tangents(&x), &[voltage]);
            -law.at::<1>(&SVector::from(at), &SVector::zeros()).gradient[6]
        };
        self.sheets[element].iter().map(charge).sum()
    }

    /// Fields of a triangle of a membrane without its viscosity.
    pub(crate) fn sheet_fields(
        &self,
        element: usize,
        places: &[Vector],
        potentials: &[f64],
    ) -> Fields {
        let x = self.of_nodes(element, places);
        let field = self.voltage_across(element, potentials) / self.thickness();
        // The deformation gradient, whose third column is n λ₃.
        let gradient = |point: &SheetPoint| {
            let [a, b] = point.tangents(&x);
            let normal = a.cross(&b);
            let [e1, e2, n] = point.frame.map(|axis| axis.transpose());
            a * e1 + b * e2 + normal / normal.norm_squared() * n
        };
        let total = |point: &SheetPoint| {
            let tangents = point.tangents(&x);
            let mut sum = stress(self.sheet_elasticity(element, &tangents), &tangents);
            if self.is_dielectric[element] {
                let law = self.sheet_field(element, 1.0);
                let at = arguments::<7>(&tangents, &[field * self.thickness()]);
                sum += stress(forces(&law, at), &tangents);
            }
            sum
        };
        let mean_gradient = self.mean(element, gradient);
        let mean = |of: &dyn Fn(&SheetPoint) -> Vector| {
            self.mean(element, |p| {
                Matrix::from_columns(&[of(p), Vector::zeros(), Vector::zeros()])
            })
            .column(0)
            .into_owned()
        };
        let area = |point: &SheetPoint| {
            let [a, b] = point.tangents(&x);
            a.cross(&b)
        };
        let charge = |point: &SheetPoint| {
            if !self.is_dielectric[element] {
                return Vector::zeros();
            }
            let law = self.sheet_field(element, 1.0);
            let at = arguments::<7>(&point.tangents(&x), &[field * self.thickness()]);
            let density = law.at::<1>(&SVector::from(at), &SVector::zeros()).gradient[6];
            let area = area(point);
            area * (-density * self.thickness() / area.norm_squared())
        };
        Fields {
            deformation_gradient: mean_gradient,
            jacobian_determinant: 1.0,
            stress: self.mean(element, total),
            reference_electric_field: mean(&|point| point.frame[2] * field),
            electric_field: mean(&|point| area(point) * field),
            electric_displacement: mean(&charge),
        }
    }

    /// Mean viscous stress in MPa of a triangle of a membrane.
    pub(crate) fn sheet_viscous_stress(
        &self,
        element: usize,
        [places, velocities]: [&[Vector]; 2],
        coefficient: f64,
    ) -> Matrix {
        let [x, v] = [places, velocities].map(|of| self.of_nodes(element, of));
        self.mean(element, |point| {
            let (tangents, rates) = (point.tangents(&x), point.tangents(&v));
            let all = [[Vector::zeros(); 2], tangents, rates].concat();
            let mut all = all.iter().flat_map(|vector| vector.iter().copied());
            let at: [f64; 18] = std::array::from_fn(|_| all.next().unwrap_or(0.0));
            stress(
                forces(&ViscousMembrane { coefficient }, at).map(|force| -force),
                &tangents,
            )
        })
    }

    /// Stress in MPa of the spring of a Maxwell branch at a point of a triangle, with z₁, z₂ and a of the viscous strain, times the part of
    /// the point in the triangle.
    pub(crate) fn sheet_branch_stress(
        &self,
        element: usize,
        point: usize,
        x: &[Vector],
        shear_modulus: f64,
        [z1, z2, a]: [f64; 3],
    ) -> Matrix {
        let points = &self.sheets[element];
        let area: f64 = points.iter().map(|point| point.area).sum();
        let point = &points[point];
        let tangents = point.tangents(&self.nodes(element).map(|v: usize| x[v]));
        let volume = point.area / area;
        let law = MaxwellMembrane {
            volume,
            shear_modulus,
        };
        let at = arguments::<12>(&tangents, &[z1, z2, 0.0, a, 0.0, 0.0]);
        stress(forces(&law, at), &tangents)
    }
}
