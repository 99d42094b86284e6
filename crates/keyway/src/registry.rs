//! Registration of named things with parameters: one line each.

/// Registers things of one kind. Each line has the documentation, the variant with its parameters,
/// and the type whose `NAME` identifies it.
///
/// The macro generates the enum of choices, as data, with `NAMES`, `by_name`, `name`,
/// `as_published` and `readings`, and with `parameters`, which returns the parameters as the
/// kind's own trait. That trait provides `as_published` and `readings`, and any other property
/// that every thing of the kind has; it is implemented beside the thing. Parameters start with
/// their defaults, or, with `for Robot` after the trait's name, with those of its `for_robot`.
macro_rules! registry {
    (
        $(#[$enum_attribute:meta])*
        $choice:ident by $parameters:ident;
        $($(#[$attribute:meta])* $variant:ident($config:ty) => $thing:ty;)+
    ) => {
        registry! {
            @choice $(#[$enum_attribute])* $choice by $parameters;
            $($(#[$attribute])* $variant($config) => $thing;)+
        }

        impl $choice {
            /// The one of this name, with its default parameters; `None` if there is none.
            pub fn by_name(name: &str) -> Option<Self> {
                $(if name == <$thing>::NAME {
                    return Some(Self::$variant(<$config>::default()));
                })+
                None
            }
        }
    };
    (
        $(#[$enum_attribute:meta])*
        $choice:ident by $parameters:ident for Robot;
        $($(#[$attribute:meta])* $variant:ident($config:ty) => $thing:ty;)+
    ) => {
        registry! {
            @choice $(#[$enum_attribute])* $choice by $parameters;
            $($(#[$attribute])* $variant($config) => $thing;)+
        }

        impl $choice {
            /// The one of this name, with the parameters for a robot; `None` if there is none.
            pub fn by_name(name: &str, robot: &Robot) -> Option<Self> {
                $(if name == <$thing>::NAME {
                    return Some(Self::$variant(<$config as $parameters>::for_robot(robot)));
                })+
                None
            }
        }
    };
    (
        @choice
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

            /// Its name.
            pub const fn name(&self) -> &'static str {
                match self {
                    $(Self::$variant(_) => <$thing>::NAME,)+
                }
            }

            /// The same with the parameters of its paper; `None` without such a paper.
            pub fn as_published(&self) -> Option<Self> {
                match self {
                    $(Self::$variant(_) => {
                        <$config as $parameters>::as_published().map(Self::$variant)
                    })+
                }
            }

            /// The fields of [`Self::as_published`] that the paper gives no value for: they are
            /// readings.
            pub fn readings(&self) -> &'static [&'static str] {
                self.parameters().readings()
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
