//! Fields of elastic blocks for ParaView: `fields/0000.vtu`, `fields/0001.vtu`, … and `trajectory.pvd`, in SI.
//!
//! Potentials belong to intervals: instant k shows those of the interval that ends there, the first instant those of the
//! first interval. So do velocities, the mean ones of that interval, and with them the viscous part of the stress. All
//! other fields of an element are taken at the places of the instant, as a mean over its reference volume.

use crate::coordinates::Configuration;
use crate::dynamics::DiscreteTrajectory;
use crate::element::Fields;
use crate::math::{Matrix, Vector};
use crate::model::{Model, SolidBlock};
use crate::report::atomic::WriteError;
use crate::report::file_set::FileSet;
use crate::report::origin::Origin;
use crate::report::paraview::{Field, Series, UnstructuredGrid};

/// Maximum number of instants written.
const MOST: usize = 200;
/// Folder of the instants.
pub(super) const FOLDER: &str = "fields";

/// Writes the fields of a motion instant by instant; the number of instants written, zero where nothing is elastic.
pub(super) fn write(
    files: &mut FileSet,
    model: &Model,
    discrete: &DiscreteTrajectory,
    origin: &Origin,
) -> Result<usize, WriteError> {
    if model.solids.is_empty() {
        return Ok(0);
    }
    let instants = spread(discrete.z.len(), MOST);
    let mut series = Series::new("trajectory", FOLDER, origin, files)?;
    for &k in &instants {
        let state = SolidState::new(model, discrete, k);
        let blocks = (0..model.solids.len()).map(|b| grid(model, b, &state));
        let blocks: Vec<_> = blocks.collect();
        series.add(discrete.times[k] / 1e3, &blocks, files)?;
    }
    series.finish(files)?;
    Ok(instants.len())
}

/// Largest reference field −∂φ/∂X of an element in V/m at an instant; `None` where there is none.
pub(super) fn largest_nominal_field(
    model: &Model,
    discrete: &DiscreteTrajectory,
    k: usize,
) -> Option<f64> {
    let state = SolidState::new(model, discrete, k);
    let each = model.solids.iter().flat_map(|block| {
        let places = block.places(&state.here.x);
        let potentials = block.potentials(&state.scalars);
        let elements = (0..block.solid.mesh.element_count()).filter(|&e| block.is_dielectric[e]);
        let field = move |e: usize| {
            let fields = block.fields(e, &places, &potentials);
            fields.reference_electric_field.norm() * 1e3
        };
        elements.map(field).collect::<Vec<_>>()
    });
    each.reduce(f64::max)
}

/// At most `most` of `count` instants: all, or evenly chosen ones with the first and the last.
fn spread(count: usize, most: usize) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    let place = |i: usize| (i * (count - 1) + (most - 1) / 2) / (most - 1);
    (0..most).map(place).collect()
}

/// One instant: its places, those of the other end of its interval and the time to there, voltages and potentials.
struct SolidState {
    here: Configuration,
    there: Option<(Configuration, f64)>,
    scalars: Vec<f64>,
}

impl SolidState {
    fn new(model: &Model, discrete: &DiscreteTrajectory, k: usize) -> Self {
        let placed = |k: usize| model.action.map.placed(&discrete.z[k]);
        let other = match k {
            0 => 1.min(discrete.z.len() - 1),
            _ => k - 1,
        };
        let time = discrete.times[other] - discrete.times[k];
        let scalars = discrete.scalars.get(k.saturating_sub(1)).cloned();
        Self {
            here: placed(k),
            there: (other != k).then(|| (placed(other), time)),
            scalars: scalars.unwrap_or_else(|| vec![0.0; model.action.intervals.scalars]),
        }
    }
}

/// A block at an instant, as shown.
fn grid<'m>(model: &'m Model, number: usize, state: &SolidState) -> UnstructuredGrid<'m> {
    let block = &model.solids[number];
    let mesh = &block.solid.mesh;
    let places = block.places(&state.here.x);
    let potentials = block.potentials(&state.scalars);
    let velocities = state.there.as_ref().map(|(there, time)| {
        let others = block.places(&there.x);
        let pairs = others.iter().zip(&places);
        pairs
            .map(|(there, here)| (there - here) / *time)
            .collect::<Vec<_>>()
    });
    let moved = places.iter().zip(&mesh.nodes);
    let moved = moved.flat_map(|(x, at)| components(&(x - at), 1e-3));
    let mut point_data = vec![field("displacement [m]", 3, moved)];
    if let Some(velocities) = &velocities {
        let values = velocities.iter().flat_map(|v| components(v, 1.0));
        point_data.push(field("velocity [m/s]", 3, values));
    }
    if block.terminals.iter().any(Option::is_some) {
        let known = potentials.iter().zip(&block.terminals);
        let values = known.map(|(phi, terminal)| terminal.map_or(f64::NAN, |_| *phi));
        point_data.push(field("potential [V]", 1, values));
    }
    let is_dielectric = block.is_dielectric.contains(&true);
    let fields = |e: usize| {
        let mut fields = block.fields(e, &places, &potentials);
        if let Some(stress) = model.branch_stress(number, e, &state.here) {
            fields.stress += stress;
        }
        let of_velocities = |velocities| block.viscous_stress(e, &places, velocities);
        if let Some(stress) = velocities.as_deref().and_then(of_velocities) {
            fields.stress += stress;
        }
        fields
    };
    let fields: Vec<Fields> = (0..block.solid.mesh.element_count()).map(fields).collect();
    UnstructuredGrid {
        points: places.iter().map(|x| x * 1e-3).collect(),
        cells: mesh.elements().collect(),
        point_data,
        cell_data: cells(number, block, &fields)
            .into_iter()
            .filter(|field| is_dielectric || !field.name.starts_with("electric"))
            .collect(),
    }
}

/// Quantities of the elements.
fn cells(number: usize, block: &SolidBlock, all: &[Fields]) -> Vec<Field<'static>> {
    let vectors = |name, of: fn(&Fields) -> &Vector| {
        field(name, 3, all.iter().flat_map(|f| components(of(f), 1e3)))
    };
    let numbers = |name, of: fn(&Fields) -> f64| field(name, 1, all.iter().map(of));
    let stresses = all.iter().flat_map(|f| by_rows(&f.stress, 1e6));
    let regions = block.solid.mesh.regions.iter().map(|&r| r as f64);
    vec![
        vectors("electric field [V/m]", |f| &f.electric_field),
        // N/(V mm) is 1000 C/m².
        vectors("electric displacement [C/m^2]", |f| {
            &f.electric_displacement
        }),
        field("stress [Pa]", 9, stresses),
        numbers("von Mises stress [Pa]", |f| 1e6 * f.von_mises()),
        numbers("J", |f| f.jacobian_determinant),
        field("region", 1, regions),
        field("block", 1, all.iter().map(|_| number as f64)),
    ]
}

fn field(
    name: &'static str,
    components: usize,
    values: impl Iterator<Item = f64>,
) -> Field<'static> {
    Field {
        name,
        components,
        values: values.collect(),
    }
}

fn components(vector: &Vector, unit: f64) -> [f64; 3] {
    [0, 1, 2].map(|i| unit * vector[i])
}

fn by_rows(matrix: &Matrix, unit: f64) -> [f64; 9] {
    std::array::from_fn(|i| unit * matrix[(i / 3, i % 3)])
}
