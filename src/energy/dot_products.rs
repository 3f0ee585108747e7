//! Virtual works and other functions of dot products of vectors, with their derivatives by the vectors.

use crate::energy::WithDerivatives;
use crate::math::{Derivatives, Jet};
use nalgebra::{Matrix3, SVector, Vector3};

/// A sum of such works of `K` vectors.
#[derive(Clone, Copy, Debug)]
pub struct OfDotProducts<const K: usize> {
    vectors: [Vector3<f64>; K],
    pub(super) value: f64,
    pub(super) gradient: [Vector3<f64>; K],
    pub(super) hessian: [[Matrix3<f64>; K]; K],
}

/// A sum of dot products of pairs of vectors, by their numbers; of a vector with itself it is half of the square.
pub(super) type Product<'a> = &'a [[usize; 2]];

/// Vectors of a product, each with the other one, which is the derivative by it; once a vector with itself.
fn ends(product: Product<'_>) -> impl Iterator<Item = [usize; 2]> {
    let both = |&[i, j]: &[usize; 2]| [[i, j], [j, i]].into_iter().take(1 + usize::from(i != j));
    product.iter().flat_map(both)
}

impl<const K: usize> OfDotProducts<K> {
    /// Zero.
    pub(super) fn new(vectors: [Vector3<f64>; K]) -> Self {
        Self {
            vectors,
            value: 0.0,
            gradient: [Vector3::zeros(); K],
            hessian: [[Matrix3::zeros(); K]; K],
        }
    }

    /// Adds the sum of `V` products with virtual vectors, each times a function of `D` other products.
    pub(super) fn add<const V: usize, const D: usize>(
        &mut self,
        virtuals: [Product<'_>; V],
        products: [Product<'_>; D],
        factors: impl FnOnce([Jet<D, 2>; D]) -> [Jet<D, 2>; V],
    ) {
        let factors = factors(self.arguments(products));
        let mut sum = Jet::<D, 2>::constant(0.0);
        for (product, factor) in virtuals.into_iter().zip(factors) {
            sum = sum + factor * self.product(product);
            self.add_slope(product, factor.value);
            let turned = self.turned(products, &factor.gradient);
            self.add_outer(product, &turned, true);
        }
        self.add_function(products, sum);
    }

    /// Products as arguments of a function.
    pub(super) fn arguments<const D: usize>(&self, products: [Product<'_>; D]) -> [Jet<D, 2>; D] {
        let at = SVector::from(products.map(|product| self.product(product)));
        let none = SVector::zeros();
        std::array::from_fn(|a| Jet::argument(a, &at, &none))
    }

    /// Adds a function of products.
    pub(super) fn add_function<const D: usize>(
        &mut self,
        products: [Product<'_>; D],
        sum: Jet<D, 2>,
    ) {
        self.value += sum.value;
        for (a, product) in products.into_iter().enumerate() {
            self.add_slope(product, sum.gradient[a]);
            let turned = self.turned(products, &sum.hessian.column(a).into());
            self.add_outer(product, &turned, false);
        }
    }

    fn product(&self, product: Product<'_>) -> f64 {
        let parts = product.iter().map(|&[i, j]| {
            let factor = if i == j { 0.5 } else { 1.0 };
            self.vectors[i].dot(&self.vectors[j]) * factor
        });
        parts.sum()
    }

    /// Adds the derivatives of a product times a slope.
    fn add_slope(&mut self, product: Product<'_>, slope: f64) {
        for [i, other] in ends(product) {
            self.gradient[i] += self.vectors[other] * slope;
            self.hessian[i][other] += Matrix3::from_diagonal_element(slope);
        }
    }

    /// Derivatives by the vectors of a sum of products times slopes.
    pub(super) fn turned<const D: usize>(
        &self,
        products: [Product<'_>; D],
        slopes: &SVector<f64, D>,
    ) -> [Vector3<f64>; K] {
        let mut turned = [Vector3::zeros(); K];
        for (product, slope) in products.into_iter().zip(slopes) {
            for [i, other] in ends(product) {
                turned[i] += self.vectors[other] * *slope;
            }
        }
        turned
    }

    /// Adds the products of the derivatives of a product and of others, in both orders where asked for.
    fn add_outer(&mut self, product: Product<'_>, turned: &[Vector3<f64>; K], in_both: bool) {
        for [i, other] in ends(product) {
            for (k, turned) in turned.iter().enumerate() {
                let block = self.vectors[other] * turned.transpose();
                self.hessian[i][k] += block;
                if in_both {
                    self.hessian[k][i] += block.transpose();
                }
            }
        }
    }
}

impl<const K: usize> WithDerivatives for OfDotProducts<K> {
    fn scalar(&self) -> f64 {
        self.value
    }
}

impl<const K: usize> Derivatives for OfDotProducts<K> {
    fn force(&self, i: usize) -> Vector3<f64> {
        self.gradient[i]
    }

    fn block(&self, i: usize, j: usize) -> Matrix3<f64> {
        self.hessian[i][j]
    }
}
