//! Ipopt behind one safe function over the trait [`Nlp`](crate::nlp::Nlp).

/// A value of an Ipopt option.
#[derive(Clone, Debug, PartialEq)]
pub enum OptionValue {
    /// Integer option.
    Integer(i32),
    /// Real option.
    Number(f64),
    /// Text option.
    Text(String),
}
