//! A kernel of any arity as another crate may write it: one loop makes of its derivatives those of the sum by instants, scalars and
//! interval length. The oracle is the value of the sum, written out, and differences.

use crate::common::random::Random;
use proboscis::functional::{
    BlockMask, Functional, Group, Horizon, Kernel, Order, Sample, ScalarArg, Scatter, Stencil,
    SumDerivatives, VectorArg,
};
use proboscis::math::{Derivatives, Matrix, Vector};

/// `sin u` of a weighted sum u of midpoints, rates and scalars.
#[derive(Clone)]
struct Wave {
    vectors: Vec<usize>,
    /// Weights of the midpoints, then of the rates.
    weights: Vec<Vector>,
    scalars: Vec<ScalarArg>,
    /// Weights of the scalars.
    charges: Vec<f64>,
}

/// f′(u) and f″(u) of a function of u.
struct OfSum<'a>(&'a Wave, [f64; 2]);

impl Derivatives for OfSum<'_> {
    fn force(&self, i: usize) -> Vector {
        self.0.weights[i] * self.1[0]
    }

    fn row(&self, s: usize) -> f64 {
        self.0.charges[s] * self.1[0]
    }

    fn block(&self, i: usize, j: usize) -> Matrix {
        self.0.weights[i] * self.0.weights[j].transpose() * self.1[1]
    }

    fn column(&self, i: usize, s: usize) -> Vector {
        self.0.weights[i] * (self.0.charges[s] * self.1[1])
    }

    fn entry(&self, s: usize, t: usize) -> f64 {
        self.0.charges[s] * self.0.charges[t] * self.1[1]
    }
}

impl Wave {
    fn sum(&self, h: f64, vectors: [&[Vector]; 2], scalar: impl Fn(ScalarArg) -> f64) -> f64 {
        let read = |i| self.vector(i).read(h, vectors);
        let of_vectors = self
            .weights
            .iter()
            .enumerate()
            .map(|(i, w)| w.dot(&read(i)));
        let both = self.scalars.iter().zip(&self.charges);
        of_vectors.sum::<f64>() + both.map(|(&arg, charge)| charge * scalar(arg)).sum::<f64>()
    }
}

impl Kernel for Wave {
    type Storage = ();

    const READINGS: usize = 2;

    fn vectors(&self) -> usize {
        self.vectors.len()
    }

    fn scalars(&self) -> usize {
        self.scalars.len()
    }

    fn vector(&self, i: usize) -> VectorArg {
        let count = self.vectors.len();
        VectorArg {
            vector: self.vectors[i % count],
            stencil: [Stencil::Mid, Stencil::Rate][i / count],
        }
    }

    fn scalar(&self, s: usize) -> Option<(usize, f64)> {
        self.scalars[s].scalar
    }

    fn energy(&self, sample: &Sample<'_>) -> f64 {
        let read = |arg: ScalarArg| arg.read(sample.scalars);
        self.sum(sample.h, sample.vectors, read).sin()
    }

    fn derivatives<S: Scatter>(&self, order: Order, sample: &Sample<'_>, (): &(), to: &mut S) {
        let u = self.sum(sample.h, sample.vectors, |arg| arg.read(sample.scalars));
        let plain = OfSum(self, [u.cos(), -u.sin()]);
        to.plain(&plain);
        if order == Order::Third {
            let rate = |arg: ScalarArg| arg.rate(sample.scalars_along);
            let w = self.sum(sample.h, sample.along, rate);
            to.along(&plain, &OfSum(self, [-u.sin() * w, -u.cos() * w]));
        }
    }
}

const VECTORS: usize = 4;
const SCALARS: usize = 2;
/// Components of the vectors at both instants, scalars, interval length.
const UNKNOWNS: usize = 6 * VECTORS + SCALARS + 1;
const LENGTH: usize = UNKNOWNS - 1;
const STEP: f64 = 1e-5;

/// Two elements of three and two vectors; both scalars are read, one of them twice, and a constant.
fn waves() -> Vec<Wave> {
    let mut random = Random(3);
    let mut wave = |vectors: Vec<usize>, scalars: Vec<ScalarArg>| Wave {
        weights: (0..2 * vectors.len())
            .map(|_| Vector::from_fn(|_, _| 0.3 * random.unit()))
            .collect(),
        charges: scalars.iter().map(|_| 1.0 + random.unit()).collect(),
        vectors,
        scalars,
    };
    let of = |s: usize, factor: f64| ScalarArg {
        constant: 0.2,
        scalar: Some((s, factor)),
    };
    let constant = ScalarArg {
        constant: 0.7,
        scalar: None,
    };
    vec![
        wave(
            vec![2, 0, 3],
            vec![of(1, 2.0), constant, of(0, -0.5), of(1, 0.4)],
        ),
        wave(vec![1, 2], vec![of(0, 1.5)]),
    ]
}

/// Vectors at both instants, scalars, and the length of the interval.
fn unpack(u: &[f64]) -> ([Vec<Vector>; 2], &[f64], f64) {
    let side = |k: usize| {
        let of = &u[3 * VECTORS * k..3 * VECTORS * (k + 1)];
        of.chunks(3).map(Vector::from_column_slice).collect()
    };
    ([side(0), side(1)], &u[6 * VECTORS..LENGTH], u[LENGTH])
}

