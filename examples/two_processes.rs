//! A robot and its controller in two processes, which talk over a local socket: `cargo run --release --example two_processes`.
//!
//! The robot is stiffer than the controller knows, its measurements are noisy, and inputs act an interval after they came. The controller is that of
//! `problems/pair_observed.json` over a receding horizon: it reads the place of the tip, and finds the lasting torque of the stiffer silicone.
//!
//! Both write lines of numbers in SI units: the robot its time and the place of its tip, the controller the voltages that act from the next interval
//! on. The robot prints how far its tip is from that of the goal in the end.

use proboscis::app::{FileHorizon, SiController};
use proboscis::dynamics::Stepper;
use proboscis::files::read_problem;
use proboscis::model::Model;
use std::error::Error;
use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command};

/// Interval of the problem in ms, steps of the robot in it, and intervals of its motion: 1 s.
const INTERVAL: f64 = 10.0;
const STEPS: usize = 10;
const INTERVALS: usize = 100;
/// Intervals of the horizon.
const AHEAD: usize = 10;
/// Standard deviation of the measured places in m.
const NOISE: f64 = 2e-5;

fn problem() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/pair_observed.json")
}

/// Numbers of a line.
fn numbers(line: &str) -> Result<Vec<f64>, Box<dyn Error>> {
    let all = line.split_whitespace().map(str::parse);
    Ok(all.collect::<Result<_, _>>()?)
}

fn write(to: &mut TcpStream, values: &[f64]) -> std::io::Result<()> {
    let words: Vec<String> = values.iter().map(f64::to_string).collect();
    writeln!(to, "{}", words.join(" "))
}

/// The robot: its tip at the end, in m.
pub fn robot(address: &str) -> Result<[f64; 2], Box<dyn Error>> {
    let stiffer = "scene.materials.silicone.shear_modulus=\"110 kPa\"".to_owned();
    let system = read_problem(&problem(), &[stiffer])?.system;
    let model = Model::new(system, None, INTERVAL, &[])?;
    let mut line = TcpStream::connect(address)?;
    let mut answers = BufReader::new(line.try_clone()?).lines();
    let momentum = vec![0.0; model.coordinate_count()];
    let z = model.reference_coordinates();
    let mut stepper = Stepper::new(&model, &z, &momentum, Default::default());
    let tip = |z: &[f64]| {
        let place = model.action.map.placed(z).x[model.markers[0]];
        [0, 1, 2].map(|axis| 1e-3 * place[axis])
    };
    let mut random = 7_u64;
    let mut noise = || {
        // The sum of twelve even numbers is nearly normal.
        let mut sum = -6.0;
        for _ in 0..12 {
            random = random
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            sum += (random >> 11) as f64 / (1_u64 << 53) as f64;
        }
        NOISE * sum
    };
    let mut acting = vec![0.0; 2];
    for k in 0..INTERVALS {
        let measured = tip(stepper.coordinates()).map(|x| x + noise());
        let time = 1e-3 * INTERVAL * k as f64;
        write(&mut line, &[&[time][..], &measured].concat())?;
        let next = numbers(&answers.next().ok_or("the controller has gone")??)?;
        for _ in 0..STEPS {
            stepper.step(INTERVAL / STEPS as f64, &model.scalars(&acting))?;
        }
        acting = next;
    }
    let [x, y, _] = tip(stepper.coordinates());
    Ok([x, y])
}

/// The controller: answers the robot until it has gone, and returns the number of answers that are those of a plan.
pub fn control(listener: &TcpListener) -> Result<usize, Box<dyn Error>> {
    let horizon = FileHorizon::new(&problem(), None, AHEAD)?;
    let mut controller = SiController::new(&horizon);
    let (mut line, _) = listener.accept()?;
    let mut planned = 0;
    for measured in BufReader::new(line.try_clone()?).lines() {
        let measured = numbers(&measured?)?;
        let (source, inputs) = controller.step(measured[0], Some(&measured[1..]));
        planned += usize::from(source.word() == "plan");
        write(&mut line, inputs)?;
        controller.prepare();
    }
    Ok(planned)
}

/// Starts the robot as a process of this program, for an address.
fn start(address: &str) -> std::io::Result<Child> {
    Command::new(std::env::current_exe()?)
        .args(["robot", address])
        .spawn()
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [word, address] = &arguments[..]
        && word == "robot"
    {
        let [x, y] = robot(address)?;
        println!("the tip ends at ({:.3}, {:.3}) mm", 1e3 * x, 1e3 * y);
        return Ok(());
    }
    let listener = TcpListener::bind("127.0.0.1:0")?;
    let mut robot = start(&listener.local_addr()?.to_string())?;
    let planned = control(&listener)?;
    println!("{planned} answers of the plan");
    robot.wait()?;
    Ok(())
}
