//! A small generator of numbers, the same on every machine.

use proboscis::math::Vector;

/// `splitmix64` of S. Vigna (public domain).
pub struct Random(pub u64);

impl Random {
    /// A number in [−1, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// A number between two bounds.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * 0.5 * (self.unit() + 1.0)
    }

    /// A vector in the cube of half edge 1.
    pub fn vector(&mut self) -> Vector {
        Vector::new(self.unit(), self.unit(), self.unit())
    }
}
