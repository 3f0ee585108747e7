//! Corrections of pressures, S q = r, by conjugate gradients with symmetric sweeps: on grids and on meshes.

/// Residual of a correction relative to that of none, in the norm of the sweeps.
const RESIDUAL: f64 = 0.1;
/// Iterations for one correction.
const LIMIT: usize = 40;

/// Lists by pressure.
pub(super) struct Lists<'l> {
    /// r.
    pub(super) residual: &'l mut [f32],
    /// q.
    pub(super) correction: &'l mut [f32],
    /// The correction that a sweep makes of the residual.
    pub(super) swept: &'l mut [f32],
    pub(super) direction: &'l mut [f32],
    /// S times the direction.
    pub(super) product: &'l mut [f32],
}

/// The matrix S with its lists.
pub(super) trait Schur {
    fn lists(&mut self) -> Lists<'_>;

    /// Writes S times the direction.
    fn multiply(&mut self);

    /// Writes what a sweep forwards and one backwards make of the residual.
    fn sweep(&mut self);
}

fn dot(a: &[f32], b: &[f32]) -> f64 {
    let mut sums = [0.0; 8];
    let (a, b) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest = a.remainder().iter().zip(b.remainder());
    let rest: f64 = rest.map(|(a, b)| f64::from(*a) * f64::from(*b)).sum();
    for (a, b) in a.zip(b) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += f64::from(*a) * f64::from(*b);
        }
    }
    sums.iter().sum::<f64>() + rest
}

/// Sweeps, and returns the product of the residual with what the sweep made of it.
fn swept(of: &mut impl Schur) -> f64 {
    of.sweep();
    let Lists {
        residual, swept, ..
    } = of.lists();
    dot(residual, swept)
}

/// Solves S q = −residual; the residual is lost.
pub(super) fn correct(of: &mut impl Schur) {
    let Lists {
        residual,
        correction,
        ..
    } = of.lists();
    residual.iter_mut().for_each(|value| *value = -*value);
    correction.fill(0.0);
    let mut square = swept(of);
    let lists = of.lists();
    lists.direction.copy_from_slice(lists.swept);
    let enough = RESIDUAL * RESIDUAL * square.abs();
    for _ in 0..LIMIT {
        of.multiply();
        let Lists {
            residual,
            correction,
            direction,
            product,
            ..
        } = of.lists();
        let factor = square / dot(direction, product);
        // Nothing is left, or nothing can be said.
        if !factor.is_finite() {
            break;
        }
        let factor = factor as f32;
        let along = direction.iter().zip(product.iter());
        let both = correction.iter_mut().zip(residual.iter_mut());
        for ((q, residual), (direction, product)) in both.zip(along) {
            *q += factor * direction;
            *residual -= factor * product;
        }
        let next = swept(of);
        if next.is_nan() || next.abs() <= enough {
            break;
        }
        let ratio = (next / square) as f32;
        let lists = of.lists();
        for (direction, swept) in lists.direction.iter_mut().zip(lists.swept.iter()) {
            *direction = swept + ratio * *direction;
        }
        square = next;
    }
}
