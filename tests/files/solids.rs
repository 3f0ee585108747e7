//! Elastic blocks of a scene: what they mean, and mistakes in them.

use crate::scene::{Case, check, folder, mistake};
use proboscis::control::problem::Task;
use proboscis::files::{expand, read_problem, read_scene};
use proboscis::model::system::{ElementKind, Potential};
use std::fs;

const BLOCK: &str = r#"{
  "name": "block",
  "materials": {
    "silicone": { "shear_modulus": "100 kPa", "poisson_ratio": 0.4, "relative_permittivity": 3.0 },
    "rubber": { "shear_modulus": "100 kPa", "lame_lambda": "400 kPa" },
    "jelly": { "shear_modulus": "100 kPa", "relative_permittivity": 3.0 }
  },
  "bodies": [
    { "name": "left", "mass": 1, "sphere": { "radius": 1 }, "position": [0, 0, 0], "free": true },
    { "name": "right", "mass": 1, "sphere": { "radius": 1 }, "position": [0, 0, 0], "free": true }
  ],
  "solids": [
    {
      "name": "beam", "materials": { "lower": "silicone", "upper": "silicone" },
      "box": { "corner": [0, 0, "5 mm"], "size": ["6 mm", "4 mm", "4 mm"],
        "elements": [3, 2, [{ "thickness": "1 mm", "elements": 2, "region": "lower" }, { "thickness": "3 mm", "elements": 2, "region": "upper" }]] },
      "electrodes": [
        { "name": "ends", "face": "z_min", "potential": "driven" },
        { "name": "middle", "plane": { "z": "6 mm" }, "potential": "grounded" },
        { "name": "ends", "face": "z_max", "potential": "driven" }
      ],
      "fixed": ["x_min", { "face": "y_min", "directions": ["y"] }],
      "glued": { "x_max": "right" },
      "velocity": { "linear": ["1 m/s", 0, 0], "angular": [0, 0, "2 rad/s"], "stretch_rate": [0, 0, "10 1/s"] }
    },
    {
      "name": "pile", "material": "silicone", "element": "hex8_q1p0",
      "box": { "size": ["1 mm", "1 mm", "4 mm"], "elements": [1, 1, 8] },
      "stack": { "axis": "z", "layers": 4, "name": "stack" }
    }
  ],
  "markers": [ { "name": "tip", "solid": "beam", "at": ["6 mm", "2 mm", "9.5 mm"] } ]
}"#;

#[test]
fn a_block_means_what_is_written() {
    let (folder, _) = folder(BLOCK, "{}");
    let system = read_scene(&folder.path().join("scene.json")).expect("blocks");
    let [beam, pile] = &system.solids[..] else {
        panic!("two blocks")
    };
    assert_eq!((beam.mesh.nodes.len(), beam.mesh.hexahedra.len()), (60, 24));
    assert_eq!(beam.mesh.region_names, ["lower", "upper"]);
    for (corners, &region) in beam.mesh.hexahedra.iter().zip(&beam.mesh.regions) {
        let is_upper = beam.mesh.nodes[corners[0]].z >= 6.0;
        assert_eq!(region, usize::from(is_upper));
    }
    // λ = 2 μ ν/(1 − 2 ν) to rounding.
    let lambda = beam.materials[0]
        .lame_lambda
        .expect("a compressible material");
    assert!((lambda - 0.4).abs() < 1e-15, "{lambda}");
    // Driven electrodes of one name are connected.
    let driven = |source| Potential::Driven {
        source,
        factor: 1.0,
    };
    let electrodes = |i: usize| -> Vec<_> {
        let all = system.solids[i].electrodes.iter();
        all.map(|e| (e.name.as_str(), e.nodes.len(), e.potential))
            .collect()
    };
    let grounded = Potential::Given(0.0);
    assert_eq!(
        electrodes(0),
        [("ends", 24, driven(0)), ("middle", 12, grounded)]
    );
    assert_eq!(
        electrodes(1),
        [("stack_ground", 12, grounded), ("stack", 8, driven(1))]
    );
    let heights: Vec<f64> = pile.electrodes[1]
        .nodes
        .iter()
        .map(|&n| pile.mesh.nodes[n].z)
        .collect();
    assert_eq!(heights, [1.0, 1.0, 1.0, 1.0, 3.0, 3.0, 3.0, 3.0]);
    let names: Vec<_> = system
        .sources()
        .into_iter()
        .map(|source| source.name)
        .collect();
    assert_eq!(names, ["beam.ends", "pile.stack"]);
    assert_eq!(
        (beam.element, pile.element),
        (ElementKind::Hex8, ElementKind::Hex8Q1P0)
    );
    // A glued node is not held as well: the edge of y_min at x_max.
    let held: Vec<_> = beam
        .supports
        .iter()
        .map(|s| (s.nodes.len(), s.held))
        .collect();
    assert_eq!(held, [(15, [true; 3]), (15, [false, true, false])]);
    assert_eq!(
        (beam.glued[0].nodes.len(), beam.glued[0].body),
        (15, Some(1))
    );
    for (node, velocity) in beam.mesh.nodes.iter().zip(&beam.velocities) {
        let expected = [
            1.0 - 2e-3 * (node.y - 2.0),
            2e-3 * (node.x - 3.0),
            1e-2 * (node.z - 7.0),
        ];
        for (ours, theirs) in velocity.iter().zip(expected) {
            assert!((ours - theirs).abs() < 1e-15, "{velocity} {expected:?}");
        }
    }
    assert!(pile.velocities.is_empty());
    let tip = &system.markers[0];
    assert_eq!((tip.solid, tip.point.body), (Some(0), None));
    let file = folder.path().join("scene.json");
    let again = expand(&file).expect("an expansion");
    fs::write(&file, again).expect("a written scene");
    assert_eq!(read_scene(&file).expect("the same blocks"), system);
}

