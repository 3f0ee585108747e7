//! Conversion of the contents of a file to a mesh: used nodes, regions of physical volumes, sets of the other physical groups. Where there is no
//! volume, surfaces are a membrane of triangles, whose regions are sets too.

use super::contents::{
    Contents, Element, Group, HEXAHEDRON, LINEAR_TRIANGLE, QUADRANGLE, QUADRATIC_QUADRANGLE,
    TETRAHEDRON, TRIANGLE, UNGROUPED, VOLUMES, named,
};
use crate::math::refuse;
use crate::mesh::Mesh;
use crate::mesh::error::{ElementName, MeshError, MeshPlace};
use std::collections::{BTreeMap, BTreeSet};

/// Nodes of elements with so many each.
fn elements<const NODES: usize>(
    solid: &[&Element],
    index: &BTreeMap<u64, usize>,
) -> Vec<[usize; NODES]> {
    let nodes = |element: &&Element| std::array::from_fn(|i| index[&element.nodes[i]]);
    solid.iter().map(nodes).collect()
}

/// Elements that go together: triangles of either kind are made of quadrangles too.
fn family(element: &Element) -> usize {
    match element.kind {
        QUADRANGLE => LINEAR_TRIANGLE,
        QUADRATIC_QUADRANGLE => TRIANGLE,
        kind => kind,
    }
}

/// Places among the nodes of a surface element of those of the triangles that it consists of; any other is one part.
fn triangles(element: &Element) -> &'static [&'static [usize]] {
    match element.kind {
        QUADRANGLE => &[&[0, 1, 2], &[0, 2, 3]],
        QUADRATIC_QUADRANGLE => &[&[0, 1, 2, 4, 5, 8], &[0, 2, 3, 8, 6, 7]],
        _ => &[&[0, 1, 2, 3, 4, 5]],
    }
}

/// Nodes of the triangles of surface elements.
fn in_triangles<const NODES: usize>(
    solid: &[&Element],
    index: &BTreeMap<u64, usize>,
) -> Vec<[usize; NODES]> {
    let mut all = Vec::new();
    for element in solid {
        let nodes = |places: &[usize]| std::array::from_fn(|i| index[&element.nodes[places[i]]]);
        all.extend(triangles(element).iter().map(|places| nodes(places)));
    }
    all
}

/// Elements with a node in the middle of each edge, from corners, and these nodes by the ends of their edges.
fn raised<const CORNERS: usize, const NODES: usize>(
    mesh: &mut Mesh,
    corners: &[[usize; CORNERS]],
) -> (Vec<[usize; NODES]>, BTreeMap<[usize; 2], usize>) {
    let first = mesh.nodes.len();
    let (elements, edges) = mesh.raise(corners);
    (elements, edges.into_iter().zip(first..).collect())
}

/// Adds the elements of one kind to a mesh that has their nodes; returns the middles of edges that were added by the ends of these.
fn add_elements(
    mesh: &mut Mesh,
    solid: &[&Element],
    index: &BTreeMap<u64, usize>,
) -> BTreeMap<[usize; 2], usize> {
    let mut middles = BTreeMap::new();
    match solid[0].kind {
        HEXAHEDRON => mesh.hexahedra = elements(solid, index),
        TETRAHEDRON => {
            mesh.tetrahedra = elements(solid, index);
            // VTK has the last two middles the other way round.
            mesh.tetrahedra
                .iter_mut()
                .for_each(|nodes| nodes.swap(8, 9));
        }
        TRIANGLE | QUADRATIC_QUADRANGLE => mesh.triangles = in_triangles(solid, index),
        LINEAR_TRIANGLE | QUADRANGLE => {
            (mesh.triangles, middles) = raised::<3, 6>(mesh, &in_triangles(solid, index));
        }
        _ => (mesh.tetrahedra, middles) = raised::<4, 10>(mesh, &elements(solid, index)),
    }
    middles
}

