//! Pages of cycles and equilibria, and additions of the live page to other pages.

use dwell_findings::{Column, Record, Table};
use dwell_page::{Page, PageColumn};
use dwell_study::cycle::compute::{COORDINATE_COLUMN, CycleResults};
use dwell_study::equilibria::compute::EquilibriaResults;
use dwell_study::machines::MachineScene;
use dwell_study::page::{scene_page, table_page, unit_group};
use dwell_study::reduce::compute::ReducedScene as _;
use dwell_study::{StudyScene, compute_period};

/// One steady cycle.
pub(crate) fn cycle<S: MachineScene>(scene: &S, found: &CycleResults<'_, S>) -> Page {
    let (steady, errors) = (&found.steady, &found.errors);
    let mut record = Record::default();
    for (name, unit, value) in [
        ("period", "s", steady.period),
        ("mean_speed", "rad/s", steady.mean_speed),
    ] {
        record.add_within(name, unit, value, errors.speed * value.abs());
    }
    let (name, fluctuation) = ("coefficient_of_fluctuation", steady.fluctuation);
    record.add_within(name, "", fluctuation, errors.fluctuation);
    let works = found.works.rows.iter().flatten();
    for (of, &work) in found.works.columns.iter().zip(works) {
        record.add_within(&of.name, &of.unit, work, errors.work);
    }
    let page = table_page(scene_page(scene, "cycle"), &found.samples, unit_group);
    Page {
        subtitle: "one steady cycle".to_owned(),
        numbers: record.numbers,
        drawing: scene.drawing_along(&page.columns[COORDINATE_COLUMN].values),
        ..page
    }
}

/// The equilibria, and the static force around them.
pub(crate) fn equilibria<S: MachineScene>(scene: &S, results: &EquilibriaResults<'_, S>) -> Page {
    let mut record = Record::default();
    for (k, row) in results.table.rows.iter().enumerate() {
        let values = results.table.columns.iter().zip(row);
        for (of, &value) in values.filter(|(_, value)| value.is_finite()) {
            let name = format!("equilibrium.{}.{}", k + 1, of.name);
            record.add(name, &of.unit, value);
        }
    }
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
        numbers: record.numbers,
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

/// Adds m and ½m′ at the coordinate of each row, if there is one actuator.
pub(crate) fn add_reduced_inertia<S: StudyScene>(scene: &S, page: &mut Page) {
    let Ok(prepared) = scene.prepared_without_loads() else {
        return;
    };
    let name = prepared.coordinate_name();
    let Some(coordinate) = page.columns.iter().find(|c| c.key == name) else {
        return;
    };
    let mut inertia = prepared.inertia();
    let rows = coordinate
        .values
        .iter()
        .map(|&q| inertia(q).unwrap_or((f64::NAN, f64::NAN)));
    let (m, half_dm) = rows.unzip();
    drop(inertia);
    let units = if prepared.is_angle() {
        ["kg m2", "kg m2/rad"]
    } else {
        ["kg", "kg/m"]
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

/// Adds the period of the free motion, if it is conservative and periodic.
pub(crate) fn add_period<S: StudyScene>(scene: &S, page: &mut Page) {
    if !scene.has_motion() {
        return;
    }
    if let Ok(orbit) = compute_period(scene) {
        let mut record = Record::default();
        record.add("period", "s", orbit.period);
        record.add("energy", "J", orbit.energy);
        page.numbers.extend(record.numbers);
    }
}
