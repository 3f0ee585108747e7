//! Numbers that are rounded up.

use crate::math::fault::no_smaller;

#[test]
fn a_number_rounded_up_is_no_smaller() {
    for (value, expected) in [
        (0.1841, "0.185"),
        (0.2, "0.200"),
        (24.44, "24.5"),
        (9.996, "10.00"),
        (0.001_234, "0.00124"),
    ] {
        let found: f64 = no_smaller(value, 3).parse().unwrap();
        assert!(found >= value, "{found} for {value}");
        assert_eq!(found, expected.parse::<f64>().unwrap());
    }
}
