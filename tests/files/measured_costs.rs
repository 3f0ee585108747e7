//! Costs of measured quantities in problem files, and their errors.

use crate::objectives::{read, square, with};
use crate::scene::{Case, SCENE, check, mistake};
use proboscis::control::problem::{CostFunction, During, QuantityCost};
use proboscis::model::{FieldPlace, Pulling, Quantity, What};

#[test]
fn measured_quantities_are_costs_along_the_motion_or_at_its_end() {
    let objective = r#"{ "track": [
        { "tension": { "muscle": "muscle1", "at": "2 N", "weight": 3 } },
        { "joint_rate": { "joint": "joint1", "at": "90 deg/s" } },
        { "joint_rate": { "joint": "joint2" } } ],
      "final": [
        { "marker_speed": { "marker": "tip", "weight": 5 } },
        { "electric_field": { "muscle": "muscle1" } },
        { "joint_rate": { "joint": "joint2", "at": "0.2 m/s" } } ] }"#;
    let found = read(objective).objective;
    let muscle = 0;
    let rate = |joint| Quantity::joint_rate(joint);
    let at = |cost: QuantityCost, during| QuantityCost { during, ..cost };
    let itself = |quantity, weight| QuantityCost {
        quantity,
        weight,
        function: CostFunction::Itself,
        during: During::End,
    };
    let speed = Quantity::squared_speed(0);
    let field = Quantity::of(What::Field(FieldPlace::Muscle(muscle))).in_unit(1e3);
    let right = std::f64::consts::FRAC_PI_2;
    let expected = [
        square(Quantity::tension(Pulling::Muscle(muscle)), 3.0, 2.0.into()),
        square(rate(0), 1.0, right.into()),
        square(rate(1), 1.0, 0.0.into()),
        itself(speed, 5.0),
        itself(field, 1.0),
        at(square(rate(1), 1.0, 0.2.into()), During::End),
    ];
    assert_eq!(found.quantities, expected);
}

#[test]
fn measured_costs_that_make_no_sense_are_refused() {
    const COST: &str = r#"{ "track": [ { "tension": { "muscle": "muscle1", "at": "2 N" } } ] }"#;
    let problem = with(COST);
    let whole = "\"tension\": { \"muscle\": \"muscle1\", \"at\": \"2 N\" }";
    #[rustfmt::skip]
    let cases: &[Case] = &[
        ("\"muscle\": \"muscle1\"", "\"muscle\": \"muscle9\"", "control.objective.track[0].tension.muscle", "\"muscle9\"", "the name of a muscle", "\"muscle9\""),
        ("\"2 N\"", "\"2 kPa\"", "control.objective.track[0].tension.at", "which is a stress", "a force", "2 kPa"),
        ("\"2 N\"", "1, \"weight\": 0", "control.objective.track[0].tension.weight", "0", "a positive weight", "0"),
        ("\"muscle\": \"muscle1\", ", "", "control.objective.track[0].tension", "none of them", "exactly one of \"muscle\", \"muscles\"", "{ \"at\""),
        (whole, "\"current\": { \"source\": \"muscle1\" }", "control.objective.track[0].current.source", "\"muscle1\", without a resistor", "a muscle with a \"resistance\"", "\"muscle1\""),
        (whole, "\"electric_field\": { \"muscle\": \"muscle2\" }", "control.objective.track[0].electric_field.muscle", "\"muscle2\", whose material has no electric term", "a muscle of", "\"muscle2\""),
        (whole, "\"joint_rate\": { \"joint\": \"joint2\", \"at\": \"3 deg/s\" }", "control.objective.track[0].joint_rate.at", "which is an angular velocity", "a velocity", "3 deg/s"),
        (whole, "\"marker_speed\": { \"marker\": \"tipp\" }", "control.objective.track[0].marker_speed.marker", "\"tipp\"", "the name of a marker", "\"tipp\""),
    ];
    check(cases, &problem, |problem| mistake(SCENE, problem, &[]));
}
