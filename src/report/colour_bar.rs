//! Colour bar: the voltages of the colours.

use crate::report::axes::{Axis, Extent};
use crate::report::canvas::{Align, Canvas, CanvasPoint, Stroke};
use crate::report::style;

/// Colours of the voltages from zero to the full scale in V, labelled in kV; the upper left corner is given.
pub fn colour_bar(canvas: &Canvas<'_>, [left, top]: CanvasPoint, scale: f64) {
    const STEPS: usize = 64;
    let (width, height) = (14.0, 120.0);
    let at = |fraction: f64| top + height * (1.0 - fraction);
    canvas.text(
        [left, top - 14.0],
        "voltage [kV]",
        style::TICK_SIZE,
        style::INK,
        Align::Left,
    );
    for i in 0..STEPS {
        let low = i as f64 / STEPS as f64;
        let high = (i + 1) as f64 / STEPS as f64;
        // Each step reaches under the next one, so that no seam shows.
        let upper = at((high + 1.0 / STEPS as f64).min(1.0));
        let corners = [
            [left, at(low)],
            [left + width, at(low)],
            [left + width, upper],
            [left, upper],
        ];
        canvas.fill(&corners, style::voltage((low + high) / 2.0), 1.0);
    }
    let frame = [
        [left, at(0.0)],
        [left + width, at(0.0)],
        [left + width, at(1.0)],
        [left, at(1.0)],
    ];
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
            style::INK,
            Align::Left,
        );
    }
}