#[test]
fn mistakes_in_a_block_name_place_found_and_expected() {
    #[rustfmt::skip]
    let cases: &[Case] = &[
        ("\"name\": \"pile\"", "\"name\": \"beam\"", "solids[1].name", "\"beam\" a second time", "not taken", "\"beam\""),
        ("\"material\": \"silicone\"", "\"material\": \"silicon\"", "solids[1].material", "\"silicon\"", "the name of a material", "silicon"),
        ("\"material\": \"silicone\"", "\"material\": \"jelly\"", "solids[1].material", "\"jelly\", which has neither", "a material with one of them", "jelly"),
        ("\"material\": \"silicone\"", "\"material\": \"rubber\"", "solids[1].material", "\"rubber\", which has no electric term, in a block with electrodes", "relative_permittivity", "rubber"),
        ("\"upper\": \"silicone\"", "\"upper\": \"rubber\"", "solids[0].materials.upper", "no electric term", "relative_permittivity", "rubber"),
        ("\"upper\": \"silicone\"", "\"uper\": \"silicone\"", "solids[0].materials.uper", "\"uper\"", "one of \"lower\", \"upper\"", "uper"),
        (", \"upper\": \"silicone\"", "", "solids[0].materials", "no material of the region \"upper\"", "one", "lower"),
        ("\"name\": \"beam\", \"materials\"", "\"name\": \"beam\", \"material\": \"silicone\", \"materials\"", "solids[0]", "\"material\", \"materials\"", "exactly one of", "beam"),
        (", \"region\": \"upper\"", "", "solids[0].box.elements[2][1]", "a layer without a region", "a region for each layer", "3 mm"),
        ("\"elements\": [3, ", "\"elements\": [[{ \"thickness\": \"6 mm\", \"elements\": 3, \"region\": \"all\" }], ", "solids[0].box.elements[2][0].region", "second direction", "one direction only", "lower"),
        ("\"thickness\": \"3 mm\"", "\"thickness\": \"2 mm\"", "solids[0].box.elements[2]", "thicknesses that sum to 3 mm", "4 mm, the size of the box", "2 mm"),
        ("\"thickness\": \"3 mm\"", "\"thickness\": \"-3 mm\"", "solids[0].box.elements[2][1].thickness", "-3 mm", "a positive value", "-3 mm"),
        ("\"thickness\": \"3 mm\", \"elements\": 2", "\"thickness\": \"3 mm\", \"elements\": 0", "solids[0].box.elements[2][1].elements", "0", "1 element or more", "0"),
        ("\"elements\": [3, ", "\"elements\": [0, ", "solids[0].box.elements[0]", "0", "1 element or more", "0"),
        ("\"elements\": [3, ", "\"elements\": [\"3\", ", "solids[0].box.elements[0]", "\"3\"", "a whole number of elements or a list of layers", "3"),
        ("\"elements\": [3, ", "\"elements\": [3000000, ", "solids[0].box.elements", "3000000", "no more than", "3000000"),
        ("[\"6 mm\", \"4 mm\", \"4 mm\"]", "[\"6 mm\", \"-4 mm\", \"4 mm\"]", "solids[0].box.size[1]", "-4 mm", "a positive value", "-4 mm"),
        ("\"face\": \"z_min\"", "\"face\": \"z_mn\"", "solids[0].electrodes[0].face", "\"z_mn\"", "one of \"x_max\", \"x_min\"", "z_mn"),
        ("\"z\": \"6 mm\"", "\"z\": \"6.2 mm\"", "solids[0].electrodes[1].plane.z", "electrode \"middle\" in the plane z = 6.2 mm, which holds no node", "z = 5, 5.5, 6, 7.5, 9 mm", "6.2 mm"),
        ("\"plane\": { \"z\": \"6 mm\" }", "\"plane\": {}", "solids[0].electrodes[1].plane", "none of them", "exactly one of", "{}"),
        ("\"plane\": { \"z\": \"6 mm\" }", "\"box\": { \"min\": [0, 0, 0], \"max\": [1, 1, \"2 mm\"] }", "solids[0].electrodes[1].box", "electrode \"middle\" in a box that holds no node", "from (0, 0, 5) mm to (6, 4, 9) mm", "2 mm"),
        ("\"plane\": { \"z\": \"6 mm\" }", "\"face\": \"x_max\"", "solids[0].electrodes[1]", "belongs to electrode \"ends\" too", "do not meet", "middle"),
        ("\"name\": \"middle\"", "\"name\": \"ends\"", "solids[0].electrodes[1].name", "\"ends\" a second time", "only driven electrodes share one", "ends"),
        ("\"grounded\"", "\"ground\"", "solids[0].electrodes[1].potential", "\"ground\"", "\"grounded\"", "ground"),
        ("\"grounded\"", "{ \"given\": \"5 mm\" }", "solids[0].electrodes[1].potential.given", "a length", "a voltage", "5 mm"),
        ("\"grounded\"", "\"given\"", "solids[0].electrodes[1].potential.given", "a word alone", "an object with this key", "given"),
        ("\"layers\": 4", "\"layers\": 3", "solids[1].stack.layers", "3", "a divisor of the 8 elements along z", "3"),
        ("\"layers\": 4", "\"layers\": 0", "solids[1].stack.layers", "0", "a divisor of the 8 elements along z", "0"),
        ("\"stack\": { \"axis\": \"z\", \"layers\": 4, \"name\": \"stack\" }", "\"electrodes\": [ { \"name\": \"a\", \"face\": \"x_min\", \"potential\": \"floating\" } ]", "solids[1].electrodes", "floating electrodes only", "grounded, driven or given", "floating"),
        ("\"fixed\": [\"x_min\"", "\"fixed\": [\"x_mi\"", "solids[0].fixed[0]", "\"x_mi\"", "the name of a face", "x_mi"),
        ("\"directions\": [\"y\"]", "\"directions\": []", "solids[0].fixed[1].directions", "no direction", "\"x\", \"y\", \"z\"", "[]"),
        ("\"directions\": [\"y\"]", "\"directions\": [\"w\"]", "solids[0].fixed[1].directions[0]", "\"w\"", "\"x\"", "w"),
        ("\"glued\": { \"x_max\"", "\"glued\": { \"x_mx\"", "solids[0].glued.x_mx", "\"x_mx\"", "the name of a face", "x_mx"),
        ("\"x_max\": \"right\"", "\"x_max\": \"rihgt\"", "solids[0].glued.x_max", "\"rihgt\"", "the name of a body or \"ground\"", "rihgt"),
        ("\"x_max\": \"right\"", "\"x_max\": \"right\", \"y_max\": \"left\"", "solids[0].glued.y_max", "\"left\", though \"right\" holds the node", "do not meet", "left"),
        ("\"10 1/s\"", "\"10 mm\"", "solids[0].velocity.stretch_rate[2]", "a length", "a rate", "10 mm"),
        ("\"solid\": \"beam\"", "\"solid\": \"bem\"", "markers[0].solid", "\"bem\"", "the name of a block", "bem"),
        ("\"solid\": \"beam\"", "\"solid\": \"beam\", \"body\": \"left\"", "markers[0]", "\"body\", \"solid\"", "exactly one of", "beam"),
        ("\"9.5 mm\"", "\"19 mm\"", "markers[0].at", "10.000 mm away from the nearest node, at (6, 2, 9) mm", "no farther from the block than the size of an element", "19 mm"),
        ("\"box\": { \"size\": [\"1 mm\", \"1 mm\", \"4 mm\"], \"elements\": [1, 1, 8] }", "\"mesh\": \"nowhere.msh\"", "solids[1].mesh", "\"nowhere.msh\", where there is no file", "the path of a Gmsh file", "nowhere"),
        ("\"element\": \"hex8_q1p0\"", "\"unit\": \"1 mm\"", "solids[1].unit", "\"1 mm\"", "no such key", "1 mm"),
        ("\"element\": \"hex8_q1p0\"", "\"mesh\": \"x.msh\"", "solids[1]", "\"box\", \"mesh\"", "exactly one of", "pile"),
    ];
    check(cases, BLOCK, |scene| {
        let (folder, _) = folder(scene, "{}");
        read_scene(&folder.path().join("scene.json")).expect_err("a mistake")
    });
}

