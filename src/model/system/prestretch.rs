//! Prestretch of blocks and of muscles of finite elements: the mesh is that of the stretched block, x = U X of the places X without
//! stress.
//!
//! Elements have their shape functions, volume and mass at X, and all else at x: the deformation gradient of the reference configuration
//! is U. A muscle is stretched along its span and free of stress across.

use crate::element::{
    Elastomer, ElementEnergy, ElementGeometry, ElementLaw, IsochoricLaw, Local, NodeState, Passive,
    Volume,
};
use crate::energy::{ElasticLaw, NeoHooke};
use crate::math::{Fault, Key, Vector, refuse};
use crate::mesh::grid::Grid;
use crate::model::system::{Material, Muscle, Solid};

/// Bisections of the interval of stretches across, after which its ends are neighbouring numbers.
const BISECTIONS: usize = 100;

/// Factor by which the stretch across may lie outside those between constant volume and constant shape.
const WIDER: f64 = 10.0;

impl Solid {
    /// Returns true if it is a membrane.
    pub fn is_membrane(&self) -> bool {
        self.thickness.is_some()
    }

    /// Place of a node in mm without stress.
    pub(crate) fn unstretched(&self, node: usize) -> Vector {
        let place = self.mesh.nodes[node];
        match self.prestretch {
            None => place,
            Some(stretch) => stretch
                .lu()
                .solve(&place)
                .expect("a checked stretch is positive"),
        }
    }

    /// Checks that the stretch is symmetric and positive, and that its materials have an energy there.
    pub(crate) fn check_prestretch(&self) -> Result<(), Fault> {
        let Some(stretch) = self.prestretch else {
            return Ok(());
        };
        let is_symmetric = stretch.iter().all(|s| s.is_finite()) && stretch == stretch.transpose();
        let is_positive = is_symmetric && stretch.cholesky().is_some();
        refuse!(unless is_positive, Key("prestretch");
            found format!("{:?}", stretch.as_slice()),
            expected "a symmetric stretch with positive values");
        let volume = stretch.determinant();
        let squares = stretch.norm_squared();
        let invariant = squares * volume.powf(-2.0 / 3.0) - 3.0;
        for law in self.materials.iter().filter_map(|material| material.law) {
            if let ElasticLaw::Gent { limit } = law {
                refuse!(unless invariant < limit, Key("prestretch");
                    found format!("a prestretch of I1 - 3 = {invariant:.4}"),
                    expected format!("less than Gent's limit, I1 - 3 < {limit}"));
            }
        }
        Ok(())
    }
}

impl Muscle {
    /// Stretches across and along the span of a prestretched muscle of finite elements, which is free of stress across.
    pub(crate) fn stretches(&self) -> Option<[f64; 2]> {
        let along = self.prestretch?;
        let material = &self.material;
        let across = match material.law.and_then(IsochoricLaw::new) {
            None => free_across(material, NeoHooke, along),
            Some(law) => free_across(material, law, along),
        };
        Some([across, along])
    }
}

/// Stretch across at which a material that is stretched along one axis is free of stress, by bisection.
fn free_across<L: ElementLaw>(material: &Material, law: L, along: f64) -> f64 {
    let elastomer = Elastomer {
        shear_modulus: material.shear_modulus,
        lame_lambda: material.lame_lambda.unwrap_or(0.0),
        volume: Volume::Pointwise,
        field: Passive,
        law,
    };
    let cube = Grid::uniform(Vector::zeros(), Vector::repeat(1.0), [1; 3]).mesh();
    let corners = cube.hexahedra[0].map(|node| cube.nodes[node]);
    let shape = ElementGeometry::new(&corners).expect("a cube is not inverted");
    let mut local = Local::default();
    // dW/dt of F = diag(t, t, λ). It is not finite beyond Gent's limit, which a change of the volume towards t = λ avoids.
    let mut is_below = |across: f64| {
        let stretch = Vector::new(across, across, along);
        let x = corners.map(|corner| corner.component_mul(&stretch));
        elastomer.gradient(&NodeState::new(&shape, &x, &()), &mut local);
        let pairs = corners.iter().zip(&local.forces);
        let slope: f64 = pairs
            .map(|(corner, force)| corner.xy().dot(&force.xy()))
            .sum();
        match slope.is_nan() {
            true => across < along,
            false => slope < 0.0,
        }
    };
    let incompressible = along.powf(-0.5);
    let (mut low, mut high) = (
        incompressible.min(along) / WIDER,
        incompressible.max(along) * WIDER,
    );
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        match is_below(middle) {
            true => low = middle,
            false => high = middle,
        }
    }
    0.5 * (low + high)
}
