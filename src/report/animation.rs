//! The motion in space as a plotly figure: bodies as glass, muscles and blocks coloured by voltage, a slider over time.

use nalgebra::Vector3;
use serde_json::{Value, json};

use crate::model::system::Attachment;
use crate::report::Run;
use crate::report::markup::escape;
use crate::report::plotly::{AnimationFrame, Figure, Trace, layout, rgb};
use crate::report::pose::{ANGLES, lumped};
use crate::report::skins::{Skin, shown};
use crate::report::solids::{Prism, SurfaceMesh};
use crate::report::style::{self, Colour};
use crate::report::ties;
use crate::report::view::View;

/// Titles of the axes in space.
const TITLES: [&str; 3] = ["x [mm]", "y [mm]", "z [mm]"];
/// Shortest and longest time in ms that a frame stays.
const PACE: [f64; 2] = [40.0, 120.0];

/// The figure: a trace of bodies, one of muscles, one of joints, one of the blocks with potentials and one of those
/// without where there are any, then the marker paths.
pub fn figure(run: &Run<'_>) -> Figure {
    let last = run.trajectory.times.len().saturating_sub(1);
    let instants = match run.skins.list.is_empty() {
        true => shown(&run.trajectory.times, 0),
        false => run.skins.instants.clone(),
    };
    let highest = vec![run.skins.highest()];
    let scale = style::voltage_scale(run.trajectory.voltages.iter().chain([&highest])) / 1e3;
    let stage = Stage { run, scale };
    let kinds = [true, false].map(|is| run.skins.list.iter().any(|skin| skin.is_charged == is));
    let kinds = [true, false].into_iter().zip(kinds);
    let kinds: Vec<bool> = kinds.filter_map(|(is, any)| any.then_some(is)).collect();
    let moving = |k: usize, with_triangles: bool| {
        let mut traces = vec![stage.bodies(k), stage.muscles(k), stage.joints(k)];
        traces.extend(kinds.iter().map(|&is| stage.blocks(k, is, with_triangles)));
        traces.extend(stage.ties(k));
        traces
    };
    let has_ties = usize::from(run.system.components.iter().next().is_some());
    let frame = |&k: &usize| AnimationFrame {
        name: name(k),
        traces: (0..3 + kinds.len() + has_ties).collect(),
        data: moving(k, false),
    };
    let mut data = moving(last, true);
    if last > 0 {
        data.extend(stage.paths());
    }
    let mut look = json!({
        "margin": { "l": 0, "r": 0, "t": 0, "b": 10 },
        "scene": stage.scene(&instants),
        "legend": { "x": 0, "y": 0.98 },
    });
    // A state of rest has nothing to play.
    if instants.len() > 1 {
        let duration = run.trajectory.times.last().unwrap_or(&0.0);
        let pace = (duration / instants.len() as f64).clamp(PACE[0], PACE[1]);
        look["sliders"] = json!([stage.slider(&instants)]);
        look["updatemenus"] = json!([buttons(pace)]);
    }
    let frames = instants.iter().map(frame).collect();
    Figure::new(data, layout(look)).animated(frames)
}

fn name(k: usize) -> String {
    format!("instant {k}")
}

struct Stage<'a> {
    run: &'a Run<'a>,
    /// Full scale of the colours in kV.
    scale: f64,
}

