//! The pictures of an analysis: described with the results, and drawn afterwards on request.

use super::Outcome;
use super::page_file::tables_page;
use super::provenance::signature;
use crate::explain::StudyError;
use crate::number_format::count;
use crate::progress::{Progress, Step};
use dwell_page::FileLink;
use dwell_report::{Animation, Block, Document, Figure, Layout, ReportError, png, svg};
use dwell_scene::SceneFile;
use rayon::prelude::*;

/// Which pictures are drawn. Drawing takes most of the time of a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Pictures {
    /// None.
    None,
    /// The pictures of the main results of the analysis.
    #[default]
    Main,
    /// All, and the animation of the mechanism.
    All,
}

/// The formats in which figures are drawn; animations are always GIF.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PictureFormat {
    /// Pixels, for pages and screens.
    #[default]
    Png,
    /// Lines and letters, for papers.
    Svg,
    /// Both.
    Both,
}

impl PictureFormat {
    fn has_png(self) -> bool {
        self != Self::Svg
    }

    fn has_svg(self) -> bool {
        self != Self::Png
    }
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
    /// A figure of a scene, with its provenance, and with lengths in the scene's unit.
    pub fn figure(scene: &SceneFile, path: String, is_main: bool, mut figure: Figure) -> Self {
        figure.provenance = signature(scene, &figure.provenance);
        let (factor, unit) = scene.to_scene_unit(1.0, false);
        figure.change_unit("m", unit, factor);
        Self {
            path,
            is_main,
            content: Content::Figure(figure),
        }
    }

    /// A main figure that belongs to no single scene.
    pub fn of_no_scene(path: String, figure: Figure) -> Self {
        Self {
            path,
            is_main: true,
            content: Content::Figure(figure),
        }
    }

    /// The layout of the picture; for an animation, of each frame.
    ///
    /// # Errors
    /// [`ReportError::Size`], [`ReportError::NoFrames`] or [`ReportError::AnimationSize`] if it cannot be drawn.
    pub fn layouts(&self) -> Result<Vec<Layout>, ReportError> {
        match &self.content {
            Content::Figure(figure) => Ok(vec![Layout::of(figure)?]),
            Content::Animation(animation) => Layout::of_animation(animation),
        }
    }

    /// An animation of a scene, with its provenance, and with lengths in the scene's unit.
    pub(crate) fn animation(scene: &SceneFile, path: String, mut animation: Animation) -> Self {
        animation.provenance = signature(scene, &animation.provenance);
        let (factor, unit) = scene.to_scene_unit(1.0, false);
        animation.change_unit("m", unit, factor);
        Self {
            path,
            is_main: false,
            content: Content::Animation(animation),
        }
    }

    fn name(&self) -> &str {
        match &self.content {
            Content::Figure(figure) => &figure.name,
            Content::Animation(animation) => &animation.name,
        }
    }

    /// The files of the picture, drawn.
    fn files(&self, format: PictureFormat) -> Result<Vec<(String, Vec<u8>)>, ReportError> {
        let figure = match &self.content {
            Content::Figure(figure) => figure,
            Content::Animation(animation) => {
                return Ok(vec![(self.path.clone(), animation.gif()?)]);
            }
        };
        let mut files = Vec::new();
        if format.has_png() {
            files.push((self.path.clone(), png(figure)?));
        }
        if format.has_svg() {
            files.push((svg_path(&self.path), svg(figure)?.into_bytes()));
        }
        Ok(files)
    }
}

/// The path of the SVG beside a PNG.
fn svg_path(png: &str) -> String {
    format!("{}.svg", png.strip_suffix(".png").unwrap_or(png))
}

impl Outcome {
    /// Draws the requested pictures on all cores, and adds them and the page that shows them to the files.
    ///
    /// # Errors
    /// [`StudyError::Report`] if one cannot be drawn.
    pub fn draw(
        mut self,
        (wanted, format): (Pictures, PictureFormat),
        progress: Progress<'_>,
    ) -> Result<Self, StudyError> {
        let (pictures, page) = (std::mem::take(&mut self.pictures), self.page.take());
        let all = pictures.len();
        let (drawn, left): (Vec<Picture>, Vec<Picture>) =
            pictures.into_iter().partition(|picture| match wanted {
                Pictures::None => false,
                Pictures::Main => picture.is_main,
                Pictures::All => true,
            });
        let picture_files = drawn.par_iter().map(|picture| {
            let files = picture.files(format)?;
            progress(Step {
                total: drawn.len(),
                done: picture.name(),
            });
            Ok(files)
        });
        let picture_files = picture_files.collect::<Result<Vec<_>, ReportError>>()?;
        let tables = || page.as_ref().map(|(_, page)| tables_page(page));
        let mut run = self.run.take().or_else(tables).unwrap_or_default();
        for (picture, files) in drawn.iter().zip(picture_files) {
            for (path, bytes) in files {
                // Rows have curves.
                if run.columns.is_empty() && path.ends_with(".png") {
                    let picture = FileLink::embedded_png(picture.name(), &bytes);
                    run.pictures.push(picture);
                }
                self.files.add(path, bytes);
            }
        }
        self.run = Some(run);
        if let Some((path, page)) = page {
            self.files
                .add(path, with_drawn_pictures(page, &left, format).markdown());
        }
        if wanted == Pictures::Main && !left.is_empty() {
            self.summary += &format!(
                "  {} of {} drawn; --pictures all draws the others\n",
                drawn.len(),
                count(all, "picture")
            );
            self.record.add_count("pictures", all);
            self.record.add_count("pictures_drawn", drawn.len());
        }
        Ok(self)
    }
}

/// A page without some pictures, with the others as they have been drawn.
fn with_drawn_pictures(mut page: Document, left: &[Picture], format: PictureFormat) -> Document {
    let is_left = |file: &str| left.iter().any(|picture| picture.path == file);
    page.blocks
        .retain(|block| !matches!(block, Block::Figure { file, .. } if is_left(file)));
    for block in &mut page.blocks {
        if let Block::Figure { file, .. } = block
            && !format.has_png()
            && file.ends_with(".png")
        {
            *file = svg_path(file);
        }
    }
    page
}
