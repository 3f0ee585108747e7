//! Contacts that act, read at vectors and their rates: overlap, forces and slip.

use crate::energy::{ContactFriction, ContactLaw, Cores, StickingFriction, Touch};
use crate::math::Vector;

/// A contact that is read at times: a placed configuration with rates of the vectors.
#[derive(Clone, Debug)]
pub struct ContactReading {
    /// Name of the contact.
    pub name: String,
    /// Its normal force.
    pub(crate) law: ContactLaw,
    /// Span between both sides.
    pub(crate) span: usize,
    /// Normal of a plane of a body.
    pub(crate) normal: Option<usize>,
    /// Cores of shapes that are no points.
    pub(crate) cores: Option<Cores>,
    /// Their axes.
    pub(crate) axes: Vec<usize>,
    /// Friction with the vectors that it reads.
    pub(crate) friction: Option<(ContactFriction, Vec<usize>)>,
    /// Elastic displacement of one that sticks, over its greatest length, with the time of its damping in ms.
    pub(crate) bristle: Option<(usize, f64)>,
}

impl ContactReading {
    /// The vectors that the normal force reads.
    pub(crate) fn normal_vectors(&self) -> Vec<usize> {
        let first = [self.span].into_iter().chain(self.normal);
        first.chain(self.axes.iter().copied()).collect()
    }

    /// Names and units of its values.
    pub fn columns(&self) -> &'static [(&'static str, &'static str)] {
        const ALL: [(&str, &str); 4] = [
            ("force", "N"),
            ("gap", "mm"),
            ("friction", "N"),
            ("slip", "mm/ms"),
        ];
        match self.friction {
            Some(_) => &ALL,
            None => &ALL[..2],
        }
    }

    /// Overlap and normal force at vectors and their rates.
    pub fn touch(&self, [x, rates]: [&[Vector]; 2]) -> Touch {
        if let Some(cores) = &self.cores {
            let vectors = self.normal_vectors();
            let [x, rates] = [x, rates].map(|of| read(of, &vectors));
            return cores.touch(&self.law, &x, &rates);
        }
        let ends = [x, rates].map(|of| {
            [
                of[self.span],
                self.normal.map_or(Vector::zeros(), |n| of[n]),
            ]
        });
        self.law.touch(ends)
    }

    /// Normal force in N and gap in mm, negative where both overlap; with friction its size in N, and the slip in mm/ms.
    pub fn values(&self, at: [&[Vector]; 2]) -> Vec<f64> {
        let Touch { overlap, force } = self.touch(at);
        let friction = self.friction.iter().flat_map(|(friction, vectors)| {
            let [mut x, mut rates] = at.map(|of| read(of, vectors));
            if let Some(cores) = &self.cores {
                [x[0], rates[0]] = cores.span(&x, [&x, &rates]);
            }
            let bristle = self.bristle.map(|(v, time)| {
                let readings = [at[0][v], at[1][v]];
                StickingFriction::damped(readings, time)
            });
            friction.of_rates(&x, &rates, force, bristle)
        });
        [force, -overlap].into_iter().chain(friction).collect()
    }
}

/// Vectors of a list by their numbers.
fn read(all: &[Vector], vectors: &[usize]) -> Vec<Vector> {
    vectors.iter().map(|&v| all[v]).collect()
}
