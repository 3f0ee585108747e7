//! Laws of meshes: boxes, their parts and sides, the files of Gmsh, and what is refused.

use nalgebra::{Matrix3, Rotation3, Vector3};
use proboscis::mesh::Mesh;
use proboscis::mesh::error::MeshError;
use proboscis::mesh::gmsh::{self};
use proboscis::mesh::grid::Grid;
use proptest::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};

/// Six tetrahedra around the diagonal from corner 0 to corner 6: exact where faces are plane.
pub(crate) fn volume(mesh: &Mesh, element: usize) -> f64 {
    let x = mesh.hexahedra[element].map(|node| mesh.nodes[node]);
    let around = [1, 2, 3, 7, 4, 5, 1];
    let volumes = around.windows(2).map(|edge| {
        let edges = [x[edge[0]] - x[0], x[edge[1]] - x[0], x[6] - x[0]];
        Matrix3::from_columns(&edges).determinant() / 6.0
    });
    volumes.sum()
}

pub(crate) fn volumes(mesh: &Mesh) -> f64 {
    (0..mesh.hexahedra.len()).map(|e| volume(mesh, e)).sum()
}

/// A box 2 mm × 1 mm × 0.5 mm of 2 × 2 × 2 elements.
pub(crate) fn block() -> Mesh {
    let size = Vector3::new(2.0, 1.0, 0.5);
    Grid::uniform(Vector3::zeros(), size, [2, 2, 2]).mesh()
}

pub(crate) fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/meshes")
        .join(name)
}

pub(crate) fn text(name: &str) -> String {
    fs::read_to_string(file(name)).unwrap()
}

pub(crate) fn parse(text: &str) -> Result<Mesh, MeshError> {
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
    fn boxes_have_the_properties(
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
    assert_eq!(
        mesh.nodes_on_plane(0, 1.05, 0.1),
        mesh.nodes_on_plane(0, 1.0, 0.0)
    );
    assert_eq!(mesh.nodes_on_plane(0, 1.5, 0.1), [0; 0]);
    assert_eq!(Mesh::default().size(), 0.0);
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
        "mesh: found no element, expected one element or more"
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
            "hexahedron 3: found the node at (2, 0.5, 0) repeated, expected 8 different nodes",
        ),
        (
            |m| m.hexahedra[3] = m.hexahedra[2],
            "hexahedron 3: found the nodes of hexahedron 2, expected each element once, in one region",
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
            "mesh: found 2 regions of 8 elements, expected one region per element",
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
