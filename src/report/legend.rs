//! Legend next to a drawing in space: names of the drawn parts, axes, a scale.

use crate::report::axes::{Axis, Extent};
use crate::report::canvas::{Align, Canvas, CanvasPoint, Stroke, rectangle, text_width};
use crate::report::style;
use crate::report::style::Colour;
use crate::report::view::View;
use nalgebra::Vector3;

/// Height of a row in pt.
pub const ROW: f64 = 16.0;
/// Height of axes and scale in pt.
pub const TRIAD: f64 = 112.0;
/// Left end of the text of a row in pt.
const TEXT: f64 = 20.0;

/// Symbol of a part in the legend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LegendSymbol {
    /// A surface.
    Swatch(Colour),
    /// The path of a marker.
    Path(Colour),
}

/// Width in pt that rows take.
pub fn width(rows: &[(String, LegendSymbol)]) -> f64 {
    let texts = rows.iter();
    let widths = texts.map(|(name, _)| text_width(name, style::TICK_SIZE));
    TEXT + widths.fold(0.0, f64::max)
}

/// The rows, the middle of the first at the given place.
pub fn draw(canvas: &Canvas<'_>, [left, top]: CanvasPoint, rows: &[(String, LegendSymbol)]) {
    for (i, (name, sample)) in rows.iter().enumerate() {
        let at = top + ROW * i as f64;
        match *sample {
            LegendSymbol::Swatch(colour) => {
                let corners = rectangle([left, at - 4.0], [left + 14.0, at + 4.0]);
                canvas.fill(&corners, colour.mix(style::PAPER, 0.55), 1.0);
                canvas.outline(&corners, Stroke::solid(colour, 0.8));
            }
            LegendSymbol::Path(colour) => {
                let ink = Stroke::solid(colour, 1.1);
                canvas.line(&[[left, at], [left + 14.0, at]], ink);
            }
        }
        let place = [left + TEXT, at];
        canvas.text(place, name, style::TICK_SIZE, Align::Left);
    }
}

/// The axes of the ground frame, and a bar of a round length.
pub fn triad(canvas: &Canvas<'_>, view: &View, at: CanvasPoint) {
    let unit = View {
        scale: 24.0,
        origin: at,
        ..*view
    };
    for (name, axis) in [
        ("x", Vector3::x()),
        ("y", Vector3::y()),
        ("z", Vector3::z()),
    ] {
        if axis.dot(&view.toward).abs() > 0.999 {
            continue;
        }
        canvas.line(&[at, unit.place(&axis)], Stroke::solid(style::MUTED, 1.0));
        let place = unit.place(&(axis * 1.4));
        canvas.text(place, name, style::TICK_SIZE, Align::Centre);
    }
    let rough = 60.0 / view.scale;
    let power = 10_f64.powf(rough.log10().floor());
    let round = [5.0, 2.0, 1.0].into_iter().find(|m| m * power <= rough);
    let length = round.unwrap_or(1.0) * power;
    let (left, top) = (at[0] - 22.0, at[1] - 64.0);
    let right = left + length * view.scale;
    canvas.line(&[[left, top], [right, top]], Stroke::solid(style::INK, 1.6));
    let label = format!("{length} mm");
    canvas.text([left, top - 10.0], &label, style::TICK_SIZE, Align::Left);
}

/// Colours of the voltages from zero to the full scale in V, labelled in kV; the upper left corner is given.
pub fn colour_bar(canvas: &Canvas<'_>, [left, top]: CanvasPoint, scale: f64) {
    const STEPS: usize = 64;
    let (width, height) = (14.0, 120.0);
    let at = |fraction: f64| top + height * (1.0 - fraction);
    canvas.text(
        [left, top - 14.0],
        "voltage [kV]",
        style::TICK_SIZE,
        Align::Left,
    );
    for i in 0..STEPS {
        let low = i as f64 / STEPS as f64;
        let high = (i + 1) as f64 / STEPS as f64;
        // Each step reaches under the next one, so that no seam shows.
        let upper = at((high + 1.0 / STEPS as f64).min(1.0));
        let corners = rectangle([left, at(low)], [left + width, upper]);
        canvas.fill(&corners, style::voltage((low + high) / 2.0), 1.0);
    }
    let frame = rectangle([left, at(0.0)], [left + width, at(1.0)]);
    canvas.outline(&frame, Stroke::solid(style::INK, 0.6));
    let axis = Axis::linear("", Extent::Tight);
    for (value, label) in axis.ticks([0.0, scale / 1e3], 5.0).major {
        let y = at(value * 1e3 / scale);
        canvas.line(
            &[[left + width, y], [left + width + 3.5, y]],
            Stroke::solid(style::INK, 0.6),
        );
        canvas.text(
            [left + width + 7.0, y],
            &label,
            style::TICK_SIZE,
            Align::Left,
        );
    }
}
