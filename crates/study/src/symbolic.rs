//! `dwell symbolic`: a mechanism made of dyads as formulas, held against its numbers.

use crate::error::{
    StudyError, explain_model, joint_labels, names_or_whole, not_one_actuator, size,
};
use crate::outcome::Outcome;
use crate::prepare::shared;
use crate::words::{count, digits, number};
use dwell_findings::Finding;
use dwell_geometry::{Reaction, Vec2};
use dwell_kinetostatics::{Coefficients, Exact, ExactWork, Model, Reduced};
use dwell_report::{Block, Document};
use dwell_scene::Scene;
use dwell_symbolic::{Form, Language, Of, Part, Symbolic, SymbolicError};
use dwell_verify::spread;

/// How closed forms are printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Printed {
    /// Markdown with LaTeX.
    Latex,
    /// A function.
    Code(Language),
}

/// Positions at which the forms are held against the numbers.
const POSITIONS: usize = 24;
/// The agreement asked for, of the largest quantity of its kind: some thousands of roundings.
const TOLERANCE: f64 = 1e-12;
/// What the forms themselves know no better widens the tolerance, up to this.
const BLUNTEST: f64 = 1e-8;

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

/// What is compared: its key, words, unit by what the coordinate is, and the scale.
const KINDS: [(&str, &str, &str); 5] = [
    (
        "symbolic-positions",
        "points, angles and travels by closed forms",
        "the mechanism's largest length, or 1 rad",
    ),
    ("symbolic-m", "m(q) by closed forms", "the largest m"),
    (
        "symbolic-half-dm",
        "½m′(q), differentiated as symbols",
        "the largest ½m′, or m over one radian or length",
    ),
    (
        "symbolic-a",
        "a of the reactions, the joint released as symbols: a = m₁₂",
        "the largest a of its unit",
    ),
    (
        "symbolic-b",
        "b of the reactions, the joint released as symbols: b = ∂m₁₂/∂q − ½ ∂m₁₁/∂q₂",
        "the largest b of its unit",
    ),
];

/// The largest difference of one kind.
#[derive(Debug, Clone, Default)]
struct Worst {
    absolute: f64,
    relative: f64,
    own: f64,
    place: String,
    met: bool,
}

/// Holds forms against the numbers at some positions.
struct Judge<'a> {
    scene: &'a Scene,
    exact: &'a Exact,
    at: Vec<(f64, Coefficients)>,
    work: ExactWork,
    size: f64,
    /// The largest m and ½m′, and of forces and moments a and b.
    scales: [f64; 2],
    reactions: [[f64; 2]; 2],
    worst: [Worst; 5],
    refused: Option<String>,
}

impl<'a> Judge<'a> {
    fn new(scene: &'a Scene, exact: &'a Exact) -> Self {
        let mut judge = Self {
            scene,
            exact,
            at: Vec::new(),
            work: exact.work(),
            size: size(scene),
            scales: [0.0; 2],
            reactions: [[0.0; 2]; 2],
            worst: Default::default(),
            refused: None,
        };
        for q in spread(exact.range(), POSITIONS) {
            let mut out = exact.model().coefficients();
            match exact.coefficients(q, &mut judge.work, &mut out) {
                Ok(()) => judge.at.push((q, out)),
                Err(e) => judge.refused = Some(format!("at {}: {e}", number(q))),
            }
        }
        judge.scale();
        judge
    }

    /// The largest quantities of each kind; what may be zero throughout is measured by its neighbour.
    fn scale(&mut self) {
        let length = if self.size > 0.0 { self.size } else { 1.0 };
        let per = if self.exact.model().plan().is_angle(0) {
            1.0
        } else {
            length
        };
        for (_, out) in &self.at {
            self.scales[0] = self.scales[0].max(out.m.abs());
            self.scales[1] = self.scales[1].max(out.half_dm.abs());
            for (k, r) in self.exact.model().reactions().iter().enumerate() {
                let kind = &mut self.reactions[usize::from(r.component.unit() != "N")];
                kind[0] = kind[0].max(out.a[k].abs());
                kind[1] = kind[1].max(out.b[k].abs());
            }
        }
        self.scales[1] = self.scales[1].max(self.scales[0] / per);
        let [forces, moments] = &mut self.reactions;
        for j in 0..2 {
            moments[j] = moments[j].max(forces[j] * length);
        }
        for kind in &mut self.reactions {
            kind[1] = kind[1].max(kind[0] / per);
        }
    }

