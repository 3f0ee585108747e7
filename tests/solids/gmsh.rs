//! Meshes from Gmsh: both formats read equal, and files that are refused.

use crate::mesh::{block, file, parse, text, volume, volumes};
use proboscis::mesh::Mesh;
use proboscis::mesh::gmsh::{self, UNGROUPED};

/// The block as both files have it: sets and regions besides those of a box.
fn grouped_block() -> Mesh {
    let mut mesh = block();
    let left = mesh.sets["x_min"].clone();
    let right = mesh.sets["x_max"].clone();
    mesh.region_names = vec!["soft".to_owned(), "stiff layer".to_owned()];
    mesh.regions = [[0; 4], [1; 4]].concat();
    mesh.sets = [
        ("left", left),
        ("surface_7", right),
        ("edge", vec![0, 1, 2]),
        ("tip", vec![26]),
    ]
    .map(|(name, nodes)| (name.to_owned(), nodes))
    .into();
    mesh
}

#[test]
fn both_formats_read_equal_to_the_grid() {
    for name in ["block_v2.msh", "block_v4.msh"] {
        assert_eq!(gmsh::read(&file(name), 1.0), Ok(grouped_block()), "{name}");
        let scaled = grouped_block().transformed(|x| x * 25.4);
        assert_eq!(gmsh::read(&file(name), 25.4), Ok(scaled), "{name}");
        let windows = text(name).replace('\n', "\r\n\r\n");
        assert_eq!(parse(&windows), Ok(grouped_block()), "{name}");
    }
}

#[test]
fn a_meshed_geometry_reads_equal_in_both_formats() {
    let mesh = gmsh::read(&file("bars_v4.msh"), 1.0).unwrap();
    assert_eq!(gmsh::read(&file("bars_v2.msh"), 1.0).as_ref(), Ok(&mesh));
    // Bars of 3 mm and 1 mm with a section of 1 mm × 0.2 mm, 2 × 2 × 2 elements each.
    assert!((volumes(&mesh) - 0.8).abs() < 1e-12);
    assert_eq!(mesh.region_names, ["part0", "part1"]);
    for (region, expected) in [(0, 0.6), (1, 0.2)] {
        let inside = (0..16).filter(|&element| mesh.regions[element] == region);
        let inside: f64 = inside.map(|element| volume(&mesh, element)).sum();
        assert!((inside - expected).abs() < 1e-12);
    }
    assert_eq!(mesh.sets.len(), 1);
    assert_eq!(mesh.sets["clamped"], mesh.nodes_on_plane(0, 0.0, 1e-9));
    assert_eq!(mesh.sets["clamped"].len(), 9);
    assert_eq!(mesh.parts().len(), 1);
}

#[test]
fn groups_without_names_and_elements_without_groups() {
    let names = text("block_v2.msh");
    let (start, rest) = names.split_once("$PhysicalNames").unwrap();
    let (_, end) = rest.split_once("$EndPhysicalNames").unwrap();
    let unnamed = parse(&format!("{start}{end}")).unwrap();
    let names: Vec<_> = unnamed.sets.keys().collect();
    assert_eq!(names, ["curve_8", "point_9", "surface_5", "surface_7"]);
    assert_eq!(unnamed.region_names, ["volume_3", "volume_4"]);

    let loose = text("block_v2.msh").replace(" 5 2 3 1 ", " 5 2 0 1 ");
    let loose = parse(&loose).unwrap();
    assert_eq!(loose.region_names, ["stiff layer", UNGROUPED]);
    assert_eq!(loose.regions, [[1; 4], [0; 4]].concat());

    let four = text("block_v4.msh");
    let (start, rest) = four.split_once("$Entities").unwrap();
    let (_, end) = rest.split_once("$EndEntities").unwrap();
    let bare = parse(&format!("{start}{end}")).unwrap();
    assert_eq!(bare.region_names, [UNGROUPED]);
    assert!(bare.sets.is_empty());

    let merged = parse(&text("block_v2.msh").replace("stiff layer", "soft")).unwrap();
    assert_eq!(merged.region_names, ["soft"]);
}

