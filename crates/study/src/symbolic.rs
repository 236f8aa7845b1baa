//! `dwell symbolic`: a mechanism made of dyads as formulas, held against its numbers.

mod judge;

use crate::error::{StudyError, explain_model, joint_labels, names_or_whole, not_one_actuator};
use crate::outcome::Outcome;
use crate::prepare::shared;
use crate::words::{count, digits};
use dwell_findings::Finding;
use dwell_geometry::Reaction;
use dwell_kinetostatics::{Exact, Model};
use dwell_report::{Block, Document};
use dwell_scene::Scene;
use dwell_symbolic::{Form, Language, Part, Symbolic, SymbolicError};
use judge::Judge;

/// How closed forms are printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Printed {
    /// Markdown with LaTeX.
    Latex,
    /// A function.
    Code(Language),
}

/// The closed forms of a scene, printed, for the reaction named, or the first that the scene requests.
///
/// # Errors
/// [`StudyError`] where the mechanism is not made of dyads, has several actuators, or has no such
/// reaction.
pub fn symbolic(
    scene: &Scene,
    printed: Printed,
    reaction: Option<&str>,
) -> Result<Outcome, StudyError> {
    let exact = model(scene)?;
    let plan = exact.model().plan();
    let reaction = match reaction {
        Some(name) => Some(named(scene, name)?),
        None => {
            let shared = shared(scene, plan);
            let mut requested = scene.requests.reactions.iter();
            requested.find(|r| !shared.contains(r)).copied()
        }
    };
    let explain = |e: SymbolicError| explain(scene, &e);
    let symbolic = Symbolic::new(&scene.mechanism, &scene.masses, plan).map_err(explain)?;
    let form = symbolic.form(reaction).map_err(explain)?;
    let mut judge = Judge::new(scene, &exact);
    judge.hold(&form, reaction);
    let findings = judge.findings();
    let mut outcome = Outcome {
        summary: summary(scene, &form, &findings),
        findings,
        ..Outcome::default()
    };
    let about = format!("{}: closed forms, written by dwell", scene.title);
    let name = function_name(&scene.name);
    let (rest, text) = match printed {
        Printed::Latex => ("md", document(scene, &form)),
        Printed::Code(language) => {
            let rest = match language {
                Language::Rust => "rs",
                Language::C => "c",
                Language::Python => "py",
            };
            (rest, form.code(language, &name, &about))
        }
    };
    outcome
        .files
        .add(format!("{}-symbolic.{rest}", scene.name), text);
    Ok(outcome)
}

/// The closed forms of a scene, with those of every reaction, held against its exact model at 24 positions; no
/// findings where it is not made of dyads or has several actuators.
///
/// # Errors
/// [`StudyError`] when the mechanism cannot be put together.
pub fn symbolic_findings(scene: &Scene) -> Result<Vec<Finding>, StudyError> {
    if scene.mechanism.actuators.len() != 1 {
        return Ok(Vec::new());
    }
    let exact = model(scene)?;
    let plan = exact.model().plan();
    let Ok(symbolic) = Symbolic::new(&scene.mechanism, &scene.masses, plan) else {
        return Ok(Vec::new());
    };
    let mut judge = Judge::new(scene, &exact);
    let reactions = scene.mechanism.reactions();
    let unique = (0..reactions.len()).filter(|&k| plan.is_unique(k));
    for k in unique {
        let form = symbolic.form(Some(reactions[k]));
        let form = form.map_err(|e| explain(scene, &e))?;
        judge.hold(&form, Some(reactions[k]));
    }
    Ok(judge.findings())
}

/// The exact model with every reaction.
fn model(scene: &Scene) -> Result<Exact, StudyError> {
    if scene.mechanism.actuators.len() != 1 {
        return Err(not_one_actuator(scene));
    }
    let (start, all) = (scene.assembly.to_start(), scene.mechanism.reactions());
    let model = Model::new(&scene.mechanism, &scene.masses, &start, &all)
        .map_err(|e| explain_model(scene, &e))?;
    Exact::new(model).ok_or_else(|| not_one_actuator(scene))
}

fn named(scene: &Scene, name: &str) -> Result<Reaction, StudyError> {
    let all = scene.mechanism.reactions();
    let names = |r: &Reaction| scene.mechanism.reaction_name(*r);
    all.iter()
        .find(|r| names(r) == name)
        .copied()
        .ok_or_else(|| {
            let list: Vec<String> = all.iter().map(names).collect();
            let help = format!("the reactions are {}", list.join(", "));
            let message = format!("there is no reaction `{name}`");
            scene.error(message, Some(help), &[]).into()
        })
}

