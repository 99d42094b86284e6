//! How things with names and parameters are entered: one line each.

/// Enters things of one kind. Each line has the documentation, the variant with its parameters, and the type
/// whose `NAME` it is known by.
///
/// It makes the type that is a choice as data, its `NAMES`, `by_name`, `name`, and `as_published`; and
/// `parameters`, which gives the parameters as the kind's own trait. That trait has a provided
/// `as_published`, and whatever else is to be known of every thing of the kind; it is implemented beside the
/// thing.
macro_rules! registry {
    (
        $(#[$enum_attribute:meta])*
        $choice:ident by $parameters:ident;
        $($(#[$attribute:meta])* $variant:ident($config:ty) => $thing:ty;)+
    ) => {
        $(#[$enum_attribute])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
        #[serde(tag = "name", rename_all = "kebab-case")]
        #[non_exhaustive]
        pub enum $choice {
            $($(#[$attribute])* $variant($config),)+
        }

        impl $choice {
            /// All names, for [`Self::by_name`].
            pub const NAMES: [&'static str; [$(<$thing>::NAME),+].len()] = [$(<$thing>::NAME),+];

            /// The one of this name, with its default parameters.
            pub fn by_name(name: &str) -> Option<Self> {
                $(if name == <$thing>::NAME {
                    return Some(Self::$variant(<$config>::default()));
                })+
                None
            }

            /// Its name.
            pub const fn name(&self) -> &'static str {
                match self {
                    $(Self::$variant(_) => <$thing>::NAME,)+
                }
            }

            /// The same with the parameters as its paper has them; `None` without such a paper.
            pub fn as_published(&self) -> Option<Self> {
                match self {
                    $(Self::$variant(_) => {
                        <$config as $parameters>::as_published().map(Self::$variant)
                    })+
                }
            }

            fn parameters(&self) -> &dyn $parameters {
                match self {
                    $(Self::$variant(config) => config,)+
                }
            }
        }
    };
}

pub(crate) use registry;
