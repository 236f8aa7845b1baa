//! What the page of a case says about the family of mechanisms that meet its source.

use super::family::{DrawnNumber, Family, Member, MemberRow, part_below};
use crate::report_parts::table;
use dwell_report::Block;
use dwell_scene::PlaneScene;
use dwell_study::number_format::{count, digits};
use std::f64::consts::{PI, TAU};

/// The name of an angle at which the quantity before it is largest.
const LARGEST_AT: &str = "where it is largest";
/// What varies by less than this factor over the family is called decided by the source.
const DECIDED: f64 = 1.1;

/// A number of a member.
type Of = fn(&Member) -> f64;

/// A quantity that the source shows or could show.
struct Observable {
    name: String,
    unit: String,
    /// Its value in a member.
    of: Of,
    /// An angle, whose ratio to another says nothing.
    is_position: bool,
}

/// Heading, sentences and tables.
pub(super) fn blocks(scene: &PlaneScene, family: &Family) -> Vec<Block> {
    let observables = observables(scene);
    vec![
        Block::Heading("What the lost dimensions decide".to_owned()),
        Block::Text(family_sentence(family)),
        table(
            &["Not stated in the source", "Drawn between, of the scene's"],
            family.described.drawn.iter().map(drawn_row),
        ),
        table(
            &[
                "Quantity",
                "Unit",
                "Reconstruction",
                "Smallest",
                "10 %",
                "90 %",
                "Largest",
            ],
            observables.iter().map(|o| observable_row(family, o)),
        ),
        Block::Text(decision_sentence(family, &observables)),
    ]
}

fn family_sentence(family: &Family) -> String {
    let [no_revolution, no_rocker, no_dwell, no_period] = family.left_out;
    let kept = family.members.len();
    format!(
        "The source states the topology, the centres of mass, the start and the period, but no length, mass or inertia. \
         Of {} {kept} meet it. Of the others {no_revolution} cannot be assembled over a whole revolution, the guide of \
         {no_rocker} is no rocker, {no_dwell} stand still for less than {}° of the crank, and for {no_period} no value of \
         the fitted number gives the period. Not drawn are the scales: masses multiplied by μ and lengths by λ multiply m \
         by μλ² and forces by μλ, and change neither velocity nor period.",
        count(family.described.draws, "drawn mechanism"),
        digits(family.described.shortest_dwell, 3),
    )
}

fn drawn_row(number: &DrawnNumber) -> Vec<String> {
    let [from, to] = number.factors.map(|factor| digits(factor, 3));
    vec![number.name.clone(), format!("{from} and {to} times")]
}

fn observables(scene: &PlaneScene) -> Vec<Observable> {
    let reaction = scene.requests.reactions.first();
    let (reaction, force) = reaction.map_or(("reaction".to_owned(), "N"), |r| {
        (scene.mechanism.reaction_name(*r), r.component.unit())
    });
    let fitted = scene.calibration.as_ref();
    let (fitted, unit) = fitted.map_or(("", String::new()), |c| (&c.path, scene.unit_of(&c.path)));
    let unit = unit.as_str();
    let of_fitted = format!("fitted `{fitted}`");
    let largest = format!("largest magnitude of {reaction}");
    let changes = format!("changes of sign of {reaction}");
    let named: [(&str, &str, Of); 13] = [
        ("period", "s", |m| last(m).t),
        ("mean velocity", "rad/s", |m| TAU / last(m).t),
        ("largest velocity", "rad/s", |m| fastest(m).q_dot),
        (LARGEST_AT, "°", |m| signed_degrees(fastest(m).q)),
        ("smallest velocity", "rad/s", |m| slowest(m).q_dot),
        ("mean of m over m at the start", "", mean_inertia),
        ("m at the start", "kg m²", Member::start_inertia),
        (&of_fitted, unit, |m| m.calibrated),
        ("dwell", "°", |m| (m.dwell.to - m.dwell.from).to_degrees()),
        ("swing of the dwelling body", "°", |m| {
            m.dwell.swing.to_degrees()
        }),
        (&largest, force, |m| strongest(m).reaction.abs()),
        (LARGEST_AT, "°", |m| signed_degrees(strongest(m).q)),
        (&changes, "", sign_changes),
    ];
    let observable = |(name, unit, of): (&str, &str, _)| Observable {
        name: name.to_owned(),
        unit: unit.to_owned(),
        of,
        is_position: name == LARGEST_AT,
    };
    named.map(observable).into()
}

fn last(member: &Member) -> MemberRow {
    member.rows[member.rows.len() - 1]
}

fn fastest(member: &Member) -> MemberRow {
    member.row_of_largest(|row| row.q_dot.abs())
}

fn slowest(member: &Member) -> MemberRow {
    member.row_of_largest(|row| -row.q_dot.abs())
}

fn strongest(member: &Member) -> MemberRow {
    member.row_of_largest(|row| row.reaction.abs())
}

/// Over the angle; the last row repeats the first.
fn mean_inertia(member: &Member) -> f64 {
    let rows = member.rows.len().saturating_sub(1);
    let sum: f64 = member.rows.iter().take(rows).map(|row| row.m).sum();
    sum / (rows as f64 * member.start_inertia())
}

fn sign_changes(member: &Member) -> f64 {
    let pairs = member.rows.windows(2);
    let changes = pairs.filter(|two| two[0].reaction * two[1].reaction < 0.0);
    changes.count() as f64
}

/// Between −180° and 180°: where the motion starts is not a border.
fn signed_degrees(q: f64) -> f64 {
    ((q + PI).rem_euclid(TAU) - PI).to_degrees()
}

/// The smallest value over the family with the reconstruction, those that a tenth and nine tenths do not exceed, and the
/// largest.
fn spread(family: &Family, of: Of) -> [f64; 4] {
    let members = family.members.iter().chain([&family.reconstruction]);
    let mut values: Vec<f64> = members.map(of).collect();
    values.sort_by(f64::total_cmp);
    [0.0, 0.1, 0.9, 1.0].map(|part| part_below(&values, part))
}

fn observable_row(family: &Family, observable: &Observable) -> Vec<String> {
    let own = (observable.of)(&family.reconstruction);
    let values = [own].into_iter().chain(spread(family, observable.of));
    let names = [observable.name.clone(), observable.unit.clone()];
    names
        .into_iter()
        .chain(values.map(|v| digits(v, 4)))
        .collect()
}

/// What the source decides: what hardly varies over the family, or over most of it.
fn decision_sentence(family: &Family, observables: &[Observable]) -> String {
    let hardly_varies = |low: f64, high: f64| high < DECIDED * low;
    let mut names: [Vec<&str>; 3] = Default::default();
    for observable in observables.iter().filter(|o| !o.is_position) {
        let [smallest, low, high, largest] = spread(family, observable.of);
        let class = match () {
            () if hardly_varies(smallest, largest) => 0,
            () if hardly_varies(low, high) => 1,
            () => 2,
        };
        names[class].push(&observable.name);
    }
    let [decided, mostly, open] = names.map(|names| match names.is_empty() {
        true => "nothing".to_owned(),
        false => names.join(", "),
    });
    let percent = digits(100.0 * (DECIDED - 1.0), 2);
    format!(
        "**What the text decides** (within {percent} % over the whole family): {decided}. **What it decides for four of five \
         members:** {mostly}. **What only the reconstruction decides:** {open}, and with them every number that has the unit \
         of a mass, a length or a force. An agreement of such a number with the paper's pictures would be a choice, not a \
         finding."
    )
}
