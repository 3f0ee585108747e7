//! The system in space: initial configuration in light grey, last instant coloured by the voltages that hold it.

use nalgebra::Vector3;

use crate::dynamics::trajectory::Trajectory;
use crate::model::system::{Attachment, Fidelity, Joint, System};
use crate::report::body::{Tint, draw_back, draw_front, extent_points};
use crate::report::canvas::{self, Canvas, CanvasPoint, Stroke};
use crate::report::colour_bar::colour_bar;
use crate::report::legend::{self, LegendSymbol};
use crate::report::origin::Origin;
use crate::report::skin::{self, Paint};
use crate::report::skins::{Skin, Skins};
use crate::report::solids::{Prism, circle, slice};
use crate::report::style::{self, Colour};
use crate::report::ties;
use crate::report::view::View;

/// Turn about y and elevation of the view in rad.
pub const ANGLES: [f64; 2] = [0.5, 0.32];
/// Most width and height of the drawing in pt.
const MOST: [f64; 2] = [400.0, 440.0];
/// Margin around the drawing in pt.
const MARGIN: f64 = 22.0;
/// Least width of the column with colour bar and names in pt.
const SIDE: f64 = 112.0;
/// Height of the colour bar with what is above and below it in pt.
const BAR: f64 = 154.0;
/// Lines across a muscle that hint at its layers.
const LAYERS: usize = 12;

/// `configuration.svg`: first and last instant in axonometric view with y upwards, muscles coloured by
/// the voltages that hold the last instant (V, one per muscle) or else by those of the last interval, blocks by the
/// potentials of the last interval, and the path of each marker.
///
/// Of a single instant blocks have their reference configuration behind them.
pub fn svg(
    system: &System,
    trajectory: &Trajectory,
    skins: &Skins,
    held: Option<&[f64]>,
    origin: &Origin,
) -> String {
    let last = trajectory.times.len().saturating_sub(1);
    let view = View::axonometric(ANGLES[0], ANGLES[1]);
    let ground = ground_plate(system);
    let mut points: Vec<_> = ground.clone();
    for k in [0, last] {
        for (body, pose) in system.bodies.iter().zip(&trajectory.poses[k]) {
            points.extend(extent_points(&body.shape, pose));
        }
        for i in lumped(system) {
            points.extend(Prism::muscle(system, trajectory, k, i).corners());
        }
        for skin in &skins.list {
            points.extend(&skin.places[skins.position(k)]);
        }
        points.extend(ties::lines(system, trajectory, k).into_iter().flatten());
    }
    if last == 0 {
        points.extend(skins.list.iter().flat_map(|skin| &skin.reference));
    }
    points.extend(trajectory.marks.iter().flatten());
    let (view, [width, height]) = view.fitted(&points, [MARGIN, MARGIN], MOST);
    let zero = vec![0.0; system.sources().len()];
    let last_voltages = held.map_or_else(
        || trajectory.voltages.last().cloned().unwrap_or(zero),
        <[f64]>::to_vec,
    );
    let highest = vec![skins.highest()];
    let scale = match held {
        Some(_) => style::voltage_scale([&last_voltages, &highest]),
        None => style::voltage_scale(trajectory.voltages.iter().chain([&highest])),
    };
    let is_charged = !system.muscles.is_empty() || skins.list.iter().any(|skin| skin.is_charged);
    let mut drawing = Drawing {
        system,
        trajectory,
        skins,
        view,
        voltages: last_voltages,
        is_held: held.is_some(),
        scale,
    };
    let names = drawing.names(last);
    let bar = if is_charged { BAR } else { 0.0 };
    let beside = bar + legend::ROW * names.len() as f64 + legend::TRIAD;
    let side = SIDE.max(legend::width(&names) + 22.0);
    let size = [
        width.max(120.0) + 2.0 * MARGIN + side,
        height.max(beside) + 2.0 * MARGIN,
    ];
    // What is flat stands in the middle.
    drawing.view.origin[1] += 0.5 * (size[1] - 2.0 * MARGIN - height);
    canvas::svg(size, origin, |canvas| {
        drawing.ground(canvas, &ground);
        if last > 0 {
            drawing.instant(canvas, 0, Tint::Reference);
        } else {
            for skin in &skins.list {
                drawing.skin(canvas, skin, &skin.reference, Tint::Reference);
            }
        }
        drawing.instant(canvas, last, Tint::Coloured);
        drawing.paths(canvas);
        let left = size[0] - side + 14.0;
        let top = MARGIN + 14.0;
        if is_charged {
            colour_bar(canvas, [left, top], scale);
        }
        legend::draw(canvas, [left, top + bar], &names);
        let corner = [left + 22.0, size[1] - MARGIN - 16.0];
        legend::triad(canvas, &drawing.view, corner);
    })
}

