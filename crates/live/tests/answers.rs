//! The numbers of the live page are those of the crate `dwell`, and its messages those of the scene's reader.
#![allow(clippy::unwrap_used, reason = "a test")]

use serde_json::{Value, json};
use std::path::PathBuf;

fn text_of(case: &str) -> String {
    let validation = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../validation"));
    let file = match case.ends_with(".toml") {
        true => validation.join(case),
        false => validation.join(case).join("scene.toml"),
    };
    std::fs::read_to_string(file).unwrap()
}

/// The answer to a command, and its columns by name.
fn run(command: &str, text: &str) -> (Value, Vec<f64>) {
    let request = json!({ "do": "run", "command": command, "text": text });
    let answer = dwell_live::answer(&request.to_string());
    (serde_json::from_str(&answer.text).unwrap(), answer.numbers)
}

fn column<'n>(answer: &Value, numbers: &'n [f64], name: &str) -> &'n [f64] {
    let page = &answer["page"];
    let rows = usize::try_from(page["rows"].as_u64().unwrap()).unwrap();
    let columns = page["columns"].as_array().unwrap();
    let found = columns.iter().find(|c| c["key"] == name).unwrap();
    let slot = usize::try_from(found["slot"].as_u64().unwrap()).unwrap();
    &numbers[slot * rows..(slot + 1) * rows]
}

#[test]
fn rows_of_a_motion_are_those_of_the_front_door() {
    let text = text_of("jansen");
    let (answer, numbers) = run("kinetostatics", &text);
    assert_eq!(answer["messages"], json!([]));
    let mechanism = dwell::Scene::parse(&text).unwrap().assemble().unwrap();
    let motion = mechanism.kinetostatics().unwrap();
    let mut compared = 0;
    for (name, _) in motion.columns() {
        assert_eq!(
            column(&answer, &numbers, name),
            motion.column(name).unwrap(),
            "{name}"
        );
        compared += 1;
    }
    assert!(compared > 20, "{compared} columns");
}

#[test]
fn m_of_each_row_is_that_of_the_reduced_model_and_the_period_that_of_the_quadrature() {
    let text = text_of("single-dwell");
    let (answer, numbers) = run("motion", &text);
    let mechanism = dwell::Scene::parse(&text).unwrap().assemble().unwrap();
    let reduced = mechanism.reduced(std::iter::empty::<&str>()).unwrap();
    let q = column(&answer, &numbers, "phi");
    let [m, half_dm] = ["m", "half_dm"].map(|name| column(&answer, &numbers, name));
    for ((&q, &m), &half_dm) in q.iter().zip(m).zip(half_dm) {
        let at = reduced.at(q).unwrap();
        // The same sums over fewer bodies: some roundings.
        assert!((at.m - m).abs() < 1e-14 * at.m && (at.half_dm - half_dm).abs() < 1e-14 * at.m);
    }
    let period = mechanism.period().unwrap().period;
    let numbers = answer["page"]["numbers"].as_array().unwrap();
    let shown = numbers.iter().find(|n| n["name"] == "period").unwrap();
    assert_eq!(shown["value"].as_f64(), Some(period));
}

#[test]
fn a_free_motion_and_equilibria_are_those_of_the_front_door() {
    let text = text_of("single-dwell");
    let mechanism = dwell::Scene::parse(&text).unwrap().assemble().unwrap();
    let (answer, numbers) = run("simulate", &text);
    let motion = mechanism
        .simulate(&dwell::Solver::method(dwell::Method::Bdf, 1e-10))
        .unwrap();
    for name in ["t", "phi", "phi.velocity"] {
        assert_eq!(
            column(&answer, &numbers, name),
            motion.column(name).unwrap(),
            "{name}"
        );
    }
    let text = text_of("pendulum-a01");
    let found = dwell::Scene::parse(&text)
        .unwrap()
        .assemble()
        .unwrap()
        .equilibria()
        .unwrap();
    let (answer, _) = run("equilibria", &text);
    let shown = answer["page"]["numbers"].as_array().unwrap();
    let stable = |k: usize| {
        shown
            .iter()
            .any(|n| n["name"] == format!("equilibrium.{k}.stability"))
    };
    assert!(stable(found.len()) && !stable(found.len() + 1));
}

#[test]
fn a_misspelt_name_has_its_message_and_its_place() {
    let text = text_of("single-dwell");
    let wrong = text.replacen("{ revolute", "{ revolte", 1);
    let error = dwell_scene::PlaneScene::parse("scene.toml", &wrong).unwrap_err();
    let (answer, numbers) = run("kinetostatics", &wrong);
    let messages = answer["messages"].as_array().unwrap();
    assert_eq!(messages.len(), error.errors().len());
    assert_eq!(messages[0]["message"], error.errors()[0].message);
    let label = &messages[0]["labels"][0];
    let place = usize::try_from(label["from"].as_u64().unwrap()).unwrap();
    let units: Vec<u16> = wrong.encode_utf16().collect();
    assert_eq!(
        String::from_utf16(&units[place..place + 7]).unwrap(),
        "revolte"
    );
    assert!(answer.get("page").is_none() && numbers.is_empty());
}

