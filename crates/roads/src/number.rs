//! Numbers of things that a network has in a list.

/// Defines the number of a thing: its place in the list of all such things of a network. It is read, written and printed as the bare number.
macro_rules! number {
    ($(#[$what:meta])* $name:ident) => {
        $(#[$what])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
        #[serde(transparent)]
        pub struct $name(u32);

        impl $name {
            /// The greatest number. No list is so long, so it stands for none where memory is short.
            pub const MAX: Self = Self(u32::MAX);

            /// From the bare number.
            #[must_use]
            pub const fn new(number: u32) -> Self {
                Self(number)
            }

            /// From an index into the list, or into any slice in its order. A list has fewer than 2³² entries.
            #[must_use]
            pub const fn at(index: usize) -> Self {
                Self(index as u32)
            }

            /// The index into the list, and into any slice in its order.
            #[must_use]
            pub const fn index(self) -> usize {
                self.0 as usize
            }

            /// The bare number.
            #[must_use]
            pub const fn get(self) -> u32 {
                self.0
            }

            /// All numbers in order, from 0.
            pub fn all() -> impl Iterator<Item = Self> + Clone {
                (0..).map(Self)
            }

            /// The numbers of a list with `count` entries, in order.
            pub fn first(count: usize) -> impl Iterator<Item = Self> + Clone {
                (0..count).map(Self::at)
            }

            /// The numbers of a range, in order.
            pub fn each(range: std::ops::Range<Self>) -> impl Iterator<Item = Self> {
                (range.start.0..range.end.0).map(Self)
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                self.0.fmt(f)
            }
        }

        impl From<$name> for u32 {
            fn from(number: $name) -> Self {
                number.0
            }
        }

        impl From<$name> for u64 {
            fn from(number: $name) -> Self {
                Self::from(number.0)
            }
        }

        impl From<$name> for i64 {
            fn from(number: $name) -> Self {
                Self::from(number.0)
            }
        }
    };
}

pub(crate) use number;
