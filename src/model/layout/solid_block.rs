//! An elastic block in the model: vectors and potentials of its nodes, laws of its elements, charges of its electrodes.

use crate::element::{
    Dielectric, Elastomer, ElementEnergy, ElementGeometry, Fields, IsochoricLaw, Local, NodeState,
    Passive, Volume,
};
use crate::energy::NeoHooke;
use crate::functional::ScalarArg;
use crate::math::{Matrix, Vector};
use crate::model::constants::constant::{Constant, MaterialConstant};
use crate::model::system::{Electrode, ElementKind, Material, Potential, Solid};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A block as the model sees it.
#[derive(Clone, Debug)]
pub struct SolidBlock {
    /// Block of the scene.
    pub solid: Solid,
    /// Vector of each node of the mesh.
    pub vectors: Vec<usize>,
    /// Terminal of each node of the mesh; `None` where there is no potential.
    pub terminals: Vec<Option<ScalarArg>>,
    /// Part of the scene that it is.
    pub owner: Owner,
    /// Geometry of each element.
    pub shapes: Vec<Arc<ElementGeometry>>,
    /// For each element, true if a field reaches it.
    pub is_dielectric: Vec<bool>,
    /// True if all nodes rest on the ground, and there is no field.
    pub is_immobile: bool,
}

/// Part of a scene that a block is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Owner {
    /// A block, by its index.
    Block(usize),
    /// A muscle, by its index, whose electrodes are one.
    Muscle(usize),
}

impl SolidBlock {
    /// Returns true if it is a muscle, whose electrodes are one.
    pub fn is_muscle(&self) -> bool {
        matches!(self.owner, Owner::Muscle(_))
    }

    /// A constant of the material of an element.
    pub(crate) fn constant(&self, element: usize, constant: MaterialConstant) -> Constant {
        match self.owner {
            Owner::Block(block) => constant.of_block(block, self.solid.mesh.regions[element]),
            Owner::Muscle(muscle) => constant.of_muscle(muscle),
        }
    }

    /// The material of an element.
    pub fn material(&self, element: usize) -> &Material {
        &self.solid.materials[self.solid.mesh.regions[element]]
    }

    /// Returns true if one of its materials has a density.
    pub(crate) fn is_heavy(&self) -> bool {
        self.solid.materials.iter().any(|m| m.density.is_some())
    }

    /// Vectors of the nodes of an element.
    pub fn nodes(&self, element: usize) -> [usize; 8] {
        self.solid.mesh.hexahedra[element].map(|node| self.vectors[node])
    }

    /// The integral of the shape function of each node in mm³ times a density of the element, over elements that have one.
    pub(crate) fn integrals(&self, density: impl Fn(usize) -> Option<f64>) -> BTreeMap<usize, f64> {
        let mut sums = BTreeMap::new();
        for (e, nodes) in self.solid.mesh.hexahedra.iter().enumerate() {
            let Some(density) = density(e) else {
                continue;
            };
            for (&node, part) in nodes.iter().zip(self.shapes[e].loads()) {
                *sums.entry(node).or_default() += density * part;
            }
        }
        sums
    }

    /// Gradients of the shape functions at the centre of an element; `None` where it is inverted there.
    pub(crate) fn central_gradients(&self, element: usize) -> Option<[Vector; 8]> {
        let nodes = self.solid.mesh.hexahedra[element];
        ElementGeometry::central_gradients(&nodes.map(|node| self.solid.unstretched(node)))
    }

    /// Deformation gradient at a Gauss point of an element at vectors x.
    pub(crate) fn deformation(&self, element: usize, point: usize, x: &[Vector]) -> Matrix {
        let nodes = self.nodes(element).map(|v| x[v]);
        self.shapes[element].gradient_of(&nodes, point)
    }

    /// Terminals of the nodes of a dielectric element.
    pub fn terminals(&self, element: usize) -> [ScalarArg; 8] {
        self.solid.mesh.hexahedra[element]
            .map(|node| self.terminals[node].expect("a dielectric element has potentials"))
    }

    /// The law of elasticity of an element other than the neo-Hookean one.
    pub fn isochoric(&self, element: usize) -> Option<IsochoricLaw> {
        IsochoricLaw::new(self.material(element).law?)
    }

    /// Geometry of an element whose deformation gradient is one in the reference configuration.
    ///
    /// # Panics
    /// It is inverted there; an element of a checked block is not.
    pub(crate) fn reference_shape(&self, element: usize) -> ElementGeometry {
        let nodes = self.solid.mesh.hexahedra[element].map(|n| self.solid.mesh.nodes[n]);
        ElementGeometry::new(&nodes).expect("stretches of a prestretch are positive")
    }