#[test]
fn a_binary_file_is_read_as_its_text() {
    let [binary, text] = ["binary_v4.msh", "block_v4.msh"].map(|name| gmsh::read(&file(name), 1.0));
    assert_eq!(binary, text);
    let bytes = std::fs::read(file("binary_v4.msh")).unwrap();
    for end in [60, 300, 1000, 2000] {
        let error = gmsh::parse(&bytes[..end], "m.msh", 1.0)
            .unwrap_err()
            .to_string();
        assert!(error.starts_with("m.msh"), "{error}");
    }
}

#[test]
fn linear_tetrahedra_become_quadratic() {
    let mesh = gmsh::read(&file("tets.msh"), 1.0).unwrap();
    assert_eq!(mesh.tetrahedra, [[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]]);
    for (middle, [a, b]) in [[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]]
        .iter()
        .enumerate()
    {
        assert_eq!(
            mesh.nodes[4 + middle],
            0.5 * (mesh.nodes[*a] + mesh.nodes[*b])
        );
    }
    assert_eq!(mesh.boundary().len(), 4);
}

#[test]
fn files_that_are_refused() {
    let refused = |name: &str| gmsh::read(&file(name), 1.0).unwrap_err().to_string();
    let at = |name: &str| file(name).display().to_string();
    let rest = |name: &str| refused(name).strip_prefix(&at(name)).unwrap().to_owned();

    let inverted = rest("inverted.msh");
    assert!(
        inverted.starts_with(
            ":17: element 42: found an inverted element, with a determinant ratio of -1.0000 at node 0, expected a \
             Jacobian determinant that is positive"
        ),
        "{inverted}"
    );
    assert!(
        inverted.ends_with(
            "; its nodes are at (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1), (0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)"
        ),
        "{inverted}"
    );
    let degenerate = rest("degenerate.msh");
    assert!(
        degenerate.starts_with(
            ":17: element 42: found a degenerate element, with a determinant ratio of "
        ),
        "{degenerate}"
    );
    let repeated = rest("repeated_node.msh");
    assert!(
        repeated.starts_with(
            ":17: element 42: found the node at (1, 0, 1) repeated, expected 8 different nodes; its nodes are at "
        ),
        "{repeated}"
    );
    let missing = refused("missing.msh");
    assert!(
        missing.contains("missing.msh: cannot be read: "),
        "{missing}"
    );
}

