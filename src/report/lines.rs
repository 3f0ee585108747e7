//! Curves over a pair of axes: the plot that the other figures share.

use crate::report::axes::{Axis, Extent, Scale, Ticks};
use crate::report::canvas::{self, Align, Canvas, CanvasPoint, Stroke, rectangle, text_width};
use crate::report::origin::Origin;
use crate::report::style::{self, Colour, Dash};

/// A named curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Name in the legend; empty for none.
    pub name: String,
    /// Points (x, y) in the units of the axes; a point that is not finite interrupts the curve.
    pub points: Vec<[f64; 2]>,
    /// Colour of line and marks.
    pub colour: Colour,
    /// Line that joins the points, if there is one.
    pub line: Option<Dash>,
    /// Width of the line in pt.
    pub width: f64,
    /// Mark at each point.
    pub mark: Mark,
    /// Labels above the points, or below where the curve comes down to one, as far as there are any; an empty one is none.
    pub labels: Vec<String>,
}

/// Mark at a point of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// None.
    None,
    /// A ring.
    Ring,
    /// A disc.
    Disc,
    /// Two crossed lines.
    Cross,
}

impl Series {
    /// A solid curve without marks.
    pub fn curve(name: impl Into<String>, points: Vec<[f64; 2]>, colour: Colour) -> Self {
        Self {
            name: name.into(),
            points,
            colour,
            line: Some(Dash::Solid),
            width: style::CURVE,
            mark: Mark::None,
            labels: Vec::new(),
        }
    }

    /// The same, dashed or solid.
    pub fn dashed(self, dash: Dash) -> Self {
        Self {
            line: Some(dash),
            ..self
        }
    }

    /// The same with a mark at each point.
    pub fn marked(self, mark: Mark) -> Self {
        Self { mark, ..self }
    }

    /// The same with labels at its points.
    pub fn labelled(self, labels: Vec<String>) -> Self {
        Self { labels, ..self }
    }

    /// Marks alone.
    pub fn unjoined(self) -> Self {
        Self { line: None, ..self }
    }
}

/// Values at times in ms, over time in s.
pub fn over_time(times: &[f64], values: impl IntoIterator<Item = f64>) -> Vec<[f64; 2]> {
    let points = times.iter().zip(values);
    points.map(|(time, value)| [time / 1e3, value]).collect()
}

/// Aspect ratio: a unit equally long on both axes or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aspect {
    /// The frame is filled.
    Free,
    /// One unit, one length: for places in a plane.
    Equal,
}

/// Curves over a pair of axes, legend to the right.
#[derive(Clone, Debug, PartialEq)]
pub struct LinePlot {
    /// Title above the frame; empty for nothing.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis; without a label it has no ticks.
    pub y: Axis,
    /// The curves, later ones on top.
    pub series: Vec<Series>,
    /// Free or equal units.
    pub aspect: Aspect,
    /// Width and height of the frame in pt; with equal units the most they may be.
    pub frame: [f64; 2],
}

/// Margins in pt around the frame: left, top, bottom.
const MARGIN: [f64; 3] = [62.0, 14.0, 44.0];
/// Height of a title in pt.
const TITLE: f64 = 18.0;
/// Height of a legend entry in pt.
const ENTRY: f64 = 16.0;
/// Length of a line sample in the legend in pt.
const SAMPLE: f64 = 26.0;

impl LinePlot {
    /// A plot with free units and the usual frame.
    pub fn new(x: Axis, y: Axis, series: Vec<Series>) -> Self {
        Self {
            title: String::new(),
            x,
            y,
            series,
            aspect: Aspect::Free,
            frame: [400.0, 250.0],
        }
    }

    /// Curves over time in s.
    pub fn over_time(label: impl Into<String>, series: Vec<Series>) -> Self {
        let time = Axis::linear("time [s]", Extent::Tight);
        Self::new(time, Axis::linear(label, Extent::Padded), series)
    }

