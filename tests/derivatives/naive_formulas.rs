//! Every formula written anew over dual numbers, without thought of speed.

use crate::naive_hexahedron::{contracted, inverse, inverse_strain, product, transposed};
use num_dual::{Dual, DualNum};
use proboscis::energy::{
    Angle, AngleStep, AngularDamper, Capacitance, Coincidence, CoordinateDamper, CoordinateSpring,
    CoordinateStops, DeadLoad, DielectricCell, ElasticCell, Energy, FlowingCharge,
    FlowingChargeField, FollowingForce, GivenCharge, GivenChargeField, Gravity, JointAngle,
    JointDisplacement, LinearDamper, LinearSpring, MaxwellCell, MaxwellDamper, Multiple,
    Orthogonality, OutsideBox, PeakExcess, PositionComponent, Projection, ProjectionStep,
    SectionInertia, SpanDamper, SquaredDistance, SquaredField, SurfaceCharge, ViscousCell,
};

/// The naive formula of an energy.
pub(crate) trait Formula<const M: usize>: Energy<M> {
    /// Number of its arguments that are vectors.
    const VECTORS: usize = M / 3;
    /// False of an energy that is only measured, of which nobody asks for rates.
    const HAS_RATES: bool = true;

    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; M]) -> D;
}

pub(crate) fn three<D: Copy>(p: &[D], at: usize) -> [D; 3] {
    [p[at], p[at + 1], p[at + 2]]
}

pub(crate) fn squared_length<D: DualNum<f64> + Copy>(a: [D; 3]) -> D {
    a[0].powi(2) + a[1].powi(2) + a[2].powi(2)
}

/// a·b = (|a + b|² − |a − b|²)/4.
pub(crate) fn polarised<D: DualNum<f64> + Copy>(a: [D; 3], b: [D; 3]) -> D {
    let sum = [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
    let difference = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    (squared_length(sum) - squared_length(difference)) * 0.25
}

/// Λ = |r|/L₀.
fn stretch<D: DualNum<f64> + Copy>(r: [D; 3], length: f64) -> D {
    squared_length(r).sqrt() / length
}

/// The derivative along `rate`, as a number.
pub(crate) fn along<D: DualNum<f64> + Copy, const K: usize>(
    p: [D; K],
    rate: [D; K],
    f: impl Fn([Dual<D, f64>; K]) -> Dual<D, f64>,
) -> D {
    f(std::array::from_fn(|i| Dual::new(p[i], rate[i]))).eps
}

impl Formula<3> for ElasticCell {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 3]) -> D {
        let s = stretch(*p, self.length);
        (s.powi(2) + s.recip() * 2.0 - 3.0) * (0.5 * self.shear_modulus * self.volume)
    }
}

impl Formula<4> for DielectricCell {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 4]) -> D {
        let s = stretch(three(p, 0), self.elastic.length);
        // The energy density at F = diag(Λ^(−1/2), Λ^(−1/2), Λ), E = (0, 0, V/t): C:(E⊗E) = Λ²E², C⁻¹:(E⊗E) = E²/Λ².
        let field = p[3] / self.layer;
        let density = (s.powi(2) + s.recip() * 2.0 - 3.0) * (0.5 * self.elastic.shear_modulus)
            + field.powi(2) * self.c1
            + (s * field).powi(2) * self.c2
            - (field / s).powi(2) * (0.5 * self.permittivity);
        density * self.elastic.volume
    }
}

/// Of layers of the thickness t Λ and the area V₀/(t Λ) each, with the permittivity along the field of docs/theory.md, 2.4.
impl Formula<3> for Capacitance {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 3]) -> D {
        let s = stretch(*p, self.cell.elastic.length);
        let permittivity = -s.powi(2) * (2.0 * self.cell.c2) - 2.0 * self.cell.c1
            + s.powi(-2) * self.cell.permittivity;
        permittivity * (self.cell.elastic.volume / self.cell.layer.powi(2))
    }
}

/// Q²/(2C).
fn charged<D: DualNum<f64> + Copy>(capacitance: &Capacitance, r: [D; 3], charge: D) -> D {
    (capacitance.naive(&r) * 2.0).recip() * charge.powi(2)
}

impl Formula<4> for GivenCharge {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 4]) -> D {
        charged(&self.capacitance, three(p, 0), p[3])
    }
}

impl Formula<6> for FlowingCharge {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 6]) -> D {
        charged(&self.capacitance, three(p, 0), p[3] * self.unit)
    }
}

