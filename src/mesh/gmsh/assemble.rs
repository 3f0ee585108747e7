//! Conversion of the contents of a file to a mesh: used nodes, regions of physical volumes, sets of the other physical groups.

use super::contents::{Contents, Element, Group, UNGROUPED};
use crate::math::refuse;
use crate::mesh::Mesh;
use crate::mesh::error::{ElementName, MeshError, MeshPlace};
use std::collections::{BTreeMap, BTreeSet};

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
            found format!("no hexahedron among {} elements", self.elements.len()),
            expected "8-node hexahedra (type 5)");
        let used: BTreeSet<u64> = solid.iter().flat_map(|e| &e.nodes).copied().collect();
        let index: BTreeMap<u64, usize> = used.iter().enumerate().map(|(i, &n)| (n, i)).collect();

        let (regions, region_names) = self.regions(&solid).map_err(|element| {
            let names: Vec<_> = element.groups.iter().map(|&g| self.name((3, g))).collect();
            let found = format!("element {} in {}", element.number, names.join(" and "));
            at(element.line).wrong(found, "each hexahedron in one physical volume")
        })?;
        let sets = self.sets(&others, &index).map_err(|(line, name)| {
            let found = format!("no node of a hexahedron in the physical group {name:?}");
            at(line).wrong(found, "one node or more that is")
        })?;
        let corner = |element: &Element, i: usize| index[&element.nodes[i]];
        let hexahedra = solid
            .iter()
            .map(|element| std::array::from_fn(|i| corner(element, i)));
        let mesh = Mesh {
            nodes: used.iter().map(|node| self.nodes[node] * unit).collect(),
            hexahedra: hexahedra.collect(),
            regions,
            region_names,
            sets,
        };
        mesh.check_elements(|index| ElementName::File {
            file: file.to_owned(),
            line: solid[index].line,
            number: solid[index].number,
        })?;
        Ok(mesh)
    }

    /// Region of each hexahedron and the names of regions by the numbers of their groups, or a hexahedron in two of them.
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

    /// Nodes of hexahedra in each physical group of a lower dimension, or the line and the name of a group without any.
    fn sets(
        &self,
        others: &[&Element],
        index: &BTreeMap<u64, usize>,
    ) -> Result<BTreeMap<String, Vec<usize>>, (usize, String)> {
        let mut sets: BTreeMap<String, (usize, BTreeSet<usize>)> = BTreeMap::new();
        for element in others {
            for &group in &element.groups {
                let name = self.name((element.dimension, group));
                let (_, nodes) = sets.entry(name).or_insert((element.line, BTreeSet::new()));
                nodes.extend(element.nodes.iter().filter_map(|node| index.get(node)));
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
