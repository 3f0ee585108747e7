//! The motion in space as a plotly figure: bodies as glass, muscles and blocks coloured by voltage, a slider over time.

use nalgebra::Vector3;
use plotly::common::{
    Anchor, ColorBar, ColorScale, ColorScaleElement, DashType, HoverInfo, Line, Marker, Mode, Pad,
};
use plotly::layout::update_menu::{ButtonBuilder, UpdateMenu, UpdateMenuDirection, UpdateMenuType};
use plotly::layout::{
    Animation, AnimationMode, AnimationOptions, AspectMode, Axis, Camera, Frame, FrameSettings,
    LayoutScene, Legend, Margin, Slider, SliderCurrentValue, SliderStepBuilder, TransitionSettings,
};
use plotly::traces::mesh3d::{IntensityMode, Lighting, Mesh3D};
use plotly::{Configuration, Plot, Scatter3D, Traces};

use crate::model::system::Attachment;
use crate::report::page::{escape, layout, rgb};
use crate::report::pose::{ANGLES, lumped};
use crate::report::skins::{Skin, shown};
use crate::report::solids::{Mesh, Prism};
use crate::report::view::View;
use crate::report::{Run, style};

/// Shortest and longest time in ms that a frame stays.
const PACE: [f64; 2] = [40.0, 120.0];
/// Why building a button or a step of the slider cannot fail.
const COMPLETE: &str = "an animation step needs no more than its frame";

/// The figure: a trace of bodies, one of muscles, one of joints, one of the blocks with potentials and one of those
/// without where there are any, then the marker paths.
pub fn plot(run: &Run<'_>) -> Plot {
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
    let mut plot = Plot::new();
    plot.add_trace(stage.bodies(last));
    plot.add_trace(stage.muscles(last));
    plot.add_trace(stage.joints(last));
    for &is_charged in &kinds {
        plot.add_trace(stage.blocks(last, is_charged, true));
    }
    if last > 0 {
        stage.add_paths(&mut plot);
    }
    for &k in &instants {
        let mut data = Traces::new();
        data.push(stage.bodies(k));
        data.push(stage.muscles(k));
        data.push(stage.joints(k));
        for &is_charged in &kinds {
            data.push(stage.blocks(k, is_charged, false));
        }
        let traces = (0..3 + kinds.len()).collect();
        let frame = Frame::new().name(name(k)).traces(traces);
        plot.add_frame(frame.data(data));
    }
    let duration = run.trajectory.times.last().unwrap_or(&0.0);
    let pace = (duration / instants.len() as f64).clamp(PACE[0], PACE[1]);
    let still = layout()
        .margin(Margin::new().left(0).right(0).top(0).bottom(10))
        .scene(stage.scene(&instants))
        .legend(Legend::new().x(0.0).y(0.98));
    // A state of rest has nothing to play.
    plot.set_layout(match instants.len() {
        0 | 1 => still,
        _ => still
            .sliders(vec![stage.slider(&instants)])
            .update_menus(vec![buttons(pace as usize)]),
    });
    plot.set_configuration(Configuration::new().responsive(true).display_logo(false));
    plot
}

type Surface = Mesh3D<f64, f64, f64>;

fn name(k: usize) -> String {
    format!("instant {k}")
}

struct Stage<'a> {
    run: &'a Run<'a>,
    /// Full scale of the colours in kV.
    scale: f64,
}

