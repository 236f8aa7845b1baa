//! Mechanisms as code: reduced models for controllers, and closed forms.

use crate::error::Error;
use crate::mechanism::scene::Scene;
use dwell_export::{
    Export, FmiVersion, Identifiers, Precision, Request, c_files, c_files_of_several_freedoms,
    matlab_files, rust_files,
};
use dwell_findings::Finding;
use dwell_scene::SceneFile;
use dwell_study::{
    ClosedForm, ExportRequest, SceneTask, StudyError, StudyScene, compute_closed_form,
    compute_export, compute_export_of_several_freedoms, fmu_archive, with_dimension,
};

/// The target of [`Scene::export`], in double precision.
///
/// ```
/// use dwell::{ExportTarget, FmiVersion};
/// assert_ne!(ExportTarget::Fmu(FmiVersion::Three), ExportTarget::ExactFmu(FmiVersion::Three));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExportTarget {
    /// C99, a header and a source without libraries: functions of the coordinate as piecewise polynomials (cells).
    C,
    /// C99 with the model's own operations instead of cells: exact to rounding, with square roots, sines and cosines.
    ExactC,
    /// A crate without the standard library, allocation or unsafe code, in cells.
    Rust,
    /// A MAT-file with the cells, and functions for MATLAB and Octave.
    Matlab,
    /// An FMU for model exchange and co-simulation, with cells: sources, and a library for this platform if a C compiler is found.
    Fmu(FmiVersion),
    /// An FMU with the model's own operations.
    ExactFmu(FmiVersion),
}

impl ExportTarget {
    fn is_c(self) -> bool {
        matches!(self, Self::C | Self::ExactC)
    }

    /// Whether it has the model's own operations instead of cells.
    fn is_exact(self) -> bool {
        matches!(self, Self::ExactC | Self::ExactFmu(_))
    }
}

impl Scene {
    /// The machine as code: the path and content of each file, as `dwell export` writes them. With cells, the error of every function of the
    /// coordinate is at most `accuracy` (1e-14 to 1e-2) times its largest value; exact code has rounding errors only. Machines of several degrees of
    /// freedom are exported as exact code in C, mechanisms in space with cells and one degree of freedom only.
    ///
    /// # Errors
    /// [`Error::Study`] if the machine cannot be exported, with the reason and a suggestion: it has several degrees of freedom and the target
    /// is not C, or the mechanism is in space; it passes change points, or has sticking friction. [`Error::Table`] for an invalid accuracy.
    ///
    /// ```
    /// use dwell::ExportTarget;
    /// let scene = dwell::Scene::read("../../docs/slider.toml")?;
    /// let files = scene.export(ExportTarget::C, 1e-9)?;
    /// let (path, content) = &files[0];
    /// assert_eq!(path, "slider.h");
    /// assert!(String::from_utf8_lossy(content).contains("slider_coefficients("));
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn export(
        &self,
        target: ExportTarget,
        accuracy: f64,
    ) -> Result<Vec<(String, Vec<u8>)>, Error> {
        let asked = request(target, accuracy)?;
        with_dimension(self.inner(), ExportScene { target, asked })
    }

    /// The closed forms of a mechanism made of dyads: a function `reduced` of the coordinate, in a programming language, that returns the positions, m, ½m′, and a
    /// and b of a reaction (by default the first that the scene requests). They agree with the reduced model to 1e-12 at 24
    /// positions.
    ///
    /// # Errors
    /// [`Error::Study`] if the mechanism is in space, is not made of dyads, has several actuators, or has no such reaction;
    /// [`Error::ClosedForm`] if the closed forms disagree with the reduced model.
    ///
    /// ```
    /// let scene = dwell::Scene::read("../../docs/slider.toml")?;
    /// let code = scene.closed_form(dwell::Language::Python, Some("B.x"))?;
    /// assert!(code.contains("def reduced(phi):"));
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn closed_form(
        &self,
        language: crate::Language,
        reaction: Option<&str>,
    ) -> Result<String, Error> {
        let (form, findings) = with_dimension(self.inner(), FindClosedForm(reaction))?;
        if let Some(finding) = findings.iter().find(|finding| !finding.pass) {
            return Err(Error::ClosedForm {
                difference: finding.relative_difference,
            });
        }
        Ok(form.code(language, "reduced", self.title()))
    }
}

struct ExportScene {
    target: ExportTarget,
    asked: ExportRequest,
}

impl SceneTask for ExportScene {
    type Output = Result<Vec<(String, Vec<u8>)>, Error>;

    fn run<S: StudyScene>(self, scene: &S) -> Self::Output {
        let Self { target, asked } = self;
        if scene.actuator(1).is_some() {
            if !target.is_c() {
                return Err(scene.several_freedoms_error().into());
            }
            let export = compute_export_of_several_freedoms(scene, &asked)?;
            return Ok(texts(c_files_of_several_freedoms(&export).into()));
        }
        files(scene, target, &compute_export(scene, &asked)?)
    }
}

struct FindClosedForm<'r>(Option<&'r str>);

impl SceneTask for FindClosedForm<'_> {
    type Output = Result<(ClosedForm, Vec<Finding>), StudyError>;

    fn run<S: StudyScene>(self, scene: &S) -> Self::Output {
        compute_closed_form(scene, self.0)
    }
}

/// The request of a target.
fn request(target: ExportTarget, accuracy: f64) -> Result<ExportRequest, Error> {
    let exact = target.is_exact();
    if !exact && !(1e-14..=1e-2).contains(&accuracy) {
        let message = format!("the accuracy must be between 1e-14 and 1e-2, and not {accuracy}");
        return Err(Error::Table(message));
    }
    Ok(ExportRequest {
        request: Request {
            accuracy,
            precision: Precision::Double,
        },
        exact,
        interval: None,
    })
}

/// The files of a target.
fn files(
    scene: &SceneFile,
    target: ExportTarget,
    export: &Export,
) -> Result<Vec<(String, Vec<u8>)>, Error> {
    Ok(match target {
        ExportTarget::C | ExportTarget::ExactC => texts(c_files(export).into()),
        ExportTarget::Rust => texts(rust_files(export).into_iter().flatten().collect()),
        ExportTarget::Matlab => matlab_files(export).unwrap_or_default(),
        ExportTarget::Fmu(version) | ExportTarget::ExactFmu(version) => {
            let (bytes, _) = fmu_archive(scene, export, version)?;
            let identifier = Identifiers::new(&export.machine).prefix;
            vec![(format!("{identifier}.fmu"), bytes)]
        }
    })
}

fn texts(files: Vec<(String, String)>) -> Vec<(String, Vec<u8>)> {
    let file = |(path, text): (String, String)| (path, text.into_bytes());
    files.into_iter().map(file).collect()
}