    fn hold(&mut self, form: &Form, reaction: Option<Reaction>) {
        let name = reaction.map(|r| self.scene.mechanism.reaction_name(r));
        for k in 0..self.at.len() {
            let q = self.at[k].0;
            let (found, own) = (form.evaluate(q), form.rounding(q));
            self.positions(form, q, &found, &own);
            let out = &self.at[k].1;
            let mut wanted = vec![(out.m, self.scales[0]), (out.half_dm, self.scales[1])];
            if let Some(reaction) = reaction {
                let all = self.exact.model().reactions();
                let at = all.iter().position(|&r| r == reaction).unwrap_or(0);
                let scale = self.reactions[usize::from(reaction.component.unit() != "N")];
                wanted.extend([(out.a[at], scale[0]), (out.b[at], scale[1])]);
            }
            let results = found.len() - wanted.len();
            for (j, (value, scale)) in wanted.into_iter().enumerate() {
                let difference = found[results + j] - value;
                let place = match (&name, j) {
                    (Some(name), 2..) => format!(", {name}"),
                    _ => String::new(),
                };
                self.meet(1 + j, (difference, own[results + j]), scale, q, &place);
            }
        }
    }

    /// Angles, travels and points.
    fn positions(&mut self, form: &Form, q: f64, found: &[f64], own: &[f64]) {
        let plan = self.exact.model().plan();
        let mut pose = plan.pose::<f64>();
        if plan.place(&[q], &mut pose).is_err() {
            return;
        }
        let mut roots = Vec::new();
        plan.roots(&pose, &mut roots);
        let axis = |v: Vec2, k: usize| if k == 0 { v.x } else { v.y };
        let length = if self.size > 0.0 { self.size } else { 1.0 };
        for (k, quantity) in form.quantities.iter().enumerate() {
            let (difference, scale) = match quantity.of {
                Of::Frame(frame) => {
                    let turn = Vec2::from_angle(found[k]).turn_back(pose.turn[frame]);
                    (turn.angle(), 1.0)
                }
                Of::Slide(slide) => (found[k] - pose.slide[slide], length),
                Of::Root(body, i) => {
                    let place = plan.tree().place[body].unwrap_or(0);
                    (found[k] - axis(roots[place], i), length)
                }
                Of::Closure(_) | Of::Centre(..) | Of::Coordinate | Of::Result => continue,
            };
            let place = format!(", {}", quantity.code);
            self.meet(0, (difference, own[k]), scale, q, &place);
        }
    }

    fn meet(&mut self, kind: usize, (difference, own): (f64, f64), scale: f64, q: f64, at: &str) {
        let absolute = difference.abs();
        let of = |x: f64| if x == 0.0 { 0.0 } else { x / scale };
        let relative = of(absolute);
        let worst = &mut self.worst[kind];
        worst.met = true;
        let own = of(own);
        worst.own = worst.own.max(if own.is_finite() { own } else { 0.0 });
        // What is no number is the worst.
        if worst.place.is_empty() || relative > worst.relative || relative.is_nan() {
            worst.absolute = absolute;
            worst.relative = if relative.is_nan() {
                f64::INFINITY
            } else {
                relative
            };
            let name = &self.scene.mechanism.actuators[0].name;
            worst.place = format!("{name} = {}{at}", number(q));
        }
    }

    fn findings(self) -> Vec<Finding> {
        let angle = self.exact.model().plan().is_angle(0);
        let units = if angle {
            [
                "m or rad",
                "kg m²",
                "kg m²",
                "kg m or kg m²",
                "kg m or kg m²",
            ]
        } else {
            ["m or rad", "kg", "kg/m", "kg or kg m", "kg/m or kg"]
        };
        let kinds = KINDS.into_iter().zip(units).zip(self.worst);
        let met = kinds.filter(|(_, worst)| worst.met);
        met.map(|(((key, compared, scale), unit), worst)| {
            // To a power of ten: every machine is to have the same one.
            let wide = (10.0 * worst.own).min(BLUNTEST);
            let tolerance = if wide > TOLERANCE {
                10.0_f64.powi(wide.log10().ceil() as i32)
            } else {
                TOLERANCE
            };
            let mut why = "both are computed from closed forms: thousands of roundings".to_owned();
            if tolerance > TOLERANCE {
                why = "ten times what a unit of rounding in the lengths does to the closed forms, \
                       to a power of ten"
                    .to_owned();
            }
            Finding {
                key: key.to_owned(),
                truth: "11 symbolic closed forms".to_owned(),
                compared: compared.to_owned(),
                over: format!("{} positions", self.at.len()),
                absolute: worst.absolute,
                unit: unit.to_owned(),
                relative: worst.relative,
                scale: scale.to_owned(),
                pass: self.refused.is_none() && worst.relative <= tolerance,
                worst: self.refused.clone().unwrap_or(worst.place),
                tolerance,
                why,
                condition: (worst.own / f64::EPSILON).max(1.0),
                integrated: false,
            }
        })
        .collect()
    }
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