/// Muscles of one stretch, which are drawn as prisms; the others have surfaces.
pub(super) fn lumped(system: &System) -> impl Iterator<Item = usize> + '_ {
    let muscles = system.muscles.iter().enumerate();
    muscles.filter_map(|(i, m)| (m.fidelity == Fidelity::Lumped).then_some(i))
}

/// A disc in the ground below the points that are held by it, in mm; empty where nothing is.
fn ground_plate(system: &System) -> Vec<Vector3<f64>> {
    let muscles = system.muscles.iter().flat_map(|m| [m.from, m.to]);
    let components = system.components.iter().flat_map(|c| c.points());
    let joints = system.joints.iter().filter(|j| j.parent.is_none());
    let held: Vec<_> = muscles
        .chain(components)
        .filter(|point| point.body.is_none())
        .map(|point| point.at)
        .chain(joints.map(|j| j.at))
        .collect();
    if held.is_empty() {
        return vec![];
    }
    let centre = held.iter().sum::<Vector3<f64>>() / held.len() as f64;
    let lowest = held.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    let spread = held.iter().map(|p| (p - centre).xz().norm());
    let radius = 1.6 * spread.fold(0.0, f64::max) + 8.0;
    let middle = Vector3::new(centre.x, lowest, centre.z);
    circle(middle, Vector3::x(), Vector3::z(), radius)
}

/// What is drawn between the walls of the bodies.
enum Inside<'a> {
    Muscle(usize, Prism),
    Skin(&'a Skin, &'a [Vector3<f64>]),
}

impl Inside<'_> {
    fn centre(&self) -> Vector3<f64> {
        match self {
            Self::Muscle(_, prism) => prism.centre,
            Self::Skin(_, places) => places.iter().sum::<Vector3<f64>>() / places.len() as f64,
        }
    }
}

struct Drawing<'a> {
    system: &'a System,
    trajectory: &'a Trajectory,
    skins: &'a Skins,
    view: View,
    /// Voltages in V that colour the muscles.
    voltages: Vec<f64>,
    /// Whether these hold the last instant.
    is_held: bool,
    /// Full scale of the colours in V.
    scale: f64,
}

