//! Mistakes in bodies within surfaces of STL files, and files of any bytes.

use crate::body_meshes::{KEYS, Vector, cuboid, scene, text};
use crate::scene::{folder, mistake};
use proboscis::files::{read_scene, stl};
use proboscis::mesh::triangulated::Surface;
use proboscis::model::system::Body;
use proptest::prelude::*;
use std::fs;

/// The message of a body with these keys and this file.
fn refusal(keys: &str, bytes: Option<&[u8]>) -> String {
    let (folder, _) = folder(&scene(keys), "{}");
    if let Some(bytes) = bytes {
        fs::write(folder.path().join("part.stl"), bytes).unwrap();
    }
    let error = read_scene(&folder.path().join("scene.json")).expect_err("a mistake");
    assert!(error.span().is_some(), "{error}");
    error.to_string()
}

#[test]
fn mistakes_in_a_surface_have_one_message() {
    let cube = cuboid([0.0; 3], [4.0; 3]);
    let inverted: Vec<_> = cube.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let mut twisted = cube.clone();
    twisted[3].swap(0, 1);
    let flat: Vec<_> = [[0.0, 1.0], [1.0, 0.0]]
        .map(|[x, y]| {
            [
                Vector::zeros(),
                Vector::new(x, y, 0.0),
                Vector::new(1.0, 1.0, 0.0),
            ]
        })
        .into();
    let flat: Vec<_> = flat
        .iter()
        .flat_map(|&[a, b, c]| [[a, b, c], [a, c, b]])
        .collect();
    let not_finite = text(&cube).replacen("vertex 0e0", "vertex nan", 1);
    let mut binary = stl::bytes_of(&Surface::from_corners(cube.clone()), 1.0);
    let cut = binary[..200].to_vec();
    binary[100..104].copy_from_slice(&f32::NAN.to_le_bytes());
    let repeated: Vec<_> = cube.iter().chain(&cube[..1]).copied().collect();
    let cases: [(Option<Vec<u8>>, &str, &str); 12] = [
        (
            Some(text(&repeated).into_bytes()),
            "twice",
            "each triangle once",
        ),
        (None, "where there is no file", "the path of an STL file"),
        (Some(vec![]), "which is empty", "an STL file"),
        (
            Some(b"<html>".to_vec()),
            "neither text that begins with \"solid\" nor binary",
            "an STL file",
        ),
        (Some(cut), "neither text", "an STL file"),
        (
            Some(b"solid x\nendsolid\n".to_vec()),
            "no triangles",
            "a surface",
        ),
        (Some(not_finite.into_bytes()), "triangle 1", "a triangle"),
        (
            Some(binary),
            "triangle 1: a corner that is not finite",
            "finite places",
        ),
        (
            Some(text(&cube[..11]).into_bytes()),
            "an open surface: 3 of 18 edges",
            "a closed surface",
        ),
        (
            Some(text(&inverted).into_bytes()),
            "normals that point inwards",
            "counter-clockwise seen from outside",
        ),
        (
            Some(text(&twisted).into_bytes()),
            "opposite orientation",
            "oriented alike",
        ),
        (
            Some(text(&flat).into_bytes()),
            "encloses no volume",
            "a solid",
        ),
    ];
    for (bytes, found, expected) in cases {
        let message = refusal(KEYS, bytes.as_deref());
        assert!(message.contains("bodies[0].mesh.file"), "{message}");
        assert!(message.contains(found), "{found} in {message}");
        assert!(message.contains(expected), "{expected} in {message}");
        assert!(!message.contains('\n'), "{message}");
    }
}

#[test]
fn mistakes_in_the_keys_of_a_body_have_one_message() {
    let cube = text(&cuboid([0.0; 3], [4.0; 3])).into_bytes();
    let mesh = r#""mesh": { "file": "part.stl" }"#;
    let cases = [
        (format!(r#""mass": 1, "position": [0, 0, 0], {mesh}"#), "bodies[0].position", "\"at\" of the mesh"),
        (format!(r#""mass": 1, "density": 1000, {mesh}"#), "bodies[0]:", "exactly one of \"mass\", \"density\""),
        (format!(r#""mass": 1, "sphere": {{ "radius": 1 }}, {mesh}"#), "\"sphere\", \"mesh\"", "exactly one of"),
        (r#""mass": 1, "sphere": { "radius": 1 }"#.to_owned(), "no \"position\"", "centre of mass"),
        (r#""density": 1, "inertia": [1, 1, 1], "position": [0, 0, 0]"#.to_owned(), "without a volume", "\"mass\""),
        (format!(r#""mass": 1, "products_of_inertia": [0, 0, 0], {mesh}"#), "bodies[0].products_of_inertia", "\"inertia\""),
        (r#""mass": 1, "inertia": [1, 1, 1], "products_of_inertia": [2, 0, 0], "position": [0, 0, 0]"#.to_owned(), "principal moments of", "positive moments"),
        (r#""mass": 1, "mesh": { "file": "part.stl", "unit": "0 mm" }"#.to_owned(), "bodies[0].mesh.unit", "a positive value"),
        (r#""mass": 1, "mesh": { "file": "part.stl", "rotation": { "axis": [0, 0, 0], "angle": 1 } }"#.to_owned(), "bodies[0].mesh.rotation.axis", "a direction"),
    ];
    for (keys, found, expected) in cases {
        let message = refusal(&keys, Some(&cube));
        assert!(message.contains(found), "{found} in {message}");
        assert!(message.contains(expected), "{expected} in {message}");
    }
    // A path that is no text is a mistake of the key.
    let error = mistake(&scene(r#""mass": 1, "mesh": { "file": 3 }"#), "{}", &[]);
    assert!(error.to_string().contains("scene"), "{error}");
}

proptest! {
    #[test]
    fn surfaces_of_any_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        if let Ok(surface) = stl::parse(bytes, "part.stl", 1.0) {
            let _ = Body::within(surface);
        }
    }

    #[test]
    fn surfaces_of_any_numbers_never_panic(numbers in proptest::collection::vec(any::<f32>(), 36..37), words in "(solid|facet|vertex|loop|end| |\n|[0-9.e-]){0,60}") {
        let mut bytes = vec![0; 80];
        bytes.extend(3_u32.to_le_bytes());
        for triangle in numbers.chunks(12) {
            triangle.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        if let Ok(surface) = stl::parse(bytes, "part.stl", 1e3) {
            let _ = Body::within(surface);
        }
        let text = format!("solid {words}");
        let _ = stl::parse(text.into_bytes(), "part.stl", 1.0);
    }
}
