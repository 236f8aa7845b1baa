//! Groups of many bodies that require Newton's method: rings of ternary links, each held by a strut. From forty
//! unknowns on, faer factors them.

use super::closed_forms::dd;
use super::forms::Form;
use super::in_scenes::StatedTable;
use super::mechanisms::{body, mass};
use super::ratios::FIGURE;
use super::series::{ALLOWED_ROUNDINGS, ParameterSeries, Requirement, RunResult};
use crate::cases::model_states::{ModelStates, StateRequest};
use crate::checked::states::inertias;
use dwell_findings::Finding;
use dwell_kinetostatics::Mass;
use dwell_numerics::{DoubleDouble, Scalar};
use dwell_scene::PlaneScene;
use dwell_verify::check_states;

/// Positions of a revolution.
const POINTS: usize = 13;
/// Points are on a grid with this number of lines per metre.
const GRID: f64 = 8192.0;
/// Links of the ring that is checked by dense equations.
const DENSE_LINKS: usize = 20;
/// States in which it is checked.
const DENSE_STATES: usize = 8;

/// A ring of ternary links on a disk: each link is joined to both neighbours and, by a strut that is inclined to one side or the other,
/// to the disk. All bodies rotate with the disk: m and the reactions of the disk's central pin are
/// sums over the bodies, whereas every other joint force follows from the group.
struct Ring {
    text: String,
    bodies: Vec<Mass>,
}

/// Link `k` of `links` and its strut: the points and the mass of each, and the strut's foot on the disk.
fn pair(k: usize, links: usize) -> ([(String, Mass); 2], [f64; 2]) {
    let angle = |k: f64| k * std::f64::consts::TAU / links as f64;
    // Differences of points are exact: the errors are those of the group.
    let rounded = |x: f64| (GRID * x).round() / GRID;
    let polar = |r: f64, a: f64| [rounded(r * a.cos()), rounded(r * a.sin())];
    let (at, radius) = (k as f64, 0.025 * links as f64);
    let [a, b] = [at - 0.5, at + 0.5].map(|k| polar(radius, angle(k)));
    let third = polar(radius + 0.12, angle(at + 0.15));
    let side = if k.is_multiple_of(2) { 1.5 } else { -1.5 };
    let strut = polar(0.3, angle(at) + side + 0.2 * (3.0 * at + 1.0).sin());
    let foot = [0, 1].map(|i| third[i] + strut[i]);
    let (of_link, of_strut) = (0.3125 + (k % 7) as f64 / 64.0, 0.5 + (k % 6) as f64 / 32.0);
    let middle = [0, 1].map(|i| rounded(0.5 * (third[i] + foot[i])));
    let link = format!("A = {a:?}, B = {b:?}, C = {third:?}");
    let strut = format!("P = {foot:?}, C = {third:?}");
    let bodies = [
        (link, mass(of_link, polar(radius + 0.04, angle(at)), 0.002)),
        (strut, mass(of_strut, middle, 0.004)),
    ];
    (bodies, foot)
}

impl Ring {
    fn new(links: usize) -> Self {
        let mut ring = Self {
            text: String::new(),
            bodies: vec![mass(2.0, [0.0; 2], 0.5)],
        };
        let [mut disk, mut bodies, mut joints, mut assembly] = [const { String::new() }; 4];
        for k in 0..links {
            let ([(link, of_link), (strut, of_strut)], foot) = pair(k, links);
            ring.bodies.extend([of_link, of_strut]);
            bodies += &body(&format!("link{k}"), &link, &of_link);
            bodies += &body(&format!("strut{k}"), &strut, &of_strut);
            disk += &format!("P{k} = {foot:?}, ");
            let next = (k + 1) % links;
            joints += &format!(
                "R{k} = {{ revolute = [\"link{k}.B\", \"link{next}.A\"] }}\n\
                 T{k} = {{ revolute = [\"strut{k}.C\", \"link{k}.C\"] }}\n\
                 P{k} = {{ revolute = [\"disk.P{k}\", \"strut{k}.P\"] }}\n"
            );
            assembly += &format!("link{k} = 0\nstrut{k} = 0\n");
        }
        ring.text = format!(
            "[bodies]\nground = {{ points = {{ O = [0, 0] }} }}\n\
             disk = {{ points = {{ {disk}O = [0, 0] }}, mass = 2, center = \"O\", inertia = 0.5 }}\n{bodies}\
             [joints]\nO = {{ revolute = [\"ground.O\", \"disk.O\"] }}\n{joints}\
             [actuators]\nphi = {{ angle = [\"ground\", \"disk\"] }}\n[assembly]\nphi = 0\n{assembly}\
             [requests]\nreactions = [\"O\"]\n",
        );
        ring
    }

