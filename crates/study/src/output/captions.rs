//! Captions, labels, limits and axes that figures share.

use crate::models::PreparedScene;
use crate::ranges::extent;
use dwell_geometry::Range;
use dwell_report::{Axis, Chart, Figure, Panel, Series};
use dwell_scene::{PlaneScene, SceneFile};

/// Maximum number of reaction figures if none is requested by name.
pub(crate) const MAX_REACTION_FIGURES: usize = 8;

/// The number of reaction figures to draw, of `figures` possible ones, and a note if some are left out.
/// Reactions requested by name are all drawn.
pub(crate) fn reaction_figure_count(are_listed: bool, figures: usize) -> (usize, Option<String>) {
    if are_listed || figures <= MAX_REACTION_FIGURES {
        return (figures, None);
    }
    let note = format!(
        "of {figures} reaction figures only the first {MAX_REACTION_FIGURES} are drawn: select reactions with `reactions` \
         in [requests]"
    );
    (MAX_REACTION_FIGURES, Some(note))
}

/// Adds a note to the caption of the last figure.
pub(crate) fn add_note(figures: &mut [Figure], note: Option<&str>) {
    if let (Some(last), Some(note)) = (figures.last_mut(), note) {
        last.caption += &format!(" Note: {note}.");
    }
}

/// A figure of a scene with its caption, one panel below another.
pub fn figure(
    scene: &SceneFile,
    name: impl Into<String>,
    title: impl Into<String>,
    text: &str,
    panels: Vec<Panel>,
    provenance: impl Into<String>,
) -> Figure {
    Figure {
        name: name.into(),
        title: title.into(),
        caption: scene_caption(scene, text),
        // In one column more would be longer than two pages.
        columns: if panels.len() > 5 { 2 } else { 1 },
        panels,
        provenance: provenance.into(),
    }
}

/// Curves over two axes.
pub fn chart(title: impl Into<String>, x: Axis, y: Axis, series: Vec<Series>) -> Chart {
    Chart {
        title: title.into(),
        x,
        y,
        series,
        ..Chart::default()
    }
}

/// The axis of a coordinate: in degrees, or in m.
pub(crate) fn coordinate_axis(label: &str, is_angle: bool) -> Axis {
    if is_angle {
        Axis::degrees(label)
    } else {
        Axis::new(label, "m")
    }
}

/// The text of a caption of a figure over the range, which explains why curves may leave it.
pub(crate) fn range_caption(has_limits: [bool; 2], text: &str) -> String {
    let limits = match has_limits {
        [false, false] => "",
        [true, true] => {
            " Towards the limit positions at both ends all quantities grow without bound."
        }
        _ => " Towards the limit position all quantities grow without bound.",
    };
    format!("{text}{limits}")
}

/// The caption of a figure: the scene's title and the text. The provenance is added when it is drawn.
pub fn scene_caption(scene: &SceneFile, text: &str) -> String {
    format!("{}. {text}", scene.title.trim_end_matches('.'))
}

/// A coordinate's name, as a symbol if it is the name of a Greek letter.
pub fn symbol(name: &str) -> String {
    const GREEK: [(&str, &str); 8] = [
        ("alpha", "α"),
        ("beta", "β"),
        ("gamma", "γ"),
        ("phi", "φ"),
        ("psi", "ψ"),
        ("theta", "θ"),
        ("omega", "ω"),
        ("delta", "δ"),
    ];
    let found = GREEK.iter().find(|(latin, _)| *latin == name);
    found.map_or(name, |(_, greek)| greek).to_owned()
}

/// The label of the axis of the independent coordinate.
pub fn coordinate_label(prepared: &PreparedScene<'_>) -> String {
    let mechanism = &prepared.scene.mechanism;
    let bodies = mechanism.actuators[0].bodies;
    let symbol = symbol(prepared.coordinate_name());
    if !prepared.is_angle() {
        return symbol;
    }
    // The angle of the second body; from another than the ground, both are named.
    let [from, body] = bodies.map(|b| mechanism.body_name(b));
    if bodies[0].0 == mechanism.ground {
        format!("{body} angle {symbol}")
    } else {
        format!("angle {symbol} of {body} from {from}")
    }
}

/// A spread below this part of the values is rounding.
const MIN_SPREAD: f64 = 1e-12;

/// The vertical extent of the curves. Towards a limit position they grow without bound; the extent is then that of the
/// inner nine tenths of the range.
pub(crate) fn inner_range(range: Range, curves: &[Series]) -> Option<[f64; 2]> {
    if range == Range::Full {
        return None;
    }
    let inner = |c: &Series| {
        let n = c.points.len();
        c.points[n / 20..n - n / 20].to_vec()
    };
    let [low, high] = extent(curves.iter().flat_map(inner).map(|[_, v]| v));
    let margin = 0.08 * (high - low);
    // Of a constant the axis shows its size, not the rounding of its last digit.
    let varies = high - low > MIN_SPREAD * low.abs().max(high.abs());
    varies.then_some([low - margin, high + margin])
}

/// The line of a summary that names the statically indeterminate reactions; empty if there are none.
pub(crate) fn indeterminate_note(names: impl Iterator<Item = String>) -> String {
    let names: Vec<String> = names.collect();
    if names.is_empty() {
        return String::new();
    }
    let names = names.join(", ");
    format!(
        "  statically indeterminate (redundant constraints share the load), so in no table: {names}\n"
    )
}

/// The line of a summary about separating forces, which a and b cannot hold; empty if there are none.
pub(crate) fn separating_note(scene: &PlaneScene) -> String {
    let separating = scene.loads.iter().filter(|load| !load.does_work());
    let names: Vec<&str> = separating.map(|load| load.name.as_str()).collect();
    if names.is_empty() {
        return String::new();
    }
    let names = names.join(", ");
    format!(
        "  a and b are without the separating forces {names}: each is |tooth force| × tan(pressure angle) at one state, and adds c times itself to a reaction\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rounding_of_a_constant_is_no_range() {
        let curve = |values: &[f64]| {
            let points = (0..).zip(values).map(|(k, v)| [f64::from(k), *v]);
            Series::line("m", points.collect())
        };
        let constant = curve(&[2.5, 2.5 * (1.0 + f64::EPSILON), 2.5]);
        assert_eq!(inner_range(Range::Revolutions(6), &[constant]), None);
        let varying = curve(&[2.5, 2.6, 2.5]);
        assert!(inner_range(Range::Revolutions(6), &[varying]).is_some());
    }

    #[test]
    fn named_reactions_are_all_drawn_and_too_many_others_are_not() {
        let scene = |requests: &str| {
            let text = format!(
                "[bodies.ground]\npoints = {{ A = [0, 0] }}\n[bodies.crank]\npoints = {{ A = [0, 0] }}\n\
                 [joints]\nA = {{ revolute = [\"ground.A\", \"crank.A\"] }}\n[actuators]\n\
                 phi = {{ angle = [\"ground\", \"crank\"] }}\n{requests}"
            );
            PlaneScene::parse("crank.toml", &text).expect("a scene")
        };
        let lists = crate::models::lists_reactions;
        assert_eq!(
            reaction_figure_count(lists(&scene("")), MAX_REACTION_FIGURES),
            (MAX_REACTION_FIGURES, None)
        );
        let (pages, note) = reaction_figure_count(lists(&scene("")), 176);
        assert_eq!(pages, MAX_REACTION_FIGURES);
        assert!(note.expect("a note").starts_with("of 176 reaction figures"));
        let named = scene("[requests]\nreactions = [\"A.x\"]");
        assert_eq!(reaction_figure_count(lists(&named), 176), (176, None));
    }
}
