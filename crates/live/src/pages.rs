//! Pages of results that are no trajectories, and what the live page adds to one.

use dwell_findings::{Column, RecordedEvent, RecordedNumber, Table};
use dwell_page::{Page, PageColumn};
use dwell_scene::Scene;
use dwell_study::cycle::compute::{COORDINATE_COLUMN, CycleResults};
use dwell_study::equilibria::compute::EquilibriaResults;
use dwell_study::machines::MachineScene;
use dwell_study::page::{scene_page, table_page, unit_group};
use dwell_study::reduce::compute::ReducedScene as _;
use dwell_study::{PreparedScene, compute_period};

/// One steady cycle.
pub(crate) fn cycle<S: MachineScene>(scene: &S, found: &CycleResults<'_, S>) -> Page {
    let (steady, errors) = (&found.steady, &found.errors);
    let of_speed = |value: f64| Some(errors.speed * value.abs());
    let fluctuation = steady.fluctuation;
    let mut numbers = vec![
        number("period", "s", steady.period, of_speed(steady.period)),
        number(
            "mean_speed",
            "rad/s",
            steady.mean_speed,
            of_speed(steady.mean_speed),
        ),
        number(
            "coefficient_of_fluctuation",
            "",
            fluctuation,
            Some(errors.fluctuation),
        ),
    ];
    let works = found
        .works
        .columns
        .iter()
        .zip(found.works.rows.iter().flatten());
    numbers.extend(works.map(|(of, &work)| number(&of.name, &of.unit, work, Some(errors.work))));
    let page = table_page(scene_page(scene, "cycle"), &found.samples, unit_group);
    Page {
        subtitle: "one steady cycle".to_owned(),
        numbers,
        drawing: scene.drawing_along(&page.columns[COORDINATE_COLUMN].values),
        ..page
    }
}

/// The equilibria, and the static force around them.
pub(crate) fn equilibria<S: MachineScene>(scene: &S, results: &EquilibriaResults<'_, S>) -> Page {
    let rows = results.table.rows.iter().enumerate();
    let numbers = rows.flat_map(|(k, row)| {
        let values = results.table.columns.iter().zip(row);
        let known = values.filter(|(_, value)| value.is_finite());
        known.map(move |(of, &value)| {
            number(
                &format!("equilibrium.{}.{}", k + 1, of.name),
                &of.unit,
                value,
                None,
            )
        })
    });
    let subtitle = match results.found.len() {
        1 => "1 equilibrium".to_owned(),
        found => format!("{found} equilibria"),
    };
    let page = match static_forces(results) {
        None => scene_page(scene, "equilibria"),
        Some(table) => {
            let mut page = table_page(scene_page(scene, "equilibria"), &table, unit_group);
            page.drawing = scene.drawing_along(&page.columns[0].values);
            page
        }
    };
    Page {
        subtitle,
        numbers: numbers.collect(),
        ..page
    }
}

/// Static force and potential over the coordinate.
fn static_forces(results: &EquilibriaResults<'_, impl MachineScene>) -> Option<Table> {
    let curves = results.curves.as_ref()?;
    let coordinate = results.table.columns.first()?.clone();
    let force = if coordinate.unit == "rad" { "N m" } else { "N" };
    let rows = curves.q.iter().zip(&curves.force_and_potential);
    let table = Table {
        columns: vec![
            coordinate,
            Column::new("static_force", force),
            Column::new("potential", "J"),
        ],
        rows: rows
            .map(|(&q, &[force, potential])| vec![q, force, potential])
            .collect(),
    };
    Some(table)
}

/// Adds m and ½m′ at the coordinate of each row, where there is one actuator.
pub(crate) fn add_reduced_inertia(scene: &Scene, page: &mut Page) {
    let Ok(prepared) = PreparedScene::without_loads(scene) else {
        return;
    };
    let name = prepared.coordinate_name();
    let Some(coordinate) = page.columns.iter().find(|c| c.key == name) else {
        return;
    };
    let mut inertia = prepared.inertia();
    let rows = coordinate.values.iter();
    let rows = rows.map(|&q| inertia(q).unwrap_or((f64::NAN, f64::NAN)));
    let (m, half_dm) = rows.unzip();
    drop(inertia);
    let units = match prepared.is_angle() {
        true => ["kg m2", "kg m2/rad"],
        false => ["kg", "kg/m"],
    };
    for ((key, values), unit) in [("m", m), ("half_dm", half_dm)].into_iter().zip(units) {
        let (group, description) = match key {
            "m" => ("Generalised inertia", "m(q): generalised inertia"),
            _ => ("Half its slope, ½m′", "½ dm/dq"),
        };
        page.columns.push(PageColumn {
            group: group.to_owned(),
            description: description.to_owned(),
            ..PageColumn::new(key, unit, values)
        });
    }
}

/// Adds the period of the free motion, where it is conservative and repeats itself.
pub(crate) fn add_period(scene: &Scene, page: &mut Page) {
    if scene.motion.is_none() {
        return;
    }
    if let Ok(orbit) = compute_period(scene) {
        page.numbers.push(number("period", "s", orbit.period, None));
        page.numbers.push(number("energy", "J", orbit.energy, None));
    }
}

pub(crate) fn events(events: Vec<(f64, String)>) -> Vec<RecordedEvent> {
    let event = |(t, name)| RecordedEvent { name, t };
    events.into_iter().map(event).collect()
}

fn number(name: &str, unit: &str, value: f64, error: Option<f64>) -> RecordedNumber {
    RecordedNumber {
        name: name.to_owned(),
        unit: unit.to_owned(),
        value,
        error,
    }
}
