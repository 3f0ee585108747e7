//! Bodies within surfaces of STL files: closed forms, and forms of the file.

use crate::scene::folder;
use nalgebra::{Matrix3, Rotation3, Vector3};
use proboscis::files::{read_scene, stl};
use proboscis::mesh::triangulated::{Surface, rings_of_sphere};
use proboscis::model::system::{Body, Shape};
use std::f64::consts::{PI, TAU};
use std::fs;

pub(crate) type Vector = Vector3<f64>;
pub(crate) type Triangle = [Vector; 3];

/// The twelve triangles of a box, normals outwards.
pub(crate) fn cuboid(corner: [f64; 3], size: [f64; 3]) -> Vec<Triangle> {
    let at = |bits: usize| {
        Vector::from_fn(|axis, _| corner[axis] + size[axis] * f64::from((bits >> axis & 1) as u8))
    };
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let halves = |[a, b, c, d]: [usize; 4]| [[a, b, c], [a, c, d]];
    let triangles = faces.into_iter().flat_map(halves);
    triangles.map(|corners| corners.map(at)).collect()
}

/// A surface over a grid of two angles in turns, or of turns and height, of which both poles or both ends are closed.
fn revolved(around: usize, profile: &[[f64; 2]]) -> Vec<Triangle> {
    let at = |[radius, height]: [f64; 2], i: usize| {
        // The same bits where the circle closes.
        let (s, c) = (TAU * (i % around) as f64 / around as f64).sin_cos();
        match radius == 0.0 {
            true => Vector::new(0.0, 0.0, height),
            false => Vector::new(radius * c, radius * s, height),
        }
    };
    let mut triangles = Vec::new();
    for pair in profile.windows(2) {
        for i in 0..around {
            let [a, b] = [0, 1].map(|j| at(pair[0], i + j));
            let [c, d] = [0, 1].map(|j| at(pair[1], i + j));
            triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    triangles.retain(|[a, b, c]| a != b && b != c && c != a);
    triangles
}

/// A file of text with every digit.
pub(crate) fn text(triangles: &[Triangle]) -> String {
    let corner = |x: &Vector| format!("vertex {:e} {:e} {:e}\n", x.x, x.y, x.z);
    let triangle = |corners: &Triangle| {
        let corners: String = corners.iter().map(corner).collect();
        format!("facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n")
    };
    let all: String = triangles.iter().map(triangle).collect();
    format!("solid part\n{all}endsolid part\n")
}

/// A scene of a free body with these keys.
pub(crate) fn scene(keys: &str) -> String {
    format!(r#"{{ "name": "part", "bodies": [ {{ "name": "part", {keys}, "free": true }} ] }}"#)
}

fn read(keys: &str, bytes: &[u8]) -> Body {
    let (folder, _) = folder(&scene(keys), "{}");
    fs::write(folder.path().join("part.stl"), bytes).unwrap();
    let system = read_scene(&folder.path().join("scene.json"));
    system
        .unwrap_or_else(|error| panic!("{error}"))
        .bodies
        .remove(0)
}

pub(crate) const KEYS: &str =
    r#""density": "1000 kg/m^3", "mesh": { "file": "part.stl", "unit": "1 mm" }"#;

/// The tensor of inertia about the centre of mass and the axes of the ground frame.
fn tensor(body: &Body) -> Matrix3<f64> {
    body.directors * Matrix3::from_diagonal(&body.inertia.into()) * body.directors.transpose()
}

/// Volume that triangles enclose whose corners are counter-clockwise seen from outside.
fn volume(surface: &Surface) -> f64 {
    let corners = surface.corners();
    corners.map(|[a, b, c]| a.cross(&b).dot(&c) / 6.0).sum()
}

#[test]
fn shapes_are_drawn_with_their_faces_outwards() {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    // Away from the origin, so that each face counts.
    let centre = Vector3::new(3.0, -5.0, 7.0);
    let mut cuboid = Surface::default();
    cuboid.add_box(centre, &[axes[0], axes[1] * 2.0, axes[2] * 3.0]);
    assert!((volume(&cuboid) - 48.0).abs() < 1e-12);
    let mut cylinder = Surface::default();
    cylinder.add_rings(centre, axes, &[(-1.0, 2.0), (1.0, 2.0)]);
    let exact = PI * 8.0;
    let found = volume(&cylinder);
    assert!(0.95 * exact < found && found < exact, "{found} {exact}");
    let mut sphere = Surface::default();
    sphere.add_rings(centre, axes, &rings_of_sphere(2.0));
    let exact = PI * 32.0 / 3.0;
    let found = volume(&sphere);
    assert!(0.9 * exact < found && found < exact, "{found} {exact}");
}

#[test]
fn a_cube_is_exact() {
    let triangles = cuboid([5.0, -3.0, 2.5], [4.0, 4.0, 4.0]);
    let body = read(KEYS, text(&triangles).as_bytes());
    // 1000 kg/m³ = 1e-3 g/mm³.
    assert!((body.mass - 0.064).abs() < 1e-12 * 0.064, "{}", body.mass);
    assert!((body.centre - Vector::new(7.0, -1.0, 4.5)).norm() < 1e-12);
    let moment = 0.064 * 16.0 / 6.0;
    for found in body.inertia {
        assert!((found / moment - 1.0).abs() < 1e-12, "{found} {moment}");
    }
    assert_eq!(body.directors, Matrix3::identity());
}

/// A bracket of two boxes has products of inertia; the oracle is the theorem of Steiner.
#[test]
fn a_bracket_is_the_sum_of_its_boxes() {
    // An L in the plane of x and y, of 8 × 2 and 2 × 6, extruded by 3.
    let corners = [
        [0.0, 0.0],
        [8.0, 0.0],
        [8.0, 2.0],
        [2.0, 2.0],
        [2.0, 8.0],
        [0.0, 8.0],
    ];
    let at = |i: usize, z: f64| Vector::new(corners[i % 6][0], corners[i % 6][1], z);
    let mut triangles = Vec::new();
    for i in 0..6 {
        let (a, b, c, d) = (at(i, 0.0), at(i + 1, 0.0), at(i + 1, 3.0), at(i, 3.0));
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    // Both ends as fans about the inner corner, which sees all others.
    for i in [4, 5, 6, 7] {
        let (i, j) = (i % 6, (i + 1) % 6);
        triangles.push([at(3, 3.0), at(i, 3.0), at(j, 3.0)]);
        triangles.push([at(3, 0.0), at(j, 0.0), at(i, 0.0)]);
    }
    let keys = r#""mass": "66 g", "mesh": { "file": "part.stl", "unit": "1 mm", "at": ["10 mm", 0, "-5 mm"],
        "rotation": { "axis": [1, 2, -1], "angle": "40 deg" } }"#;
    let body = read(keys, text(&triangles).as_bytes());

    // Boxes of masses 48 g and 36 g over volumes 48 and 36 mm³, scaled to 66 g.
    let parts = [
        ([4.0, 1.0, 1.5], [8.0, 2.0, 3.0]),
        ([1.0, 5.0, 1.5], [2.0, 6.0, 3.0]),
    ];
    let volume = |size: &[f64; 3]| size.iter().product::<f64>();
    let density = 66.0 / parts.iter().map(|(_, size)| volume(size)).sum::<f64>();
    let parts = parts.map(|(centre, size)| (Vector::from(centre), density * volume(&size), size));
    let centre = parts.iter().map(|(c, m, _)| c * *m).sum::<Vector>() / 66.0;
    let mut expected = Matrix3::zeros();
    for (c, m, [a, b, h]) in parts {
        let own = Vector::new(b * b + h * h, a * a + h * h, a * a + b * b) * (m / 12.0);
        let r = c - centre;
        expected += Matrix3::from_diagonal(&own)
            + (Matrix3::identity() * r.norm_squared() - r * r.transpose()) * m;
    }
    assert!(expected[(0, 1)].abs() > 0.1 * expected[(0, 0)]);
    let axis = nalgebra::Unit::new_normalize(Vector::new(1.0, 2.0, -1.0));
    let turn = Rotation3::from_axis_angle(&axis, 40.0_f64.to_radians());
    let place = turn * centre + Vector::new(10.0, 0.0, -5.0);
    assert!((body.centre - place).norm() < 1e-12, "{}", body.centre);
    let expected = turn * expected * turn.inverse();
    let found = tensor(&body);
    assert!(
        (found - expected).norm() < 1e-12 * expected.norm(),
        "{found} {expected}"
    );
    assert!((body.directors.determinant() - 1.0).abs() < 1e-12);
    // The picture stands where the solid does.
    let mut surface = Surface::default();
    body.shape.add_to(&mut surface, &body.pose());
    let again = Body::within(surface).unwrap();
    assert!((again.centre - place).norm() < 1e-12);
}

/// Relative deviations of mass and moments from closed forms.
fn deviations(triangles: &[Triangle], volume: f64, moments: [f64; 3]) -> [f64; 4] {
    let body = read(KEYS, text(triangles).as_bytes());
    assert!(body.centre.norm() < 1e-5, "{}", body.centre);
    let found = tensor(&body).diagonal();
    let of = |i: usize| found[i] / (1e-3 * volume * moments[i]) - 1.0;
    [body.mass / (1e-3 * volume) - 1.0, of(0), of(1), of(2)]
}

/// Deviations of both grids are those of order two.
fn check_order(coarse: [f64; 4], fine: [f64; 4]) {
    for (coarse, fine) in coarse.into_iter().zip(fine) {
        assert!(
            coarse < -1e-3,
            "a solid within the sphere is smaller: {coarse}"
        );
        let ratio = coarse / fine;
        assert!((3.9..4.1).contains(&ratio), "{coarse} {fine}");
    }
}

#[test]
fn a_sphere_converges_with_order_two() {
    let radius = 10.0;
    let sphere = |n: usize| {
        let ring = |i: usize| {
            let (s, c) = (PI * i as f64 / n as f64).sin_cos();
            let poles = i == 0 || i == n;
            [if poles { 0.0 } else { radius * s }, -radius * c]
        };
        let profile: Vec<_> = (0..=n).map(ring).collect();
        let moment = 0.4 * radius * radius;
        let volume = 4.0 / 3.0 * PI * radius.powi(3);
        deviations(&revolved(2 * n, &profile), volume, [moment; 3])
    };
    check_order(sphere(16), sphere(32));
}

#[test]
fn a_cylinder_converges_with_order_two() {
    let (radius, length) = (4.0, 14.0);
    let cylinder = |n: usize| {
        let half = 0.5 * length;
        let profile = [[0.0, -half], [radius, -half], [radius, half], [0.0, half]];
        let across = (3.0 * radius * radius + length * length) / 12.0;
        let moments = [across, across, 0.5 * radius * radius];
        deviations(
            &revolved(n, &profile),
            PI * radius * radius * length,
            moments,
        )
    };
    check_order(cylinder(24), cylinder(48));
}

/// A cavity is a surface with its normals inwards.
#[test]
fn a_cavity_is_taken_away() {
    let mut triangles = cuboid([0.0; 3], [4.0; 3]);
    let inside = cuboid([1.0; 3], [1.0; 3]);
    triangles.extend(inside.iter().map(|&[a, b, c]| [a, c, b]));
    let body = read(KEYS, text(&triangles).as_bytes());
    assert!((body.mass - 0.063).abs() < 1e-14, "{}", body.mass);
    let centre = (64.0 * 2.0 - 1.5) / 63.0;
    assert!((body.centre - Vector::repeat(centre)).norm() < 1e-12);
}

#[test]
fn all_forms_of_a_file_are_one_surface() {
    let triangles = cuboid([0.0; 3], [2.0, 3.0, 5.0]);
    let written = text(&triangles);
    let plain = read(KEYS, written.as_bytes());
    let surface = stl::parse(written.clone().into_bytes(), "part.stl", 1.0).unwrap();
    assert_eq!((surface.vertices.len(), surface.triangles.len()), (8, 12));
    let binary = stl::bytes_of(&surface, 1.0);
    let mut titled = binary.clone();
    titled[..11].copy_from_slice(b"solid part\n");
    let (first, second) = triangles.split_at(7);
    let forms = [
        binary,
        titled,
        written.to_uppercase().into_bytes(),
        written.replace("solid part", "solid").into_bytes(),
        written.replace('\n', "\r\n\r\n").into_bytes(),
        format!("{}{}", text(first), text(second)).into_bytes(),
        // Zero has two signs.
        written.replace("vertex 0e0", "vertex -0e0").into_bytes(),
    ];
    for bytes in forms {
        assert_eq!(
            read(KEYS, &bytes),
            plain,
            "{}",
            String::from_utf8_lossy(&bytes)
        );
    }
}

/// Beside explicit moments a mesh is a picture: it may be open, and stays where it is.
#[test]
fn a_mesh_beside_moments_is_only_drawn() {
    let triangles = &cuboid([1.0, 2.0, 3.0], [4.0; 3])[..9];
    let keys = r#""mass": "2 g", "position": [0, "1 mm", 0], "inertia": [3e-9, 4e-9, 5e-9],
        "products_of_inertia": [1e-9, -5e-10, 2e-10], "mesh": { "file": "part.stl", "unit": "1 mm" }"#;
    let body = read(keys, text(triangles).as_bytes());
    assert_eq!((body.mass, body.centre), (2.0, Vector::new(0.0, 1.0, 0.0)));
    let expected = Matrix3::new(3.0, 1.0, -0.5, 1.0, 4.0, 0.2, -0.5, 0.2, 5.0);
    assert!(
        (tensor(&body) - expected).norm() < 1e-14,
        "{}",
        tensor(&body)
    );
    let mut surface = Surface::default();
    body.shape.add_to(&mut surface, &body.pose());
    let (lower, upper) = surface.bounds();
    assert!(
        (lower - Vector::new(1.0, 2.0, 3.0)).norm() < 1e-12,
        "{lower}"
    );
    assert!(
        (upper - Vector::new(5.0, 6.0, 7.0)).norm() < 1e-12,
        "{upper}"
    );
}

/// A shape keeps its frame where its axes are principal axes, and is a surface otherwise.
#[test]
fn shapes_beside_moments_stand_as_written() {
    let shape = r#""mass": "2 g", "position": [0, 0, 0], "box": { "size": ["2 mm", "4 mm", "6 mm"] }, "inertia": [3e-9, 4e-9, 5e-9]"#;
    let body = read(shape, b"");
    assert_eq!(
        body.shape,
        Shape::Box {
            size: [2.0, 4.0, 6.0]
        }
    );
    assert_eq!(body.inertia, [3.0, 4.0, 5.0]);
    let oblique = format!(r#"{shape}, "products_of_inertia": [1e-9, 0, 0]"#);
    let body = read(&oblique, b"");
    let mut surface = Surface::default();
    body.shape.add_to(&mut surface, &body.pose());
    let (lower, upper) = surface.bounds();
    assert!(matches!(body.shape, Shape::Surface(_)));
    assert!((upper - Vector::new(1.0, 2.0, 3.0)).norm() < 1e-12);
    assert!((upper + lower).norm() < 1e-12);
}

#[test]
fn a_density_gives_the_mass_of_any_shape() {
    let shapes = [
        (r#""box": { "size": ["2 mm", "4 mm", "6 mm"] }"#, 48.0),
        (r#""sphere": { "radius": "3 mm" }"#, 36.0 * PI),
        (
            r#""cylinder": { "radius": "3 mm", "length": "2 mm", "axis": [0, 1, 1] }"#,
            18.0 * PI,
        ),
    ];
    for (shape, volume) in shapes {
        let keys = |mass: &str| format!(r#"{mass}, "position": [0, 0, 0], {shape}"#);
        let body = read(&keys(r#""density": "2 g/cm^3""#), b"");
        assert!(
            (body.mass / (2e-3 * volume) - 1.0).abs() < 1e-14,
            "{}",
            body.mass
        );
        let by_mass = read(&keys(&format!(r#""mass": "{:?} g""#, body.mass)), b"");
        assert!((body.inertia[1] / by_mass.inertia[1] - 1.0).abs() < 1e-14);
    }
}