/// (U/(Λ E))² of the voltage U with ½ Q U stored.
fn field_of_charge<D: DualNum<f64> + Copy>(of: &GivenChargeField, r: [D; 3], charge: D) -> D {
    let voltage = charged(&of.capacitance, r, charge) * 2.0 / charge;
    (voltage / (stretch(r, of.capacitance.cell.elastic.length) * of.voltage)).powi(2)
}

impl Formula<4> for GivenChargeField {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 4]) -> D {
        field_of_charge(self, three(p, 0), p[3])
    }
}

impl Formula<6> for FlowingChargeField {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 6]) -> D {
        field_of_charge(&self.field, three(p, 0), p[3] * self.unit)
    }
}

impl Formula<6> for SectionInertia {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 6]) -> D {
        let (r, v) = (three(p, 0), three(p, 3));
        let s = stretch(r, self.length);
        let rate = along(r, v, |r| stretch(r, self.length));
        // ½ ρV₀ (X̂² + Ŷ²)/48 Λ̇²/Λ³, where the moment holds the same over 192.
        rate.powi(2) / s.powi(3) * (0.5 * 4.0 * self.moment)
    }
}

impl Formula<9> for ViscousCell {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 9]) -> D {
        let (delta, r, v) = (three(p, 0), three(p, 3), three(p, 6));
        // −1.5 η V₀ Λ̇ δΛ/Λ²; no length at rest is left in it.
        let of = |direction| along(r, direction, |r| stretch(r, 0.7));
        -of(v) * of(delta) / stretch(r, 0.7).powi(2) * self.coefficient
    }
}

impl Formula<3> for LinearSpring {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 3]) -> D {
        (squared_length(*p).sqrt() - self.length).powi(2) * (0.5 * self.stiffness)
    }
}

impl Formula<9> for SpanDamper {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 9]) -> D {
        let (delta, r, v) = (three(p, 0), three(p, 3), three(p, 6));
        let of = |direction| along(r, direction, |r| squared_length(r).sqrt());
        -of(v) * of(delta) * self.coefficient
    }
}

/// The angle of the vector c in the plane (a, b), by half of it: tan(θ/2) = s/(r + c), r² = s² + c²; for c < 0 by half of π − θ.
fn half_angle<D: DualNum<f64> + Copy>(p: [D; 9]) -> D {
    let cosine = polarised(three(&p, 0), three(&p, 6));
    let sine = polarised(three(&p, 3), three(&p, 6));
    let radius = (sine.powi(2) + cosine.powi(2)).sqrt();
    if cosine.re() > 0.0 {
        (sine / (radius + cosine)).atan() * 2.0
    } else {
        (sine / (radius - cosine)).atan() * -2.0 + std::f64::consts::PI * sine.re().signum()
    }
}

impl Formula<9> for Angle {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 9]) -> D {
        let angle = half_angle(*p);
        let turns = ((self.near - angle.re()) / std::f64::consts::TAU).round();
        angle + turns * std::f64::consts::TAU
    }
}

impl Formula<27> for AngularDamper {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 27]) -> D {
        let part = |at: usize| -> [D; 9] { std::array::from_fn(|i| p[at + i]) };
        let of = |direction| along(part(9), direction, half_angle);
        -of(part(18)) * of(part(0)) * self.coefficient
    }
}

impl Formula<6> for CoordinateDamper {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 6]) -> D {
        -polarised(three(p, 3), three(p, 0)) * self.coefficient
    }
}

impl Formula<4> for DeadLoad {
    const VECTORS: usize = 1;

    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 4]) -> D {
        let force = three(self.force.as_slice(), 0).map(D::from);
        -polarised(force, three(p, 0)) * p[3]
    }
}

impl Formula<13> for FollowingForce {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 13]) -> D {
        polarised(three(p, 0), three(p, 9)) * p[12]
    }
}

impl Formula<2> for SurfaceCharge {
    const VECTORS: usize = 0;

    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 2]) -> D {
        ((p[0] + p[1]).powi(2) - (p[0] - p[1]).powi(2)) * self.weight / 4.0
    }
}

impl Formula<3> for CoordinateSpring {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 3]) -> D {
        let twice = p[0] * (p[0] - 2.0 * self.rest) + self.rest.powi(2);
        twice * self.stiffness / 2.0
    }
}

impl Formula<3> for CoordinateStops {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 3]) -> D {
        // The force is the integral of a stiffness that grows over the width, the energy that of the force.
        let side = |beyond: D| {
            let (k, w) = (self.stiffness, self.smoothing);
            match beyond.re() {
                x if x <= -0.5 * w => D::from(0.0),
                x if x < 0.5 * w => {
                    let t = beyond / w + 0.5;
                    (t.powi(4) / 4.0 - t.powi(5) / 10.0) * (k * w * w)
                }
                _ => beyond * beyond * (0.5 * k) + (0.25 - 0.1 - 0.125) * k * w * w,
            }
        };
        side(p[0] - self.at[1]) + side(-p[0] + self.at[0])
    }
}