    /// m = Σ (I + M c²), and Σ M c in the frame of the disk.
    fn sums(&self) -> (DoubleDouble, [DoubleDouble; 2]) {
        let mut m = dd(0.0);
        let mut moment = [dd(0.0); 2];
        for body in &self.bodies {
            let [x, y] = [body.center.x, body.center.y].map(dd);
            let mass = dd(body.mass);
            m = m + dd(body.inertia) + mass * (x * x + y * y);
            moment = [moment[0] + mass * x, moment[1] + mass * y];
        }
        (m, moment)
    }
}

pub(super) fn series(form: Form) -> Vec<ParameterSeries> {
    let run = move |unknowns: f64| -> RunResult {
        let ring = Ring::new(unknowns as usize / 2);
        let found = StatedTable::reduced(form, &ring.text, POINTS)?;
        let (m, [x, y]) = ring.sums();
        // Ground on disk: F = Σ M c̈, which for c̈ = q̈ k × c − q̇² c is a and b.
        let turned: Vec<_> = found
            .column("phi")?
            .into_iter()
            .map(|q| {
                let (sin, cos) = dd(q).sin_cos();
                [x * cos - y * sin, x * sin + y * cos]
            })
            .collect();
        let of =
            |pick: &dyn Fn(&[DoubleDouble; 2]) -> DoubleDouble| turned.iter().map(pick).collect();
        found.compare(&[
            vec![("m", vec![m; POINTS])],
            vec![
                ("O.x.a", of(&|[_, y]| -*y)),
                ("O.y.a", of(&|[x, _]| *x)),
                ("O.x.b", of(&|[x, _]| -*x)),
                ("O.y.b", of(&|[_, y]| -*y)),
            ],
        ])
    };
    vec![ParameterSeries {
        figure: FIGURE,
        key: "large-group".into(),
        description: "A ring of ternary links with their struts, one group of Newton's method, as reduce writes it: its unknowns".into(),
        parameter: ("unknowns", ""),
        values: vec![8.0, 20.0, 40.0, 48.0],
        quantities: &["m", "a and b of the central pin"],
        reference: "the ring turns as one body: m = Σ (I + M c²), a = k × Σ M c, b = −Σ M c",
        reason: "16 roundings, magnified by four times the unknowns; the forces of the central pin are small sums of larger ones, and faer rounds otherwise on another processor",
        requirement: Box::new(|unknowns, _| {
            Requirement::from_rounding(ALLOWED_ROUNDINGS, 4.0 * unknowns)
        }),
        run: Box::new(run),
    }]
}

/// Findings on the ring by the dense equations, which share no group, dyad or factors with it.
pub(super) fn dense_findings() -> Vec<Finding> {
    let ring = Ring::new(DENSE_LINKS);
    match findings_of(&ring.text.replace("reactions = [\"O\"]", "")) {
        Ok(findings) => findings,
        Err(why) => vec![Finding {
            key: "large-group-dense".to_owned(),
            worst_at: why,
            ..Finding::default()
        }],
    }
}

fn findings_of(text: &str) -> Result<Vec<Finding>, String> {
    let scene = PlaneScene::parse("ring.toml", text).map_err(|e| e.to_string())?;
    let mut model = ModelStates::new(&scene).map_err(|e| e.to_string())?;
    let state = |k: usize| {
        let request = StateRequest {
            t: k as f64,
            q: vec![0.7 * k as f64],
            q_dot: vec![2.0],
            q_ddot: Some(vec![-3.0]),
        };
        model.state(&request).map_err(|e| e.to_string())
    };
    let states: Vec<_> = (0..DENSE_STATES).map(state).collect::<Result<_, _>>()?;
    let (mechanism, inertias) = (&scene.mechanism, inertias(&scene));
    let found = check_states(mechanism, inertias, &model.assembly_poses, &states);
    let named = found.into_iter().map(|finding| Finding {
        key: format!("large-group-{}", finding.key),
        domain: format!("a ring of {DENSE_LINKS} links, {}", finding.domain),
        ..finding
    });
    Ok(named.collect())
}
