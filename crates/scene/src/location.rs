//! Errors at locations of a scene, for what is found out about it later.

use crate::error::SceneError;
use crate::scene::Scene;
use crate::spans::SceneLocation;

impl Scene {
    /// An error at places of the scene, each with a remark of its own, for what is found out
    /// about the scene later.
    pub fn error(
        &self,
        message: String,
        help: Option<String>,
        at: &[(SceneLocation, String)],
    ) -> SceneError {
        let labels = at
            .iter()
            .map(|(location, label)| (self.span(*location), label.clone()));
        SceneError::with_labels(&self.source, message, help, labels)
    }

    /// Bytes of the text where a place is.
    pub fn span(&self, mut location: SceneLocation) -> std::ops::Range<usize> {
        // Every step outwards ends at the whole, which has no span: three steps at most.
        while location != SceneLocation::Whole {
            if let Some(span) = self.spans.get(&location) {
                return span.clone();
            }
            location = location.enclosing();
        }
        0..0
    }
}
