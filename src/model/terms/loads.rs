//! Terms of loads: forces on points of bodies, on coordinates of joints and on nodes of blocks, charges on nodes.

use crate::energy::{Coefficient, DeadLoad, FollowingForce, GivenCharge, SurfaceCharge};
use crate::functional::{Element, PressureFace, areas};
use crate::math::Vector;
use crate::mesh::cell::Cell;
use crate::mesh::interpolation::{Interpolation, Parent};
use crate::model::components::muscle::{CHARGES as MUSCLE_CHARGES, constants};
use crate::model::components::{BlockLoad, Load, LoadPlace};
use crate::model::constants::free_parameters::{MovedPoints, Read};
use crate::model::construction::Construction;
use crate::model::layout::solid_block::SolidBlock;
use crate::model::presolve::presolved::Presolved;
use crate::model::system::Attachment;
use crate::model::terms::{Terms, mid};

/// Term of the loads whose forces have a potential.
pub(crate) const LOADS: &str = "loads";
const FOLLOWING: &str = "following loads";
const CHARGES: &str = "surface charges";

/// Returns true if a load acts on something that moves, or on potentials.
pub(crate) fn moves(load: &Load, presolved: &Presolved) -> bool {
    match load.on {
        LoadPlace::Point { at, .. } => presolved.carrier(at.body).is_some(),
        LoadPlace::Joint(joint) => presolved.joint(joint).is_some(),
        LoadPlace::Muscle(_) => true,
        LoadPlace::Block { block, .. } => !presolved.immobile.solids[block],
    }
}

/// Terms of the loads of a scene; their inputs are the last ones of `sources`.
pub(crate) fn build(of: &Construction<'_>, terms: &mut Terms<'_>) {
    let system = of.system;
    for (source, load) in system.loads() {
        let Some(size) = terms.input(source) else {
            terms.without(LOADS, "no load is ever other than 0 on what moves");
            continue;
        };
        let mut on = Loaded {
            name: &load.name,
            size,
            terms,
        };
        match &load.on {
            LoadPlace::Point {
                at,
                direction,
                follows,
            } => {
                let point = on.terms.point(at);
                let point = on.terms.vector(point);
                let read = on.moved(at);
                match follows {
                    false => on.pull(point, *direction, read),
                    true => {
                        let along = on.terms.direction(at, direction);
                        let along = on.terms.vector(along);
                        on.follow([point, along], read);
                    }
                }
            }
            LoadPlace::Joint(joint) => {
                let kept = of.presolved.joint(*joint);
                let coordinate = kept.and_then(|kept| of.internals.joint(kept));
                let coordinate = coordinate.expect("a loaded joint has its coordinate");
                let coordinate = on.terms.vector(coordinate);
                on.pull(coordinate, Vector::x(), Read::nothing());
            }
            LoadPlace::Muscle(muscle) => {
                charge_muscle(of, *muscle, on.terms);
            }
            LoadPlace::Block { block, load } => on.block(&of.blocks.list[*block], load),
        }
    }
}

/// Adds the energy of the charge that a load gives the electrodes of a muscle.
pub(in crate::model) fn charge_muscle(
    of: &Construction<'_>,
    muscle: usize,
    terms: &mut Terms<'_>,
) -> Option<()> {
    let mut loads = of.system.loads();
    let (source, load) = loads.find(|(_, load)| load.on == LoadPlace::Muscle(muscle))?;
    let charge = terms.input(source)?;
    let mut constants = constants(&of.system.muscles[muscle], muscle, terms);
    let capacitance = constants.capacitance()?;
    let (span, law) = (of.spans[muscle], GivenCharge { capacitance });
    let element = constants.element(law, [mid(span)], [charge]);
    terms.add_law(MUSCLE_CHARGES, "the charge of", &load.name, element);
    Some(())
}

/// A load whose terms are added.
struct Loaded<'l, 't> {
    name: &'l str,
    /// Scalar of its size.
    size: usize,
    terms: &'l mut Terms<'t>,
}