    /// The plot as an SVG document.
    pub fn svg(&self, origin: &Origin) -> String {
        let (frame, ranges) = self.layout();
        let entries: Vec<_> = self.series.iter().filter(|s| !s.name.is_empty()).collect();
        let rows = (((frame[1] + ENTRY / 2.0) / ENTRY) as usize).max(1);
        let column = entries
            .iter()
            .map(|s| text_width(&s.name, style::TICK_SIZE))
            .fold(0.0, f64::max)
            + SAMPLE
            + 22.0;
        let columns = entries.len().div_ceil(rows) as f64;
        let top = match self.title.is_empty() {
            true => MARGIN[1],
            false => MARGIN[1] + TITLE,
        };
        let size = [
            MARGIN[0] + frame[0] + 18.0 + columns * column,
            top + frame[1] + MARGIN[2],
        ];
        canvas::svg(size, origin, |canvas| {
            let plot = PlotFrame {
                canvas,
                corner: [MARGIN[0], top],
                size: frame,
                ranges,
            };
            plot.axes(&self.x, &self.y);
            let mut labelled = Vec::new();
            for series in &self.series {
                plot.series(series, &self.x, &self.y, &mut labelled);
            }
            plot.border();
            let (place, size) = ([MARGIN[0], MARGIN[1] + 0.3 * TITLE], style::LABEL_SIZE);
            canvas.text(place, &self.title, size, Align::Left);
            let left = MARGIN[0] + frame[0] + 18.0;
            for (i, series) in entries.iter().enumerate() {
                let place = [
                    left + (i / rows) as f64 * column,
                    top + ENTRY * ((i % rows) as f64 + 0.5),
                ];
                legend_entry(canvas, place, series);
            }
        })
    }

    /// Size of the frame in pt and ranges of positions on both axes.
    fn layout(&self) -> ([f64; 2], [[f64; 2]; 2]) {
        let points = || self.series.iter().flat_map(|s| &s.points);
        let ranges = [
            self.x.range(points().map(|p| p[0])),
            self.y.range(points().map(|p| p[1])),
        ];
        let [dx, dy] = ranges.map(|[low, high]| high - low);
        let frame = match self.aspect {
            Aspect::Free => self.frame,
            Aspect::Equal => {
                let scale = (self.frame[0] / dx).min(self.frame[1] / dy);
                return equal_frame(ranges, scale);
            }
        };
        (frame, ranges)
    }
}

/// A frame whose units are equally long; a motion along a line still gets a strip of paper.
fn equal_frame(ranges: [[f64; 2]; 2], scale: f64) -> ([f64; 2], [[f64; 2]; 2]) {
    const LEAST: f64 = 120.0;
    let lengths = ranges.map(|[low, high]| (scale * (high - low)).max(LEAST));
    let widen = |axis: usize| {
        let [low, high] = ranges[axis];
        let (middle, half) = ((low + high) / 2.0, lengths[axis] / scale / 2.0);
        [middle - half, middle + half]
    };
    (lengths, [widen(0), widen(1)])
}

/// The rectangle between the axes.
struct PlotFrame<'a, 'b> {
    canvas: &'a Canvas<'b>,
    corner: CanvasPoint,
    size: [f64; 2],
    ranges: [[f64; 2]; 2],
}

impl PlotFrame<'_, '_> {
    fn horizontal(&self, position: f64) -> f64 {
        let [low, high] = self.ranges[0];
        self.corner[0] + self.size[0] * (position - low) / (high - low)
    }

    fn vertical(&self, position: f64) -> f64 {
        let [low, high] = self.ranges[1];
        self.corner[1] + self.size[1] * (high - position) / (high - low)
    }

