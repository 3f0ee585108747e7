//! Conversion of a place of a block in a scene file to its nodes: a face, a plane, or a box.

use nalgebra::Vector3;

use crate::files::json::scope::{Result, Scope, list, refuse, the_one};
use crate::files::scene::point::{CornersSpec, vector};
use crate::files::scene::spec_solids::PlaneSpec;
use crate::mesh::Mesh;

/// Nodes this far from a plane lie in it, as a share of the diagonal of the mesh.
const IN_PLANE: f64 = 1e-6;

/// Planes of nodes that a message names.
const NAMED_PLANES: usize = 9;

/// Names of the coordinates.
pub(crate) const AXES: [&str; 3] = ["x", "y", "z"];

/// The nodes of exactly one of `face`, `plane` and `box` of what is written, ascending; `owner` is what lies there, for messages.
macro_rules! nodes {
    ($owner:expr, $spec:expr, $mesh:expr, $scope:expr) => {
        $crate::files::json::scope::the_one!($scope, $spec;
            "face" face |at, name| $crate::files::scene::nodes::face(name, $mesh, at)?.to_vec();
            "plane" plane |at, plane| $crate::files::scene::nodes::nodes_in_plane($owner, plane, $mesh, at)?;
            "box" cuboid |at, corners| $crate::files::scene::nodes::nodes_in_box($owner, corners, $mesh, at)?;
        )
    };
}
pub(crate) use nodes;

/// The nodes of a face or set whose name stands at `scope`.
pub(crate) fn face<'a>(name: &str, mesh: &'a Mesh, scope: &Scope<'_>) -> Result<&'a [usize]> {
    let names: Vec<String> = mesh.sets.keys().cloned().collect();
    let expected = match names.as_slice() {
        [] => "a mesh with named faces".to_owned(),
        names => format!("the name of a face: one of {}", list(names.iter())),
    };
    let index = scope.find(name, &names, &expected)?;
    let nodes = &mesh.sets[&names[index]];
    refuse!(if nodes.is_empty(), scope;
        found format!("{name:?}, which holds no node"), expected "a face with nodes");
    Ok(nodes)
}

pub(crate) fn nodes_in_plane(
    owner: &str,
    plane: &PlaneSpec,
    mesh: &Mesh,
    scope: &Scope<'_>,
) -> Result<Vec<usize>> {
    let (axis, at) = the_one!(scope, plane;
        "x" x |_, at| (0, at.value());
        "y" y |_, at| (1, at.value());
        "z" z |_, at| (2, at.value());
    );
    let nodes = in_plane(mesh, axis, at);
    refuse!(if nodes.is_empty(), scope.key(AXES[axis]);
        found format!("{owner} in the plane {} = {at} mm, which holds no node", AXES[axis]),
        expected planes_near(mesh, axis, at));
    Ok(nodes)
}

/// The nodes of a plane at right angles to an axis.
pub(crate) fn in_plane(mesh: &Mesh, axis: usize, at: f64) -> Vec<usize> {
    let within = tolerance(mesh);
    let is_in = |node: &usize| (mesh.nodes[*node][axis] - at).abs() <= within;
    (0..mesh.nodes.len()).filter(is_in).collect()
}

/// Planes with nodes near one without any, for messages.
pub(crate) fn planes_near(mesh: &Mesh, axis: usize, at: f64) -> String {
    let within = tolerance(mesh);
    let mut levels: Vec<f64> = mesh.nodes.iter().map(|node| node[axis]).collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup_by(|a, b| (*a - *b).abs() <= within);
    let nearest = levels.partition_point(|&level| level < at);
    let first = nearest.saturating_sub(NAMED_PLANES / 2);
    let first = first.min(levels.len().saturating_sub(NAMED_PLANES));
    let shown = levels.iter().skip(first).take(NAMED_PLANES);
    let shown: Vec<String> = shown.map(f64::to_string).collect();
    let before = if first > 0 { "…, " } else { "" };
    let after = if first + NAMED_PLANES < levels.len() {
        ", …"
    } else {
        ""
    };
    let (axis, shown) = (AXES[axis], shown.join(", "));
    format!("a plane with nodes: the mesh has some at {axis} = {before}{shown}{after} mm")
}

pub(crate) fn nodes_in_box(
    owner: &str,
    corners: &CornersSpec,
    mesh: &Mesh,
    scope: &Scope<'_>,
) -> Result<Vec<usize>> {
    let margin = Vector3::repeat(tolerance(mesh));
    let (low, high) = (vector(&corners.min) - margin, vector(&corners.max) + margin);
    let is_in = |node: &usize| {
        let at = &mesh.nodes[*node];
        (0..3).all(|axis| low[axis] <= at[axis] && at[axis] <= high[axis])
    };
    let nodes: Vec<usize> = (0..mesh.nodes.len()).filter(is_in).collect();
    let [from, to] = extent(mesh).map(|corner| place(&corner));
    refuse!(if nodes.is_empty(), scope;
        found format!("{owner} in a box that holds no node"),
        expected format!("a box with nodes: those of the mesh lie from {from} to {to}"));
    Ok(nodes)
}

/// Returns the distance from a plane in mm up to which a node counts as in it.
fn tolerance(mesh: &Mesh) -> f64 {
    let [low, high] = extent(mesh);
    IN_PLANE * (high - low).norm()
}

/// The lowest and the highest coordinates of the nodes in mm.
pub(crate) fn extent(mesh: &Mesh) -> [Vector3<f64>; 2] {
    let none = [
        Vector3::repeat(f64::INFINITY),
        Vector3::repeat(f64::NEG_INFINITY),
    ];
    let nodes = mesh.nodes.iter();
    nodes.fold(none, |[low, high], node| [low.inf(node), high.sup(node)])
}

/// A place in mm, for messages.
pub(crate) fn place(at: &Vector3<f64>) -> String {
    format!("({}, {}, {}) mm", at.x, at.y, at.z)
}
