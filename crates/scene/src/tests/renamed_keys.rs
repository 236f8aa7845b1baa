//! Keys that were renamed before the first release: an error names them as they are called now.

use super::*;
use crate::tests::format::tables;

/// A text that one of the three scenes contains once, and the text with the former name of a key.
const RENAMED: [(&str, &str, &str); 25] = [
    (WHOLE, "relative-band = 0.02", "band = 0.02"),
    (WHOLE, "initial-coordinate = 30", "start = 30"),
    (WHOLE, "initial-velocity = { phi", "speed = { phi"),
    (WHOLE, "parameter = \"crank", "set = \"crank"),
    (MACHINE, "coupling = [\"lift\"", "relation = [\"lift\""),
    (MACHINE, "free-length = 77.85", "free = 77.85"),
    (MACHINE, "torsion-spring = [", "torsion = ["),
    (MACHINE, "free-angle = 45", "free = 45"),
    (MACHINE, "damping = 100", "constant = 100"),
    (MACHINE, "rotational-damper = [", "torsion-damper = ["),
    (MACHINE, "damping = \"0.1", "constant = \"0.1"),
    (FREE_MOTION, "point-to-point-force = [", "push = ["),
    (FREE_MOTION, "slide-force = ", "slide = "),
    (FREE_MOTION, "guide-length = 40", "guide = 40"),
    (FREE_MOTION, "regularization-speed = 2", "fade = 2"),
    (FREE_MOTION, "applied-force = ", "action = "),
    (FREE_MOTION, "torque-constant = 0.05", "constant = 0.05"),
    (FREE_MOTION, "gear-ratio = -20", "ratio = -20"),
    (FREE_MOTION, "stall-torque = ", "stall = "),
    (FREE_MOTION, "no-load-speed = ", "idle = "),
    (
        FREE_MOTION,
        "speed-controller = \"omega\"",
        "regulator = \"omega\"",
    ),
    (FREE_MOTION, "initial-coordinate = {", "start = {"),
    (FREE_MOTION, "initial-velocity = {", "speed = {"),
    (FREE_MOTION, "[motion.prescribed]", "[motion.laws]"),
    (FREE_MOTION, "revolution = ", "turn = "),
];

#[test]
fn a_former_key_is_answered_with_its_name() {
    for (scene, current, former) in RENAMED {
        let name = |text: &str| {
            let name = text.split([' ', '=']).next().unwrap();
            let name = name.trim_matches(['[', ']']);
            name.rsplit('.').next().unwrap().to_owned()
        };
        let found = messages(&changed(scene, current, former));
        let help = format!("it is called `{}`", name(current));
        assert!(
            found.iter().any(|m| m.contains(&help)),
            "{former}: {found:?}"
        );
    }
    // Every key that was renamed is among them.
    let keys = tables("scene").into_iter().flat_map(|table| &table.keys);
    for former in keys.filter_map(|key| key.former.as_deref()) {
        let named = |text: &str| {
            text.split(|c: char| !c.is_alphanumeric() && c != '-')
                .any(|word| word == former)
        };
        assert!(RENAMED.iter().any(|(_, _, text)| named(text)), "`{former}`");
    }
}