    /// The law of a branch without stress in the reference configuration: μ₁/2 (Ī₁ − 3) of a volume that is free of stress, on the
    /// [geometry](Self::reference_shape) there.
    pub(crate) fn unrelaxed(&self, shear_modulus: f64) -> Elastomer<Passive, IsochoricLaw> {
        let volume = self.solid.prestretch.map_or(1.0, |u| u.determinant());
        let shear_modulus = shear_modulus / volume;
        Elastomer {
            shear_modulus,
            lame_lambda: -2.0 / 3.0 * shear_modulus,
            volume: Volume::Pointwise,
            field: Passive,
            law: IsochoricLaw::Yeoh { c2: 0.0, c3: 0.0 },
        }
    }

    /// The neo-Hookean law of a passive element.
    pub fn passive(&self, element: usize) -> Elastomer<Passive> {
        let material = self.material(element);
        Elastomer {
            shear_modulus: material.shear_modulus,
            lame_lambda: material.lame_lambda.unwrap_or(0.0),
            volume: match self.solid.element {
                ElementKind::Hex8 => Volume::Pointwise,
                ElementKind::Hex8Q1P0 => Volume::Mean,
            },
            field: Passive,
            law: NeoHooke,
        }
    }

    /// The neo-Hookean law of a dielectric element.
    pub fn dielectric(&self, element: usize) -> Elastomer<Dielectric> {
        let electric = self.material(element).electric;
        let electric = electric.expect("a dielectric element has electric constants");
        self.passive(element).with(electric)
    }

    /// Vector of the node nearest to a place.
    pub(crate) fn nearest(&self, place: &Vector) -> usize {
        let node = self.solid.mesh.nearest_node(place);
        self.vectors[node.expect("a mesh has nodes")]
    }

    /// Places of the nodes at vectors x.
    pub fn places(&self, x: &[Vector]) -> Vec<Vector> {
        self.vectors.iter().map(|&v| x[v]).collect()
    }

    /// Fields of an element without its viscosity, with the nodes at `places` in mm under `potentials` in V.
    pub fn fields(&self, element: usize, places: &[Vector], potentials: &[f64]) -> Fields {
        let nodes = self.solid.mesh.hexahedra[element];
        let (shape, x) = (&self.shapes[element], nodes.map(|n| places[n]));
        if self.is_dielectric[element] {
            let phi = nodes.map(|n| potentials[n]);
            let law = self.dielectric(element);
            match self.isochoric(element) {
                None => law.fields(shape, &x, &phi),
                Some(isochoric) => law.by(isochoric).fields(shape, &x, &phi),
            }
        } else {
            let law = self.passive(element);
            match self.isochoric(element) {
                None => law.fields(shape, &x, &()),
                Some(isochoric) => law.by(isochoric).fields(shape, &x, &()),
            }
        }
    }

    /// Block and electrode of the electrodes that no voltage drives.
    pub fn immobile_electrodes(&self) -> impl Iterator<Item = (&str, &str)> + '_ {
        let all = self.solid.electrodes.iter().filter(|e| self.is_immobile(e));
        all.map(|e| (self.solid.name.as_str(), e.name.as_str()))
    }

    fn is_immobile(&self, electrode: &Electrode) -> bool {
        !self.is_muscle() && !matches!(electrode.potential, Potential::Driven { .. })
    }

    /// Charges −∂W/∂φ in mC of the electrodes that no voltage drives, with the nodes at vectors x.
    pub fn immobile_charges(&self, x: &[Vector], scalars: &[f64]) -> Vec<f64> {
        let electrodes = self.solid.electrodes.iter();
        let immobile: Vec<_> = electrodes.filter(|e| self.is_immobile(e)).collect();
        if immobile.is_empty() {
            return Vec::new();
        }
        let (places, potentials) = (self.places(x), self.potentials(scalars));
        let mut charges = vec![0.0; places.len()];
        let mut local = Local::default();
        for (e, nodes) in self.solid.mesh.hexahedra.iter().enumerate() {
            if self.is_dielectric[e] {
                let (at, phi) = (nodes.map(|n| places[n]), nodes.map(|n| potentials[n]));
                let law = self.dielectric(e);
                law.gradient(&NodeState::new(&self.shapes[e], &at, &phi), &mut local);
                for (&node, charge) in nodes.iter().zip(&local.electric.charges) {
                    charges[node] -= charge;
                }
            }
        }
        let sum = |e: &&Electrode| -> f64 { e.nodes.iter().map(|&n| charges[n]).sum() };
        immobile.iter().map(sum).collect()
    }

    /// Potentials of the nodes in V; zero where there is none.
    pub fn potentials(&self, scalars: &[f64]) -> Vec<f64> {
        let value = |t: &Option<ScalarArg>| {
            let ScalarArg { constant, scalar } = t.unwrap_or_default();
            constant + scalar.map_or(0.0, |(s, factor)| factor * scalars[s])
        };
        self.terminals.iter().map(value).collect()
    }
}
