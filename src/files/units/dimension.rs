//! Dimensions that have no name in uom.

use uom::si::ISQ;
use uom::typenum::{N1, N2, N4, P1, P2, Z0};

/// Of a force for a volume.
pub(super) type Weight = ISQ<N2, P1, N2, Z0, Z0, Z0, Z0>;

/// Of the rate of a voltage.
pub(super) type VoltageRate = ISQ<P2, P1, N4, N1, Z0, Z0, Z0>;
