//! The pictures of a study.

mod along;
mod cost;
mod curves;
mod cycle;
mod digits;
mod energies;
mod equilibria;
mod mechanism;
mod motion;
mod skeleton;
mod states;
mod steps;

pub(crate) use along::{film, run};
pub(crate) use cost::{cost, drift};
pub(crate) use curves::{coefficients, extent, reduced};
pub(crate) use cycle::cycle;
pub(crate) use digits::digits;
pub(crate) use energies::energies;
pub(crate) use equilibria::{Rested, equilibria};
pub(crate) use mechanism::{Dwell, mechanism};
pub(crate) use motion::history;
pub(crate) use skeleton::{Frame, size};
pub(crate) use states::{actions, drawing};
pub(crate) use steps::steps;

use crate::prepare::Prepared;
use crate::words::count;
use dwell_report::Figure;
use dwell_scene::Scene;

/// Most pictures of reactions where none was asked for by name.
pub(crate) const PAGES: usize = 8;

/// How many of so many pictures of reactions are drawn, and what is said of the others: those that
/// were asked for are all drawn.
pub(crate) fn drawn(scene: &Scene, pages: usize) -> (usize, Option<String>) {
    let named = scene.requests.reactions.len() < scene.mechanism.reactions().len();
    if named || pages <= PAGES {
        return (pages, None);
    }
    let note = format!(
        "of {pages} pictures of reactions only the first {PAGES} are drawn: `reactions` in [requests] \
         names those that are wanted"
    );
    (PAGES, Some(note))
}

/// Adds a note to the foot of the last of some figures.
pub(crate) fn tell(figures: &mut [Figure], note: Option<&str>) {
    if let (Some(last), Some(note)) = (figures.last_mut(), note) {
        last.caption += &format!(" Note: {note}.");
    }
}

/// The foot of a figure over the range, which says why curves may leave it.
pub(crate) fn range_caption(prepared: &Prepared<'_>, words: &str) -> String {
    let limits = match prepared.model.model().plan().ends() {
        [None, None] => "",
        [Some(_), Some(_)] => {
            " Towards the limit positions at both ends everything grows without bound."
        }
        _ => " Towards the limit position everything grows without bound.",
    };
    caption(prepared, &format!("{words}{limits}"))
}

/// The foot of a figure: the scene's title and the words. What drew it is added where it is drawn.
pub(crate) fn caption(prepared: &Prepared<'_>, words: &str) -> String {
    foot(prepared.scene, words)
}

/// The same for any scene.
pub(crate) fn foot(scene: &Scene, words: &str) -> String {
    format!("{}. {words}", scene.title.trim_end_matches('.'))
}

/// How the reduced model was evaluated.
pub(crate) fn reduced_at(positions: usize) -> String {
    format!(
        "reduced model by unit runs, at {}",
        count(positions, "position")
    )
}

/// A coordinate's name as a symbol, where it is the name of a Greek letter.
pub(crate) fn symbol(name: &str) -> String {
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
pub(crate) fn coordinate_label(prepared: &Prepared<'_>) -> String {
    let bodies = prepared.scene.mechanism.actuators[0].bodies;
    let mechanism = &prepared.scene.mechanism;
    // The angle of the body that turns; from another than the ground, both are named.
    let turned = mechanism.body_name(bodies[1]);
    let symbol = symbol(prepared.coordinate());
    if bodies[0].0 == mechanism.ground {
        format!("{turned} angle {symbol}")
    } else {
        format!(
            "angle {symbol} of {turned} from {}",
            mechanism.body_name(bodies[0])
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn named_reactions_are_all_drawn_and_too_many_others_are_not() {
        let scene = |requests: &str| {
            let text = format!(
                "[bodies.ground]\npoints = {{ A = [0, 0] }}\n[bodies.crank]\npoints = {{ A = [0, 0] }}\n\
                 [joints]\nA = {{ revolute = [\"ground.A\", \"crank.A\"] }}\n[actuators]\n\
                 phi = {{ angle = [\"ground\", \"crank\"] }}\n{requests}"
            );
            Scene::parse("crank.toml", &text).expect("a scene")
        };
        assert_eq!(drawn(&scene(""), PAGES), (PAGES, None));
        let (pages, note) = drawn(&scene(""), 176);
        assert_eq!(pages, PAGES);
        assert!(note.expect("a note").starts_with("of 176 pictures"));
        let named = scene("[requests]\nreactions = [\"A.x\"]");
        assert_eq!(drawn(&named, 176), (176, None));
    }
}