    /// Grid, ticks and labels.
    fn axes(&self, x: &Axis, y: &Axis) {
        let [left, top] = self.corner;
        let (right, bottom) = (left + self.size[0], top + self.size[1]);
        let grid = Stroke::solid(style::GRID, 0.6);
        let tick = Stroke::solid(style::INK, 0.8);
        let canvas = self.canvas;

        let ticks = x.ticks(self.ranges[0], (self.size[0] / 62.0).max(2.0));
        for (position, label) in &ticks.major {
            let at = self.horizontal(*position);
            canvas.line(&[[at, top], [at, bottom]], grid);
            canvas.line(&[[at, bottom], [at, bottom + 4.0]], tick);
            let place = [at, bottom + 13.0];
            canvas.text(place, label, style::TICK_SIZE, Align::Centre);
        }
        for position in &ticks.minor {
            let at = self.horizontal(*position);
            canvas.line(&[[at, bottom], [at, bottom + 2.2]], tick);
        }

        let ticks = match y.label.is_empty() {
            true => Ticks::default(),
            false => y.ticks(self.ranges[1], (self.size[1] / 42.0).max(2.0)),
        };
        for (position, label) in &ticks.major {
            let at = self.vertical(*position);
            canvas.line(&[[left, at], [right, at]], grid);
            canvas.line(&[[left - 4.0, at], [left, at]], tick);
            let place = [left - 8.0, at];
            canvas.text(place, label, style::TICK_SIZE, Align::Right);
        }
        for position in &ticks.minor {
            let at = self.vertical(*position);
            canvas.line(&[[left - 2.2, at], [left, at]], tick);
        }

        let middle = [(left + right) / 2.0, bottom + 31.0];
        canvas.text(middle, &x.label, style::LABEL_SIZE, Align::Centre);
        let middle = [left - 46.0, (top + bottom) / 2.0];
        canvas.text(middle, &y.label, style::LABEL_SIZE, Align::Upwards);
        if y.scale == Scale::Linear && self.ranges[1][0] < 0.0 && self.ranges[1][1] > 0.0 {
            let zero = self.vertical(0.0);
            canvas.line(
                &[[left, zero], [right, zero]],
                Stroke::solid(style::MUTED, 0.6),
            );
        }
    }

    /// A curve, and its labels where none of another curve stands yet; `labelled` are the places and widths of those.
    fn series(&self, series: &Series, x: &Axis, y: &Axis, labelled: &mut Vec<(CanvasPoint, f64)>) {
        let place = |p: &[f64; 2]| {
            let [x, y] = [x.position(p[0]), y.position(p[1])];
            [self.horizontal(x), self.vertical(y)]
        };
        let places: Vec<_> = series.points.iter().map(place).collect();
        trace(self.canvas, &places, series);
        let colour = series.colour.mix(style::INK, 0.3);
        for (k, (place, label)) in places.iter().zip(&series.labels).enumerate() {
            let comes_down = k > 0 && places[k - 1][1] < place[1];
            let beside = if comes_down { 9.5 } else { -9.0 };
            let at = [place[0], place[1] + beside];
            let size = style::LABEL_OF_POINT_SIZE;
            let width = text_width(label, size);
            let covers = |(other, its): &(CanvasPoint, f64)| {
                2.0 * (at[0] - other[0]).abs() < width + its && (at[1] - other[1]).abs() < size
            };
            if label.is_empty() || labelled.iter().any(covers) {
                continue;
            }
            labelled.push((at, width));
            self.canvas
                .coloured_text(at, label, size, colour, Align::Centre);
        }
    }

    fn border(&self) {
        let [left, top] = self.corner;
        let corners = rectangle(self.corner, [left + self.size[0], top + self.size[1]]);
        let ink = Stroke::solid(style::INK, 0.8);
        self.canvas.outline(&corners, ink);
    }
}

/// Half of the side of the square that a cross fills, in points.
const ARM: f64 = 3.6;

/// Line and marks of a series along places on the sheet.
fn trace(canvas: &Canvas<'_>, places: &[CanvasPoint], series: &Series) {
    if let Some(dash) = series.line {
        let stroke = Stroke {
            dash,
            ..Stroke::solid(series.colour, series.width)
        };
        canvas.line(places, stroke);
    }
    let rim = Stroke::solid(series.colour, 1.4);
    for place in places {
        match series.mark {
            Mark::None => {}
            Mark::Ring => canvas.disc(*place, 3.4, style::PAPER, rim),
            Mark::Disc => canvas.disc(*place, 3.0, series.colour, rim),
            Mark::Cross => {
                for turn in [1.0, -1.0] {
                    let [x, y] = *place;
                    let arm = [[x - ARM, y - turn * ARM], [x + ARM, y + turn * ARM]];
                    canvas.line(&arm, rim);
                }
            }
        }
    }
}

fn legend_entry(canvas: &Canvas<'_>, [left, at]: CanvasPoint, series: &Series) {
    let sample = Series {
        mark: Mark::None,
        ..series.clone()
    };
    trace(canvas, &[[left, at], [left + SAMPLE, at]], &sample);
    let mark = Series {
        line: None,
        ..series.clone()
    };
    trace(canvas, &[[left + SAMPLE / 2.0, at]], &mark);
    let place = [left + SAMPLE + 6.0, at];
    canvas.text(place, &series.name, style::TICK_SIZE, Align::Left);
}