impl Loaded<'_, '_> {
    /// The parameters that move a point, whose place itself is given.
    fn moved(&mut self, at: &Attachment) -> Read {
        let mut read = self.terms.sought().read();
        let point = MovedPoints {
            parts: [1.0],
            bodies: [self.terms.carrier(at)],
            places: None,
        };
        read.moves(0, point, |vector| self.terms.vector(vector));
        read
    }

    /// A force w on a vector for a load of one.
    fn pull(&mut self, vector: usize, force: Vector, read: Read) {
        let force = force.map(Coefficient::from);
        let element = read.element(DeadLoad { force }, [mid(vector)], [self.size]);
        let why = "the force of";
        self.terms
            .add_law::<_, 4, 1, 1>(LOADS, why, self.name, element);
    }

    /// A force on a point along a direction of its body.
    fn follow(&mut self, [point, direction]: [usize; 2], read: Read) {
        let [point, direction] = [mid(point), mid(direction)];
        let vectors = [point, direction, point, direction];
        let element = read.element(FollowingForce, vectors, [self.size]);
        let why = "the force of";
        self.terms
            .add_law::<_, 13, 4, 1>(FOLLOWING, why, self.name, element);
    }

    /// A load of a block.
    fn block(&mut self, block: &SolidBlock, load: &BlockLoad) {
        let mesh = &block.solid.mesh;
        match load {
            BlockLoad::Traction(faces, direction) => {
                let areas = mesh.areas_of(faces);
                self.nodes(
                    block,
                    areas.into_iter().map(|(n, area)| (n, direction * area)),
                );
            }
            BlockLoad::Pressure {
                faces,
                follows: false,
            } => {
                let normals = mesh.normals_of(faces);
                self.nodes(block, normals.into_iter().map(|(n, normal)| (n, -normal)));
            }
            BlockLoad::Pressure {
                faces,
                follows: true,
            } => match mesh.cell() {
                Cell::Hexahedron => self.press::<4>(block, faces),
                Cell::Tetrahedron | Cell::Triangle => self.press::<6>(block, faces),
            },
            BlockLoad::Charge(faces) => {
                for (node, area) in mesh.areas_of(faces) {
                    self.charge(block, node, area);
                }
            }
            BlockLoad::BodyForce(direction) => {
                let volumes = block.integrals(|_| Some(1.0));
                self.nodes(
                    block,
                    volumes.into_iter().map(|(n, part)| (n, direction * part)),
                );
            }
        }
    }

    /// A pressure that follows faces with so many nodes each.
    fn press<const NODES: usize>(&mut self, block: &SolidBlock, faces: &[Vec<usize>])
    where
        Parent<NODES>: Interpolation<2, NODES>,
    {
        let areas = areas();
        for face in faces {
            let element = PressureFace::<NODES> {
                nodes: std::array::from_fn(|i| block.vectors[face[i]]),
                areas: areas.clone(),
                pressure: self.size,
            };
            let why = "the pressure of";
            self.terms.collect(FOLLOWING, why, self.name, element);
        }
    }

    /// Forces on nodes for a load of one.
    fn nodes(&mut self, block: &SolidBlock, forces: impl Iterator<Item = (usize, Vector)>) {
        for (node, force) in forces {
            let vector = block.vectors[node];
            if self.terms.moves(vector) {
                self.pull(vector, force, Read::nothing());
            }
        }
    }

    /// The charge on the area of a node; a source supplies that of a node at its voltage.
    fn charge(&mut self, block: &SolidBlock, node: usize, area: f64) {
        let Some((potential, unit)) = block.terminals[node].and_then(|terminal| terminal.scalar)
        else {
            return;
        };
        if !self.terms.is_unknown(potential) {
            return;
        }
        let element = Element {
            energy: SurfaceCharge {
                weight: area * unit,
            },
            vectors: [],
            scalars: [potential, self.size],
        };
        self.terms.add(CHARGES, "the charge of", self.name, element);
    }
}