impl Contents {
    pub(super) fn assemble(mut self, file: &str, unit: f64) -> Result<Mesh, MeshError> {
        let at = |line: usize| MeshPlace::Line(file.to_owned(), line);
        self.elements.sort_by_key(|element| element.number);
        for element in &self.elements {
            let unknown = element.nodes.iter().find(|n| !self.nodes.contains_key(n));
            refuse!(if let Some(node) = unknown, at(element.line);
                found format!("node {node} in element {}", element.number),
                expected "a node that $Nodes lists");
        }
        let dimension = self.elements.iter().map(|e| e.dimension).max();
        let is_solid = |element: &&Element| Some(element.dimension) == dimension;
        let (solid, mut others): (Vec<_>, Vec<_>) = self.elements.iter().partition(is_solid);
        refuse!(unless matches!(dimension, Some(2 | 3)), at(self.line);
            found format!("no volume and no surface among {} elements", self.elements.len()),
            expected VOLUMES);
        let other = solid.iter().find(|other| family(other) != family(solid[0]));
        refuse!(if let Some(other) = other, at(other.line);
            found format!("{} beside {}", named(other.kind), named(solid[0].kind)),
            expected "elements of one kind: a mesh of hexahedra, or one of tetrahedra");
        if dimension == Some(2) {
            others.extend(&solid);
        }
        // Once for each element that it becomes.
        let parts = solid
            .iter()
            .flat_map(|e| triangles(e).iter().map(move |_| *e));
        let parts: Vec<&Element> = parts.collect();
        let used: BTreeSet<u64> = solid.iter().flat_map(|e| &e.nodes).copied().collect();
        let index: BTreeMap<u64, usize> = used.iter().enumerate().map(|(i, &n)| (n, i)).collect();

        let (regions, region_names) = self.regions(&parts).map_err(|element| {
            let groups = element.groups.iter();
            let names: Vec<_> = groups.map(|&g| self.name((element.dimension, g))).collect();
            let found = format!("element {} in {}", element.number, names.join(" and "));
            let kind = if dimension == Some(3) {
                "volume"
            } else {
                "surface"
            };
            at(element.line).wrong(found, format!("each element in one physical {kind}"))
        })?;
        let mut mesh = Mesh {
            nodes: used.iter().map(|node| self.nodes[node] * unit).collect(),
            regions,
            region_names,
            ..Mesh::default()
        };
        let middles = add_elements(&mut mesh, &solid, &index);
        mesh.sets = self
            .sets(&others, &index, &middles)
            .map_err(|(line, name)| {
                let found =
                    format!("no node of an element of the mesh in the physical group {name:?}");
                at(line).wrong(found, "one node or more that is")
            })?;
        mesh.check_elements(|index| ElementName::File {
            file: file.to_owned(),
            line: parts[index].line,
            number: parts[index].number,
        })?;
        Ok(mesh)
    }

    /// Region of each volume and the names of regions by the numbers of their groups, or a volume in two of them.
    fn regions<'a>(&self, solid: &[&'a Element]) -> Result<(Vec<usize>, Vec<String>), &'a Element> {
        let mut names: Vec<String> = Vec::new();
        let dimension = solid.first().map_or(3, |element| element.dimension);
        let groups: BTreeSet<u64> = solid.iter().flat_map(|e| &e.groups).copied().collect();
        let mut region_of = BTreeMap::new();
        for group in groups {
            let name = self.name((dimension, group));
            let known = names.iter().position(|n| *n == name);
            region_of.insert(
                group,
                known.unwrap_or_else(|| {
                    names.push(name);
                    names.len() - 1
                }),
            );
        }
        let ungrouped = names.len();
        if solid.iter().any(|element| element.groups.is_empty()) {
            names.push(UNGROUPED.to_owned());
        }
        let region = |element: &&'a Element| match element.groups[..] {
            [] => Ok(ungrouped),
            [group] => Ok(region_of[&group]),
            _ => Err(*element),
        };
        let regions = solid.iter().map(region).collect::<Result<_, _>>()?;
        Ok((regions, names))
    }

    /// Nodes of volumes in each physical group of a lower dimension, with the middles of edges by their ends, or the line and the name of a group
    /// without any.
    fn sets(
        &self,
        others: &[&Element],
        index: &BTreeMap<u64, usize>,
        middles: &BTreeMap<[usize; 2], usize>,
    ) -> Result<BTreeMap<String, Vec<usize>>, (usize, String)> {
        let mut sets: BTreeMap<String, (usize, BTreeSet<usize>)> = BTreeMap::new();
        for element in others {
            for &group in &element.groups {
                let name = self.name((element.dimension, group));
                let (_, nodes) = sets.entry(name).or_insert((element.line, BTreeSet::new()));
                let corners = element
                    .nodes
                    .iter()
                    .filter_map(|node| index.get(node).copied());
                let corners: Vec<usize> = corners.collect();
                let pairs = corners
                    .iter()
                    .flat_map(|&a| corners.iter().map(move |&b| [a, b]));
                nodes.extend(pairs.filter_map(|ends| middles.get(&ends)));
                nodes.extend(corners);
            }
        }
        let sets = sets.into_iter().map(|(name, (line, nodes))| {
            if nodes.is_empty() {
                return Err((line, name));
            }
            Ok((name, nodes.into_iter().collect()))
        });
        sets.collect()
    }

    /// Name of a physical group, `surface_7` where it has none.
    fn name(&self, group: Group) -> String {
        let kind = ["point", "curve", "surface", "volume"];
        let unnamed = || format!("{}_{}", kind[group.0.min(3)], group.1);
        self.names.get(&group).cloned().unwrap_or_else(unnamed)
    }
}
