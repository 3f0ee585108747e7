//! An elastic block or a membrane in the model: vectors and potentials of its nodes, laws of its elements, charges of its electrodes.

use crate::element::{
    Dielectric, Elastomer, ElementEnergy, ElementGeometry, Fields, Inverted, IsochoricLaw, Local,
    NodeState, Passive, SHEET_POINTS, SheetPoint, Viscosity, Volume,
};
use crate::energy::NeoHooke;
use crate::functional::ScalarArg;
use crate::math::{Matrix, Vector};
use crate::mesh::cell::Cell;
use crate::mesh::interpolation::{Element, Parent};
use crate::model::constants::constant::{Constant, MaterialConstant};
use crate::model::system::{Electrode, Material, Potential, Solid};
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
    /// Geometry of each element of a block.
    pub shapes: Vec<Shape>,
    /// Points of each triangle of a membrane.
    pub sheets: Vec<[SheetPoint; SHEET_POINTS]>,
    /// For each element, true if a field reaches it.
    pub is_dielectric: Vec<bool>,
    /// True if all nodes rest on the ground, and there is no field.
    pub is_immobile: bool,
}

/// Geometry of an element by its kind.
#[derive(Clone, Debug)]
pub enum Shape {
    /// Of a hexahedron.
    Hexahedron(Arc<ElementGeometry<8>>),
    /// Of a tetrahedron.
    Tetrahedron(Arc<ElementGeometry<10>>),
}

/// Does the same with the geometry of an element of any kind, and with arrays of as many nodes.
macro_rules! of_shape {
    ($of:expr, $shape:ident => $does:expr) => {
        match $of {
            crate::model::layout::solid_block::Shape::Hexahedron($shape) => $does,
            crate::model::layout::solid_block::Shape::Tetrahedron($shape) => $does,
        }
    };
}
pub(crate) use of_shape;

impl Shape {
    /// The element with these nodes, of places in mm.
    ///
    /// # Errors
    /// It is inverted at a Gauss point.
    pub(crate) fn new(nodes: &[usize], place: impl Fn(usize) -> Vector) -> Result<Self, Inverted> {
        Ok(match Cell::of(nodes) {
            Cell::Hexahedron => Self::Hexahedron(geometry(nodes, place)?),
            Cell::Tetrahedron => Self::Tetrahedron(geometry(nodes, place)?),
            Cell::Triangle => unreachable!("a membrane has points"),
        })
    }

    /// Weights of the Gauss points in mm³.
    pub fn weights(&self) -> &[f64; 8] {
        of_shape!(self, shape => shape.weights())
    }
}

