//! Conversion of the contents of a file to a mesh: used nodes, regions of physical volumes, sets of the other physical groups.

use super::contents::{
    Contents, Element, Group, HEXAHEDRON, TETRAHEDRON, UNGROUPED, VOLUMES, named,
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
        let (solid, others): (Vec<_>, Vec<_>) =
            self.elements.iter().partition(|e| e.dimension == 3);
        refuse!(if solid.is_empty(), at(self.line);
            found format!("no volume among {} elements", self.elements.len()),
            expected VOLUMES);
        let other = solid.iter().find(|element| element.kind != solid[0].kind);
        refuse!(if let Some(other) = other, at(other.line);
            found format!("{} beside {}", named(other.kind), named(solid[0].kind)),
            expected "elements of one kind: a mesh of hexahedra, or one of tetrahedra");
        let used: BTreeSet<u64> = solid.iter().flat_map(|e| &e.nodes).copied().collect();
        let index: BTreeMap<u64, usize> = used.iter().enumerate().map(|(i, &n)| (n, i)).collect();

        let (regions, region_names) = self.regions(&solid).map_err(|element| {
            let names: Vec<_> = element.groups.iter().map(|&g| self.name((3, g))).collect();
            let found = format!("element {} in {}", element.number, names.join(" and "));
            at(element.line).wrong(found, "each element in one physical volume")
        })?;
        let mut mesh = Mesh {
            nodes: used.iter().map(|node| self.nodes[node] * unit).collect(),
            regions,
            region_names,
            ..Mesh::default()
        };
        let mut middles = BTreeMap::new();
        match solid[0].kind {
            HEXAHEDRON => mesh.hexahedra = elements(&solid, &index),
            TETRAHEDRON => {
                mesh.tetrahedra = elements(&solid, &index);
                // VTK has the last two middles the other way round.
                mesh.tetrahedra
                    .iter_mut()
                    .for_each(|nodes| nodes.swap(8, 9));
            }
            _ => {
                let first = mesh.nodes.len();
                let edges = mesh.raise(&elements(&solid, &index)).into_iter();
                middles.extend(edges.zip(first..));
            }
        }
        mesh.sets = self
            .sets(&others, &index, &middles)
            .map_err(|(line, name)| {
                let found = format!("no node of a volume in the physical group {name:?}");
                at(line).wrong(found, "one node or more that is")
            })?;
        mesh.check_elements(|index| ElementName::File {
            file: file.to_owned(),
            line: solid[index].line,
            number: solid[index].number,
        })?;
        Ok(mesh)
    }

    /// Region of each volume and the names of regions by the numbers of their groups, or a volume in two of them.
    fn regions<'a>(&self, solid: &[&'a Element]) -> Result<(Vec<usize>, Vec<String>), &'a Element> {
        let mut names: Vec<String> = Vec::new();
        let groups: BTreeSet<u64> = solid.iter().flat_map(|e| &e.groups).copied().collect();
        let mut region_of = BTreeMap::new();
        for group in groups {
            let name = self.name((3, group));
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
