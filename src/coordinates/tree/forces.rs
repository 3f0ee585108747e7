//! Forces on vectors, pulled back to joint coordinates: rows, curvature, and its derivative along a direction.

use crate::coordinates::configuration::{Configuration, Moments, TreeState};
use crate::coordinates::tree::{LinkKind, Tree};
use crate::math::Vector;

impl Tree {
    /// Adds Pᵀ R for the forces on all vectors, without columns: `a·τ` about each link, gathered from the leaves to the
    /// root (slide: `a·f`).
    pub fn pull_back(&self, state: &mut TreeState, forces: &[Vector], rows: &mut [f64]) {
        state.wrenches.fill([Vector::zeros(); 2]);
        for (term, x) in self.terms.iter().zip(&state.terms) {
            let force = &forces[term.vector];
            let [torque, sum] = &mut state.wrenches[self.carrier[term.body]];
            *torque += x.cross(force);
            *sum += force * term.centre;
        }
        for (j, link) in self.links.iter().enumerate().rev() {
            let [torque, force] = state.wrenches[j];
            if let Some(before) = self.before[j] {
                state.wrenches[before][0] += torque;
                state.wrenches[before][1] += force;
            }
            let axis = state.axes[j];
            match (link.coordinate, link.kind) {
                (Some(c), LinkKind::Turn) => {
                    rows[c] += axis.dot(&(torque - state.points[j].cross(&force)));
                }
                (Some(c), _) => rows[c] += axis.dot(&force),
                (None, _) => {}
            }
        }
    }

    /// Moments of the forces R on all vectors, gathered from the leaves to the root; with rates along l where `rates`
    /// holds the contracted forces.
    fn gather(&self, instant: &mut Configuration, rates: bool) {
        let Configuration {
            forces,
            contracted,
            tree,
            ..
        } = instant;
        tree.moments.fill(Moments::default());
        for (t, term) in self.terms.iter().enumerate() {
            let (x, force) = (&tree.terms[t], &forces[term.vector]);
            let m = &mut tree.moments[self.carrier[term.body]];
            m.moment += x * force.transpose();
            m.force += force * term.centre;
            if rates {
                let rate = &contracted[term.vector];
                m.moment_l += tree.terms_l[t] * force.transpose() + x * rate.transpose();
                m.force_l += rate * term.centre;
            }
        }
        for j in (0..self.links.len()).rev() {
            if let Some(i) = self.before[j] {
                let m = tree.moments[j];
                let sum = &mut tree.moments[i];
                sum.moment += m.moment;
                sum.force += m.force;
                sum.moment_l += m.moment_l;
                sum.force_l += m.force_l;
            }
        }
    }

    /// Adds R·P′ at the slots of `curvature_entries`, both orders: `slots[e]` is (i, k), (k, i).
    pub fn curvature(&self, instant: &mut Configuration, slots: &[[usize; 2]], values: &mut [f64]) {
        self.gather(instant, false);
        let tree = &instant.tree;
        let mut of = usize::MAX;
        let mut y = Vector::zeros();
        for (&(i, k), slot) in self.paths.iter().zip(slots) {
            if k != of {
                of = k;
                let m = &tree.moments[k];
                let axis = tree.axes[k];
                y = match self.links[k].kind {
                    LinkKind::Turn => {
                        let moment = m.moment - tree.points[k] * m.force.transpose();
                        moment * axis - axis * moment.trace()
                    }
                    _ => axis.cross(&m.force),
                };
            }
            let value = tree.axes[i].dot(&y);
            values[slot[0]] += value;
            if i != k {
                values[slot[1]] += value;
            }
        }
    }

    /// Adds (Hᵀw)·P′ + R·P″_l at the slots of `curvature_entries`, both orders.
    pub fn curvature_along(
        &self,
        instant: &mut Configuration,
        slots: &[[usize; 2]],
        values: &mut [f64],
    ) {
        self.gather(instant, true);
        let tree = &instant.tree;
        let mut of = usize::MAX;
        let (mut y, mut y_l) = (Vector::zeros(), Vector::zeros());
        for (&(i, k), slot) in self.paths.iter().zip(slots) {
            if k != of {
                of = k;
                let m = &tree.moments[k];
                let (a, a_l) = (tree.axes[k], tree.axes_l[k]);
                (y, y_l) = match self.links[k].kind {
                    LinkKind::Turn => {
                        let (c, c_l) = (tree.points[k], tree.points_l[k]);
                        let n = m.moment - c * m.force.transpose();
                        let n_l =
                            m.moment_l - c_l * m.force.transpose() - c * m.force_l.transpose();
                        (
                            n * a - a * n.trace(),
                            n_l * a + n * a_l - a_l * n.trace() - a * n_l.trace(),
                        )
                    }
                    _ => (a.cross(&m.force), a_l.cross(&m.force) + a.cross(&m.force_l)),
                };
            }
            let value = tree.axes_l[i].dot(&y) + tree.axes[i].dot(&y_l);
            values[slot[0]] += value;
            if i != k {
                values[slot[1]] += value;
            }
        }
    }
}
