//! Symbols of loads: springs and dampers between points, in the plane and in space.

use dwell_geometry::BodyId;
use dwell_kinetostatics::load::AnyLoadKind;
use dwell_kinetostatics::{LoadCoordinate, LoadSymbol};
use dwell_page::LinkLook;

/// The symbol of a load between two points of bodies, in their frames; most loads have none.
pub(crate) fn link_of<V: Copy, C: LoadCoordinate<Point = V>, S>(
    kind: &AnyLoadKind<V, C, S>,
) -> Option<(LinkLook, [(BodyId, V); 2])> {
    let (symbol, bodies, points) = kind.symbol()?;
    let look = match symbol {
        LoadSymbol::Spring => LinkLook::Spring,
        LoadSymbol::Damper => LinkLook::Damper,
    };
    Some((look, [0, 1].map(|k| (bodies[k], points[k]))))
}
