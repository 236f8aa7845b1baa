//! The family of mechanisms that meet what a source states, beside the reconstruction.

use crate::case_report::family::{Family, Member, MemberRow, part_below};
use dwell_report::{Axis, Figure, Paint, Panel, Series, Stroke};
use dwell_study::PreparedScene;
use dwell_study::number_format::count;
use dwell_study::output::{chart, coordinate_label, figure, symbol};

/// The paper's Figures 3a, 3b and 4, each without the scales of mass and length, which the text leaves open.
pub(crate) fn family(prepared: &PreparedScene<'_>, family: &Family) -> Figure {
    let q = symbol(prepared.coordinate_name());
    let reaction = prepared.reaction_units().into_iter().next();
    let reaction = reaction.map_or_else(|| "reaction".to_owned(), |(name, _)| name);
    let over_angle = |title: &str, label: &str, y: Value| -> Panel {
        let (x, curves) = (
            Axis::degrees(coordinate_label(prepared)),
            curves(family, |row| row.q.to_degrees(), y),
        );
        chart(title, x, Axis::new(label, ""), curves).into()
    };
    let over_time = |title: String, y_axis, y: Value| -> Panel {
        let curves = curves(family, |row| row.t, y);
        chart(title, Axis::new("time", "s"), y_axis, curves).into()
    };
    let velocity = Axis::new(format!("d{q}/dt"), "rad/s");
    let relative = Axis::new(format!("{reaction} / its largest"), "");
    let panels = vec![
        over_angle(
            "Generalised inertia",
            "m / m at the start",
            |member, row| row.m / member.start_inertia(),
        ),
        over_angle(
            "Half its derivative",
            "½m′ / m at the start",
            |member, row| row.half_dm / member.start_inertia(),
        ),
        over_time(
            "Velocity in the free motion".to_owned(),
            velocity,
            |_, row| row.q_dot,
        ),
        over_time(
            format!("Reaction {reaction} in the free motion"),
            relative,
            |member, row| {
                let largest = member.row_of_largest(|row| row.reaction.abs());
                row.reaction / largest.reaction.abs()
            },
        ),
    ];
    let text = format!(
        "The reconstruction, and between which values four of five of {} are that meet the text of the source. All have \
         the stated period.",
        count(family.members.len(), "mechanism")
    );
    let provenance = format!(
        "exact reduced models of {}",
        count(family.described.draws, "draw")
    );
    let title = "What the lost dimensions decide";
    Figure {
        columns: 2,
        ..figure(prepared.scene, "family", title, &text, panels, provenance)
    }
}

/// A value of a member at a row.
type Value = fn(&Member, &MemberRow) -> f64;

/// Abscissas at which the members are compared.
const POINTS: usize = 361;

/// The reconstruction, and the values below which a tenth and nine tenths of the members are.
fn curves(family: &Family, x: fn(&MemberRow) -> f64, y: Value) -> Vec<Series> {
    let points = |member: &Member| -> Vec<[f64; 2]> {
        let rows = member.rows.iter();
        rows.map(|row| [x(row), y(member, row)]).collect()
    };
    let all: Vec<Vec<[f64; 2]>> = family.members.iter().map(points).collect();
    let own = points(&family.reconstruction);
    let [from, to] = [own.first(), own.last()].map(|end| end.map_or(0.0, |p| p[0]));
    let mut limits = [Vec::new(), Vec::new()];
    for k in 0..POINTS {
        let at = from + (to - from) * k as f64 / (POINTS - 1) as f64;
        let mut values: Vec<f64> = all.iter().map(|curve| interpolated(curve, at)).collect();
        values.sort_by(f64::total_cmp);
        for (limit, part) in limits.iter_mut().zip([0.1, 0.9]) {
            limit.push([at, part_below(&values, part)]);
        }
    }
    let [low, high] = limits;
    let limit = |name: &str, points| {
        let line = Series::line(name, points).color(Paint::Grey);
        line.stroke(Stroke::Dashed)
    };
    vec![
        Series::line("reconstruction", own),
        limit("four of five members between", low),
        limit("", high),
    ]
}

/// The value of a curve of growing abscissas, straight between its points: enough for a picture.
fn interpolated(curve: &[[f64; 2]], at: f64) -> f64 {
    let after = curve.partition_point(|p| p[0] < at);
    let before = curve.get(after.saturating_sub(1));
    match (before, curve.get(after)) {
        (Some([x0, y0]), Some([x1, y1])) if x1 > x0 => y0 + (y1 - y0) * (at - x0) / (x1 - x0),
        (_, Some([_, y])) | (Some([_, y]), None) => *y,
        (None, None) => f64::NAN,
    }
}
