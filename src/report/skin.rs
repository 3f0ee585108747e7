//! The surface of an elastic block on a sheet.

use nalgebra::Vector3;

use crate::report::body::Tint;
use crate::report::canvas::{Canvas, Place, Stroke};
use crate::report::skins::{Skin, normal};
use crate::report::style::{self, Colour};
use crate::report::view::View;

/// Width of the edges of elements as a part of their length, and at most in pt.
const EDGE: [f64; 2] = [0.02, 0.4];
/// Elements whose edges are shorter than this in pt are drawn without.
const FINEST: f64 = 2.0;

/// Draws the faces that look at the viewer, far ones first, lit from the upper left.
///
/// `colour` gives the colour of a face by its corners; a ghost has its own.
pub fn draw(
    canvas: &Canvas<'_>,
    view: &View,
    skin: &Skin,
    places: &[Vector3<f64>],
    tint: Tint,
    colour: impl Fn(&[usize; 4]) -> Colour,
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
    for (_, quad, sharp, corners, normal) in faces {
        let strength = match tint {
            Tint::Ghost => 0.12,
            Tint::Coloured => 0.34,
        };
        let colour = match tint {
            Tint::Ghost => style::GRID,
            Tint::Coloured => colour(quad),
        };
        let shade = strength * (1.0 - normal.dot(&light).max(0.0));
        let fill = colour.mix(style::INK, shade);
        let sheet = corners.map(|corner| view.place(&corner));
        canvas.fill(&sheet, fill, 1.0);
        // A seam between neighbours is painted over.
        canvas.outline(&sheet, Stroke::solid(fill, 0.3));
        for i in 0..4 {
            let ends = [sheet[i], sheet[(i + 1) % 4]];
            if let Some(stroke) = edge(fill, sharp[i], length(ends), tint) {
                canvas.line(&ends, stroke);
            }
        }
    }
}

/// How an edge is drawn: strong where it is the body's, faint where it is an element's.
fn edge(fill: Colour, is_sharp: bool, length: f64, tint: Tint) -> Option<Stroke> {
    match (tint, is_sharp) {
        (Tint::Ghost, true) => Some(Stroke::solid(style::GHOST, 0.6)),
        (Tint::Ghost, false) => None,
        (Tint::Coloured, true) => Some(Stroke::solid(fill.mix(style::INK, 0.55), 0.7)),
        (Tint::Coloured, false) if length < FINEST => None,
        (Tint::Coloured, false) => {
            let width = (EDGE[0] * length).min(EDGE[1]);
            Some(Stroke::solid(fill.mix(style::INK, 0.35), width).faint(0.6))
        }
    }
}

fn length([a, b]: [Place; 2]) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}