/// Two cubes of 1 unit side by side along z, the upper one in a volume of its own.
const MESH: &str = "$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
4
2 1 \"bottom\"
2 2 \"top\"
3 3 \"soft\"
3 4 \"stiff\"
$EndPhysicalNames
$Nodes
12
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
5 0 0 1
6 1 0 1
7 1 1 1
8 0 1 1
9 0 0 2
10 1 0 2
11 1 1 2
12 0 1 2
$EndNodes
$Elements
4
1 3 2 1 1 1 2 3 4
2 3 2 2 2 9 10 11 12
3 5 2 3 3 1 2 3 4 5 6 7 8
4 5 2 4 4 5 6 7 8 9 10 11 12
$EndElements
";

#[test]
fn a_mesh_file_is_read_beside_the_scene_and_answers_for_mistakes() {
    let scene = r#"{ "name": "x",
      "materials": { "a": { "shear_modulus": 1, "lame_lambda": 1 }, "b": { "shear_modulus": 2, "lame_lambda": 1, "relative_permittivity": 2 } },
      "solids": [ { "name": "cubes", "mesh": "cubes.msh", "unit": "2 mm", "materials": { "soft": "a", "stiff": "b" },
        "fixed": ["bottom"], "glued": { "top": "ground" } } ] }"#;
    let (folder, _) = folder(scene, "{}");
    let (file, mesh) = (
        folder.path().join("scene.json"),
        folder.path().join("cubes.msh"),
    );
    fs::write(&mesh, MESH).expect("a written mesh");
    let solid = &read_scene(&file).expect("two cubes").solids[0];
    assert_eq!(solid.mesh.nodes[11].as_slice(), [0.0, 2.0, 4.0]);
    let moduli: Vec<_> = solid.materials.iter().map(|m| m.shear_modulus).collect();
    assert_eq!(moduli, [1e-6, 2e-6]);
    let held: Vec<_> = solid
        .supports
        .iter()
        .map(|s| (&s.nodes[..], s.held))
        .collect();
    assert_eq!(
        held,
        [
            (&[0, 1, 2, 3][..], [true; 3]),
            (&[8, 9, 10, 11][..], [true; 3])
        ]
    );
    assert!(solid.glued.is_empty());

    for (old, new, words) in [
        ("2.2 0 8", "7.7 0 8", "cubes.msh:2"),
        ("3 1 1 0\n", "3 1 one 0\n", "cubes.msh:15"),
        (
            "5 6 7 8 9 10 11 12\n",
            "9 10 11 12 5 6 7 8\n",
            "cubes.msh:31",
        ),
    ] {
        fs::write(&mesh, MESH.replacen(old, new, 1)).expect("a written mesh");
        let error = read_scene(&file).expect_err("a broken mesh");
        assert_eq!(error.path(), "solids[0].mesh");
        assert!(error.found().contains(words), "{words} in {error}");
    }
    fs::write(&mesh, MESH).expect("a written mesh");
    for (old, new, path, words) in [
        (
            "[\"bottom\"]",
            "[\"floor\"]",
            "solids[0].fixed[0]",
            "one of \"bottom\", \"top\"",
        ),
        (
            "\"soft\"",
            "\"sft\"",
            "solids[0].materials.sft",
            "one of \"soft\", \"stiff\"",
        ),
        ("\"2 mm\"", "\"0 mm\"", "solids[0].unit", "a positive value"),
        (
            "\"fixed\"",
            "\"stack\": { \"axis\": \"z\", \"layers\": 3, \"name\": \"s\" }, \"fixed\"",
            "solids[0].stack",
            "z = 0, 2, 4 mm",
        ),
    ] {
        fs::write(&file, scene.replacen(old, new, 1)).expect("a written scene");
        let error = read_scene(&file).expect_err("a mistake");
        assert_eq!(error.path(), path, "{error}");
        assert!(error.expected().contains(words), "{words} in {error}");
    }
}

#[test]
fn voltages_are_named_for_driven_electrodes() {
    let problem =
        r#"{ "scene": "scene.json", "equilibrium": { "voltages": { "pile.stack": "2 kV" } } }"#;
    let (_folder, path) = folder(BLOCK, problem);
    let task = read_problem(&path, &[]).expect("an equilibrium").task;
    assert!(matches!(task, Task::Equilibrium(task) if task.voltages == [0.0, 2000.0]));
    let wrong = problem.replace("pile.stack", "pile.stak");
    let error = mistake(BLOCK, &wrong, &[]);
    assert_eq!(error.path(), "equilibrium.voltages.pile.stak");
    assert_eq!(error.nearest(), Some("pile.stack"));
    let expected = "the name of a muscle or of a driven electrode (block.electrode)";
    assert_eq!(error.expected(), expected);
}
