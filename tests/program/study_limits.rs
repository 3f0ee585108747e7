//! Limits and observed orders of sequences.

use crate::study::apart;
use proboscis::study::limit::{How, limit, observed_order};

#[test]
fn limits_and_orders_of_made_up_sequences() {
    for order in [1.0, 2.0, 4.0, 6.0] {
        // Steps that are not halved evenly.
        let sizes = [1.0, 0.6, 0.25, 0.15];
        let value = |h: &f64| vec![3.0 + 0.2 * h.powf(order), -1.0 - 0.7 * h.powf(order), 0.5];
        let values: Vec<_> = sizes.iter().map(value).collect();
        let found = limit(&sizes, &values, 3).unwrap();
        assert_eq!(found.how, How::Extrapolated);
        for p in &found.orders {
            assert!((p.unwrap() - order).abs() < 1e-6, "{p:?} for {order}");
        }
        assert!(apart(&found.value, &[3.0, -1.0, 0.5]) < 1e-12);
        let errors = sizes
            .iter()
            .zip(&values)
            .map(|(h, x)| [*h, apart(x, &found.value)]);
        let errors: Vec<_> = errors.collect();
        let shown = observed_order(&errors, 1e-12).unwrap();
        assert!((shown - order).abs() < 1e-6);
    }
    let sizes = [1.0, 0.5, 0.25];
    let of = |values: [f64; 3]| limit(&sizes, &values.map(|x| vec![x]), 1).unwrap();
    assert_eq!(of([1.0, 2.0, 1.0]).how, How::NoOrder);
    // Values that go to and fro show no order, however quickly they calm down.
    assert_eq!(of([1.0, 5.0, 4.0]).how, How::NoOrder);
    assert_eq!(of([1.0, 2.0, 4.0]).value, [4.0]);
    assert_eq!(of([5.0, 7.0, 7.0 + 1e-14]).how, How::Rounding);
    assert_eq!(
        limit(&sizes[..2], &[vec![1.0], vec![2.0]], 1).unwrap().how,
        How::TooFew
    );
    assert_eq!(limit(&[], &[], 1), None);
    let single = limit(&[1.0], &[vec![1.0]], 1).unwrap();
    assert_eq!(single.floor(), f64::INFINITY);
    // Without an order, the larger of the last two differences, as the order 0.5 has errors: 1/(√2 − 1) of it.
    let factor = (2.0_f64.sqrt() - 1.0).recip();
    assert!((of([1.0, 5.0, 4.0]).floor() - 4.0 * factor).abs() < 1e-12);
    let two = limit(&sizes[..2], &[vec![1.0], vec![2.0]], 1).unwrap();
    assert!((two.floor() - factor).abs() < 1e-12);
    // Errors of the orders 0.6 and 1 with kinks of a quarter show no order, and the finest value is not further off than it says.
    let mut without = 0;
    for (order, kinks) in [
        (0.6, [1.0, 0.75, 1.25]),
        (1.0, [1.0, 1.3, 0.8]),
        (1.0, [1.0, 1.25, 1.0]),
    ] {
        let value = |k: usize| 7.0 + 0.3 * kinks[k] * sizes[k].powf(order);
        let found = of([0, 1, 2].map(value));
        without += usize::from(found.how == How::NoOrder);
        let error = (found.value[0] - 7.0).abs();
        assert!(error > 0.01 && error < found.floor(), "{error} {found:?}");
    }
    assert_eq!(without, 3);
    // A rough start and rounding at the end do not belong to the straight part, a flat curve has no order.
    let error = |h: f64| if h > 0.3 { 0.5 } else { h * h };
    let halved: Vec<_> = (0..12)
        .map(|k| 0.5_f64.powi(k))
        .map(|h| [h, error(h).max(1e-6)])
        .collect();
    let shown = observed_order(&halved, 1.1e-6).unwrap();
    assert!((shown - 2.0).abs() < 0.05, "{shown}");
    let flat: Vec<_> = halved.iter().map(|p| [p[0], 0.3]).collect();
    assert_eq!(observed_order(&flat, 0.0), None);
    assert_eq!(observed_order(&[[1.0, 1.0]], 0.0), None);
    let level = [[8.0, 3.18], [4.0, 1.29], [2.0, 0.684], [1.0, 0.693]];
    assert_eq!(observed_order(&level, 0.0), None);
}
