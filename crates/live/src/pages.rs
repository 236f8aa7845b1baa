//! Pages of results that are no trajectories, and what the live page adds to one.

use dwell_findings::{Column, RecordedEvent, RecordedNumber, Table};
use dwell_page::{Page, PageColumn};
use dwell_scene::Scene;
use dwell_study::cycle::compute::CycleResults;
use dwell_study::equilibria::compute::EquilibriaResults;
use dwell_study::page::scene_page;
use dwell_study::reduce::compute::{ReducedScene as _, Reduction};
use dwell_study::{PreparedScene, compute_period};

/// A table with the column of its abscissa.
fn table_page(scene: &Scene, command: &str, table: &Table, group: impl Fn(&Column) -> &'static str) -> Page {
    let column = |(k, column): (usize, &Column)| {
        let values = table.rows.iter().map(|row| row[k]).collect();
        PageColumn {
            group: group(column).to_owned(),
            ..PageColumn::new(&column.name, &column.unit, values)
        }
    };
    Page {
        axis: Some(0),
        columns: table.columns.iter().enumerate().map(column).collect(),
        ..scene_page(scene, command)
    }
}

/// The reduced model over the range.
pub(crate) fn reduction(scene: &Scene, reduction: &Reduction<PreparedScene<'_>>) -> Page {
    let table = reduction.table();
    let positions = table.rows.len();
    let coordinate = reduction.prepared.coordinate_name();
    Page {
        subtitle: format!("{positions} positions over the range of {coordinate}"),
        method: "evaluated exactly at each position".to_owned(),
        ..table_page(scene, "reduce", &table, |column| match column.name.as_str() {
            "m" | "half_dm" => "Reduced model",
            name if name.ends_with(".a") => "Reactions per acceleration",
            name if name.ends_with(".b") => "Reactions per squared speed",
            _ => "Loads and errors",
        })
    }
}

/// One steady cycle.
pub(crate) fn cycle(scene: &Scene, found: &CycleResults<'_>) -> Page {
    let steady = &found.steady;
    let work = found.works.columns.iter().zip(found.works.rows.iter().flatten());
    let work = work.map(|(column, &work)| number(&column.name, &column.unit, work, Some(found.errors.work)));
    let mut numbers = vec![
        number("period", "s", steady.period, Some(found.errors.speed * steady.period)),
        number("mean_speed", "rad/s", steady.mean_speed, Some(found.errors.speed * steady.mean_speed.abs())),
        number("coefficient_of_fluctuation", "", steady.fluctuation, Some(found.errors.fluctuation)),
    ];
    numbers.extend(work);
    Page {
        subtitle: "one steady cycle".to_owned(),
        numbers,
        ..table_page(scene, "cycle", &found.samples, |column| match column.unit.as_str() {
            "J" => "Work since the start of the cycle",
            _ => "Motion",
        })
    }
}

/// The equilibria, and the static force around them.
pub(crate) fn equilibria(scene: &Scene, results: &EquilibriaResults<'_>) -> Page {
    let named = results.table.rows.iter().enumerate();
    let numbers = named.flat_map(|(k, row)| {
        let values = results.table.columns.iter().zip(row);
        let known = values.filter(|(_, value)| value.is_finite());
        known.map(move |(column, &value)| {
            number(&format!("equilibrium.{}.{}", k + 1, column.name), &column.unit, value, None)
        })
    });
    let found = results.found.len();
    let mut page = Page {
        subtitle: format!("{found} found"),
        numbers: numbers.collect(),
        ..scene_page(scene, "equilibria")
    };
    if let Some(curves) = &results.curves {
        let column = &results.table.columns[0];
        let force = if column.unit == "rad" { "N m" } else { "N" };
        let part = |k: usize| curves.force_and_potential.iter().map(|at| at[k]).collect();
        page.axis = Some(0);
        page.columns = vec![
            PageColumn::new(&column.name, &column.unit, curves.q.clone()),
            PageColumn::new("static_force", force, part(0)),
            PageColumn::new("potential", "J", part(1)),
        ];
    }
    page
}

/// Adds m and ½m′ at the coordinate of each row, where there is one actuator and its model is exact everywhere.
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
    let rows: Vec<(f64, f64)> = rows.map(|&q| inertia(q).unwrap_or((f64::NAN, f64::NAN))).collect();
    drop(inertia);
    let units = match prepared.is_angle() {
        true => ["kg m2", "kg m2/rad"],
        false => ["kg", "kg/m"],
    };
    let column = |key: &str, unit: &str, description: &str, values: Vec<f64>| PageColumn {
        group: "Reduced model".to_owned(),
        description: format!("{description} {name}"),
        ..PageColumn::new(key, unit, values)
    };
    let (m, half_dm) = rows.into_iter().unzip();
    let added = [
        column("m", units[0], "generalised inertia along", m),
        column("half_dm", units[1], "half the derivative of m along", half_dm),
    ];
    page.columns.extend(added);
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
