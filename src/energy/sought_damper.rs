//! Joint dampers whose coefficient is an argument.

use crate::energy::{AngularDamper, CoordinateDamper, Energy, LinearDamper};
use crate::math::Jet;
use nalgebra::SVector;

/// A damper times its last argument: `d W` with the virtual work W of the damper, arguments: its vectors, then d.
#[derive(Clone, Copy, Debug)]
pub struct SoughtDamper<E>(pub E);

macro_rules! sought_damper {
    ($damper:ty, $own:literal, $all:literal) => {
        impl Energy<$all> for SoughtDamper<$damper> {
            type Local<const ORDER: usize> = Jet<$all, ORDER>;

            const READINGS: usize = <$damper as Energy<$own>>::READINGS;
            const VIRTUAL: usize = <$damper as Energy<$own>>::VIRTUAL;
            const ISOTROPIC: bool = <$damper as Energy<$own>>::ISOTROPIC;

            fn couples(i: usize, j: usize) -> bool {
                <$damper as Energy<$own>>::couples(i, j)
            }

            fn at<const ORDER: usize>(
                &self,
                p: &SVector<f64, $all>,
                w: &SVector<f64, $all>,
            ) -> Jet<$all, ORDER> {
                let own = |x: &SVector<f64, $all>| x.fixed_rows::<$own>(0).into_owned();
                let jet: Jet<$own, ORDER> = self.0.at(&own(p), &own(w));
                let mut work = Jet::<$all, ORDER>::constant(jet.value);
                work.value_w = jet.value_w;
                work.gradient
                    .fixed_rows_mut::<$own>(0)
                    .copy_from(&jet.gradient);
                work.gradient_w
                    .fixed_rows_mut::<$own>(0)
                    .copy_from(&jet.gradient_w);
                work.hessian
                    .fixed_view_mut::<$own, $own>(0, 0)
                    .copy_from(&jet.hessian);
                work.hessian_w
                    .fixed_view_mut::<$own, $own>(0, 0)
                    .copy_from(&jet.hessian_w);
                work * Jet::argument($own, p, w)
            }
        }
    };
}

sought_damper!(CoordinateDamper, 6, 7);
sought_damper!(LinearDamper, 18, 19);
sought_damper!(AngularDamper, 27, 28);
