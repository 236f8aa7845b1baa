//! The pictures of an analysis: described with the results, drawn afterwards, and only those that are wanted.

use super::Outcome;
use super::provenance::signature;
use crate::explain::StudyError;
use crate::number_format::count;
use crate::progress::{Progress, Step};
use dwell_report::{Animation, Block, Document, Figure, ReportError, png};
use dwell_scene::Scene;
use rayon::prelude::*;

/// Which pictures are drawn. Drawing takes most of the time of a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Pictures {
    /// None.
    None,
    /// Those that answer what the analysis is asked for first.
    #[default]
    Main,
    /// All, and the animation of the mechanism.
    All,
}

/// A picture that is not drawn yet.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Its file, relative to the output folder.
    pub path: String,
    /// Whether it is one of the main ones.
    pub is_main: bool,
    content: Content,
}

#[derive(Debug, Clone, PartialEq)]
enum Content {
    Figure(Figure),
    Animation(Animation),
}

impl Picture {
    /// A figure of a scene, with its provenance.
    pub(crate) fn figure(scene: &Scene, path: String, is_main: bool, figure: Figure) -> Self {
        let provenance = signature(scene, &figure.provenance);
        Self {
            path,
            is_main,
            content: Content::Figure(Figure {
                provenance,
                ..figure
            }),
        }
    }

    /// An animation of a scene, with its provenance.
    pub(crate) fn animation(scene: &Scene, path: String, animation: Animation) -> Self {
        let provenance = signature(scene, &animation.provenance);
        Self {
            path,
            is_main: false,
            content: Content::Animation(Animation {
                provenance,
                ..animation
            }),
        }
    }

    fn name(&self) -> &str {
        match &self.content {
            Content::Figure(figure) => &figure.name,
            Content::Animation(animation) => &animation.name,
        }
    }

    fn bytes(&self) -> Result<Vec<u8>, ReportError> {
        match &self.content {
            Content::Figure(figure) => png(figure),
            Content::Animation(animation) => animation.gif(),
        }
    }
}

impl Outcome {
    /// Draws the pictures that are wanted, on all cores, and adds them to the files, with the page that shows them.
    ///
    /// # Errors
    /// [`StudyError::Report`] where one cannot be drawn.
    pub fn draw(self, wanted: Pictures, progress: Progress<'_>) -> Result<Self, StudyError> {
        let Self {
            mut summary,
            mut record,
            mut files,
            findings,
            pictures,
            page,
        } = self;
        let all = pictures.len();
        let (drawn, left): (Vec<Picture>, Vec<Picture>) =
            pictures.into_iter().partition(|picture| match wanted {
                Pictures::None => false,
                Pictures::Main => picture.is_main,
                Pictures::All => true,
            });
        let bytes = drawn.par_iter().map(|picture| {
            let bytes = picture.bytes()?;
            progress(Step {
                total: drawn.len(),
                done: picture.name(),
            });
            Ok((picture.path.clone(), bytes))
        });
        for (path, bytes) in bytes.collect::<Result<Vec<_>, ReportError>>()? {
            files.add(path, bytes);
        }
        if let Some((path, page)) = page {
            files.add(path, without(page, &left).markdown());
        }
        if wanted == Pictures::Main && !left.is_empty() {
            summary += &format!(
                "  {} of {} drawn; --pictures all draws the others\n",
                drawn.len(),
                count(all, "picture")
            );
            record.add_count("pictures", all);
            record.add_count("pictures_drawn", drawn.len());
        }
        Ok(Self {
            summary,
            record,
            files,
            findings,
            ..Self::default()
        })
    }
}

/// A page without some pictures.
fn without(mut page: Document, left: &[Picture]) -> Document {
    let is_left = |file: &str| left.iter().any(|picture| picture.path == file);
    page.blocks
        .retain(|block| !matches!(block, Block::Figure { file, .. } if is_left(file)));
    page
}
