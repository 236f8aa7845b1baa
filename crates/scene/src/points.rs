//! Whether a scene is one in space, by its points.

use crate::diagnostics::Span;
use crate::error::{SceneError, Source};
use crate::read::syntax;
use crate::scene_data::SpaceScene;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The place of the first point or centre of three numbers, if the scene is in space, that is, if more of them have three numbers
/// than two.
pub(crate) fn three_numbers(root: &DeTable<'_>) -> Option<Span> {
    let DeValue::Table(bodies) = root.get("bodies")?.get_ref() else {
        return None;
    };
    let (mut first, mut triples, mut pairs) = (None::<Span>, 0, 0);
    for value in bodies
        .iter()
        .flat_map(|(_, body)| points_and_center(body.get_ref()))
    {
        match value.get_ref() {
            DeValue::Array(all) if all.len() == 3 => {
                triples += 1;
                if first
                    .as_ref()
                    .is_none_or(|first| value.span().start < first.start)
                {
                    first = Some(value.span());
                }
            }
            DeValue::Array(all) if all.len() == 2 => pairs += 1,
            _ => {}
        }
    }
    first.filter(|_| triples > pairs)
}

fn points_and_center<'v>(body: &'v DeValue<'v>) -> Vec<&'v Spanned<DeValue<'v>>> {
    let DeValue::Table(body) = body else {
        return Vec::new();
    };
    let points = match body.get("points").map(Spanned::get_ref) {
        Some(DeValue::Table(points)) => points.iter().map(|(_, point)| point).collect(),
        _ => Vec::new(),
    };
    points.into_iter().chain(body.get("center")).collect()
}

impl SpaceScene {
    /// The error of analyses that accept only scenes in the plane.
    pub fn planar_only(&self) -> SceneError {
        let root = syntax(&self.source).ok();
        let point = root.and_then(|root| three_numbers(root.get_ref()));
        planar_only(&self.source, point.unwrap_or_default())
    }
}

/// The error for a scene in space where a scene in the plane is needed.
pub(crate) fn planar_only(source: &Source, point: Span) -> SceneError {
    let help = "`dwell check`, `reduce`, `kinematics`, `statics`, `kinetostatics`, `simulate`, `cycle`, `equilibria`, `linearise`, `calibrate`, `sweep`, `runs`, `work-precision` and `export` take mechanisms in space; for one in the plane, points have two numbers [x, y]";
    SceneError::with_labels(
        source,
        "this mechanism is in space, where one in the plane is needed".to_owned(),
        Some(help.to_owned()),
        [(point, "three numbers".to_owned())],
    )
}
