//! Laws of meshes: boxes, their parts and sides, the files of Gmsh, and what is refused.

use nalgebra::{Matrix3, Rotation3, Vector3};
use proboscis::mesh::Mesh;
use proboscis::mesh::error::MeshError;
use proboscis::mesh::gmsh::{self, UNGROUPED};
use proboscis::mesh::grid::Grid;
use proptest::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};

/// Six tetrahedra around the diagonal from corner 0 to corner 6: exact where faces are plane.
fn volume(mesh: &Mesh, element: usize) -> f64 {
    let x = mesh.hexahedra[element].map(|node| mesh.nodes[node]);
    let around = [1, 2, 3, 7, 4, 5, 1];
    let volumes = around.windows(2).map(|edge| {
        let edges = [x[edge[0]] - x[0], x[edge[1]] - x[0], x[6] - x[0]];
        Matrix3::from_columns(&edges).determinant() / 6.0
    });
    volumes.sum()
}

fn volumes(mesh: &Mesh) -> f64 {
    (0..mesh.hexahedra.len()).map(|e| volume(mesh, e)).sum()
}

/// A box 2 mm × 1 mm × 0.5 mm of 2 × 2 × 2 elements.
fn block() -> Mesh {
    let size = Vector3::new(2.0, 1.0, 0.5);
    Grid::uniform(Vector3::zeros(), size, [2, 2, 2]).mesh()
}

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/meshes")
        .join(name)
}

fn text(name: &str) -> String {
    fs::read_to_string(file(name)).unwrap()
}

fn parse(text: &str) -> Result<Mesh, MeshError> {
    gmsh::parse(text.as_bytes(), "m.msh", 1.0)
}

#[test]
fn planes_are_exact() {
    let (origin, length, n) = (0.3, 0.7, 7);
    let planes = Grid::uniform(Vector3::repeat(origin), Vector3::repeat(length), [n; 3]).planes;
    for axis in planes {
        assert_eq!(axis.len(), n + 1);
        for (i, plane) in axis[..n].iter().enumerate() {
            assert_eq!(*plane, origin + length * i as f64 / n as f64);
        }
        assert_eq!(axis[n], origin + length);
    }
}

#[test]
fn layers_are_exact() {
    let (origin, size) = (Vector3::new(1.0, 2.0, 3.0), Vector3::new(1.0, 1.0, 1.5));
    let z = vec![(0.25, 1), (1.0, 4), (0.25, 2)];
    let layers = [vec![(1.0, 1)], vec![(0.5, 1), (0.5, 2)], z];
    let grid = Grid::layers(origin, size, layers).unwrap();
    let expected = [3.0, 3.25, 3.5, 3.75, 4.0, 4.25, 4.375, 4.5];
    assert_eq!(grid.planes[0], [1.0, 2.0]);
    assert_eq!(grid.planes[1], [2.0, 2.5, 2.75, 3.0]);
    assert_eq!(grid.planes[2], expected);
    assert_eq!(grid.mesh().check(), Ok(()));

    let one = [0, 1, 2].map(|axis| vec![(size[axis], 7)]);
    let uniform = Grid::uniform(origin, size, [7; 3]);
    assert_eq!(Grid::layers(origin, size, one), Ok(uniform));
}

#[test]
fn layers_fill_the_box() {
    let layers = |z: Vec<(f64, usize)>| {
        let one = vec![(1.0, 1)];
        let grid = Grid::layers(
            Vector3::zeros(),
            Vector3::repeat(1.0),
            [one.clone(), one, z],
        );
        grid.unwrap_err().to_string()
    };
    assert_eq!(
        layers(vec![(0.5, 1), (0.25, 1)]),
        "layers along z: found thicknesses that sum to 0.75 mm, expected 1 mm, the size of the box"
    );
    let faulty = "expected a positive thickness in one or more elements";
    for layer in [
        (0.5, 0),
        (0.0, 1),
        (-1.0, 1),
        (f64::NAN, 1),
        (f64::INFINITY, 1),
    ] {
        let error = layers(vec![(0.5, 1), layer]);
        assert!(
            error.starts_with("layers along z: found a layer of "),
            "{error}"
        );
        assert!(error.ends_with(faulty), "{error}");
    }
    assert!(layers(Vec::new()).contains("sum to 0 mm"));
}

