//! A membrane in the model: points of its triangles, and their stresses and fields.

use crate::element::{COORDINATES, Fields, SHEET_POINTS, SheetPoint, sheet_masses};
use crate::energy::{
    DielectricMembrane, ElasticMembrane, Elasticity, Energy, MaxwellMembrane, NeoHooke,
    ViscousMembrane,
};
use crate::functional::POINTS;
use crate::kinematics::MaterialVector;
use crate::math::{Derivatives, Jet, Local, Matrix, Vector};
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

/// The electric energy and its gradient under a voltage.
fn electric(law: &DielectricMembrane, tangents: &[Vector; 2], voltage: f64) -> Jet<7, 1> {
    let at = arguments::<7>(tangents, &[voltage]);
    law.at::<1>(&SVector::from(at), &SVector::zeros())
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
        match self.solid.is_membrane() {
            false => [POINTS, COORDINATES],
            true => [SHEET_POINTS, SHEET_COORDINATES],
        }
    }

    /// Thickness of a membrane without stress in mm.
    pub(crate) fn thickness(&self) -> f64 {
        self.solid.thickness.unwrap_or(f64::NAN)
    }

    /// Parts of the points in the area of a triangle.
    fn parts(&self, element: usize) -> impl Iterator<Item = (&SheetPoint, f64)> {
        let points = &self.sheets[element];
        let area: f64 = points.iter().map(|point| point.area).sum();
        points.iter().map(move |point| (point, point.area / area))
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
            -electric(&law, &point.tangents(&x), voltage).gradient[6]
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
        let (thickness, voltage) = (self.thickness(), self.voltage_across(element, potentials));
        let field = voltage / thickness;
        let mut fields = Fields {
            deformation_gradient: Matrix::zeros(),
            jacobian_determinant: 1.0,
            stress: Matrix::zeros(),
            reference_electric_field: Vector::zeros(),
            electric_field: Vector::zeros(),
            electric_displacement: Vector::zeros(),
        };
        for (point, part) in self.parts(element) {
            let tangents = point.tangents(&x);
            let [a, b] = tangents;
            let area = a.cross(&b);
            let [e1, e2, normal] = point.frame;
            // The third column is n λ₃.
            let across = area / area.norm_squared();
            let gradient = a * e1.transpose() + b * e2.transpose() + across * normal.transpose();
            fields.deformation_gradient += gradient * part;
            fields.stress += stress(self.sheet_elasticity(element, &tangents), &tangents) * part;
            if self.is_dielectric[element] {
                let local = electric(&self.sheet_field(element, 1.0), &tangents, voltage);
                let forces = [0, 1].map(|i| Vector::from_fn(|m, _| local.gradient[3 * i + m]));
                fields.stress += stress(forces, &tangents) * part;
                fields.electric_displacement += across * (-local.gradient[6] * thickness * part);
            }
            fields.reference_electric_field += normal * (field * part);
            fields.electric_field += area * (field * part);
        }
        fields
    }

    /// Mean viscous stress in MPa of a triangle of a membrane.
    pub(crate) fn sheet_viscous_stress(
        &self,
        element: usize,
        [places, velocities]: [&[Vector]; 2],
        coefficient: f64,
    ) -> Matrix {
        let [x, v] = [places, velocities].map(|of| self.of_nodes(element, of));
        let stress_at = |point: &SheetPoint| {
            let (tangents, rates) = (point.tangents(&x), point.tangents(&v));
            let all = [[Vector::zeros(); 2], tangents, rates].concat();
            let mut all = all.iter().flat_map(|vector| vector.iter().copied());
            let at: [f64; 18] = std::array::from_fn(|_| all.next().unwrap_or(0.0));
            let forces = forces(&ViscousMembrane { coefficient }, at);
            stress(forces.map(|force| -force), &tangents)
        };
        let parts = self.parts(element);
        parts.map(|(point, part)| stress_at(point) * part).sum()
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
        let mut parts = self.parts(element);
        let (point, volume) = parts.nth(point).expect("a point of a triangle");
        let tangents = point.tangents(&self.nodes(element).map(|v: usize| x[v]));
        let law = MaxwellMembrane {
            volume,
            shear_modulus,
        };
        let at = arguments::<12>(&tangents, &[z1, z2, 0.0, a, 0.0, 0.0]);
        stress(forces(&law, at), &tangents)
    }
}
