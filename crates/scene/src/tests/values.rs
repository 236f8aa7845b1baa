//! Numbers by their path.

use super::*;

#[test]
fn every_number_by_its_path() {
    let scene = parse(WHOLE).unwrap();
    for (path, value, unit, written) in [
        ("ground.points.S[1]", 10.0, "mm", "S"),
        ("crank.mass", 2.0, "kg", "2.0"),
        ("crank.inertia", 1666.0, "kg mm2", "1666.0"),
        ("crank.center[1]", 1.0, "mm", "[50, 1]"),
        ("rod.points.P[0]", 300.0, "mm", "P"),
    ] {
        assert_eq!(scene.value(path).unwrap(), value);
        assert_eq!(scene.unit_of(path), unit);
        let label = (scene.location_of(path), "here".to_owned());
        let error = scene.error("too heavy".to_owned(), None, &[label]);
        assert_eq!(error.labelled(), [(written, "here")]);
        assert!(scene.number_paths().contains(&path.to_owned()));
    }
    assert_eq!(scene.number_paths().len(), 2 * 7 + 3 + 2 + 1);
}

#[test]
fn the_hash_is_that_of_the_text_whatever_its_line_ends() {
    let text = "[bodies.ground]\npoints = { A = [0, 0] }\n[bodies.crank]\npoints = { A = [0, 0] }\n[joints]\n\
                A = { revolute = [\"ground.A\", \"crank.A\"] }\n[actuators]\nphi = { angle = [\"ground\", \"crank\"] }\n";
    let hash = |text: &str| PlaneScene::parse("crank.toml", text).unwrap().hash();
    // Of `sha256sum` on a file of this text.
    assert_eq!(
        hash(text),
        "8935b793c8c2d479fab03b9e2a7e9cfeffbf0f9ae67063cf00dc2c66a644d467"
    );
    assert_eq!(hash(&text.replace('\n', "\r\n")), hash(text));
    assert_ne!(hash(&format!("{text}\n")), hash(text));
    let scene = parse(WHOLE).unwrap();
    assert_ne!(
        scene.with_value("crank.mass", 3.25).unwrap().hash(),
        scene.hash()
    );
}

#[test]
fn a_changed_number_changes_what_follows_from_it_and_nothing_else() {
    let scene = parse(WHOLE).unwrap();
    let heavier = scene.with_value("crank.mass", 3.25).unwrap();
    assert_eq!(heavier.masses[1].mass, 3.25);
    assert_eq!(heavier.masses[1].center, scene.masses[1].center);
    assert_eq!(heavier.mechanism, scene.mechanism);
    assert_eq!(heavier.name, scene.name);
    let longer = scene.with_value("rod.points.P[0]", 1e-7).unwrap();
    assert_eq!(longer.points[2][1].1.x, 1e-7 / 1000.0);
    assert_eq!(longer.mechanism.joints[2].points[0].x, 1e-7 / 1000.0);
    assert_eq!(longer.requests.paths[0].at.x, 1e-7 / 1000.0);
    // Changed back, digit for digit, whatever the number.
    for value in [0.1, 1.0 / 3.0, 5e-324, 1e60, 123456789.125, 0.0] {
        let changed = scene.with_value("crank.mass", value).unwrap();
        assert_eq!(changed.value("crank.mass").unwrap(), value);
        let back = changed.with_value("crank.mass", 2.0).unwrap();
        assert_eq!(back.source.inner(), WHOLE);
    }
}

#[test]
fn a_wrong_path_is_told_what_there_is() {
    let scene = parse(WHOLE).unwrap();
    let message = |path: &str| {
        let error = scene.with_value(path, 1.0).unwrap_err();
        assert_eq!(scene.value(path).unwrap_err().message, error.message);
        assert_eq!(scene.unit_of(path), "");
        render(&error);
        format!("{} ⇒ {}", error.message, error.help.unwrap())
    };
    assert_eq!(
        message("crank.interia"),
        "the scene has no number `crank.interia` ⇒ did you mean `crank.inertia`?"
    );
    assert_eq!(
        message("piston.center[0]"),
        "the scene has no number `piston.center[0]` ⇒ the numbers written in `piston` are \
         `piston.points.P[0]`, `piston.points.P[1]` and `piston.mass`"
    );
    for path in [
        "",
        ".",
        "crank",
        "crank.",
        "crank.points.B[2]",
        "crank.points.B",
        "φ",
    ] {
        assert!(message(path).contains("has no number"), "{path}");
    }
}

#[test]
fn a_wrong_value_is_shown_where_it_stands() {
    let scene = parse(WHOLE).unwrap();
    let error = scene.with_value("crank.mass", -1.5).unwrap_err();
    assert_eq!(error.message, "the mass of body `crank` is negative");
    assert_eq!(error.labelled(), [("-1.5", "expected 0 or more")]);
    for value in [f64::NAN, f64::INFINITY] {
        let error = scene.with_value("crank.mass", value).unwrap_err();
        assert!(error.message.contains("not finite"));
        assert_eq!(error.labelled(), [("2.0", "this number")]);
    }
    assert!(scene.with_value("crank.mass", 1e61).is_err());
}

#[test]
fn several_numbers_change_at_once() {
    let scene = parse(WHOLE).unwrap();
    let both = [("rod.points.P[0]", 1e-7), ("crank.mass", 3.25)];
    let at_once = scene.with_values(&both).unwrap();
    let one_by_one = scene
        .with_value("crank.mass", 3.25)
        .and_then(|scene| scene.with_value("rod.points.P[0]", 1e-7))
        .unwrap();
    assert_eq!(at_once.source.inner(), one_by_one.source.inner());
    assert_eq!(scene.with_values(&[]).unwrap().hash(), scene.hash());
    let twice = [("crank.mass", 1.0), ("crank.mass", 2.0)];
    let error = scene.with_values(&twice).unwrap_err();
    assert!(error.message.contains("two values"), "{}", error.message);
}

#[test]
fn numbers_outside_the_bodies_are_found_by_their_keys() {
    let text = WHOLE.to_owned()
        + "\n[loads]\nbrake = { rotational-damper = [\"ground\", \"crank\"], damping = 1_2.5 }\n\
           weight = { gravity = [0, -9.81] }\n";
    let scene = parse(&text).unwrap();
    for (path, value) in [
        ("loads.brake.damping", 12.5),
        ("loads.weight.gravity[1]", -9.81),
    ] {
        assert_eq!(scene.value(path).unwrap(), value);
        let changed = scene.with_value(path, 3.0).unwrap();
        assert_eq!(changed.value(path).unwrap(), 3.0);
        assert_ne!(changed.loads, scene.loads);
        // What was not asked for is as it was.
        assert_eq!(changed.masses, scene.masses);
    }
    let error = scene.value("loads.brake.dampng").unwrap_err();
    assert_eq!(error.help.unwrap(), "did you mean `loads.brake.damping`?");
    let error = scene.with_value("loads.brake.damping", -1.0).unwrap_err();
    assert_eq!(error.labelled()[0].0, "-1.0");
}
