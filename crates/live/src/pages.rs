//! Pages of results that are no trajectories, and what the live page adds to one.

use dwell_findings::{Column, RecordedEvent, RecordedNumber, Table};
use dwell_page::{Drawing, Page, PageColumn};
use dwell_scene::Scene;
use dwell_study::cycle::compute::CycleResults;
use dwell_study::equilibria::compute::EquilibriaResults;
use dwell_study::page::{drawing_at, scene_page, table_page, unit_group};
use dwell_study::reduce::compute::{ReducedScene, Reduction};
use dwell_study::{PreparedScene, compute_period};

/// The reduced model over the range, with the mechanism at each position.
pub(crate) fn reduction<P: ReducedScene>(
    reduction: &Reduction<P>,
    drawing: Option<Drawing>,
) -> Page {
    let (table, prepared) = (reduction.table(), &reduction.prepared);
    let positions = table.rows.len();
    let coordinate = prepared.coordinate_name();
    Page {
        subtitle: format!("{positions} positions over the range of {coordinate}"),
        method: "evaluated exactly at each position".to_owned(),
        drawing,
        ..table_page(prepared.file(), "reduce", &table, reduced_group)
    }
}

/// What belongs in one chart.
fn reduced_group(name: &str, _: &str) -> (String, String) {
    let [group, description] = match name {
        "m" => ["Generalised inertia", "m(q)"],
        "half_dm" => ["Half its slope, ½m′", "½ dm/dq"],
        "V" => ["Potential energy", "of the loads"],
        name if name.ends_with(".a") => ["Reaction coefficients a", "per unit of acceleration"],
        name if name.ends_with(".b") => ["Reaction coefficients b", "per unit of squared speed"],
        name if name.ends_with(".w") => ["Generalised forces w", "per unit of the load"],
        _ => ["Coordinates and others", ""],
    };
    (group.to_owned(), description.to_owned())
}

/// One steady cycle.
pub(crate) fn cycle(scene: &Scene, found: &CycleResults<'_>) -> Page {
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
    Page {
        subtitle: "one steady cycle".to_owned(),
        numbers,
        ..table_page(&scene.file, "cycle", &found.samples, unit_group)
    }
}

/// The equilibria, and the static force around them.
pub(crate) fn equilibria(scene: &Scene, results: &EquilibriaResults<'_>) -> Page {
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
        None => scene_page(&scene.file, "equilibria"),
        Some((q, table)) => Page {
            drawing: (scene.mechanism.actuators.len() == 1)
                .then(|| drawing_at(scene, &over_one(q)))
                .flatten(),
            ..table_page(&scene.file, "equilibria", &table, unit_group)
        },
    };
    Page {
        subtitle,
        numbers: numbers.collect(),
        ..page
    }
}

/// Static force and potential over the coordinate, and the coordinates, rad or m.
fn static_forces<'a>(results: &'a EquilibriaResults<'_>) -> Option<(&'a [f64], Table)> {
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
    Some((&curves.q, table))
}

/// Coordinates of the only actuator, as those of all.
pub(crate) fn over_one(q: &[f64]) -> Vec<Vec<f64>> {
    q.iter().map(|&q| vec![q]).collect()
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
        let (group, description) = reduced_group(key, unit);
        page.columns.push(PageColumn {
            group,
            description,
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
