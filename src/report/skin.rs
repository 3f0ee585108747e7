//! The surface of an elastic block on a sheet.

use nalgebra::Vector3;

use crate::report::canvas::{Canvas, CanvasPoint, Stroke};
use crate::report::skins::{Skin, normal};
use crate::report::style::{self, Colour};
use crate::report::view::View;

/// Width of the edges of elements as a part of their length, and at most in pt.
const EDGE: [f64; 2] = [0.02, 0.4];
/// Elements whose edges are shorter than this in pt are drawn without.
const FINEST: f64 = 2.0;
/// Part of the scale of colours that a patch of one colour may span, where faces are few.
const STEP: f64 = 0.03;
/// Most patches along a side of a face.
const PATCHES: usize = 12;
/// Maximum number of faces that are cut into patches.
const FEW: usize = 1000;

/// Colour of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Paint<'a> {
    /// The initial configuration: outlines on light grey.
    Reference,
    /// One colour.
    Even(Colour),
    /// Amounts of the potential at the corners in V, and the full scale of the colours.
    Potential {
        /// By corner.
        potentials: &'a [f64],
        /// Full scale in V.
        scale: f64,
    },
}

/// Draws the faces that look at the viewer, far ones first, lit from the upper left.
pub fn draw(
    canvas: &Canvas<'_>,
    view: &View,
    skin: &Skin,
    places: &[Vector3<f64>],
    paint: Paint<'_>,
) {
    let light = (view.toward + view.up * 0.9 - view.right * 0.7).normalize();
    let mut faces = Vec::new();
    for (quad, sharp) in skin.quads.iter().zip(&skin.sharp) {
        let corners = quad.map(|corner| places[corner]);
        let normal = normal(&corners);
        if normal.dot(&view.toward) > 0.0 {
            let depth = corners.iter().map(|corner| view.depth(corner)).sum::<f64>();
            faces.push((depth, quad, sharp, corners, normal.normalize()));
        }
    }
    faces.sort_by(|a, b| a.0.total_cmp(&b.0));
    let is_reference = paint == Paint::Reference;
    let few = faces.len() < FEW;
    for (_, quad, sharp, corners, normal) in faces {
        let strength = if is_reference { 0.12 } else { 0.34 };
        let shade = strength * (1.0 - normal.dot(&light).max(0.0));
        let sheet = corners.map(|corner| view.place(&corner));
        let patch = |corners: &[CanvasPoint; 4], colour: Colour| {
            let fill = colour.mix(style::INK, shade);
            canvas.fill(corners, fill, 1.0);
            // A seam between neighbours is painted over.
            canvas.outline(corners, Stroke::solid(fill, 0.3));
        };
        let middle = match paint {
            Paint::Reference => style::GRID,
            Paint::Even(colour) => colour,
            Paint::Potential { potentials, scale } => {
                let values = quad.map(|corner| potentials[corner] / scale);
                if few {
                    for (corners, value) in patches(&sheet, &values) {
                        patch(&corners, style::voltage(value));
                    }
                }
                style::voltage(values.iter().sum::<f64>() / 4.0)
            }
        };
        if !few || !matches!(paint, Paint::Potential { .. }) {
            patch(&sheet, middle);
        }
        let fill = middle.mix(style::INK, shade);
        for i in 0..4 {
            let next = (i + 1) % 4;
            // Its neighbour draws an edge within a surface the other way round.
            if !sharp[i] && quad[i] > quad[next] {
                continue;
            }
            let ends = [sheet[i], sheet[next]];
            if let Some(stroke) = edge(fill, sharp[i], length(ends), is_reference) {
                canvas.line(&ends, stroke);
            }
        }
    }
}

/// A face in parts between which a quantity changes little, with its value in the middle of each.
fn patches(corners: &[CanvasPoint; 4], values: &[f64; 4]) -> Vec<([CanvasPoint; 4], f64)> {
    let count = |a: [usize; 2], b: [usize; 2]| {
        let change = |[from, to]: [usize; 2]| (values[to] - values[from]).abs();
        let parts = (change(a).max(change(b)) / STEP).ceil();
        (parts as usize).clamp(1, PATCHES)
    };
    let counts = [count([0, 1], [3, 2]), count([0, 3], [1, 2])];
    // Bilinear between the corners.
    let weights = |u: f64, v: f64| [(1.0 - u) * (1.0 - v), u * (1.0 - v), u * v, (1.0 - u) * v];
    let place = |u: f64, v: f64| {
        let parts = || weights(u, v).into_iter().zip(corners);
        [0, 1].map(|i| parts().map(|(w, corner)| w * corner[i]).sum())
    };
    let part = |i: usize, j: usize| {
        let [m, n] = counts.map(|count| count as f64);
        let at = |a: f64, b: f64| [(i as f64 + a) / m, (j as f64 + b) / n];
        let ends = [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
        let [u, v] = at(0.5, 0.5);
        let value = weights(u, v).iter().zip(values).map(|(w, x)| w * x).sum();
        (ends.map(|[u, v]| place(u, v)), value)
    };
    let all = (0..counts[0]).flat_map(|i| (0..counts[1]).map(move |j| (i, j)));
    all.map(|(i, j)| part(i, j)).collect()
}

/// Returns the stroke of an edge: strong where it is the body's, faint where it is an element's.
fn edge(fill: Colour, is_sharp: bool, length: f64, is_reference: bool) -> Option<Stroke> {
    match (is_reference, is_sharp) {
        (true, true) => Some(Stroke::solid(style::REFERENCE, 0.6)),
        (true, false) => None,
        (false, true) => Some(Stroke::solid(fill.mix(style::INK, 0.55), 0.7)),
        (false, false) if length < FINEST => None,
        (false, false) => {
            let width = (EDGE[0] * length).min(EDGE[1]);
            Some(Stroke::solid(fill.mix(style::INK, 0.35), width).faint(0.6))
        }
    }
}

fn length([a, b]: [CanvasPoint; 2]) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}
