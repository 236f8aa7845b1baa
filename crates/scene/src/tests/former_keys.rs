//! Former names of keys: read as the current ones, with a warning.

use super::*;
use crate::keys::{TableSchema, ValueShape, kinds};
use crate::tests::format::tables;

/// A text with current names, which one of the three scenes contains once, and the same with former names.
const RENAMED: [(&str, &str, &str); 27] = [
    (WHOLE, "relative-band = 0.02", "band = 0.02"),
    (WHOLE, "initial-coordinate = 30", "start = 30"),
    (WHOLE, "initial-velocity = { phi", "speed = { phi"),
    (WHOLE, "parameter = \"crank", "set = \"crank"),
    (MACHINE, "coupling = [\"lift\"", "relation = [\"lift\""),
    (MACHINE, "[coordinate-sweep]", "[sweep]"),
    (MACHINE, "lift.velocity", "lift.speed"),
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

/// All that a scene holds, but its text and the places in it.
fn data(scene: &Scene) -> String {
    let mechanism = (&scene.mechanism, &scene.masses, &scene.points);
    let motions = (&scene.prescribed, &scene.sweep, &scene.motion);
    let forces = (&scene.loads, &scene.drives);
    let rest = (&scene.assembly, &scene.coordinates, &scene.requests);
    format!(
        "{mechanism:?} {motions:?} {forces:?} {rest:?} {:?}",
        scene.calibration
    )
}

fn former_names() -> Vec<(&'static TableSchema, &'static str)> {
    let keys = tables("scene").into_iter().flat_map(|table| {
        let former = table.keys.iter().filter_map(|k| k.former.as_deref());
        former.map(move |former| (table, former))
    });
    keys.collect()
}

#[test]
fn a_former_name_is_read_as_the_current_one_with_a_warning() {
    for (scene, current, former) in RENAMED {
        let expected = parse(scene).unwrap();
        assert!(expected.warnings.is_empty(), "{:?}", expected.warnings);
        let read = parse(&changed(scene, current, former))
            .unwrap_or_else(|e| panic!("{former}: {}", render(&e)));
        // An expression keeps the names that it was written with.
        let data_read = data(&read).replace("lift.speed", "lift.velocity");
        assert_eq!(data_read, data(&expected), "{former}");
        let [warning] = read.warnings.as_slice() else {
            panic!("{former}: {:?}", read.warnings);
        };
        assert!(warning.message.contains("is now called"), "{warning}");
        let label = &warning.labels[0];
        let text = &read.source.inner()[label.offset()..label.offset() + label.len()];
        assert!(
            text.contains(
                former
                    .split([' ', '='])
                    .next()
                    .unwrap()
                    .trim_matches(['[', ']'])
            ) || former.starts_with("[motion."),
            "{text}"
        );
    }
    // Every key that was renamed is among them.
    for (_, former) in former_names() {
        let named = |text: &str| {
            text.split(|c: char| !c.is_alphanumeric() && c != '-')
                .any(|word| word == former)
        };
        assert!(RENAMED.iter().any(|(_, _, text)| named(text)), "`{former}`");
    }
}

#[test]
fn each_former_name_gives_one_warning_however_often_it_stands() {
    let text = changed(
        FREE_MOTION,
        "speed-controller = \"omega\"",
        "regulator = \"omega\"",
    );
    let text = changed(&text, "speed-controller = \"rise\"", "regulator = \"rise\"");
    let warnings = parse(&text).unwrap().file.warnings;
    assert_eq!(warnings.len(), 1);
    assert_eq!(
        warnings[0].message,
        "`regulator` is now called `speed-controller`"
    );
}

#[test]
fn the_former_and_the_current_name_at_once_are_an_error() {
    let text = changed(
        FREE_MOTION,
        "regularization-speed = 2",
        "fade = 2, regularization-speed = 3",
    );
    assert_eq!(
        messages(&text),
        [
            "both `fade` and `regularization-speed` are given | «fade» the former name | \
          «regularization-speed» the current name of the same key ⇒ keep `regularization-speed` and delete `fade`"
        ]
    );
}

/// Otherwise one name would mean two things.
#[test]
fn no_former_name_is_a_current_one_beside_it() {
    for (table, former) in former_names() {
        assert!(!table.contains_key(former), "`{former}` of {}", table.name);
    }
    let keys = tables("scene")
        .into_iter()
        .flat_map(|table| table.keys.iter().chain(&table.named));
    for key in keys {
        let ValueShape::Kinds(things) = &key.shape else {
            continue;
        };
        let kinds = kinds(things);
        for former in kinds.iter().filter_map(|kind| kind.keys[0].former.as_ref()) {
            assert!(
                !kinds.iter().any(|kind| kind.contains_key(former)),
                "`{former}`"
            );
        }
    }
}

#[test]
fn numbers_are_found_by_former_paths_too() {
    let scene = parse(FREE_MOTION).unwrap();
    for (current, former) in [
        ("motion.initial-velocity.phi", "motion.speed.phi"),
        (
            "motion.prescribed.psi.sinusoid.amplitude",
            "motion.laws.psi.sinusoid.amplitude",
        ),
        ("friction.slide.regularization-speed", "friction.slide.fade"),
        ("drives.starter.torque-constant", "drives.starter.constant"),
    ] {
        assert_eq!(scene.value(former).unwrap(), scene.value(current).unwrap());
        assert_eq!(scene.renamed_path(former), Some(current));
        assert_eq!(scene.renamed_path(current), None);
        let value = scene.value(current).unwrap() + 1.0;
        let [a, b] = [former, current].map(|path| scene.with_value(path, value).unwrap());
        assert_eq!(data(&a), data(&b));
    }
    let old = changed(MACHINE, "[coordinate-sweep]", "[sweep]");
    let scene = parse(&old).unwrap();
    assert_eq!(
        scene.value("coordinate-sweep.speed").unwrap(),
        scene.value("sweep.speed").unwrap()
    );
}

#[test]
fn an_unknown_name_in_an_expression_is_answered_with_current_names() {
    let text = changed(MACHINE, "lift.velocity", "lift.sped");
    assert!(
        !messages(&text)[0].contains(".speed"),
        "{}",
        messages(&text)[0]
    );
}

#[test]
fn an_error_names_the_key_as_the_file_has_it() {
    for (scene, current, wrong, message) in [
        (
            MACHINE,
            "free-length = 77.85",
            "free = -1",
            "free of load `coil` is negative",
        ),
        (
            MACHINE,
            "damping = 100",
            "constant = -1",
            "constant of load `oil` is negative",
        ),
        (
            FREE_MOTION,
            "regularization-speed = 2",
            "fade = 0",
            "fade of friction of `slide`",
        ),
        (
            WHOLE,
            "initial-coordinate = 30",
            "start = true",
            "start of [motion]: expected",
        ),
    ] {
        let found = messages(&changed(scene, current, wrong));
        assert!(found[0].contains(message), "{found:?}");
    }
}
