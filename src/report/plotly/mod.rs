//! Interactive figures: what plotly.js draws, as JSON, and the library itself (its bundle for curves and scenes in space, MIT).

use serde::Serialize;
use serde_json::{Value, json};

use crate::report::style::{self, Colour};

/// The library, so that a page works without a network.
const LIBRARY: &str = include_str!("plotly-gl3d.min.js");

/// Curves or surfaces over a layout, with frames of an animation where there are any.
#[derive(Debug, Serialize)]
pub struct Figure {
    /// What is drawn.
    pub data: Vec<Trace>,
    /// Axes, legend, slider, buttons.
    pub layout: Value,
    /// States of the animation.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub frames: Vec<AnimationFrame>,
    config: Value,
}

/// A curve or a surface: its points, and how it looks by the names of plotly.
#[derive(Debug, Default, Serialize)]
pub struct Trace {
    /// Kind, name, colours.
    #[serde(flatten)]
    pub look: Value,
    /// First coordinate of each point.
    pub x: Vec<f64>,
    /// Second coordinate.
    pub y: Vec<f64>,
    /// Third coordinate, in space.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub z: Vec<f64>,
    /// Corners of the triangles of a surface: the first,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub i: Vec<usize>,
    /// the second
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub j: Vec<usize>,
    /// and the third of each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub k: Vec<usize>,
    /// Value of each point of a surface that is coloured by one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub intensity: Vec<f64>,
}

/// A state of an animation: these traces replace those of the figure.
#[derive(Debug, Serialize)]
pub struct AnimationFrame {
    /// Name that slider and buttons use.
    pub name: String,
    /// Places of the traces in the figure.
    pub traces: Vec<usize>,
    /// Their data.
    pub data: Vec<Trace>,
}

impl Figure {
    /// A figure without animation.
    pub fn new(data: Vec<Trace>, layout: Value) -> Self {
        Self {
            data,
            layout,
            frames: Vec::new(),
            config: json!({ "responsive": true, "displaylogo": false }),
        }
    }

    /// The figure with the states of an animation.
    pub fn animated(self, frames: Vec<AnimationFrame>) -> Self {
        Self { frames, ..self }
    }

    /// The element that shows it, with its script.
    ///
    /// # Panics
    /// Never: figures are trees of numbers and texts.
    pub fn html(&self, id: &str) -> String {
        let text = serde_json::to_string(self).expect("a figure is a tree of numbers and texts");
        // In JSON such a sign stands in texts only; there it must not end the script.
        let text = text.replace('<', "\\u003c");
        format!(
            "<div id=\"{id}\" style=\"height:100%;width:100%\"></div>\n<script>Plotly.newPlot(\"{id}\", {text})</script>"
        )
    }
}

/// The element of the library.
pub fn library() -> String {
    format!("<script>{LIBRARY}</script>")
}

/// A colour as plotly takes it.
pub(crate) fn rgb(colour: Colour) -> String {
    colour.hex()
}

/// What all figures have in common, completed by `more`.
pub(crate) fn layout(more: Value) -> Value {
    let mut layout = json!({
        "font": { "family": style::FONT, "size": 13, "color": rgb(style::INK) },
        "paper_bgcolor": rgb(style::PAPER),
        "plot_bgcolor": rgb(style::PAPER),
        "margin": { "l": 70, "r": 20, "t": 20, "b": 55 },
    });
    if let (Some(layout), Value::Object(more)) = (layout.as_object_mut(), more) {
        layout.extend(more);
    }
    layout
}