impl Formula<6> for MaxwellCell {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 6]) -> D {
        let elastic = (stretch(three(p, 0), self.length).ln() - p[3]).exp();
        (elastic.powi(2) + elastic.recip() * 2.0 - 3.0) * (0.5 * self.shear_modulus * self.volume)
    }
}

impl Formula<18> for MaxwellDamper {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 18]) -> D {
        let strain = |at: usize| [p[at], p[at + 1], p[at + 3], p[at + 4], p[at + 5]];
        let middle = strain(6);
        let rate = |at: usize| -> [[D; 3]; 3] {
            std::array::from_fn(|i| {
                std::array::from_fn(|j| along(middle, strain(at), |q| inverse_strain(q)[i][j]))
            })
        };
        let left = inverse(inverse_strain(middle));
        let [real, imagined] = [rate(12), rate(0)].map(|rate| product(left, rate));
        -contracted(real, transposed(imagined)) * (0.5 * self.coefficient)
    }
}

impl Formula<13> for JointAngle {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 13]) -> D {
        // |c| sin(φ − θ) in the plane (a, b), by the angle itself.
        let cosine = polarised(three(p, 0), three(p, 6));
        let sine = polarised(three(p, 3), three(p, 6));
        let angle = half_angle(std::array::from_fn(|i| p[i]));
        (sine.powi(2) + cosine.powi(2)).sqrt() * (angle - p[9]).sin() * p[12]
    }
}

impl Formula<10> for JointDisplacement {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 10]) -> D {
        polarised(three(p, 0), three(p, 3)) * p[9] - p[6] * p[9]
    }
}

impl Formula<18> for LinearDamper {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 18]) -> D {
        let part = |at: usize| -> [D; 6] { std::array::from_fn(|i| p[at + i]) };
        let of = |direction| {
            along(part(6), direction, |q| {
                polarised(three(&q, 0), three(&q, 3))
            })
        };
        -of(part(12)) * of(part(0)) * self.coefficient
    }
}

impl Formula<3> for Gravity {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 3]) -> D {
        -polarised(
            *p,
            [self.weight.x, self.weight.y, self.weight.z].map(D::from),
        )
    }
}

impl Formula<7> for Orthogonality {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 7]) -> D {
        (polarised(three(p, 0), three(p, 3)) - self.product) * p[6] * self.factor
    }
}

impl Formula<6> for Coincidence {
    const VECTORS: usize = 1;

    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 6]) -> D {
        polarised(three(p, 3), three(p, 0))
    }
}

impl Formula<6> for Projection {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 6]) -> D {
        polarised(three(p, 0), three(p, 3))
    }
}

impl Formula<3> for PositionComponent {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 3]) -> D {
        let normal = [self.normal.x, self.normal.y, self.normal.z].map(D::from);
        polarised(*p, normal) - self.origin.dot(&self.normal)
    }
}

impl Formula<3> for SquaredDistance {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 3]) -> D {
        let d = std::array::from_fn(|i| p[i] - self.centre[i]);
        (squared_length(d).sqrt() / self.scale).powi(2)
    }
}

impl Formula<3> for OutsideBox {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 3]) -> D {
        let power = |i: usize| {
            let square = ((p[i] - self.centre[i]) / self.half[i]).powi(2);
            let fourth = square * square;
            fourth * fourth * fourth * fourth
        };
        power(0) + power(1) + power(2)
    }
}

impl Formula<4> for SquaredField {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 4]) -> D {
        (p[3] / (stretch(three(p, 0), self.length) * self.voltage)).powi(2)
    }
}

impl Formula<1> for Multiple {
    const VECTORS: usize = 0;

    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 1]) -> D {
        p[0] / self.unit
    }
}

impl Formula<2> for PeakExcess {
    const VECTORS: usize = 0;

    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 2]) -> D {
        (p[0] - p[1]) * (p[0] + p[1]) / (self.unit * self.unit)
    }
}

impl Formula<18> for AngleStep {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 18]) -> D {
        let part = |at: usize| -> [D; 9] { std::array::from_fn(|i| p[at + i]) };
        let step = half_angle(part(9)) - half_angle(part(0));
        let turns = (step.re() / std::f64::consts::TAU).round();
        step - turns * std::f64::consts::TAU
    }
}

impl Formula<12> for ProjectionStep {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 12]) -> D {
        polarised(three(p, 6), three(p, 9)) - polarised(three(p, 0), three(p, 3))
    }
}
