//! Writes closed forms: document or code, and summary.

use crate::number_format::{count, digits};
use crate::output::Outcome;
use crate::symbolic::closed_form_check::POSITIONS;
use dwell_findings::{Finding, Record};
use dwell_report::{Block, Document};
use dwell_scene::SceneFile;
use dwell_symbolic::{ClosedForm, Constant, FormulaSection, Language};

/// The output format of closed forms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FormulaFormat {
    /// Markdown with LaTeX.
    Latex,
    /// A function.
    Code(Language),
}

/// A scene whose closed forms are written: its file, the name of its coordinate, and notes on the omitted parts.
pub(crate) struct WrittenForm<'a> {
    pub(crate) file: &'a SceneFile,
    pub(crate) coordinate: &'a str,
    pub(crate) notes: &'a str,
}

/// Closed forms as formulas or code.
pub(crate) fn closed_form_outcome(
    scene: &WrittenForm<'_>,
    form: &ClosedForm,
    findings: Vec<Finding>,
    format: FormulaFormat,
) -> Outcome {
    let mut record = Record::default();
    record.add_count("steps", form.assignment_count());
    record.add_count("positions", POSITIONS);
    for f in &findings {
        record.add(&f.key, "", f.relative_difference);
        record.add(format!("{}.tolerance", f.key), "", f.tolerance);
    }
    let mut outcome = Outcome {
        summary: summary(scene, form, &findings),
        record,
        findings,
        ..Outcome::default()
    };
    let about = format!("{}: closed forms, written by dwell", scene.file.title);
    let name = function_name(&scene.file.name);
    let (extension, text) = match format {
        FormulaFormat::Latex => ("md", document(scene, form)),
        FormulaFormat::Code(language) => {
            let extension = match language {
                Language::Rust => "rs",
                Language::C => "c",
                Language::Python => "py",
            };
            (extension, form.code(language, &name, &about))
        }
    };
    let file = format!("{}-symbolic.{extension}", scene.file.name);
    outcome.files.add(file, text);
    outcome
}

/// The name of the generated function; the prefix keeps it from being a reserved word.
pub(crate) fn function_name(scene: &str) -> String {
    let plain = |c: char| match c {
        c if c.is_ascii_alphanumeric() => c.to_ascii_lowercase(),
        _ => '_',
    };
    format!("reduced_{}", scene.chars().map(plain).collect::<String>())
}

fn summary(scene: &WrittenForm<'_>, form: &ClosedForm, findings: &[Finding]) -> String {
    let reaction = form.reaction.as_ref();
    let reaction = reaction.map_or_else(String::new, |r| format!("; a and b of {r}"));
    let mut text = format!(
        "{}: closed forms in {}\n  positions, m and ½m′ as functions of {}{reaction}\n",
        scene.file.title,
        count(form.assignment_count(), "step"),
        scene.coordinate,
    );
    text += scene.notes;
    for f in findings {
        let result = if f.pass { "pass" } else { "FAIL" };
        text += &format!(
            "  {result}  {}: differs by {:.1e} from the numerical model at {} (tolerance {:.0e})\n",
            f.key, f.relative_difference, f.domain, f.tolerance
        );
    }
    text
}

/// Markdown with LaTeX.
fn document(scene: &WrittenForm<'_>, form: &ClosedForm) -> String {
    let of = &form.coordinate;
    let constant = |c: &Constant| {
        let (latex, value) = (format!("${}$", c.latex), digits(c.value, 12));
        vec![latex, value, c.unit.to_owned(), c.meaning.clone()]
    };
    let mut blocks = vec![
        Block::Text(format!(
            "The coordinate is ${}$ ({}), in {}. Each line depends only on lines above it. A prime is the derivative with respect to the \
             coordinate. All quantities are in SI units.",
            of.latex, scene.coordinate, of.unit
        )),
        Block::Heading("Constants".to_owned()),
        Block::Table {
            header: ["", "value", "unit", "meaning"].map(str::to_owned).into(),
            rows: form.constants.iter().map(constant).collect(),
        },
    ];
    for (part, lines) in form.latex() {
        let (heading, text_below) = part_heading(part, form);
        blocks.push(Block::Heading(heading.to_owned()));
        if !text_below.is_empty() {
            blocks.push(Block::Text(text_below));
        }
        blocks.push(Block::Text(format!(
            "```math\n\\begin{{aligned}}\n{lines}\n\\end{{aligned}}\n```"
        )));
    }
    let title = format!("{}: closed forms", scene.file.title);
    Document { title, blocks }.markdown()
}

/// The heading of a part and the words under it.
fn part_heading(part: FormulaSection, form: &ClosedForm) -> (&'static str, String) {
    let reaction = form.reaction.as_deref().unwrap_or_default();
    match part {
        FormulaSection::Positions => (
            "Positions",
            "Dyad by dyad, each by the joint that closes it: $d$ is the part of the loop that is known, $D$ its \
             square. The first arm of a pinned dyad is $f$ times $d$ and $h$ times $d$ rotated by +90°, the second \
             arm closes the loop. At a guide, $\\kappa$ or $k$ and $g$ are the parts across and along it. The sign \
             $\\sigma$ is the branch. Points then follow, and the centres of mass $G$."
                .to_owned(),
        ),
        FormulaSection::FirstDerivatives => ("First derivatives", String::new()),
        FormulaSection::SecondDerivatives => ("Second derivatives", String::new()),
        FormulaSection::VirtualDisplacements => (
            "Virtual displacements",
            format!(
                "The joint is released along {reaction}: its second body is displaced against its first by a second \
                 coordinate $q_2$ (rotated, for a couple). $\\delta$ is the derivative by $q_2$, at $q_2 = 0$."
            ),
        ),
        FormulaSection::Results if form.reaction.is_some() => (
            "Inertia and reaction",
            format!(
                "$m \\ddot q + \\tfrac{{1}}{{2}} m' \\dot q^2$ is the generalised inertia force, and \
                 $a \\ddot q + b \\dot q^2$ the inertia's part of {reaction} (Jordi, Zayas and Cardona 2008): \
                 $a = m_{{12}}$, $b = \\partial m_{{12}}/\\partial q - \\tfrac{{1}}{{2}} \\partial m_{{11}}/\\partial q_2$."
            ),
        ),
        FormulaSection::Results => (
            "Inertia",
            "$m \\ddot q + \\tfrac{1}{2} m' \\dot q^2$ is the generalised inertia force.".to_owned(),
        ),
    }
}