/// Format of the block, what is replaced in its file, by what, and the start of the error after the file's name.
const REFUSED_LINES: &str = r#"
v2 | 2.2 0 8 | 1 0 8 | 2: found format 1, expected a mesh in format 2.2 or 4.1
v2 | 2.2 0 8 | 4 0 8 | 2: found format 4, expected a mesh in format 2.2 or 4.1
v2 | 2.2 0 8 | 2.2 0 | 2: found "2.2 0", expected the version, 0 for ASCII or 1 for binary, and the size of a number: 4.1 0 8
v2 | $MeshFormat | $NOD | 1: found format 1, expected a mesh in format 2.2 or 4.1
v2 | $MeshFormat | solid x | 1: found "solid x", expected $MeshFormat, the head of a .msh file
v2 | Nodes\n | Knots\n | 63: found the end of the file, expected the section $Nodes
v2 | Elements\n | Things\n | 63: found the end of the file, expected the section $Elements
v2 | $EndElements |  | 63: found the end of the file, expected $EndElements
v2 | $EndNodes | $EndNode | 41: found "$EndNode" after as many lines as were counted, expected $EndNodes
v2 | $Nodes\n27 | $Nodes\n28 | 41: found "$EndNodes" before as many lines as were counted, expected a node: number, x, y, z
v2 | $Nodes\n27 | $Nodes\n26 | 40: found "27 2 1 0.5" after as many lines as were counted, expected $EndNodes
v2 | $Nodes\n27 | $Nodes\n-1 | 13: found "-1" in "-1", expected the number of nodes
v2 | $Elements\n19 | $Elements\n99999999999999 | 63: found "$EndElements" before as many lines as were counted, expected an element: number, type, number of tags, tags, nodes
v2 | \n14 1 0.5 0.25 | \n14 1 0.5 | 27: found "14 1 0.5", expected a node: number, x, y, z
v2 | \n14 1 0.5 0.25 | \n14 1 0.5 a | 27: found "a" in "14 1 0.5 a", expected a node: number, x, y, z
v2 | \n14 1 0.5 0.25 | \n14 1 0.5 0.25 7 | 27: found "14 1 0.5 0.25 7", expected a node: number, x, y, z
v2 | \n14 1 0.5 0.25 | \n14 1 nan 0.25 | 27: found "14 1 nan 0.25", expected finite coordinates
v2 | \n14 1 0.5 0.25 | \n14 1 1e999 0.25 | 27: found "14 1 1e999 0.25", expected finite coordinates
v2 | \n14 1 0.5 0.25 | \n13 1 0.5 0.25 | 27: found a second node 13, expected a number of its own for each node
v2 | 12 5 2 3 1 1 | 12 5 2 3 1 77 | 55: found node 77 in element 12, expected a node that $Nodes lists
v2 | 12 5 2 3 1 1 | 12 99 2 3 1 1 | 55: found an element of type 99, expected 8-node hexahedra (type 5)
v2 | 12 5 2 3 1 1 | 12 17 2 3 1 1 | 55: found a 20-node hexahedron of second order (type 17), expected 8-node hexahedra (type 5)
v2 | 13 5 2 3 1 2 3 6 5 11 12 15 14 | 13 5 2 4 1 1 2 5 4 10 11 14 13 | 56: element 13: found the nodes of m.msh:55: element 12, expected each element once, in one region
v2 | $Elements | $Nodes | 42: found a second $Nodes, expected it once
v2 | $Elements | Elements | 42: found "Elements", expected a section such as $Nodes
v2 | 3 4 "stiff layer" | 3 4 stiff | 10: found "3 4 stiff", expected a physical group: dimension, number, "name"
v4 | 6 28 10 99 | 6 29 10 99 | 22: found a total of 29, expected 28, as many as the blocks hold
v4 | 6 28 10 99 | 6 28 | 22: found "6 28", expected four counts: blocks, all of them, smallest and largest number
v4 | 6 28 10 99 | 7 28 10 99 | 85: found "$EndNodes" before as many lines as were counted, expected a block of nodes: dimension and number of the entity, 0 or 1 for parameters, number of nodes
v4 | 1 1 2 2\n | 1 1 2 1\n | 19: found "2 0 0 0.25 2 1 0.5 1 4 0" after as many lines as were counted, expected $EndEntities
v4 | 1 1 2 2\n | 1 1 2\n | 13: found "1 1 2", expected the numbers of points, curves, surfaces and volumes
v4 | 3 2 5 4 | 3 8 5 4 | 108: found the entity 8 of dimension 3, expected an entity that $Entities lists
v4 | 3 2 5 4 | 2 2 5 4 | 108: found elements of dimension 3 in an entity of dimension 2, expected equal dimensions
v4 | 2 1 0.5 1 4 0 | 2 1 0.5 2 3 4 0 | 109: found element 116 in soft and stiff layer, expected each element in one physical volume
v4 | \n101 36 | \n101 99 | 89: found no node of an element of the mesh in the physical group "tip", expected one node or more that is
v4 | $Entities | $PartitionedEntities | 12: found a partitioned mesh, expected a mesh of one partition
"#;

#[test]
fn lines_that_are_refused() {
    let mut different = Vec::new();
    for row in REFUSED_LINES.trim().lines() {
        let row = row.replace("\\n", "\n");
        let parts: Vec<_> = row
            .splitn(4, '|')
            .map(|part| part.trim_matches(' '))
            .collect();
        let [format, old, new, expected] = parts[..] else {
            panic!("{row}")
        };
        let good = text(&format!("block_{format}.msh"));
        assert!(good.contains(old), "{row}");
        // A name of a section stands at its start and at its end.
        let count = if old.ends_with("s\n") { 2 } else { 1 };
        let error = parse(&good.replacen(old, new, count)).expect_err(expected);
        let error = error.to_string();
        if !error.starts_with(&format!("m.msh:{expected}")) {
            different.push(format!("{row}\n{error}"));
        }
    }
    assert!(different.is_empty(), "{}", different.join("\n\n"));
    assert_eq!(
        parse("").unwrap_err().to_string(),
        "m.msh:1: found the end of the file, expected $MeshFormat"
    );
}