impl Stage<'_> {
    fn bodies(&self, k: usize) -> Box<Surface> {
        let mut mesh = Mesh::default();
        for (body, pose) in self
            .run
            .system
            .bodies
            .iter()
            .zip(&self.run.trajectory.poses[k])
        {
            mesh.add_body(&body.shape, pose);
        }
        surface(&mesh)
            .name("bodies")
            .color(rgb(style::BODY))
            .opacity(0.22)
            .flat_shading(false)
            .hover_info(HoverInfo::Skip)
    }

    fn muscles(&self, k: usize) -> Box<Surface> {
        let trajectory = self.run.trajectory;
        let voltages = trajectory.voltages.get(k.saturating_sub(1));
        let mut mesh = Mesh::default();
        let mut intensity = Vec::new();
        for i in lumped(self.run.system) {
            mesh.add_prism(&Prism::muscle(self.run.system, trajectory, k, i));
            let kilovolts = voltages.map_or(0.0, |v| v[i].abs() / 1e3);
            intensity.resize(mesh.vertices.len(), (kilovolts * 1e4).round() / 1e4);
        }
        self.by_voltage(surface(&mesh), intensity)
            .name("muscles")
            .show_scale(!mesh.vertices.is_empty())
    }

    /// A surface with colours by voltage in kV.
    fn by_voltage(&self, mesh: Box<Surface>, kilovolts: Vec<f64>) -> Box<Surface> {
        let stops = (0..=6).map(|i| f64::from(i) / 6.0);
        let colours = stops.map(|s| ColorScaleElement(s, style::voltage(s).hex()));
        mesh.intensity(kilovolts)
            .intensity_mode(IntensityMode::Vertex)
            .color_scale(ColorScale::Vector(colours.collect()))
            .c_min(0.0)
            .c_max(self.scale)
            .color_bar(
                ColorBar::new()
                    .title("kV")
                    .thickness(14)
                    .len(260)
                    .len_mode(plotly::common::ThicknessMode::Pixels),
            )
            .flat_shading(true)
            .lighting(Lighting::new().ambient(0.75).diffuse(0.45).specular(0.1))
            .hover_info(HoverInfo::Skip)
    }

    /// The blocks that have potentials, or those that have none; frames go without the triangles, which stay.
    fn blocks(&self, k: usize, is_charged: bool, with_triangles: bool) -> Box<Surface> {
        let skins = self.run.skins;
        let position = skins.position(k);
        let of_kind = |skin: &&Skin| skin.is_charged == is_charged;
        let (mut mesh, mut kilovolts) = (Mesh::default(), Vec::new());
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
        let surface = match with_triangles {
            true => surface(&mesh),
            false => {
                let [x, y, z] = columns(&mesh.vertices);
                Mesh3D::new(x, y, z, None, None, None)
            }
        };
        if is_charged {
            let has_bar = lumped(self.run.system).next().is_none();
            self.by_voltage(surface, kilovolts)
                .name("blocks")
                .show_scale(has_bar)
        } else {
            surface
                .name("passive blocks")
                .color(rgb(style::PASSIVE))
                .flat_shading(true)
                .hover_info(HoverInfo::Skip)
        }
    }

    /// Lines from each joint to the centres of its bodies.
    fn joints(&self, k: usize) -> Box<Scatter3D<f64, f64, f64>> {
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
        let [x, y, z] = columns(&points);
        Scatter3D::new(x, y, z)
            .name("joints")
            .mode(Mode::Lines)
            .line(Line::new().color(rgb(style::INK)).width(4.0))
            .hover_info(HoverInfo::Skip)
            .show_legend(false)
    }

    fn add_paths(&self, plot: &mut Plot) {
        let mut curves = vec![(
            self.run.name,
            self.run.trajectory,
            DashType::Solid,
            style::INK,
        )];
        if let Some((name, trajectory)) = self.run.comparison {
            curves.push((name, trajectory, DashType::Dot, style::MUTED));
        }
        for (name, trajectory, dash, colour) in curves {
            for (m, marker) in self.run.system.markers.iter().enumerate() {
                let [x, y, z] = columns(&trajectory.path(m));
                let line = Line::new().color(rgb(colour)).width(3.0).dash(dash.clone());
                let trace = Scatter3D::new(x, y, z)
                    .name(escape(&format!("{}, {name}", marker.name)))
                    .mode(Mode::Lines)
                    .marker(Marker::new().size(2))
                    .line(line);
                plot.add_trace(trace);
            }
        }
    }

    /// Axes that stay while the motion runs, seen as in the figure of the configuration.
    fn scene(&self, instants: &[usize]) -> LayoutScene {
        let mut mesh = Mesh::default();
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
            let axis = Axis::new()
                .title(["x [mm]", "y [mm]", "z [mm]"][i])
                .grid_color(rgb(style::GRID))
                .zero_line(false);
            if low > high {
                return axis;
            }
            if margin < 10.0 {
                return axis.range(vec![low - margin, high + margin]);
            }
            axis.range(vec![(low - margin).floor(), (high + margin).ceil()])
        };
        let toward = View::axonometric(ANGLES[0], ANGLES[1]).toward * 2.1;
        LayoutScene::new()
            .aspect_mode(AspectMode::Data)
            .x_axis(axis(0))
            .y_axis(axis(1))
            .z_axis(axis(2))
            .camera(
                Camera::new()
                    .up((0.0, 1.0, 0.0).into())
                    .eye((toward.x, toward.y, toward.z).into()),
            )
    }

    fn slider(&self, instants: &[usize]) -> Slider {
        let steps = instants.iter().map(|&k| {
            let options = AnimationOptions::new()
                .mode(AnimationMode::Immediate)
                .frame(FrameSettings::new().duration(0).redraw(true))
                .transition(TransitionSettings::new().duration(0));
            SliderStepBuilder::new()
                .label(format!("{:.3}", self.run.trajectory.times[k] / 1e3))
                .animation(Animation::frames(vec![name(k)]).options(options))
                .build()
                .expect(COMPLETE)
        });
        Slider::new()
            .active(instants.len() as i32 - 1)
            .steps(steps.collect())
            .x(0.16)
            .length(0.8)
            .pad(Pad::new(20, 10, 0))
            .current_value(SliderCurrentValue::new().prefix("time ").suffix(" s"))
    }
}

/// Play and pause.
fn buttons(pace: usize) -> UpdateMenu {
    let options = AnimationOptions::new()
        .mode(AnimationMode::Immediate)
        .fromcurrent(false)
        .frame(FrameSettings::new().duration(pace).redraw(true))
        .transition(TransitionSettings::new().duration(0));
    let play = Animation::all_frames().options(options);
    let buttons = [("play", play), ("pause", Animation::pause())];
    let buttons = buttons.map(|(label, animation)| {
        let button = ButtonBuilder::new().label(label).animation(animation);
        button.build().expect(COMPLETE)
    });
    UpdateMenu::new()
        .ty(UpdateMenuType::Buttons)
        .direction(UpdateMenuDirection::Right)
        .show_active(false)
        .buttons(buttons.to_vec())
        .pad(Pad::new(45, 0, 10))
        .x(0.0)
        .x_anchor(Anchor::Left)
        .y(0.0)
        .y_anchor(Anchor::Top)
}

fn surface(mesh: &Mesh) -> Box<Surface> {
    let [x, y, z] = columns(&mesh.vertices);
    let corner = |i: usize| Some(mesh.triangles.iter().map(|t| t[i]).collect());
    Mesh3D::new(x, y, z, corner(0), corner(1), corner(2))
}

/// Coordinates in mm to a thousandth, so that the page stays small.
fn columns(points: &[Vector3<f64>]) -> [Vec<f64>; 3] {
    let round = |x: f64| (x * 1e3).round() / 1e3;
    [0, 1, 2].map(|i| points.iter().map(|p| round(p[i])).collect())
}