#[test]
fn nodes_count_x_first() {
    let mesh = Grid {
        planes: [vec![0.0, 1.0, 4.0], vec![0.0, 2.0], vec![0.0, 3.0]],
    }
    .mesh();
    assert_eq!(mesh.nodes[1], Vector3::new(1.0, 0.0, 0.0));
    assert_eq!(mesh.nodes[3], Vector3::new(0.0, 2.0, 0.0));
    assert_eq!(mesh.nodes[6], Vector3::new(0.0, 0.0, 3.0));
    assert_eq!(mesh.hexahedra[0], [0, 1, 4, 3, 6, 7, 10, 9]);
    assert_eq!(mesh.regions, [0, 0]);
    assert_eq!(mesh.region_names, ["box"]);
}

proptest! {
    #[test]
    fn boxes_obey_the_laws(
        elements in prop::array::uniform3(1_usize..5),
        origin in prop::array::uniform3(-10.0..10.0_f64),
        size in prop::array::uniform3(0.1..10.0_f64),
        angles in prop::array::uniform3(-3.0..3.0_f64),
    ) {
        let (origin, size) = (Vector3::from(origin), Vector3::from(size));
        let mesh = Grid::uniform(origin, size, elements).mesh();
        prop_assert_eq!(mesh.check(), Ok(()));
        let [n_x, n_y, n_z] = elements;
        prop_assert_eq!(mesh.hexahedra.len(), n_x * n_y * n_z);
        prop_assert_eq!(mesh.nodes.len(), (n_x + 1) * (n_y + 1) * (n_z + 1));
        // Differences of coordinates around 10 mm are exact to 1e-15 mm, of thicknesses from 0.02 mm.
        let whole = size.product();
        prop_assert!((volumes(&mesh) - whole).abs() <= 1e-11 * whole);

        prop_assert_eq!(mesh.boundary_quads().len(), 2 * (n_x * n_y + n_y * n_z + n_z * n_x));
        prop_assert_eq!(mesh.parts(), vec![(0..mesh.hexahedra.len()).collect::<Vec<_>>()]);
        prop_assert_eq!(mesh.bounds(), (origin, origin + size));
        prop_assert!((mesh.size() - size.norm()).abs() <= 1e-13 * (20.0 + size.norm()));
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let count = (n_x + 1) * (n_y + 1) * (n_z + 1) / (elements[axis] + 1);
            for (side, place) in [("min", origin[axis]), ("max", (origin + size)[axis])] {
                let set = &mesh.sets[&format!("{name}_{side}")];
                prop_assert_eq!(set.len(), count);
                prop_assert_eq!(set, &mesh.nodes_on_plane(axis, place, 0.0));
            }
        }

        let rotation = Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
        let moved = mesh.clone().transformed(|x| rotation * x + Vector3::new(1.0, 2.0, 3.0));
        prop_assert_eq!(moved.check(), Ok(()));
        prop_assert!((volumes(&moved) - whole).abs() <= 1e-11 * whole);
        let mirrored = mesh.transformed(|x| -x);
        prop_assert!(mirrored.check().unwrap_err().to_string().contains("inverted"));
    }
}

#[test]
fn boundary_quads_face_outwards() {
    // By the theorem of Gauss the volume is a third of the flux of x, here over two triangles per face.
    let mesh = block().transformed(|x| Vector3::new(x.x + 0.3 * x.z, x.y - 0.2 * x.x, x.z));
    let flux = mesh.boundary_quads().into_iter().map(|quad| {
        let [a, b, c, d] = quad.map(|node| mesh.nodes[node]);
        (a.dot(&b.cross(&c)) + a.dot(&c.cross(&d))) / 6.0
    });
    let inside = volumes(&mesh);
    assert!(inside > 0.9);
    assert!((flux.sum::<f64>() - inside).abs() < 1e-13 * mesh.size().powi(3));
}

#[test]
fn parts_are_what_hangs_together() {
    let mut mesh = block();
    let nodes = mesh.nodes.len();
    let other = block().transformed(|x| x + Vector3::z() * 5.0);
    mesh.nodes.extend(other.nodes);
    // Elements of both in turn.
    let pairs = block()
        .hexahedra
        .into_iter()
        .map(|e| [e, e.map(|n| n + nodes)]);
    mesh.hexahedra = pairs.flatten().collect();
    mesh.regions = vec![0; 16];
    assert_eq!(mesh.check(), Ok(()));
    let every_other = |first: usize| (first..16).step_by(2).collect::<Vec<_>>();
    assert_eq!(mesh.parts(), [every_other(0), every_other(1)]);
    assert_eq!(mesh.boundary_quads().len(), 48);
    assert_eq!(Mesh::default().parts(), Vec::<Vec<usize>>::new());

    // One node in common connects.
    let mut chain = Grid::uniform(Vector3::zeros(), Vector3::repeat(2.0), [2, 2, 2]).mesh();
    chain.hexahedra = vec![chain.hexahedra[0], chain.hexahedra[7]];
    assert_eq!(chain.parts(), [[0, 1]]);
    assert_eq!(chain.boundary_quads().len(), 12);
}

