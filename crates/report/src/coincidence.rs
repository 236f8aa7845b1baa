//! Curves that lie on each other: drawn with dashes in turn, so that each of them is seen.
