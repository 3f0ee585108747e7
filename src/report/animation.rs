//! The motion in space as a plotly figure: bodies as glass, muscles coloured by voltage, a slider over time.

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
use crate::report::pose::ANGLES;
use crate::report::solids::{Mesh, Prism};
use crate::report::view::View;
use crate::report::{Run, style, tip_path};

/// Most frames of the animation; a longer motion is shown at evenly spread instants.
const FRAMES: usize = 80;
/// Shortest and longest time in ms that a frame stays.
const PACE: [f64; 2] = [40.0, 120.0];
/// Why building a button or a step of the slider cannot fail.
const COMPLETE: &str = "an animation step needs no more than its frame";

/// The figure: a trace of bodies, one of muscles, one of joints, then the marker paths.
pub fn plot(run: &Run<'_>) -> Plot {
    let last = run.trajectory.times.len().saturating_sub(1);
    let stride = last.div_ceil(FRAMES).max(1);
    let mut instants: Vec<_> = (0..=last).step_by(stride).collect();
    if instants.last() != Some(&last) {
        instants.push(last);
    }
    let scale = style::voltage_scale(&run.trajectory.voltages) / 1e3;
    let stage = Stage { run, scale };
    let mut plot = Plot::new();
    plot.add_trace(stage.bodies(last));
    plot.add_trace(stage.muscles(last));
    plot.add_trace(stage.joints(last));
    stage.add_paths(&mut plot);
    for &k in &instants {
        let mut data = Traces::new();
        data.push(stage.bodies(k));
        data.push(stage.muscles(k));
        data.push(stage.joints(k));
        let frame = Frame::new().name(name(k)).traces(vec![0, 1, 2]);
        plot.add_frame(frame.data(data));
    }
    let duration = run.trajectory.times.last().unwrap_or(&0.0);
    let pace = (duration / instants.len() as f64).clamp(PACE[0], PACE[1]);
    plot.set_layout(
        layout()
            .margin(Margin::new().left(0).right(0).top(0).bottom(10))
            .scene(stage.scene(&instants))
            .legend(Legend::new().x(0.0).y(0.98))
            .sliders(vec![stage.slider(&instants)])
            .update_menus(vec![buttons(pace as usize)]),
    );
    plot.set_configuration(Configuration::new().responsive(true).display_logo(false));
    plot
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
    fn bodies(&self, k: usize) -> Box<Mesh3D<f64, f64, f64>> {
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

    fn muscles(&self, k: usize) -> Box<Mesh3D<f64, f64, f64>> {
        let trajectory = self.run.trajectory;
        let voltages = trajectory.voltages.get(k.saturating_sub(1));
        let mut mesh = Mesh::default();
        let mut intensity = Vec::new();
        for i in 0..self.run.system.muscles.len() {
            mesh.add_prism(&Prism::muscle(self.run.system, trajectory, k, i));
            let kilovolts = voltages.map_or(0.0, |v| v[i].abs() / 1e3);
            intensity.resize(mesh.vertices.len(), (kilovolts * 1e4).round() / 1e4);
        }
        let stops = (0..=6).map(|i| f64::from(i) / 6.0);
        let colours = stops.map(|s| ColorScaleElement(s, style::voltage(s).hex()));
        surface(&mesh)
            .name("muscles")
            .intensity(intensity)
            .intensity_mode(IntensityMode::Vertex)
            .color_scale(ColorScale::Vector(colours.collect()))
            .c_min(0.0)
            .c_max(self.scale)
            .show_scale(true)
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
            for marker in &self.run.system.markers {
                let path = tip_path::path(self.run.system, trajectory, marker);
                let [x, y, z] = columns(&path);
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
            for i in 0..self.run.system.muscles.len() {
                mesh.add_prism(&Prism::muscle(self.run.system, self.run.trajectory, k, i));
            }
        }
        let axis = |i: usize| {
            let values = mesh.vertices.iter().map(|p| p[i]).filter(|x| x.is_finite());
            let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| {
                [a.min(x), b.max(x)]
            });
            let axis = Axis::new()
                .title(["x [mm]", "y [mm]", "z [mm]"][i])
                .grid_color(rgb(style::GRID))
                .zero_line(false);
            if low > high {
                return axis;
            }
            axis.range(vec![(low - 10.0).floor(), (high + 10.0).ceil()])
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

fn surface(mesh: &Mesh) -> Box<Mesh3D<f64, f64, f64>> {
    let [x, y, z] = columns(&mesh.vertices);
    let corner = |i: usize| Some(mesh.triangles.iter().map(|t| t[i]).collect());
    Mesh3D::new(x, y, z, corner(0), corner(1), corner(2))
}

/// Coordinates in mm to a hundredth, so that the page stays small.
fn columns(points: &[Vector3<f64>]) -> [Vec<f64>; 3] {
    let round = |x: f64| (x * 100.0).round() / 100.0;
    [0, 1, 2].map(|i| points.iter().map(|p| round(p[i])).collect())
}
