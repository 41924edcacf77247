//! Methods that set single fields of options.

/// For each field a method of its name that takes its value, or what an `Option` holds.
macro_rules! setters {
    ($options:ident { $($field:ident: $value:ty),* $(,)? }) => {
        impl $options {$(
            #[doc = concat!("Sets [`", stringify!($field), "`](Self::", stringify!($field), ").")]
            #[must_use]
            pub fn $field(self, $field: $value) -> Self {
                $options { $field: $field.into(), ..self }
            }
        )*}
    };
}

pub(crate) use setters;