impl Stage<'_> {
    fn bodies(&self, k: usize) -> Trace {
        let mut mesh = SurfaceMesh::default();
        for (body, pose) in self
            .run
            .system
            .bodies
            .iter()
            .zip(&self.run.trajectory.poses[k])
        {
            mesh.add_body(&body.shape, pose);
        }
        surface(
            &mesh,
            json!({ "name": "bodies", "color": rgb(style::BODY), "opacity": 0.22, "flatshading": false }),
        )
    }

    fn muscles(&self, k: usize) -> Trace {
        let trajectory = self.run.trajectory;
        let voltages = trajectory.voltages.get(k.saturating_sub(1));
        let mut mesh = SurfaceMesh::default();
        let mut intensity = Vec::new();
        for i in lumped(self.run.system) {
            mesh.add_prism(&Prism::muscle(self.run.system, trajectory, k, i));
            let kilovolts = voltages.map_or(0.0, |v| v[i].abs() / 1e3);
            intensity.resize(mesh.vertices.len(), (kilovolts * 1e4).round() / 1e4);
        }
        let look = self.by_voltage("muscles", !mesh.vertices.is_empty());
        Trace {
            intensity,
            ..surface(&mesh, look)
        }
    }

    /// A surface with colours by voltage in kV, with or without their bar.
    fn by_voltage(&self, name: &str, has_bar: bool) -> Value {
        let stops = (0..=6).map(|i| f64::from(i) / 6.0);
        let colours: Vec<Value> = stops.map(|s| json!([s, style::voltage(s).hex()])).collect();
        json!({
            "name": name,
            "intensitymode": "vertex",
            "colorscale": colours,
            "cmin": 0,
            "cmax": self.scale,
            "colorbar": { "title": { "text": "kV" }, "thickness": 14, "len": 260, "lenmode": "pixels" },
            "showscale": has_bar,
            "flatshading": true,
            "lighting": { "ambient": 0.75, "diffuse": 0.45, "specular": 0.1 },
        })
    }

    /// The blocks that have potentials, or those that have none; frames go without the triangles, which stay.
    fn blocks(&self, k: usize, is_charged: bool, with_triangles: bool) -> Trace {
        let skins = self.run.skins;
        let position = skins.position(k);
        let of_kind = |skin: &&Skin| skin.is_charged == is_charged;
        let (mut mesh, mut kilovolts) = (SurfaceMesh::default(), Vec::new());
        for skin in skins.list.iter().filter(of_kind) {
            let first = mesh.vertices.len();
            mesh.vertices.extend(&skin.places[position]);
            let volts = skin.potentials[position].iter();
            kilovolts.extend(volts.map(|v| (v * 10.0).round() / 1e4));
            if with_triangles {
                for quad in &skin.quads {
                    let [a, b, c, d] = quad.map(|corner| first + corner);
                    mesh.triangles.extend([[a, b, c], [a, c, d]]);
                }
            }
        }
        let look = match is_charged {
            true => self.by_voltage("blocks", lumped(self.run.system).next().is_none()),
            false => {
                json!({ "name": "passive blocks", "color": rgb(style::PASSIVE), "flatshading": true })
            }
        };
        Trace {
            intensity: if is_charged { kilovolts } else { Vec::new() },
            ..surface(&mesh, look)
        }
    }

    /// Lines from each joint to the centres of its bodies.
    fn joints(&self, k: usize) -> Trace {
        let poses = &self.run.trajectory.poses[k];
        let mut points = Vec::new();
        for joint in &self.run.system.joints {
            let held = Attachment {
                body: Some(joint.child),
                at: joint.at,
            };
            points.extend(joint.parent.map(|parent| poses[parent].centre));
            points.push(self.run.trajectory.point(k, &held, self.run.system));
            points.push(poses[joint.child].centre);
        }
        let look = json!({ "name": "joints", "showlegend": false, "hoverinfo": "skip" });
        line(&points, look, style::INK, 4, "solid")
    }

    /// Springs, tendons and other components; none where there are none.
    fn ties(&self, k: usize) -> Option<Trace> {
        let lines = ties::lines(self.run.system, self.run.trajectory, k);
        let gap = Vector3::repeat(f64::NAN);
        let points = lines
            .into_iter()
            .flat_map(|line| line.into_iter().chain([gap]));
        let points: Vec<_> = points.collect();
        let look = json!({ "name": "springs and tendons", "hoverinfo": "skip" });
        (!points.is_empty()).then(|| line(&points, look, style::TIE, 4, "solid"))
    }

    /// The path of each marker, of the motion and of the one beside it.
    fn paths(&self) -> Vec<Trace> {
        let run = self.run;
        let mut curves = vec![(run.name, run.trajectory, "solid", style::INK)];
        if let Some((name, trajectory)) = run.comparison {
            curves.push((name, trajectory, "dot", style::MUTED));
        }
        let mut traces = Vec::new();
        for (name, trajectory, dash, colour) in curves {
            for (m, marker) in run.system.markers.iter().enumerate() {
                let look = json!({ "name": escape(&format!("{}, {name}", marker.name)) });
                traces.push(line(&trajectory.path(m), look, colour, 3, dash));
            }
        }
        traces
    }

    /// Axes that stay while the motion runs, seen as in the figure of the configuration.
    fn scene(&self, instants: &[usize]) -> Value {
        let mut mesh = SurfaceMesh::default();
        for &k in instants {
            for (body, pose) in self
                .run
                .system
                .bodies
                .iter()
                .zip(&self.run.trajectory.poses[k])
            {
                mesh.add_body(&body.shape, pose);
            }
            for i in lumped(self.run.system) {
                mesh.add_prism(&Prism::muscle(self.run.system, self.run.trajectory, k, i));
            }
            let lines = ties::lines(self.run.system, self.run.trajectory, k);
            mesh.vertices.extend(lines.into_iter().flatten());
            let position = self.run.skins.position(k);
            for skin in &self.run.skins.list {
                mesh.vertices.extend(&skin.places[position]);
            }
        }
        let range = |i: usize| {
            let values = mesh.vertices.iter().map(|p| p[i]).filter(|x| x.is_finite());
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| {
                [a.min(x), b.max(x)]
            })
        };
        let ranges = [0, 1, 2].map(range);
        let widest = ranges.iter().map(|[low, high]| high - low);
        // A margin of 10 mm, less where all is small.
        let margin = (0.2 * widest.fold(0.0, f64::max)).min(10.0);
        let axis = |i: usize| {
            let [low, high] = ranges[i];
            let mut axis = json!({
                "title": { "text": TITLES[i] },
                "gridcolor": rgb(style::GRID),
                "zeroline": false,
            });
            if low <= high {
                axis["range"] = match margin < 10.0 {
                    true => json!([low - margin, high + margin]),
                    false => json!([(low - margin).floor(), (high + margin).ceil()]),
                };
            }
            axis
        };
        let toward = View::axonometric(ANGLES[0], ANGLES[1]).toward * 2.4;
        json!({
            "aspectmode": "data",
            "xaxis": axis(0),
            "yaxis": axis(1),
            "zaxis": axis(2),
            "camera": {
                "up": { "x": 0, "y": 1, "z": 0 },
                "eye": { "x": toward.x, "y": toward.y, "z": toward.z },
            },
        })
    }

    fn slider(&self, instants: &[usize]) -> Value {
        let step = |&k: &usize| {
            json!({
                "label": format!("{:.3}", self.run.trajectory.times[k] / 1e3),
                "method": "animate",
                "args": [[name(k)], at_once(0.0)],
            })
        };
        json!({
            "active": instants.len() - 1,
            "steps": instants.iter().map(step).collect::<Vec<_>>(),
            "x": 0.16,
            "len": 0.8,
            "pad": { "t": 20, "b": 10, "l": 0 },
            "currentvalue": { "prefix": "time ", "suffix": " s" },
        })
    }
}