impl Drawing<'_> {
    fn ground(&self, canvas: &Canvas<'_>, plate: &[Vector3<f64>]) {
        let places = self.view.places(plate);
        let thickness = 4.0;
        let lower: Vec<CanvasPoint> = places.iter().map(|p| [p[0], p[1] + thickness]).collect();
        canvas.fill(&lower, style::REFERENCE.mix(style::INK, 0.25), 1.0);
        canvas.fill(&places, style::GRID, 1.0);
        canvas.outline(&places, Stroke::solid(style::REFERENCE, 0.6));
    }

    /// Bodies as glass around muscles and joints, what is far first.
    fn instant(&self, canvas: &Canvas<'_>, k: usize, tint: Tint) {
        let view = &self.view;
        let poses = &self.trajectory.poses[k];
        let mut bodies: Vec<_> = self.system.bodies.iter().zip(poses).collect();
        bodies.sort_by(|(_, a), (_, b)| view.depth(&a.centre).total_cmp(&view.depth(&b.centre)));
        for (body, pose) in &bodies {
            draw_back(canvas, view, &body.shape, pose, tint);
        }
        let prisms = lumped(self.system).map(|i| {
            let prism = Prism::muscle(self.system, self.trajectory, k, i);
            Inside::Muscle(i, prism)
        });
        let position = self.skins.position(k);
        let skins = self.skins.list.iter();
        let skins = skins.map(|skin| Inside::Skin(skin, &skin.places[position]));
        let mut inside: Vec<_> = prisms
            .chain(skins)
            .map(|inside| (inside.centre(), inside))
            .collect();
        inside.sort_by(|(a, _), (b, _)| view.depth(a).total_cmp(&view.depth(b)));
        let axis_depth = |centre: &Vector3<f64>| {
            let near = self.joint_places(k).into_iter().min_by(|a, b| {
                let distance = |p: &Vector3<f64>| (p - centre).norm();
                distance(a).total_cmp(&distance(b))
            });
            near.map_or(f64::NEG_INFINITY, |joint| view.depth(&joint))
        };
        let (behind, before): (Vec<_>, Vec<_>) = inside
            .into_iter()
            .partition(|(centre, _)| view.depth(centre) < axis_depth(centre));
        let draw = |inside: &Inside<'_>| match inside {
            Inside::Muscle(i, prism) => self.muscle(canvas, prism, self.colour(*i, tint)),
            Inside::Skin(skin, places) => self.skin(canvas, skin, places, tint),
        };
        behind.iter().for_each(|(_, inside)| draw(inside));
        self.joints(canvas, k, tint);
        self.ties(canvas, k, tint);
        before.iter().for_each(|(_, inside)| draw(inside));
        for (body, pose) in &bodies {
            draw_front(canvas, view, &body.shape, pose, tint);
        }
    }

    /// Colour of a muscle by its voltage.
    fn colour(&self, muscle: usize, tint: Tint) -> Colour {
        match tint {
            Tint::Reference => style::GRID,
            Tint::Coloured => style::voltage(self.voltages[muscle].abs() / self.scale),
        }
    }

    /// The surface of a block, coloured as at the last instant: by its potentials, of a muscle by its voltage.
    fn skin(&self, canvas: &Canvas<'_>, skin: &Skin, places: &[Vector3<f64>], tint: Tint) {
        let paint = match (skin.muscle, skin.potentials.last()) {
            (_, _) if tint == Tint::Reference => Paint::Reference,
            (Some(muscle), _) => Paint::Even(self.colour(muscle, tint)),
            (None, Some(potentials)) if skin.is_charged => Paint::Potential {
                potentials,
                scale: self.scale,
            },
            _ => Paint::Even(style::PASSIVE),
        };
        skin::draw(canvas, &self.view, skin, places, paint);
    }

    /// The faces that look at the viewer, lit from the upper left, with lines that hint at the layers.
    fn muscle(&self, canvas: &Canvas<'_>, prism: &Prism, colour: Colour) {
        let view = &self.view;
        let light = (view.toward + view.up * 0.9 - view.right * 0.7).normalize();
        let edge = colour.mix(style::INK, 0.35);
        for face in prism.faces() {
            let normal = face.normal.normalize();
            if normal.dot(&view.toward) <= 0.0 {
                continue;
            }
            let shade = 0.34 * (1.0 - normal.dot(&light).max(0.0));
            let places = view.places(&face.corners);
            canvas.fill(&places, colour.mix(style::INK, shade), 1.0);
            let is_side = normal.dot(&prism.halves[2]).abs() < 0.5 * prism.halves[2].norm();
            if is_side {
                for layer in 1..LAYERS {
                    let height = 2.0 * layer as f64 / LAYERS as f64 - 1.0;
                    let across = slice(&face.corners, &prism.halves[2], prism.centre, height);
                    let line = Stroke::solid(edge, 0.35).faint(0.55);
                    canvas.line(&view.places(&across), line);
                }
            }
            canvas.outline(&places, Stroke::solid(edge, 0.5));
        }
    }

    fn joint_places(&self, k: usize) -> Vec<Vector3<f64>> {
        let reference = |j: &Joint| Attachment {
            body: Some(j.child),
            at: j.at,
        };
        let joints = self.system.joints.iter();
        joints
            .map(|j| self.trajectory.point(k, &reference(j), self.system))
            .collect()
    }

    /// A line through the joints of each body, and a disc at each joint.
    fn joints(&self, canvas: &Canvas<'_>, k: usize, tint: Tint) {
        let ink = match tint {
            Tint::Reference => style::REFERENCE,
            Tint::Coloured => style::INK.mix(style::PAPER, 0.25),
        };
        let places = self.view.places(&self.joint_places(k));
        for (joint, place) in self.system.joints.iter().zip(&places) {
            let centre = self.trajectory.poses[k][joint.child].centre;
            canvas.line(&[*place, self.view.place(&centre)], Stroke::solid(ink, 1.1));
            if let Some(parent) = joint.parent {
                let centre = self.trajectory.poses[k][parent].centre;
                canvas.line(&[*place, self.view.place(&centre)], Stroke::solid(ink, 1.1));
            }
        }
        for place in places {
            canvas.disc(place, 2.6, style::PAPER, Stroke::solid(ink, 1.1));
        }
    }

    /// Springs, tendons and other components.
    fn ties(&self, canvas: &Canvas<'_>, k: usize, tint: Tint) {
        let ink = match tint {
            Tint::Reference => style::REFERENCE,
            Tint::Coloured => style::TIE,
        };
        for line in ties::lines(self.system, self.trajectory, k) {
            canvas.line(&self.view.places(&line), Stroke::solid(ink, 1.0));
        }
    }

    fn paths(&self, canvas: &Canvas<'_>) {
        let rim = Stroke::solid(style::INK, 1.1);
        for marker in 0..self.system.markers.len() {
            let places = self.view.places(&self.trajectory.path(marker));
            canvas.line(&places, rim);
            match places[..] {
                [first, .., last] => {
                    canvas.disc(first, 2.8, style::PAPER, rim);
                    canvas.disc(last, 2.4, style::INK, rim);
                }
                [only] => canvas.disc(only, 2.4, style::INK, rim),
                _ => {}
            }
        }
    }

    /// What the drawn things are.
    fn names(&self, last: usize) -> Vec<(String, LegendSymbol)> {
        let time = |k: usize| {
            let seconds = format!("{:.3}", self.trajectory.times[k] / 1e3);
            format!("{} s", seconds.trim_end_matches('0').trim_end_matches('.'))
        };
        let has_blocks = !self.skins.list.is_empty();
        let of_blocks = self.system.bodies.is_empty() && has_blocks;
        let now = match self.skins.list.first() {
            Some(skin) if of_blocks && skin.is_charged => style::voltage(0.5),
            Some(_) if of_blocks => style::PASSIVE.mix(style::INK, 0.25),
            _ => style::BODY,
        };
        let mut rows = vec![];
        match last {
            0 => {
                if has_blocks {
                    rows.push((
                        "reference".to_owned(),
                        LegendSymbol::Swatch(style::REFERENCE),
                    ));
                }
                rows.push(("at rest".to_owned(), LegendSymbol::Swatch(now)));
            }
            _ => {
                let first = format!("at {}", time(0));
                rows.push((first, LegendSymbol::Swatch(style::REFERENCE)));
                let held = if self.is_held { ", held" } else { "" };
                let end = format!("at {}{held}", time(last));
                rows.push((end, LegendSymbol::Swatch(now)));
            }
        }
        for marker in self.system.markers.iter().take(3) {
            rows.push(match last {
                0 => (marker.name.clone(), LegendSymbol::Place),
                _ => (format!("path of {}", marker.name), LegendSymbol::Path),
            });
        }
        rows
    }
}
