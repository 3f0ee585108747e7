//! A robot and its controller in two processes, which talk over a local socket:
//!
//! ```sh
//! cargo run --release --example two_processes
//! cargo run --release --example two_processes -- PROBLEM 'PLACE=VALUE'...
//! ```
//!
//! The problem is a simulation under a controller with a `horizon`: its scene, step, start, noise and delay are those of the robot, the controller
//! knows the problem of the horizon alone. Without a problem, both muscles of the robot are of finite elements and of stiffer silicone; the controller is that
//! of `problems/pair_observed.json`, which reads the place of the tip, and finds the lasting torque of what it does not know.
//!
//! The controller begins with the names of what it measures. Then both write lines of numbers in SI units: the robot its time and what it measured, the
//! controller the origin of its inputs and these. The robot prints where its markers are in the end.

use proboscis::app::{FileHorizon, SiController};
use proboscis::control::problem::{BoundaryState, FeedbackControl, Simulation, Task};
use proboscis::control::resolve_start;
use proboscis::dynamics::{Stepper, rates_of_momentum};
use proboscis::files::read_problem;
use proboscis::math::Random;
use proboscis::model::{Model, Role, System};
use std::collections::{BTreeMap, VecDeque};
use std::error::Error;
use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::Command;

/// Any mistake.
type Mistake = Box<dyn Error>;

/// The robot without a problem: one of finite elements under the plans of a lumped one, with noise and a delay of an interval.
const PROBLEM: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/problems/pair_receding.json");
const CHANGES: [&str; 6] = [
    "scene.chain.muscles.model=\"finite_elements\"",
    "scene.chain.muscles.elements=[1,1,4]",
    "scene.materials.silicone.shear_modulus=\"110 kPa\"",
    "simulate.duration=\"1 s\"",
    "simulate.step=\"5 ms\"",
    "simulate.controller={\"horizon\":{\"problem\":\"pair_observed.json\",\"intervals\":10},\"noise\":{\"length\":\"0.02 mm\",\"seed\":7}}",
];

fn read(problem: &[String]) -> Result<(System, Simulation, FeedbackControl), Mistake> {
    let (file, changes) = problem.split_first().ok_or("no problem")?;
    let loaded = read_problem(Path::new(file), changes)?;
    let Task::Simulate(simulation) = loaded.task else {
        return Err("expected a simulation".into());
    };
    let controller = simulation.controller.as_deref();
    let controller = controller.filter(|one| one.ahead.is_some());
    let controller = controller.ok_or("expected a controller with a horizon")?;
    let controller = controller.clone();
    Ok((loaded.system, simulation, controller))
}

/// What is measured of a robot.
enum Reading {
    /// A coordinate, or its rate, by its place.
    Coordinate { i: usize, is_rate: bool },
    /// An axis of the place of a marker.
    Place { marker: usize, axis: usize },
}

/// A robot that moves by itself.
struct Robot<'m> {
    model: &'m Model,
    stepper: Stepper<'m>,
    random: Random,
    controller: &'m FeedbackControl,
    readings: Vec<Reading>,
}

impl Robot<'_> {
    /// A reading by its name.
    fn reading(model: &Model, name: &str) -> Result<Reading, Mistake> {
        let place = name.rsplit_once('.').and_then(|(marker, axis)| {
            let mut markers = model.system.markers.iter();
            let marker = markers.position(|one| one.name == marker)?;
            let axis = ["x", "y", "z"].iter().position(|one| *one == axis)?;
            Some(Reading::Place { marker, axis })
        });
        let (coordinate, is_rate) = match name.strip_prefix("rate of ") {
            Some(coordinate) => (coordinate, true),
            None => (name, false),
        };
        let mut coordinates = model.variables.with(Role::Coordinate).iter();
        let i = coordinates.position(|one| one.name == coordinate);
        let coordinate = i.map(|i| Reading::Coordinate { i, is_rate });
        place
            .or(coordinate)
            .ok_or_else(|| format!("this robot has no {name:?}").into())
    }

    /// The place of a marker in m.
    fn marker(&self, marker: usize) -> [f64; 3] {
        let instant = self.model.action.map.placed(self.stepper.coordinates());
        let place = instant.x[self.model.markers[marker]];
        [0, 1, 2].map(|axis| 1e-3 * place[axis])
    }

    /// What is measured, in SI units.
    fn measure(&mut self) -> Vec<f64> {
        let z = self.stepper.coordinates();
        let rates = rates_of_momentum(self.model, z, 0.0, self.stepper.momentum());
        let noise = &self.controller.noise;
        let mut out = Vec::new();
        for reading in &self.readings {
            // From mm, rad/ms and mm/ms.
            let (value, deviation, unit) = match *reading {
                Reading::Place { marker, axis } => {
                    (1e3 * self.marker(marker)[axis], noise.length, 1e-3)
                }
                Reading::Coordinate { i, is_rate } => match (is_rate, self.model.is_length(i)) {
                    (false, false) => (z[i], noise.angle, 1.0),
                    (false, true) => (z[i], noise.length, 1e-3),
                    (true, false) => (rates[i], noise.angular_velocity, 1e3),
                    (true, true) => (rates[i], noise.velocity, 1.0),
                },
            };
            out.push(unit * (value + deviation * self.random.normal()));
        }
        out
    }
}

