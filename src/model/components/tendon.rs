//! A tendon through any number of points.

use crate::energy::Cable;
use crate::functional::Path;
use crate::math::{Fault, Key, not_negative, positive, refuse};
use crate::model::components::component::Component;
use crate::model::constants::constant::Constant;
use crate::model::constants::free_parameters::{MovedPoints, Read};
use crate::model::system::bodies::Attachment;
use crate::model::terms::Terms;
use nalgebra::Vector3;

/// An elastic cable that slides without friction through points and takes no compression: tension `k max(L − ℓ, 0)`, over a width around ℓ
/// smooth where one is given.
#[derive(Clone, Debug, PartialEq)]
pub struct Tendon {
    /// Unique name.
    pub name: String,
    /// The points, two or more: the ends, and those that it slides through.
    pub through: Vec<Attachment>,
    /// Stiffness k in N/mm.
    pub stiffness: f64,
    /// Length ℓ in mm up to which it is slack.
    pub rest_length: f64,
    /// Width in mm, around the length up to which it is slack, over which its stiffness grows from zero; zero where it jumps.
    pub smoothing: f64,
}

const ELASTICITY: &str = "tendon elasticity";

/// Sum of the distances of neighbours.
fn path_length(places: impl Iterator<Item = Vector3<f64>> + Clone) -> f64 {
    let next = places.clone().skip(1);
    places.zip(next).map(|(a, b)| (b - a).norm()).sum()
}

impl Tendon {
    fn energy(&self) -> Cable {
        Cable {
            stiffness: self.stiffness,
            length: self.rest_length,
            smoothing: self.smoothing,
        }
    }

    /// Makes the term; `index` is its place among the tendons of the system, constants of which can be free.
    pub(crate) fn add(&self, index: Option<usize>, terms: &mut Terms<'_>) {
        let mut read = index.map_or_else(Read::nothing, |_| terms.sought().read());
        let index = index.unwrap_or_default();
        let mut length = read.constant(Constant::TendonLength(index), self.rest_length);
        let mut spans = Vec::new();
        for (first, pair) in self.through.windows(2).enumerate() {
            let span = terms.span(&pair[0], &pair[1]);
            let ends = MovedPoints {
                parts: [-1.0, 1.0],
                // A span within a body has the length that it has on the ground.
                bodies: [0, 1].map(|end| span.and_then(|_| terms.carrier(&pair[end]))),
                places: Some(&|end, axis| Constant::TendonPoint(index, first + end, axis)),
            };
            let moved = read.moves(spans.len(), ends, |vector| terms.vector(vector));
            let between = pair[1].at - pair[0].at;
            match span {
                Some(span) => spans.push(span),
                None if !moved.is_empty() => spans.push(terms.on_ground(&between)),
                // What never changes its length leaves the rest to the others.
                None => length = &length - &between.norm().into(),
            }
        }
        if spans.is_empty() {
            return terms.without(ELASTICITY, "no tendon that moves");
        }
        let energy = Cable {
            stiffness: read.constant(Constant::TendonStiffness(index), self.stiffness),
            length,
            smoothing: self.smoothing,
        };
        let (parameters, moves) = read.with_moves();
        let path = Path {
            energy,
            spans,
            parameters,
            moves,
        };
        terms.add(ELASTICITY, "stiffness of", &self.name, path);
    }

    fn length(&self) -> f64 {
        path_length(self.through.iter().map(|point| point.at))
    }
}

impl Component for Tendon {
    fn name(&self) -> &str {
        &self.name
    }

    fn points(&self) -> Vec<Attachment> {
        self.through.clone()
    }

    fn check(&self) -> Result<(), Fault> {
        let count = self.through.len();
        refuse!(if count < 2, Key("through");
            found format!("{count} points"), expected "2 points or more");
        for (index, pair) in self.through.windows(2).enumerate() {
            refuse!(if pair[0].at == pair[1].at, Key(format!("through[{}].at", index + 1));
                found "the place of the point before",
                expected "another place than the point before, as the span has no direction there");
        }
        positive("stiffness", self.stiffness)?;
        positive("rest_length", self.rest_length)?;
        let width = self.smoothing;
        not_negative("smoothing", width)?;
        refuse!(unless width <= 2.0 * self.rest_length, Key("smoothing");
            value width, expected "at most twice the rest length");
        Ok(())
    }

    fn is_prestressed(&self) -> bool {
        self.length() > self.rest_length - 0.5 * self.smoothing
    }

    fn build(&self, terms: &mut Terms<'_>) {
        self.add(None, terms);
    }

    fn columns(&self) -> Vec<(&'static str, &'static str)> {
        vec![("length", "mm"), ("tension", "N")]
    }

    fn observe(&self, places: &[Vector3<f64>]) -> Vec<f64> {
        let length = path_length(places.iter().copied());
        vec![length, self.energy().of_length(length)[1]]
    }

    fn typical_energy(&self) -> f64 {
        0.5 * self.stiffness * self.length() * self.length()
    }
}
