//! Disjoint sets against reachability.

use crate::math::DisjointSets;
use crate::math::Random;

/// Against the reachability of every pair by repeated passes over the list of pairs.
#[test]
fn sets_are_what_is_reachable() {
    let mut random = Random::new(7);
    let (mut alone, mut together) = (0, 0);
    for _ in 0..50 {
        let n = 12;
        let mut draw = || (random.between(0.0, n as f64) as usize).min(n - 1);
        let pairs: Vec<(usize, usize)> = (0..6).map(|_| (draw(), draw())).collect();
        let mut sets = DisjointSets::new(n);
        for &(a, b) in &pairs {
            sets.join(a, b);
        }
        let found = sets.all();
        for i in 0..n {
            let mut reached = vec![false; n];
            reached[i] = true;
            for _ in 0..n {
                for &(a, b) in &pairs {
                    let either = reached[a] || reached[b];
                    (reached[a], reached[b]) = (either, either);
                }
            }
            let smallest = reached.iter().position(|&r| r);
            assert_eq!(Some(found[i]), smallest);
            match found[i] == i {
                true => alone += 1,
                false => together += 1,
            }
        }
    }
    assert!(alone > 100 && together > 100, "{alone} {together}");
}
