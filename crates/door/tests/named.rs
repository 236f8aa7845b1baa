//! Every element and attribute of a file is read, or named with its line.

use dwell_door::{Coverage, Effect, Format, Import, ImportOptions, import_text};
use proptest::prelude::*;

const FOLDER: &str = "../../validation/imported";
/// Files of XML, and the joints that drive.
const FILES: [(&str, &[&str]); 10] = [
    ("m1-fourbar.xml", &[]),
    ("m2-rssr.xml", &["A"]),
    ("m3-slidercrank.xml", &["A"]),
    ("m4-sixbar.xml", &["A"]),
    ("m5-jointeq.xml", &["a"]),
    ("x1-unsupported.xml", &[]),
    ("u1-fourbar.urdf", &["A"]),
    ("u2-mimic.urdf", &["jl"]),
    ("s1-fourbar.sdf", &["A"]),
    ("s2-slidercrank.sdf", &["A"]),
];

fn text(file: &str) -> String {
    std::fs::read_to_string(format!("{FOLDER}/{file}")).unwrap_or_default()
}

fn imported(file: &str, text: &str, drives: &[&str]) -> Option<Import> {
    let drives = drives.iter().map(|name| (*name).to_owned()).collect();
    let options = ImportOptions {
        drives,
        ..ImportOptions::default()
    };
    import_text(file, text, &options).ok()
}

/// The first bytes behind the names of all elements, by a scan of the text.
fn tags(text: &str) -> Vec<usize> {
    let starts = text.match_indices('<').map(|(at, _)| at + 1);
    let is_name = |c: char| c.is_alphanumeric() || "_-".contains(c);
    let named = starts.filter(|at| text[*at..].starts_with(|c: char| c.is_alphabetic()));
    named
        .map(|at| at + text[at..].find(|c| !is_name(c)).unwrap_or_default())
        .collect()
}

/// Elements and attributes by the same scan.
fn count(text: &str) -> usize {
    let tags = tags(text);
    let inside = |at: &usize| {
        text[*at..]
            .split('>')
            .next()
            .map_or(0, |tag| tag.matches("=\"").count())
    };
    tags.len() + tags.iter().map(inside).sum::<usize>()
}

#[test]
fn as_many_elements_and_attributes_are_read_and_named_as_the_file_has() {
    for (file, drives) in FILES {
        let text = text(file);
        let Coverage { all, read, named } = imported(file, &text, drives).expect(file).coverage;
        assert_eq!(all, count(&text), "{file}");
        assert_eq!(read + named, all, "{file}");
    }
}

#[test]
fn an_unknown_attribute_is_named_wherever_it_is() {
    for (file, drives) in FILES {
        let text = text(file);
        let plain = imported(file, &text, drives).expect(file);
        for at in tags(&text) {
            let changed = format!("{} unheard-of=\"1\"{}", &text[..at], &text[at..]);
            let import = imported(file, &changed, drives).expect(file);
            let Coverage { all, read, named } = plain.coverage;
            let expected = Coverage {
                all: all + 1,
                read,
                named: named + 1,
            };
            assert_eq!(import.coverage, expected, "{file}, byte {at}");
            // It is named itself, or the element around it is.
            let line = 1 + text[..at].matches('\n').count();
            let says = import
                .findings
                .iter()
                .any(|one| one.line == line && one.text.contains("unheard-of"));
            let lines = plain.findings.iter().filter(|one| one.line <= line);
            assert!(says || lines.count() > 0, "{file}, line {line}");
            assert!(!says || import.losses().count() > plain.losses().count());
        }
    }
}

#[test]
fn what_has_no_counterpart_is_named_by_its_line() {
    let import = imported("x1.xml", &text("x1-unsupported.xml"), &[]).expect("x1");
    let lines = import
        .findings
        .iter()
        .filter(|one| one.effect != Effect::Nothing);
    let lines: Vec<String> = lines.map(ToString::to_string).collect();
    let expected = [
        "x1.xml:3: option density, viscosity, wind: fluid forces: left out (changes the motion)",
        "x1.xml:5: geom floor, plane: contact: left out (changes the motion if touched)",
        "x1.xml:7: joint A actuatorfrcrange: left out (limit of a drive)",
        "x1.xml:7: joint A armature 0.01 on a joint of the ground: kept (in the inertia about the axis)",
        "x1.xml:7: joint A frictionloss 0.05: kept as a load -0.05*sign(rate)",
        "x1.xml:7: joint A range: kept as a stop where free",
        "x1.xml:11: joint B armature 0.002, not on the ground: no exact counterpart: left out (changes the torque by 0.002 × its \
            acceleration)",
        "x1.xml:12: geom mesh part: inertia of a mesh: left out (changes the motion)",
        "x1.xml:16: body box gravcomp, fluidshape: left out (gravcomp 1 cancels the weight)",
        "x1.xml:16: body box, free, joined to nothing: left out",
        "x1.xml:20: contact pair: left out (changes the motion if touched)",
        "x1.xml:21: tendon rope: kept as a spring between s0 and s1 (straight, two sites), its range left out (acts only at a limit)",
        "x1.xml:22: equality poly, polynomial of degree 2: coupling in the plane",
        "x1.xml:23: position actuator: servo: kept as a drive (kp, kv)",
        "x1.xml:23: muscle actuator of B: left out (changes the motion)",
    ];
    assert_eq!(lines, expected);
    let nothing: Vec<usize> = import
        .findings
        .iter()
        .filter(|one| one.effect == Effect::Nothing)
        .map(|one| one.line)
        .collect();
    assert_eq!(nothing, [19, 24], "asset and sensor");
}