/// How plotly changes to a frame: without a transition, `duration` ms for each.
fn at_once(duration: f64) -> Value {
    json!({
        "mode": "immediate",
        "fromcurrent": false,
        "frame": { "duration": duration, "redraw": true },
        "transition": { "duration": 0 },
    })
}

/// Play and pause.
fn buttons(pace: f64) -> Value {
    let button =
        |label: &str, args: Value| json!({ "label": label, "method": "animate", "args": args });
    let play = json!([null, at_once(pace.round())]);
    let pause = json!([[null], at_once(0.0)]);
    json!({
        "type": "buttons",
        "direction": "right",
        "showactive": false,
        "buttons": [button("play", play), button("pause", pause)],
        "pad": { "t": 45, "b": 0, "l": 10 },
        "x": 0,
        "xanchor": "left",
        "y": 0,
        "yanchor": "top",
    })
}

/// A surface; what does not say so otherwise answers nothing to the mouse.
fn surface(mesh: &SurfaceMesh, mut look: Value) -> Trace {
    look["type"] = "mesh3d".into();
    look["hoverinfo"] = "skip".into();
    let [x, y, z] = columns(&mesh.vertices);
    let corner = |i: usize| mesh.triangles.iter().map(|t| t[i]).collect();
    Trace {
        look,
        x,
        y,
        z,
        i: corner(0),
        j: corner(1),
        k: corner(2),
        ..Trace::default()
    }
}

fn line(points: &[Vector3<f64>], mut look: Value, colour: Colour, width: u32, dash: &str) -> Trace {
    look["type"] = "scatter3d".into();
    look["mode"] = "lines".into();
    look["line"] = json!({ "color": rgb(colour), "width": width, "dash": dash });
    let [x, y, z] = columns(points);
    Trace {
        look,
        x,
        y,
        z,
        ..Trace::default()
    }
}

/// Coordinates in mm to a thousandth, so that the page stays small.
fn columns(points: &[Vector3<f64>]) -> [Vec<f64>; 3] {
    let round = |x: f64| (x * 1e3).round() / 1e3;
    [0, 1, 2].map(|i| points.iter().map(|p| round(p[i])).collect())
}
