//! Drawings of a mechanism in space: pictures from several sides, and the parts of a page, on which it can be turned.

mod arrangement;
mod direction;
#[cfg(feature = "output")]
mod drawing;
#[cfg(feature = "output")]
mod joints;
mod page;
mod parts;
#[cfg(feature = "output")]
mod paths;
#[cfg(feature = "output")]
mod pictures;
mod points;
#[cfg(feature = "output")]
mod projection;
mod segments;
#[cfg(feature = "output")]
mod solids;

pub(crate) use self::page::page_drawing;
pub(crate) use self::parts::anchor;
#[cfg(feature = "output")]
pub(crate) use self::pictures::SpacePositions;
pub(crate) use self::points::placed;