/// The robot: the places of its markers at the end, in m.
pub fn robot(address: &str, problem: &[String]) -> Result<BTreeMap<String, [f64; 3]>, Mistake> {
    let (system, task, controller) = read(problem)?;
    let model = Model::new(system, task.coordinates, task.step, &[])?;
    let mut line = TcpStream::connect(address)?;
    let mut answers = BufReader::new(line.try_clone()?).lines();
    let mut next =
        || -> Result<String, Mistake> { Ok(answers.next().ok_or("the controller has gone")??) };
    let names = next()?;
    let names = names.split('\t').map(|name| Robot::reading(&model, name));
    let start = resolve_start(&model, &task.start)?;
    let stepper = Stepper::new(&model, &start.z, &start.momentum, task.solving);
    let mut robot = Robot {
        model: &model,
        stepper,
        random: Random::new(controller.noise.seed),
        readings: names.collect::<Result<_, _>>()?,
        controller: &controller,
    };
    let mut voltages = match &task.start {
        BoundaryState::RestAtVoltages(voltages, _) => voltages.clone(),
        _ => vec![0.0; model.sources.len()],
    };
    let inputs = controller.law.inputs.iter().map(|input| {
        let mut sources = model.sources.iter();
        sources.position(|source| source.name == input.name)
    });
    let inputs: Vec<Option<usize>> = inputs.collect();
    // Inputs on their way, with the steps from which they act.
    let mut sent = VecDeque::new();
    let count = |time: f64| (time / task.step).round() as usize;
    for step in 0..count(task.duration) {
        if step % count(controller.sample) == 0 {
            let time = 1e-3 * task.step * step as f64;
            write(&mut line, "", &[vec![time], robot.measure()].concat())?;
            let answer = next()?;
            let mut words = answer.split_whitespace().skip(1);
            let values = inputs.iter().map(|_| {
                words
                    .next()
                    .ok_or("too few inputs")?
                    .parse()
                    .map_err(Mistake::from)
            });
            let values: Vec<f64> = values.collect::<Result<_, Mistake>>()?;
            sent.push_back((step + count(controller.delay), values));
        }
        while sent.front().is_some_and(|(acts, _)| *acts <= step) {
            let values = sent.pop_front().map(|(_, values)| values);
            for (input, value) in inputs.iter().zip(values.into_iter().flatten()) {
                input.iter().for_each(|&source| voltages[source] = value);
            }
        }
        robot.stepper.step(task.step, &model.scalars(&voltages))?;
    }
    let markers = model.system.markers.iter().enumerate();
    let markers = markers.map(|(marker, one)| (one.name.clone(), robot.marker(marker)));
    Ok(markers.collect())
}

fn write(to: &mut TcpStream, word: &str, values: &[f64]) -> std::io::Result<()> {
    let words: Vec<String> = values.iter().map(f64::to_string).collect();
    writeln!(to, "{word} {}", words.join(" "))
}

/// The controller: answers the robot until it has gone, and returns the number of answers by their origin.
pub fn control(
    listener: &TcpListener,
    problem: &[String],
) -> Result<BTreeMap<&'static str, usize>, Mistake> {
    let (_, _, known) = read(problem)?;
    let intervals = known.ahead.map_or(0, |ahead| ahead.intervals);
    let horizon = FileHorizon::new(&known.path, None, intervals)?;
    let mut controller = SiController::new(&horizon);
    let (mut line, _) = listener.accept()?;
    let names = horizon.measured().into_iter().map(|(name, _)| name);
    writeln!(line, "{}", names.collect::<Vec<_>>().join("\t"))?;
    let mut sources = BTreeMap::new();
    for measured in BufReader::new(line.try_clone()?).lines() {
        let numbers = measured?;
        let numbers = numbers.split_whitespace().map(str::parse);
        let numbers: Vec<f64> = numbers.collect::<Result<_, _>>()?;
        let (time, measured) = numbers.split_first().ok_or("a line without numbers")?;
        let (source, inputs) = controller.step(*time, Some(measured));
        write(&mut line, source.word(), inputs)?;
        *sources.entry(source.word()).or_default() += 1;
        controller.prepare();
    }
    Ok(sources)
}

/// The robot without a problem.
pub fn usual() -> Vec<String> {
    let changes = CHANGES.map(str::to_owned).into_iter();
    std::iter::once(PROBLEM.to_owned()).chain(changes).collect()
}

fn main() -> Result<(), Mistake> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [word, address, problem @ ..] = &arguments[..]
        && word == "robot"
    {
        for (marker, place) in robot(address, problem)? {
            let [x, y, z] = place.map(|x| 1e3 * x);
            println!("{marker} ends at ({x:.3}, {y:.3}, {z:.3}) mm");
        }
        return Ok(());
    }
    let problem = match arguments.is_empty() {
        true => usual(),
        false => arguments,
    };
    let listener = TcpListener::bind("127.0.0.1:0")?;
    let mut robot = Command::new(std::env::current_exe()?)
        .args(["robot", &listener.local_addr()?.to_string()])
        .args(&problem)
        .spawn()?;
    for (source, count) in control(&listener, &problem)? {
        println!("{count} answers of origin {source:?}");
    }
    robot.wait()?;
    Ok(())
}
