//! Orthographic view of the ground frame with the y axis upwards, and outlines in it.

use nalgebra::Vector3;

use crate::report::canvas::CanvasPoint;

/// An orthographic view; lengths in mm become lengths on the sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Unit vector to the right of the sheet.
    pub right: Vector3<f64>,
    /// Unit vector upwards on the sheet.
    pub up: Vector3<f64>,
    /// Unit vector towards the viewer.
    pub toward: Vector3<f64>,
    /// Points per mm.
    pub scale: f64,
    /// Place of the origin on the sheet in pt.
    pub origin: CanvasPoint,
}

impl View {
    /// View with x to the right and z towards the viewer, turned by `azimuth` about y, raised by `elevation`; in rad.
    pub fn axonometric(azimuth: f64, elevation: f64) -> Self {
        let (sa, ca) = azimuth.sin_cos();
        let (se, ce) = elevation.sin_cos();
        let right = Vector3::new(ca, 0.0, -sa);
        let toward = Vector3::new(sa * ce, se, ca * ce);
        Self {
            right,
            up: toward.cross(&right),
            toward,
            scale: 1.0,
            origin: [0.0, 0.0],
        }
    }

    /// The view of figures and pages from before, the right and above.
    pub fn oblique() -> Self {
        Self::axonometric(0.5, 0.32)
    }

    /// View against a unit vector, which points towards the viewer, with y upwards; along y with z downwards
    /// from above and upwards from below, so that x is to the right.
    pub fn toward(toward: Vector3<f64>) -> Self {
        let across = Vector3::y() - toward * toward.y;
        let up = match across.norm() > 1e-3 {
            true => across.normalize(),
            false => -(Vector3::z() - toward * toward.z).normalize() * toward.y.signum(),
        };
        Self {
            right: up.cross(&toward),
            up,
            toward,
            scale: 1.0,
            origin: [0.0, 0.0],
        }
    }

    /// Place of a point on the sheet in pt.
    pub fn place(&self, point: &Vector3<f64>) -> CanvasPoint {
        [
            self.origin[0] + self.scale * self.right.dot(point),
            self.origin[1] - self.scale * self.up.dot(point),
        ]
    }

    /// Places of many points.
    pub fn places<'a>(
        &self,
        points: impl IntoIterator<Item = &'a Vector3<f64>>,
    ) -> Vec<CanvasPoint> {
        points.into_iter().map(|p| self.place(p)).collect()
    }

    /// Distance towards the viewer in mm; parts of larger distance hide those of smaller.
    pub fn depth(&self, point: &Vector3<f64>) -> f64 {
        self.toward.dot(point)
    }

    /// The same view, scaled and shifted so that the points fill a rectangle of at most `size` from `corner`;
    /// also the size they take.
    pub fn fitted(
        self,
        points: &[Vector3<f64>],
        corner: CanvasPoint,
        size: [f64; 2],
    ) -> (Self, [f64; 2]) {
        let unit = Self {
            scale: 1.0,
            origin: [0.0, 0.0],
            ..self
        };
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for place in unit.places(points) {
            for i in 0..2 {
                low[i] = low[i].min(place[i]);
                high[i] = high[i].max(place[i]);
            }
        }
        if low.iter().chain(&high).any(|x| !x.is_finite()) {
            return (unit, size);
        }
        let extent = [0, 1].map(|i| (high[i] - low[i]).max(1.0));
        let scale = (size[0] / extent[0]).min(size[1] / extent[1]);
        let fitted = Self {
            scale,
            origin: [0, 1].map(|i| corner[i] - scale * low[i]),
            ..self
        };
        (fitted, extent.map(|e| scale * e))
    }
}

/// Lower and upper corner of the box around points; none of no points.
pub fn corners(points: impl IntoIterator<Item = Vector3<f64>>) -> Option<[Vector3<f64>; 2]> {
    let points = points.into_iter().map(|point| [point, point]);
    points.reduce(|[low, high], [point, _]| [low.inf(&point), high.sup(&point)])
}

/// Convex hull of places, by Andrew's monotone chain.
pub fn hull(mut places: Vec<CanvasPoint>) -> Vec<CanvasPoint> {
    places.retain(|p| p.iter().all(|x| x.is_finite()));
    places.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let turn = |o: CanvasPoint, a: CanvasPoint, b: CanvasPoint| {
        (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])
    };
    let half = |places: &mut dyn Iterator<Item = CanvasPoint>| {
        let mut chain: Vec<CanvasPoint> = Vec::new();
        for place in places {
            while let [.., a, b] = chain[..]
                && turn(a, b, place) <= 0.0
            {
                chain.pop();
            }
            chain.push(place);
        }
        chain.pop();
        chain
    };
    let mut outline = half(&mut places.iter().copied());
    outline.extend(half(&mut places.iter().rev().copied()));
    outline
}