#[test]
fn an_export_is_that_of_the_command_line() {
    let request = json!({ "do": "c", "text": text_of("single-dwell") });
    let answer: Value =
        serde_json::from_str(&dwell_live::answer(&request.to_string()).text).unwrap();
    let files = answer["files"].as_array().unwrap();
    assert_eq!(files.len(), 2);
    assert!(files[0][0].as_str().unwrap().ends_with(".h"));
    assert!(files[1][1].as_str().unwrap().contains("#include"));
}

#[test]
fn texts_that_are_no_scenes_are_answered() {
    for text in [
        "",
        "\u{feff}",
        "[",
        "a = [[[[[[",
        "bodies = 1",
        "\0",
        &"[".repeat(100_000),
    ] {
        let (answer, numbers) = run("simulate", text);
        assert!(
            !answer["messages"].as_array().unwrap().is_empty(),
            "{text:.20}"
        );
        assert!(numbers.is_empty());
    }
}

#[test]
fn a_mechanism_in_space_moves_back_after_its_published_period() {
    // IFToMM A04: released at rest, it is there again after 4.9917115136887 s.
    let period = 4.991_711_513_688_7;
    let text = text_of("spatial/bricard-a04.toml") + &format!("\n[motion]\nduration = {period}\n");
    let (answer, numbers) = run("simulate", &text);
    assert_eq!(answer["messages"], json!([]));
    let [q, speed] = ["q", "q.velocity"].map(|name| column(&answer, &numbers, name));
    assert_eq!(column(&answer, &numbers, "t").last(), Some(&period));
    let turns = (q.last().unwrap() - q[0]) / std::f64::consts::TAU;
    // 2e-11 turns and 3e-9 rad/s are seen.
    assert!((turns - turns.round()).abs() < 2e-9, "{turns} turns");
    assert!(speed.last().unwrap().abs() < 3e-7, "{speed:?}");
    assert!(speed.iter().any(|speed| speed.abs() > 1.0));
    assert!(answer["page"]["drawing"].is_object());
}

#[test]
fn the_equilibria_of_a_mechanism_in_space_are_where_its_potential_is_flat() {
    let text = text_of("spatial/bricard-a04.toml");
    let (answer, numbers) = run("equilibria", &text);
    assert_eq!(answer["messages"], json!([]));
    let [q, potential] = ["q", "potential"].map(|name| column(&answer, &numbers, name));
    let shown = answer["page"]["numbers"].as_array().unwrap();
    let at = |k: usize| {
        let name = format!("equilibrium.{k}.q");
        let found = shown.iter().find(|n| n["name"] == name)?;
        found["value"].as_f64()
    };
    let found: Vec<f64> = (1..).map_while(at).collect();
    assert!(!found.is_empty());
    // Between two rows around each the potential has no slope: it changes by the square of a step.
    for at in found {
        let k = q.windows(2).position(|pair| pair[0] <= at && at <= pair[1]);
        let k = k.unwrap();
        let step = q[k + 1] - q[k];
        let slope = (potential[k + 1] - potential[k]) / step;
        assert!(slope.abs() < 20.0 * step, "{at}: {slope}");
    }
    assert!(answer["page"]["drawing"].is_object());
}

#[test]
fn the_mechanism_of_a_cycle_is_drawn_at_the_coordinates_of_its_rows() {
    let (answer, numbers) = run("cycle", &text_of("four-bar"));
    assert_eq!(answer["messages"], json!([]));
    let page = &answer["page"];
    let coordinate = page["columns"][1]["key"].as_str().unwrap();
    let coordinate = column(&answer, &numbers, coordinate);
    assert!(coordinate.len() > 10);
    // The crank turns with the coordinate: the third placement of a body is its angle, in single precision.
    let bodies = page["drawing"]["bodies"].as_array().unwrap();
    let crank = bodies.iter().find(|body| body["name"] == "crank").unwrap();
    let slot = usize::try_from(crank["placements"][2].as_u64().unwrap()).unwrap();
    let angles = &numbers[slot * coordinate.len()..(slot + 1) * coordinate.len()];
    for (angle, q) in angles.iter().zip(coordinate) {
        assert!(((angle - q) / 2.0).sin().abs() < 1e-6, "{angle} at {q}");
    }
}