#[test]
fn an_external_entity_is_not_read() {
    let text = "<!DOCTYPE mujoco [<!ENTITY e SYSTEM \"/etc/hostname\">]><mujoco model=\"&e;\"/>";
    let error = import_text("e.xml", text, &ImportOptions::default()).expect_err("refused");
    assert!(error.to_string().contains("invalid"), "{error}");
    let include = "<mujoco><include file=\"../outside.xml\"/></mujoco>";
    assert!(import_text("e.xml", include, &ImportOptions::default()).is_err());
}

#[test]
fn what_is_careless_is_refused_in_words_that_help() {
    let four_bar = text("m1-fourbar.xml");
    let default = ImportOptions::default;
    let of = |from| ImportOptions {
        from: Some(from),
        ..default()
    };
    let drives = |name: &str| ImportOptions {
        drives: vec![name.to_owned()],
        ..default()
    };
    let closes = |text: &str| ImportOptions {
        close: text.parse().into_iter().collect(),
        ..default()
    };
    let some = |text: &str| Some(text.to_owned());
    let key = ImportOptions {
        key: some("home"),
        ..default()
    };
    let fix = ImportOptions {
        fix: some("base"),
        ..default()
    };
    let loops = ImportOptions {
        loops: some("closed_loop: []"),
        ..default()
    };
    let cases: [(&str, ImportOptions, &str); 13] = [
        ("", default(), "`m.xml` is empty"),
        (
            "<html/>",
            default(),
            "shows its format (give --from mjcf, urdf, sdf, asmt or pmks)",
        ),
        (
            "<html/>",
            of(Format::Mjcf),
            "begins with `html` in place of `mujoco`",
        ),
        (
            &four_bar,
            of(Format::Urdf),
            "begins with `mujoco` in place of `robot`",
        ),
        (&four_bar, of(Format::Pmks), "`m.xml` is no link of PMKS+"),
        ("<mujoco>", default(), "m.xml:1: the XML is invalid"),
        (
            "<mujoco/>",
            default(),
            "the model has no joint that may drive",
        ),
        (
            &four_bar,
            drives("X"),
            "no joint with one coordinate `X`: it has A, B, D",
        ),
        (
            &four_bar,
            closes("X=crank:fixed"),
            "no frame `X`: it has ground, crank, coupler",
        ),
        (
            &four_bar,
            fix,
            "no body `base`: it has crank, coupler, rocker",
        ),
        (&four_bar, key.clone(), "no keyframe `home`: it has none"),
        (
            &text("s1-fourbar.sdf"),
            key,
            "`m.xml` is SDF, which has no keyframes",
        ),
        (
            &four_bar,
            loops,
            "`m.xml` is MJCF, which has no YAML files of loops",
        ),
    ];
    for (text, options, expected) in cases {
        let error = import_text("m.xml", text, &options).expect_err(expected);
        let message = error.full_message();
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn joints_within_one_body_and_too_many_drives_are_named() {
    let options = ImportOptions {
        fix: Some("crank".to_owned()),
        drives: vec!["B".to_owned(), "D".to_owned()],
        ..ImportOptions::default()
    };
    let import = import_text("m1.xml", &text("m1-fourbar.xml"), &options).expect("m1");
    let says = |text: &str| import.scene.contains(text);
    assert!(says("joint A, between parts of one body: left out"));
    assert!(says("the model has no degrees of freedom and 2 drives"));
    assert!(!says("A = {"));
}

/// Changes of a text: bytes are removed, lines removed and doubled, values and elements inserted.
fn mutated(text: &str, changes: &[(prop::sample::Index, u8)]) -> String {
    let mut text = text.to_owned();
    for (place, kind) in changes {
        let at = place.index(text.len().max(1));
        let line = text[..at].rfind('\n').map_or(0, |end| end + 1);
        let end = text[at..].find('\n').map_or(text.len(), |end| at + end + 1);
        let value = text[at..].find("=\"").map_or(at, |equals| at + equals + 2);
        let close = text[value..].find('"').map_or(value, |quote| value + quote);
        match kind % 8 {
            0 => drop(text.drain(at..(at + usize::from(*kind) / 32).min(text.len()))),
            1 => drop(text.drain(line..end)),
            2 => text = [&text[..end], &text[line..]].concat(),
            3 => text.insert(value, '-'),
            4 => text.replace_range(value..close, "1e308 1e308 1e308"),
            5 => text.replace_range(value..close, "0"),
            6 => text.replace_range(value..close, ""),
            _ => text.insert_str(line, "<a b=\"c\"/>"),
        }
    }
    text
}

proptest! {
    #[test]
    fn no_mutated_file_causes_a_panic_or_loses_a_part(
        file in 0..FILES.len() + 2,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
    ) {
        let others: [(&str, &[&str]); 2] = [("a1-fourbar.asmt", &[]), ("p1-fourbar.txt", &[])];
        let (file, drives) = *FILES.get(file).unwrap_or(&others[file % 2]);
        let mut changed = mutated(&text(file), &changes);
        if file.ends_with(".txt") {
            // With the check digit of its length.
            let kept: String = changed.trim().chars().filter(char::is_ascii).collect();
            let digits: Vec<char> = ('0'..='9').chain('A'..='Z').chain('a'..='z').collect();
            changed = format!("{kept}{}", digits[kept.len() % 62]);
        }
        if let Some(import) = imported(file, &changed, drives) {
            let Coverage { all, read, named } = import.coverage;
            prop_assert_eq!(read + named, all);
            prop_assert!(!import.scene.is_empty());
        }
    }
}
