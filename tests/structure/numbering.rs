//! A variable that is given has no column, one with an equation has a row; the unknowns of a step are those with an equation.

use crate::common::cases::{Case, cases};
use proboscis::control::problem::{BoundaryState, Control, Duration};
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::math::Signal;
use proboscis::model::{Coordinates, Model, Role, System, Time};
use proboscis::nlp::Nlp;
use std::collections::BTreeSet;

/// Returns the names that begin with a text.
fn names<'n>(names: &'n [String], begin: &str) -> Vec<&'n str> {
    let all = names.iter().map(String::as_str);
    all.filter(|name| name.starts_with(begin)).collect()
}

/// Numbers of potentials and given voltages that were seen.
fn check(system: &System, control: &Control) -> [usize; 2] {
    let (intervals, h) = (control.intervals, 10.0);
    // Where inputs that hold the goal are sought, one interval more has inputs and an equilibrium.
    let held = usize::from(control.seeks_hold());
    let (model, boundary) = BoundaryConditions::resolve(system, control, h).unwrap();
    let initial = guess(&model, &boundary, control, h, None);
    let program = Transcription::of_any(&model, &boundary, control, &initial).unwrap();
    let unknowns = program.unknowns();
    let columns: Vec<String> = (0..unknowns.columns.len())
        .map(|i| program.variable_name(i))
        .collect();
    let rows: Vec<String> = (0..unknowns.rows.len())
        .map(|i| program.constraint_name(i))
        .collect();

    // Every voltage and load of the system acts in these problems.
    let sources: Vec<usize> = (0..model.sources.len())
        .filter(|&s| model.sources[s].acts())
        .collect();
    let voltage = |k: usize, s: usize| {
        let source = &model.sources[s];
        let role = if source.is_load() {
            "load"
        } else {
            "voltage of"
        };
        format!("{role} {} in interval {k}", source.name)
    };
    // What follows a time that is sought has a column too, and a row in place of its balance.
    let is_open = |s: usize| !control.given.contains_key(&s) || control.follows_time(s);
    let sought = (0..intervals + held).flat_map(|k| {
        let open = sources.iter().filter(|&&s| is_open(s));
        open.map(move |&s| voltage(k, s))
    });
    let inputs = [names(&columns, "voltage of "), names(&columns, "load ")].map(|list| list.len());
    let sought: Vec<String> = sought.collect();
    assert_eq!(inputs[0] + inputs[1], sought.len());
    assert!(sought.iter().all(|name| columns.contains(name)));
    for entry in &unknowns.inputs {
        let (k, s) = (entry.place / sources.len(), entry.input);
        assert_eq!(s, entry.place % sources.len());
        assert_eq!(columns[entry.column], voltage(k, sources[s]));
    }

    let potentials = names(&columns, "potential of ");
    let laws = names(&rows, "Gauss's law of ");
    let count = model.action.intervals.scalars - sources.len();
    assert_eq!(potentials.len(), count * (intervals + held));
    let of = |list: Vec<&str>, begin: &str| {
        let rest = |name: &str| name[begin.len()..].to_owned();
        list.into_iter().map(rest).collect::<Vec<_>>()
    };
    assert_eq!(
        of(potentials.clone(), "potential of "),
        of(laws, "Gauss's law of ")
    );

    let map = &model.action.map;
    let (n, m) = (map.coordinates, map.multipliers);
    let goal = &boundary.goal.coordinates[..n];
    let open = goal.iter().filter(|value| value.is_none()).count();
    let multipliers = names(&columns, "multiplier of ").len();
    // A free end and that of a periodic motion have no balance for a constraint force.
    let is_free = matches!(control.goal, BoundaryState::Free | BoundaryState::Periodic);
    assert_eq!(multipliers, (intervals + held + usize::from(!is_free)) * m);
    assert_eq!(names(&rows, "equilibrium at the goal, ").len(), held * n);
    let balances = names(&rows, "rest at the goal, ").len();
    assert_eq!(balances == 0, is_free, "{balances} balances at the end");
    // At the start, and where the goal gives all, nothing is left for a constraint to decide.
    let decided = 1 + usize::from(open == 0);
    let constraints = names(&rows, "constraint ").len();
    assert_eq!(constraints, (intervals + 1 - decided) * m);
    let free = usize::from(matches!(control.duration, Duration::Free { .. }));
    assert_eq!(names(&columns, "interval length").len(), free);
    let others = columns.len() - unknowns.inputs.len() - potentials.len() - multipliers - free;
    assert_eq!(others, (intervals - 1) * n + open);
    step(&model, n + m + count);
    [count, control.given.len()]
}

/// The unknowns of a step, of which there are so many.
fn step(model: &Model, count: usize) {
    let variables = &model.variables;
    let all = [Time::Instant, Time::Interval].map(|time| variables.of(time));
    let solved: Vec<String> = all
        .into_iter()
        .flatten()
        .filter(|variable| variable.source.is_none())
        .map(ToString::to_string)
        .collect();
    let unknowns: Vec<String> = variables.unknowns().map(ToString::to_string).collect();
    assert_eq!((&unknowns, unknowns.len()), (&solved, count));
    assert_eq!(variables.unknown_count(), count);
    assert_eq!(unknowns.iter().collect::<BTreeSet<_>>().len(), count);
    assert_eq!(model.sizes().len(), count);
    for (i, name) in solved.iter().enumerate() {
        assert_eq!(variables.unknown(i).to_string(), *name);
    }
    for (s, variable) in variables.of(Time::Interval).iter().enumerate() {
        let name = variables.place(s).map(|i| &solved[i]);
        let expected = variable.source.is_none().then(|| variable.to_string());
        assert_eq!(name, expected.as_ref());
        let place = variable.source.map(|source| variables.input(source));
        assert_eq!(
            place,
            matches!(variable.role, Role::Voltage | Role::Load).then_some(Some(s))
        );
    }
}

#[test]
fn columns_are_what_is_not_given_and_rows_what_has_an_equation() {
    let (mut potentials, mut given) = (0, 0);
    for Case {
        name,
        system,
        control,
    } in cases()
    {
        println!("{name}");
        for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
            let mut control = Control {
                coordinates: Some(coordinates),
                ..control.clone()
            };
            let count = check(&system, &control);
            potentials += count[0];
            let takes = |s: &usize| system.sources()[*s].takes_voltage;
            let first = (0..system.sources().len()).find(takes).unwrap();
            control.given.insert(first, Signal::Constant(300.0));
            given += check(&system, &control)[1];
        }
    }
    assert!(potentials > 10 && given > 10, "{potentials} {given}");
}
