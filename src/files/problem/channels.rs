//! Measured quantities of recordings, and their readings out of columns of a CSV file.

use crate::control::problem::{Channel, Reading};
use crate::files::columns::Columns;
use crate::files::json::scope::{Result, Scope, refuse};
use crate::files::problem::quantities::entry::Recorded;
use crate::files::problem::quantities::keys::MeasuredSpec;
use crate::files::units::quantity::{MeasuredSize, Quantity as Written, Ratio};

/// Columns, and the times of their rows.
pub(super) struct Source<'a> {
    pub(super) columns: &'a Columns,
    pub(super) times: &'a [f64],
}

impl Recorded {
    /// The standard deviation that is written for all readings.
    pub(super) fn deviation(&self, spec: &MeasuredSpec, at: &Scope<'_>) -> Result<Option<f64>> {
        let key = "standard_deviation";
        at.optional(key, &spec.standard_deviation, |at, written| {
            let value = at.value_as(written, &self.kind)?;
            refuse!(if value <= 0.0, at; found written, expected "a positive one");
            Ok(value)
        })
    }

    /// The channel with readings.
    pub(super) fn with(&self, readings: Vec<Reading>, is_deviation_known: bool) -> Channel {
        Channel {
            name: self.name.clone(),
            parts: self.parts.clone(),
            unit: self.unit,
            is_deviation_known,
            readings,
        }
    }

    /// The channel with the readings of its columns.
    pub(super) fn channel(
        &self,
        spec: &MeasuredSpec,
        source: &Source<'_>,
        at: &Scope<'_>,
    ) -> Result<Channel> {
        let given = [
            ("standard_deviation", spec.standard_deviation.is_some()),
            ("deviations", spec.deviations.is_some()),
            ("weights", spec.weights.is_some()),
        ];
        let mut given = given.into_iter().filter(|(_, is_given)| *is_given);
        let both = (given.next(), given.next());
        refuse!(if let (Some((first, _)), Some((second, _))) = both, at.key(second);
            found "a second one", expected format!("one of both, not \"{first}\" too"));
        let values = self.values(&self.of, source, &at.key("column"))?;
        let of_all = self.deviation(spec, at)?;
        let deviations = match (&spec.deviations, &spec.weights) {
            (Some(header), _) => self.values(header, source, &at.key("deviations"))?,
            (_, Some(header)) => weights(header, source, &at.key("weights"))?,
            _ => vec![Some(of_all.unwrap_or(1.0)); values.len()],
        };
        let mut readings = Vec::new();
        for (k, value) in values.iter().enumerate() {
            let (Some(value), Some(deviation)) = (*value, deviations[k]) else {
                continue;
            };
            let key = match spec.deviations {
                Some(_) => "deviations",
                None => "weights",
            };
            refuse!(if deviation <= 0.0 || deviation.is_nan(), at.key(key);
                found format!("a value that is not positive, in row {}", k + 1),
                expected "positive values");
            readings.push(Reading {
                time: source.times[k],
                value,
                deviation,
            });
        }
        refuse!(if readings.is_empty(), at.key("column");
            found format!("{:?}, a column of gaps alone", self.of), expected "one reading or more");
        let is_known = of_all.is_some() || spec.deviations.is_some();
        Ok(self.with(readings, is_known))
    }

    /// Values of a column in the units inside; none of a gap.
    fn values(
        &self,
        header: &str,
        source: &Source<'_>,
        at: &Scope<'_>,
    ) -> Result<Vec<Option<f64>>> {
        let column = source
            .columns
            .with_gaps::<MeasuredSize>(header, &self.kind, at)?;
        let value = |written: Option<Written<MeasuredSize>>| {
            let read = written.map(|written| at.value_as(&written, &self.kind));
            read.transpose()
        };
        column.into_iter().map(value).collect()
    }
}

/// Relative deviations of weights.
fn weights(header: &str, source: &Source<'_>, at: &Scope<'_>) -> Result<Vec<Option<f64>>> {
    let column = source
        .columns
        .with_gaps::<Ratio>(header, &Ratio::kind(), at)?;
    let deviation = |weight: Option<Written<Ratio>>| Some(weight?.value().sqrt().recip());
    Ok(column.into_iter().map(deviation).collect())
}
