//! Declaration of methods that change a part or a task and return it.

/// Declares methods of a builder, each by its arguments and the change that it makes.
macro_rules! builder {
    (impl $part:ty; $($(#[$about:meta])* $name:ident($($given:ident: $of:ty),*) |$it:ident| $change:expr;)*) => {
        impl $part {
            $($(#[$about])*
            pub fn $name(mut self, $($given: $of),*) -> Self {
                let $it = &mut self;
                $change;
                self
            })*
        }
    };
}
pub(super) use builder;

/// Declares names of constants of a part, each by its arguments and the constant.
macro_rules! constants {
    ($part:ty: $($(#[$about:meta])* $name:ident($($given:ident),*) $constant:ident($($further:expr),*);)*) => {
        impl Handle<$part> {
            $($(#[$about])*
            pub fn $name(self, $($given: usize),*) -> Constant {
                Constant::$constant(self.index(), $($further),*)
            })*
        }
    };
}
pub(super) use constants;