#[test]
fn nodes_are_found_by_place() {
    let mesh = block();
    assert_eq!(mesh.nearest_node(&Vector3::new(1.9, 1.2, 0.6)), Some(26));
    assert_eq!(mesh.nearest_node(&Vector3::new(1.0, 0.5, 0.25)), Some(13));
    assert_eq!(Mesh::default().nearest_node(&Vector3::zeros()), None);
    let lower = Vector3::new(0.5, 0.5, -1.0);
    assert_eq!(
        mesh.select(&lower, &Vector3::new(2.0, 1.0, 0.0)),
        [4, 5, 7, 8]
    );
    assert_eq!(
        mesh.nodes_on_plane(0, 1.05, 0.1),
        mesh.nodes_on_plane(0, 1.0, 0.0)
    );
    assert_eq!(mesh.nodes_on_plane(0, 1.5, 0.1), [0; 0]);
    assert_eq!(Mesh::default().size(), 0.0);
}

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
fn files_that_are_refused() {
    let refused = |name: &str| gmsh::read(&file(name), 1.0).unwrap_err().to_string();
    let at = |name: &str| file(name).display().to_string();
    let rest = |name: &str| refused(name).strip_prefix(&at(name)).unwrap().to_owned();

    let inverted = rest("inverted.msh");
    assert!(
        inverted.starts_with(
            ":17: element 42: found an inverted element, with a determinant ratio of -1.0000 at corner 0, expected a \
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
            ":17: element 42: found the node at (1, 0, 1) repeated, expected eight different nodes; its nodes are at "
        ),
        "{repeated}"
    );
    let tets = rest("tets.msh");
    assert!(
        tets.starts_with(
            ":18: found a 4-node tetrahedron (type 4), expected 8-node hexahedra (type 5)"
        ),
        "{tets}"
    );
    assert_eq!(
        rest("quads_only.msh"),
        ":11: found no hexahedron among 1 elements, expected 8-node hexahedra (type 5)"
    );
    let binary = rest("binary_v4.msh");
    assert!(
        binary.starts_with(
            ":2: found a binary file, expected an ASCII file: save with Mesh.Binary = 0"
        ),
        "{binary}"
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
v2 | 2.2 0 8 | 2.2 0 | 2: found "2.2 0", expected the version, 0 for ASCII, and the size of a number: 4.1 0 8
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
v2 | 13 5 2 3 1 2 3 6 5 11 12 15 14 | 13 5 2 4 1 1 2 5 4 10 11 14 13 | 56: element 13: found the nodes of m.msh:55: element 12, expected each hexahedron once, in one region
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
v4 | 2 1 0.5 1 4 0 | 2 1 0.5 2 3 4 0 | 109: found element 116 in soft and stiff layer, expected each hexahedron in one physical volume
v4 | \n101 36 | \n101 99 | 89: found no node of a hexahedron in the physical group "tip", expected one node or more that is
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

#[test]
fn meshes_that_are_refused() {
    type Spoil = fn(&mut Mesh);

    let spoilt = |spoil: Spoil| {
        let mut mesh = block();
        spoil(&mut mesh);
        mesh.check().unwrap_err().to_string()
    };
    assert_eq!(
        Mesh::default().check().unwrap_err().to_string(),
        "mesh: found no element, expected one hexahedron or more"
    );
    let empty = Grid::uniform(Vector3::zeros(), Vector3::repeat(1.0), [2, 0, 2]).mesh();
    assert!(
        empty
            .check()
            .unwrap_err()
            .to_string()
            .contains("no element")
    );
    let descending = Grid::uniform(Vector3::zeros(), Vector3::new(1.0, 1.0, -1.0), [1; 3]);
    let descending = descending.mesh().check().unwrap_err().to_string();
    assert!(descending.contains("inverted"), "{descending}");

    let cases: [(Spoil, &str); 8] = [
        (
            |m| m.hexahedra[3][2] = 27,
            "hexahedron 3: found node 27, expected indices below the number of nodes, 27; its nodes are at ",
        ),
        (
            |m| m.hexahedra[3][2] = m.hexahedra[3][1],
            "hexahedron 3: found the node at (2, 0.5, 0) repeated, expected eight different nodes",
        ),
        (
            |m| m.hexahedra[3] = m.hexahedra[2],
            "hexahedron 3: found the nodes of hexahedron 2, expected each hexahedron once, in one region",
        ),
        (
            |m| m.nodes[0].x = f64::INFINITY,
            "hexahedron 0: found a node at (inf, 0, 0), expected finite coordinates",
        ),
        (
            |m| m.regions[2] = 1,
            "mesh: found region 1 of 1 names, expected a name for each region",
        ),
        (
            |m| m.regions.truncate(2),
            "mesh: found 2 regions of 8 hexahedra, expected one region per hexahedron",
        ),
        (
            |m| m.sets.get_mut("x_min").unwrap().push(27),
            "mesh: found node 27 in the set \"x_min\", expected indices below the number of nodes, 27",
        ),
        (
            |m| m.sets.get_mut("x_min").unwrap().push(0),
            "mesh: found a set \"x_min\" that is not sorted, expected ascending nodes, each once",
        ),
    ];
    for (spoil, expected) in cases {
        let error = spoilt(spoil);
        assert!(error.starts_with(expected), "{error}\n{expected}");
    }
}

#[test]
fn proportions_and_lengths_do_not_matter_but_shape_does() {
    let thin = |height: f64| block().transformed(|x| Vector3::new(x.x, x.y, height * x.z));
    assert_eq!(thin(1e-4).check(), Ok(()));
    assert!(thin(1e-14).check().is_err(), "as thin as rounding");
    for length in [1e-200, 1e-9, 1e9, 1e200] {
        assert_eq!(
            block().transformed(|x| x * length).check(),
            Ok(()),
            "{length}"
        );
    }
    let collapsed = block().transformed(|_| Vector3::repeat(3.0));
    let error = collapsed.check().unwrap_err().to_string();
    assert!(
        error.contains("degenerate element, with a determinant ratio of 0"),
        "{error}"
    );
    // One corner pushed through the opposite face: positive at the other corners, yet folded.
    let mut folded = Grid::uniform(Vector3::zeros(), Vector3::repeat(1.0), [1; 3]).mesh();
    folded.nodes[7] = Vector3::repeat(-0.2);
    assert!(folded.check().is_err());
}

proptest! {
    #[test]
    fn spoilt_files_never_panic(
        name in prop::sample::select(vec!["block_v2.msh", "block_v4.msh", "bars_v4.msh", "degenerate.msh"]),
        changes in prop::collection::vec((any::<prop::sample::Index>(), 0..3_usize, "[ -~\n]{0,4}|-?[0-9]{1,20}|\\$End|nan|1e400|\\PC"), 1..5),
    ) {
        // Words are replaced, left out or put in.
        let good = text(name);
        let mut words: Vec<String> = good.split_inclusive([' ', '\n']).map(str::to_owned).collect();
        for (at, kind, word) in changes {
            let at = at.index(words.len());
            let space = if words[at].ends_with('\n') { '\n' } else { ' ' };
            match kind {
                0 => words[at] = format!("{word}{space}"),
                1 => words[at].clear(),
                _ => words.insert(at, format!("{word} ")),
            }
        }
        match parse(&words.concat()) {
            Ok(mesh) => prop_assert_eq!(mesh.check(), Ok(())),
            Err(error) => prop_assert!(error.to_string().starts_with("m.msh:"), "{}", error),
        }
    }

    #[test]
    fn spoilt_bytes_never_panic(
        name in prop::sample::select(vec!["block_v2.msh", "block_v4.msh", "binary_v4.msh"]),
        at in any::<prop::sample::Index>(),
        length in 0..40_usize,
        bytes in prop::collection::vec(any::<u8>(), 0..20),
    ) {
        let mut file = fs::read(file(name)).unwrap();
        let at = at.index(file.len());
        let end = (at + length).min(file.len());
        file.splice(at..end, bytes);
        if let Ok(mesh) = gmsh::parse(&file, "m.msh", 1.0) {
            prop_assert_eq!(mesh.check(), Ok(()));
        }
    }

    #[test]
    fn arbitrary_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        prop_assert!(gmsh::parse(&bytes, "m.msh", 1.0).is_err());
    }
}