fn explain(scene: &Scene, error: &SymbolicError) -> StudyError {
    match error {
        SymbolicError::Actuators(_) => not_one_actuator(scene),
        SymbolicError::Group {
            bodies,
            joints,
            what,
            ..
        } => scene
            .error(
                format!(
                    "no closed form places {}: {what}",
                    names_or_whole(&scene.mechanism, bodies)
                ),
                Some(
                    "closed forms are those of mechanisms made of dyads; `dwell reduce` computes the \
                     same quantities of any mechanism of one coordinate"
                        .to_owned(),
                ),
                &joint_labels(joints, "closes the group"),
            )
            .into(),
        SymbolicError::Reaction(reaction) => scene
            .error(
                format!(
                    "the loads do not determine `{}`",
                    scene.mechanism.reaction_name(*reaction)
                ),
                Some("constraints that repeat each other share it: name another one".to_owned()),
                &joint_labels(&[reaction.joint], "repeats others"),
            )
            .into(),
        SymbolicError::Place(place) => scene.error(place.to_string(), None, &[]).into(),
    }
}

/// The name of a function: no word that a language keeps for itself.
fn function_name(scene: &str) -> String {
    let plain = |c: char| {
        if c.is_ascii_alphanumeric() {
            c.to_ascii_lowercase()
        } else {
            '_'
        }
    };
    format!("reduced_{}", scene.chars().map(plain).collect::<String>())
}

fn summary(scene: &Scene, form: &Form, findings: &[Finding]) -> String {
    let reaction = form.reaction.as_ref();
    let reaction = reaction.map_or_else(String::new, |r| format!("; a and b of {r}"));
    let mut text = format!(
        "{}: closed forms in {}\n  positions, m and ½m′ as functions of {}{reaction}\n",
        scene.title,
        count(form.length(), "step"),
        scene.mechanism.actuators[0].name,
    );
    for f in findings {
        let verdict = if f.pass { "pass" } else { "FAIL" };
        text += &format!(
            "  {verdict}  {}: {:.1e} from the numbers at {} (at most {:.0e})\n",
            f.key, f.relative, f.over, f.tolerance
        );
    }
    text
}

/// Markdown with LaTeX.
fn document(scene: &Scene, form: &Form) -> String {
    let of = &form.coordinate;
    let text = |words: &str| Block::Text(words.to_owned());
    let mut blocks = vec![
        Block::Text(format!(
            "The coordinate is ${}$ ({}), in {}. Each line uses those above it. A prime is the derivative by the \
             coordinate. All quantities are in SI units.",
            of.latex, scene.mechanism.actuators[0].name, of.unit
        )),
        Block::Heading("Constants".to_owned()),
        Block::Table {
            header: ["", "value", "unit", "meaning"].map(str::to_owned).into(),
            rows: form
                .constants
                .iter()
                .map(|c| {
                    vec![
                        format!("${}$", c.latex),
                        digits(c.value, 12),
                        c.unit.to_owned(),
                        c.meaning.clone(),
                    ]
                })
                .collect(),
        },
    ];
    for (part, lines) in form.latex() {
        let (heading, words) = told(part, form);
        blocks.push(Block::Heading(heading.to_owned()));
        if !words.is_empty() {
            blocks.push(text(&words));
        }
        blocks.push(Block::Text(format!(
            "```math\n\\begin{{aligned}}\n{lines}\n\\end{{aligned}}\n```"
        )));
    }
    Document {
        title: format!("{}: closed forms", scene.title),
        blocks,
    }
    .markdown()
}

/// The heading of a part and the words under it.
fn told(part: Part, form: &Form) -> (&'static str, String) {
    let reaction = form.reaction.as_deref().unwrap_or_default();
    match part {
        Part::Positions => (
            "Positions",
            "Dyad by dyad, each by the joint that closes it: $d$ is the part of the loop that is known, $D$ its \
             square. The first arm of a pinned dyad is $f$ times $d$ and $h$ times $d$ turned by +90°, the second \
             arm closes the loop. At a guide, $\\kappa$ or $k$ and $g$ are the parts across and along it. The sign \
             $\\sigma$ is the branch. Points then follow, and the centres of mass $G$."
                .to_owned(),
        ),
        Part::First => ("First derivatives", String::new()),
        Part::Second => ("Second derivatives", String::new()),
        Part::Virtual => (
            "Virtual displacements",
            format!(
                "The joint lets go along {reaction}: its second body is shifted against its first by a second \
                 coordinate $q_2$ (turned, for a couple). $\\delta$ is the derivative by $q_2$, at $q_2 = 0$."
            ),
        ),
        Part::Results if form.reaction.is_some() => (
            "Inertia and reaction",
            format!(
                "$m \\ddot q + \\tfrac{{1}}{{2}} m' \\dot q^2$ is the generalised inertia force, and \
                 $a \\ddot q + b \\dot q^2$ the inertia's part of {reaction} (Jordi, Zayas and Cardona 2008): \
                 $a = m_{{12}}$, $b = \\partial m_{{12}}/\\partial q - \\tfrac{{1}}{{2}} \\partial m_{{11}}/\\partial q_2$."
            ),
        ),
        Part::Results => (
            "Inertia",
            "$m \\ddot q + \\tfrac{1}{2} m' \\dot q^2$ is the generalised inertia force.".to_owned(),
        ),
    }
}