/// Gradient and Hessian with the border of the length; what the length alone gives is not part of a gradient.
fn dense(part: &SumDerivatives, sum: &Functional) -> (Vec<f64>, Vec<Vec<f64>>) {
    let place = |v: usize, side: usize, c: usize| 3 * (VECTORS * side + v) + c;
    let scalar = |s: usize| 6 * VECTORS + s;
    let mut gradient = vec![0.0; UNKNOWNS];
    let mut hessian = vec![vec![0.0; UNKNOWNS]; UNKNOWNS];
    for (v, side, c) in (0..6 * VECTORS).map(|i| (i / 6, i / 3 % 2, i % 3)) {
        let at = place(v, side, c);
        gradient[at] = part.forces[side][v][c];
        hessian[at][LENGTH] = part.horizon_forces[side][v][c];
    }
    for s in 0..SCALARS {
        gradient[scalar(s)] = part.rows[s];
        hessian[scalar(s)][LENGTH] = part.horizon_rows[s];
    }
    for (&(a, b), blocks) in sum.couplings().full.iter().zip(&part.blocks.full) {
        for (side, block) in blocks.iter().enumerate() {
            for (r, c) in (0..9).map(|i| (i / 3, i % 3)) {
                hessian[place(a, side / 2, r)][place(b, side % 2, c)] += block[(r, c)];
            }
        }
    }
    for (&(a, s), columns) in sum.couplings().mixed.iter().zip(&part.blocks.mixed) {
        for (side, c) in (0..6).map(|i| (i / 3, i % 3)) {
            hessian[place(a, side, c)][scalar(s)] += columns[side][c];
            hessian[scalar(s)][place(a, side, c)] += columns[side][c];
        }
    }
    for (&(s, t), &entry) in sum.couplings().scalars.iter().zip(&part.blocks.scalars) {
        hessian[scalar(s)][scalar(t)] += entry;
        if s != t {
            hessian[scalar(t)][scalar(s)] += entry;
        }
    }
    (gradient, hessian)
}

/// Compares the gradient and Hessian of a scalar with differences of its value and of its gradient.
fn compare(
    u: &[f64],
    value: impl Fn(&[f64]) -> f64,
    derivatives: impl Fn(&[f64]) -> (Vec<f64>, Vec<Vec<f64>>),
) {
    let (gradient, hessian) = derivatives(u);
    assert!(
        gradient[..LENGTH].iter().all(|g| g.abs() > 1e-6),
        "{gradient:?}"
    );
    for j in 0..UNKNOWNS {
        let (mut above, mut below) = (u.to_vec(), u.to_vec());
        above[j] += STEP;
        below[j] -= STEP;
        if j != LENGTH {
            let slope = (value(&above) - value(&below)) / (2.0 * STEP);
            assert!(
                (slope - gradient[j]).abs() < 1e-8,
                "{j}: {slope} {}",
                gradient[j]
            );
        }
        let (after, before) = (derivatives(&above).0, derivatives(&below).0);
        let mut largest = 0.0_f64;
        for i in 0..LENGTH {
            let slope = (after[i] - before[i]) / (2.0 * STEP);
            largest = largest.max(slope.abs());
            assert!(
                (slope - hessian[i][j]).abs() < 1e-8,
                "{i}, {j}: {slope} {}",
                hessian[i][j]
            );
        }
        assert!(largest > 1e-4, "{j} is coupled to nothing");
    }
}

#[test]
fn one_scatter_serves_every_arity() {
    let (scale, waves_of_oracle) = (-0.8, waves());
    let term = Group::intervals("waves", scale, waves());
    let sum = Functional::new(
        vec![std::sync::Arc::new(term)],
        Vec::new(),
        VECTORS,
        SCALARS,
    );
    let mut random = Random(8);
    let mut u: Vec<f64> = (0..UNKNOWNS).map(|_| random.unit()).collect();
    u[LENGTH] = 0.9;
    // A direction of the costates, of all but the length.
    let along: Vec<f64> = (0..UNKNOWNS).map(|_| random.unit()).collect();
    let evaluate = |u: &[f64]| {
        let ([x, y], scalars, h) = unpack(u);
        let ([wx, wy], scalars_along, _) = unpack(&along);
        let sample = Sample {
            vectors: [&x, &y],
            along: [&wx, &wy],
            scalars,
            scalars_along,
            h,
            horizon: Horizon::Free,
            sides: BlockMask::ALL,
            outer: &[],
        };
        let mut out = sum.output(Order::Third);
        sum.evaluate(Order::Third, &sample, &mut out);
        out
    };
    let value = |u: &[f64]| {
        let ([x, y], scalars, h) = unpack(u);
        let wave = |wave: &Wave| {
            let count = wave.vectors.len();
            let mut sum = 0.0;
            for (i, &v) in wave.vectors.iter().enumerate() {
                sum += wave.weights[i].dot(&((x[v] + y[v]) / 2.0));
                sum += wave.weights[count + i].dot(&((y[v] - x[v]) / h));
            }
            for (arg, charge) in wave.scalars.iter().zip(&wave.charges) {
                let unknown = arg.scalar.map_or(0.0, |(s, factor)| scalars[s] * factor);
                sum += charge * (arg.constant + unknown);
            }
            sum.sin()
        };
        scale * h * waves_of_oracle.iter().map(wave).sum::<f64>()
    };
    compare(&u, value, |u| dense(&evaluate(u).plain, &sum));

    let slope = |u: &[f64]| {
        let gradient = dense(&evaluate(u).plain, &sum).0;
        let both = gradient.iter().zip(&along);
        both.map(|(g, w)| g * w).sum::<f64>()
    };
    compare(&u, slope, |u| dense(&evaluate(u).contracted, &sum));
    let far = 1e-3;
    let at = |by: f64| {
        let mut u = u.clone();
        u[LENGTH] += by;
        slope(&u)
    };
    let second = (at(far) - 2.0 * at(0.0) + at(-far)) / (far * far);
    let by_length = evaluate(&u).contracted.horizon;
    assert!(
        by_length.abs() > 1e-3 && (second - by_length).abs() < 1e-4,
        "{second} {by_length}"
    );
}
