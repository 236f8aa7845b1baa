//! The file of a scene: its name, its text, and where in the text its things are.

use crate::error::{SceneError, SceneWarning, Source};
use crate::number_paths::SceneNumber;
use crate::optimise::OptimiseJob;
use crate::spans::{SceneLocation, SceneSpans};
use crate::swept::SweepSection;
use crate::table_reader::TableReader;
use crate::units::Units;
use miette::NamedSource;
use sha2::{Digest, Sha256};
use std::fmt::Write as _;
use std::sync::Arc;

/// The file of a scene, in the plane or in space.
#[derive(Debug, Clone)]
pub struct SceneFile {
    /// The file's stem, or its folder's name if the file is `scene.toml`.
    pub name: String,
    /// The title, or the name if there is none.
    pub title: String,
    /// A remark that is shown with all results.
    pub note: Option<String>,
    /// Name and text of the file. After [`with_value`](crate::PlaneScene::with_value) the changed text.
    pub source: Arc<NamedSource<String>>,
    /// Warnings about numbers that probably have a wrong unit. A program should show them to its user.
    pub warnings: Vec<SceneWarning>,
    pub(crate) units: Units,
    pub(crate) spans: SceneSpans,
    pub(crate) body_numbers: Vec<SceneNumber>,
    /// The numbers outside the bodies.
    pub(crate) section_numbers: Vec<SceneNumber>,
    /// Tied numbers and limits of the variants in a sweep.
    pub sweep_section: SweepSection,
    /// The searches for better designs.
    pub jobs: Vec<OptimiseJob>,
}

/// What a scene says about its variants.
pub(crate) struct Searches {
    pub(crate) sweep: SweepSection,
    pub(crate) jobs: Vec<OptimiseJob>,
}

impl SceneFile {
    /// A file that has been read without errors.
    pub(crate) fn new(
        name: String,
        source: &Source,
        title: Option<String>,
        note: Option<String>,
        fields: &TableReader<'_>,
        [body_numbers, section_numbers]: [Vec<SceneNumber>; 2],
        searches: Searches,
    ) -> Self {
        let log = fields.log();
        Self {
            title: title.unwrap_or_else(|| name.clone()),
            name,
            note,
            source: Source::clone(source),
            warnings: log.warnings(),
            units: fields.units().clone(),
            spans: log.take_spans(),
            body_numbers,
            section_numbers,
            sweep_section: searches.sweep,
            jobs: searches.jobs,
        }
    }

    /// SHA-256 of the scene's text, as 64 hexadecimal digits, by which results identify their scene. Line ends count as `\n`,
    /// and a byte order mark is ignored, so that a file has the same hash on every system.
    pub fn hash(&self) -> String {
        let text = self.source.inner().trim_start_matches('\u{feff}');
        let digest = Sha256::digest(text.replace("\r\n", "\n"));
        digest.iter().fold(String::new(), |mut hash, byte| {
            // Writing to a string cannot fail.
            let _ = write!(hash, "{byte:02x}");
            hash
        })
    }

    /// An error at places of the scene, each with its own remark, for faults that are found after reading.
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

    /// A length, m, or an angle, rad, as the file would write it: in the scene's unit, and that unit.
    pub fn to_scene_unit(&self, si: f64, is_angle: bool) -> (f64, &str) {
        let unit = self.units.coordinate_unit(is_angle);
        (unit.to_scene_unit(si), &unit.name)
    }

    /// A length or an angle in the scene's unit, as one of SI: m or rad.
    pub fn to_si(&self, written: f64, is_angle: bool) -> f64 {
        self.units.coordinate_unit(is_angle).to_si(written)
    }
}