fn geometry<const NODES: usize>(
    nodes: &[usize],
    place: impl Fn(usize) -> Vector,
) -> Result<Arc<ElementGeometry<NODES>>, Inverted>
where
    Parent<NODES>: Element<NODES>,
{
    let places = std::array::from_fn(|i| place(nodes[i]));
    ElementGeometry::new(&places).map(Arc::new)
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
    pub fn nodes<const NODES: usize>(&self, element: usize) -> [usize; NODES] {
        self.of_nodes(element, &self.vectors)
    }

    /// Entries of a list by node, of the nodes of an element.
    pub(super) fn of_nodes<T: Copy, const NODES: usize>(
        &self,
        element: usize,
        of: &[T],
    ) -> [T; NODES] {
        let nodes = self.solid.mesh.element(element);
        std::array::from_fn(|i| of[nodes[i]])
    }

    /// Places in mm of the nodes of an element without stress.
    pub(crate) fn unstretched<const NODES: usize>(&self, element: usize) -> [Vector; NODES] {
        let nodes = self.solid.mesh.element(element);
        std::array::from_fn(|i| self.solid.unstretched(nodes[i]))
    }

    /// Integrals ∫ N_i dV of the shape functions of an element in mm³.
    fn loads(&self, element: usize) -> Vec<f64> {
        fn of<const NODES: usize>(
            of: &SolidBlock,
            element: usize,
            _: &ElementGeometry<NODES>,
        ) -> Vec<f64>
        where
            Parent<NODES>: Element<NODES>,
        {
            ElementGeometry::loads(&of.unstretched::<NODES>(element)).to_vec()
        }
        if self.solid.is_membrane() {
            return self
                .sheet_masses(element)
                .map(|row| row.iter().sum())
                .to_vec();
        }
        of_shape!(&self.shapes[element], shape => of(self, element, shape))
    }

    /// The integral of the shape function of each node in mm³ times a density of the element, over elements that have one.
    pub(crate) fn integrals(&self, density: impl Fn(usize) -> Option<f64>) -> BTreeMap<usize, f64> {
        let mut sums = BTreeMap::new();
        for (e, nodes) in self.solid.mesh.elements().enumerate() {
            let Some(density) = density(e) else {
                continue;
            };
            for (&node, part) in nodes.iter().zip(self.loads(e)) {
                *sums.entry(node).or_default() += density * part;
            }
        }
        sums
    }

    /// Gradients of the shape functions at the centre of an element; `None` where it is inverted there.
    pub(crate) fn central_gradients<const NODES: usize>(
        &self,
        element: usize,
    ) -> Option<[Vector; NODES]>
    where
        Parent<NODES>: Element<NODES>,
    {
        ElementGeometry::central_gradients(&self.unstretched(element))
    }

    /// Deformation gradient at a Gauss point of an element at vectors x; of a membrane along its directions and its normal.
    pub(crate) fn deformation(&self, element: usize, point: usize, x: &[Vector]) -> Matrix {
        if let Some(points) = self.sheets.get(element) {
            let nodes = self.nodes(element).map(|v: usize| x[v]);
            let [a, b] = points[point].tangents(&nodes);
            let across = a.cross(&b);
            return Matrix::from_columns(&[a, b, across / across.norm_squared()]);
        }
        of_shape!(&self.shapes[element], shape => {
            shape.gradient_of(&self.nodes(element).map(|v| x[v]), point)
        })
    }

    /// Terminals of the nodes of a dielectric element.
    pub fn terminals<const NODES: usize>(&self, element: usize) -> [ScalarArg; NODES] {
        let terminals = self.of_nodes(element, &self.terminals);
        terminals.map(|terminal| terminal.expect("a dielectric element has potentials"))
    }

    /// The law of elasticity of an element other than the neo-Hookean one.
    pub fn isochoric(&self, element: usize) -> Option<IsochoricLaw> {
        IsochoricLaw::new(self.material(element).law?)
    }

    /// Geometry of an element whose deformation gradient is one in the reference configuration.
    ///
    /// # Panics
    /// It is inverted there; an element of a checked block is not.
    pub(crate) fn reference_shape(&self, element: usize) -> Shape {
        let mesh = &self.solid.mesh;
        let shape = Shape::new(mesh.element(element), |node| mesh.nodes[node]);
        shape.expect("stretches of a prestretch are positive")
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
            volume: match self.solid.element.has_mean_dilatation() {
                false => Volume::Pointwise,
                true => Volume::Mean,
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
        if self.solid.is_membrane() {
            return self.sheet_fields(element, places, potentials);
        }
        of_shape!(&self.shapes[element], shape => {
            let x = self.of_nodes(element, places);
            let isochoric = self.isochoric(element);
            if self.is_dielectric[element] {
                let phi = self.of_nodes(element, potentials);
                let law = self.dielectric(element);
                match isochoric {
                    None => law.fields(shape, &x, &phi),
                    Some(isochoric) => law.by(isochoric).fields(shape, &x, &phi),
                }
            } else {
                let law = self.passive(element);
                match isochoric {
                    None => law.fields(shape, &x, &()),
                    Some(isochoric) => law.by(isochoric).fields(shape, &x, &()),
                }
            }
        })
    }

    /// Mean viscous stress in MPa of an element with the nodes at `places` in mm at `velocities` in mm/ms, where its material is viscous.
    pub fn viscous_stress(
        &self,
        element: usize,
        places: &[Vector],
        velocities: &[Vector],
    ) -> Option<Matrix> {
        let law = Viscosity {
            viscosity: self.material(element).viscosity?,
        };
        if self.solid.is_membrane() {
            return Some(self.sheet_viscous_stress(element, [places, velocities], law.viscosity));
        }
        Some(of_shape!(&self.shapes[element], shape => {
            let [x, v] = [places, velocities].map(|of| self.of_nodes(element, of));
            law.stress(shape, &x, &v)
        }))
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
        for (e, nodes) in self.solid.mesh.elements().enumerate() {
            if self.is_dielectric[e] && self.solid.is_membrane() {
                // All nodes are on one electrode.
                charges[nodes[0]] += self.sheet_charge(e, &places, &potentials);
            } else if self.is_dielectric[e] {
                let law = self.dielectric(e);
                of_shape!(&self.shapes[e], shape => {
                    let (at, phi) = (self.of_nodes(e, &places), self.of_nodes(e, &potentials));
                    let mut local = Local::default();
                    law.gradient(&NodeState::new(shape, &at, &phi), &mut local);
                    for (&node, charge) in nodes.iter().zip(&local.electric.charges) {
                        charges[node] -= charge;
                    }
                });
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
