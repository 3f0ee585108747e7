//! A sheet in points to draw on, written as SVG by plotters at a sixteenth of a point.

use plotters::coord::Shift;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::report::origin::Origin;
use crate::report::style::{self, Colour, Dash};

/// Units of the backend, which knows whole numbers only, per point.
const FINE: f64 = 16.0;

/// A place on the sheet in pt, to the right and down from the upper left corner.
pub type CanvasPoint = [f64; 2];

/// Colour, width and dash of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Colour.
    pub colour: Colour,
    /// Width in pt.
    pub width: f64,
    /// Solid or dashed.
    pub dash: Dash,
    /// Opacity from 0 to 1.
    pub opacity: f64,
}

impl Stroke {
    /// An opaque solid line.
    pub fn solid(colour: Colour, width: f64) -> Self {
        Self {
            colour,
            width,
            dash: Dash::Solid,
            opacity: 1.0,
        }
    }

    /// The same line, letting `1 − opacity` of the ground through.
    pub fn faint(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }

    fn style(&self) -> ShapeStyle {
        ShapeStyle {
            color: rgba(self.colour, self.opacity),
            filled: false,
            stroke_width: fine(self.width).max(1) as u32,
        }
    }
}

/// Alignment of a text relative to its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// To the right of it.
    Left,
    /// Centred on it.
    Centre,
    /// To the left of it.
    Right,
    /// Centred on it and reading upwards.
    Upwards,
}

/// A sheet to draw on. What is not finite is not drawn.
#[expect(
    missing_debug_implementations,
    reason = "the drawing area of plotters has none"
)]
pub struct Canvas<'a> {
    area: DrawingArea<SVGBackend<'a>, Shift>,
    /// Width and height in pt, without the caption.
    pub size: [f64; 2],
}

/// An SVG document of the given size in pt, with the origin as a caption below.
pub fn svg(size: [f64; 2], origin: &Origin, draw: impl FnOnce(&Canvas<'_>)) -> String {
    let lines = wrap(
        &origin.line(),
        (size[0] - 24.0) / (0.53 * style::CAPTION_SIZE),
    );
    let line_height = 1.3 * style::CAPTION_SIZE;
    let height = size[1] + 8.0 + line_height * lines.len() as f64;
    let sheet = (fine(size[0]) as u32, fine(height) as u32);
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, sheet).into_drawing_area();
        let canvas = Canvas { area, size };
        let paper = rectangle([0.0, 0.0], [size[0], height]);
        canvas.fill(&paper, style::PAPER, 1.0);
        draw(&canvas);
        for (i, line) in lines.iter().enumerate() {
            canvas.coloured_text(
                [12.0, size[1] + line_height * (i as f64 + 0.5)],
                line,
                style::CAPTION_SIZE,
                style::MUTED,
                Align::Left,
            );
        }
        canvas.area.present().expect(IN_MEMORY);
    }
    let fine_size = format!("width=\"{}\" height=\"{}\"", sheet.0, sheet.1);
    let points = format!(
        "width=\"{}pt\" height=\"{height}pt\" stroke-linejoin=\"round\"",
        size[0]
    );
    text.replacen(&fine_size, &points, 1)
}

const IN_MEMORY: &str = "drawing into memory does not fail";

impl Canvas<'_> {
    /// A line through the places, interrupted where one of them is not finite.
    pub fn line(&self, places: &[CanvasPoint], stroke: Stroke) {
        for run in places.split(|p| !finite(p)) {
            let run: Vec<_> = run.iter().map(pixel).collect();
            if run.len() < 2 {
                continue;
            }
            match stroke.dash {
                Dash::Solid => self.area.draw(&PathElement::new(run, stroke.style())),
                Dash::Dashed => {
                    let [dash, gap] = style::DASH.map(fine);
                    let line = DashedPathElement::new(run, dash, gap, stroke.style());
                    self.area.draw(&line)
                }
            }
            .expect(IN_MEMORY);
        }
    }

    /// A closed line.
    pub fn outline(&self, places: &[CanvasPoint], stroke: Stroke) {
        let closed: Vec<_> = places.iter().chain(places.first()).copied().collect();
        self.line(&closed, stroke);
    }

    /// A filled polygon.
    pub fn fill(&self, places: &[CanvasPoint], colour: Colour, opacity: f64) {
        if places.len() < 3 || !places.iter().all(finite) {
            return;
        }
        let corners: Vec<_> = places.iter().map(pixel).collect();
        let style = rgba(colour, opacity).filled();
        self.area
            .draw(&Polygon::new(corners, style))
            .expect(IN_MEMORY);
    }

    /// A filled disc with a rim.
    pub fn disc(&self, centre: CanvasPoint, radius: f64, inside: Colour, rim: Stroke) {
        if !finite(&centre) {
            return;
        }
        let draw = |style| {
            let disc = Circle::new(pixel(&centre), fine(radius), style);
            self.area.draw(&disc).expect(IN_MEMORY);
        };
        draw(rgba(inside, rim.opacity).filled());
        draw(rim.style());
    }

    /// A line of text of the given size in pt, vertically centred on its place.
    pub fn text(&self, place: CanvasPoint, text: &str, size: f64, align: Align) {
        self.coloured_text(place, text, size, style::INK, align);
    }

    /// The same in a colour.
    pub fn coloured_text(
        &self,
        place: CanvasPoint,
        text: &str,
        size: f64,
        colour: Colour,
        align: Align,
    ) {
        if text.is_empty() || !finite(&place) {
            return;
        }
        let (horizontal, turn) = match align {
            Align::Left => (HPos::Left, FontTransform::None),
            Align::Centre => (HPos::Center, FontTransform::None),
            Align::Right => (HPos::Right, FontTransform::None),
            Align::Upwards => (HPos::Center, FontTransform::Rotate270),
        };
        // The backend divides font sizes by 1.24.
        let colour = rgba(colour, 1.0);
        let style = TextStyle::from((style::FONT, 1.24 * FINE * size))
            .transform(turn)
            .color(&colour)
            .pos(Pos::new(horizontal, VPos::Center));
        self.area
            .draw_text(text, &style, pixel(&place))
            .expect(IN_MEMORY);
    }
}

/// Distance of two places in pt.
pub(super) fn length([a, b]: [CanvasPoint; 2]) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

/// Corners of a rectangle between two opposite ones.
pub fn rectangle(from: CanvasPoint, to: CanvasPoint) -> [CanvasPoint; 4] {
    [from, [to[0], from[1]], to, [from[0], to[1]]]
}

/// Width in pt that a text of the given size takes, on the generous side.
pub fn text_width(text: &str, size: f64) -> f64 {
    0.6 * size * text.chars().count() as f64
}

/// Breaks a text at spaces into lines of at most `width` characters, where words allow.
fn wrap(text: &str, width: f64) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let last = lines.last_mut().expect("there is always a line");
        let joined = last.chars().count() + 1 + word.chars().count();
        if last.is_empty() {
            last.push_str(word);
        } else if joined as f64 <= width {
            last.push(' ');
            last.push_str(word);
        } else {
            lines.push(word.to_owned());
        }
    }
    lines
}

fn finite(place: &CanvasPoint) -> bool {
    place.iter().all(|x| x.is_finite())
}

fn fine(x: f64) -> i32 {
    (x * FINE).round() as i32
}

fn pixel(place: &CanvasPoint) -> (i32, i32) {
    (fine(place[0]), fine(place[1]))
}

fn rgba(colour: Colour, opacity: f64) -> RGBAColor {
    RGBAColor(colour.0, colour.1, colour.2, opacity)
}
