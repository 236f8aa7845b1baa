//! `dwell export` of a scene in space: its fitted functions, and the files of a target.

use super::explain::explain_position;
use super::prepared::PreparedSpaceScene;
use crate::explain::{StudyError, actuator_labels, scene_error};
use crate::export::description::{
    describe_loads, domain, load_units, machine_of, missing_parts, parts_of, reference_sizes,
    reject_friction, reject_stops,
};
use crate::export::{ExportRequest, explain_fit, no_operations};
use crate::number_format::count;
use crate::reduce::compute::ReducedScene as _;
use dwell_export::{
    Domain, Export, FitError, Function, FunctionSampler, MachineDescription, PartKind,
};
use dwell_geometry::PositionError;
use dwell_kinetostatics::space::{LoadKind, Workspace};
use dwell_kinetostatics::{Coefficients, InverseDynamics, ReducedModel as _, Strength};
use dwell_scene::SpaceScene;

/// Refuses several actuators.
pub(super) fn several_freedoms_error(scene: &SpaceScene) -> StudyError {
    let given = count(scene.mechanism.actuators.len(), "actuator");
    let message =
        format!("the scene has {given}: in space several degrees of freedom are not exported");
    let labels = actuator_labels(scene, "drives it");
    let help = "give exactly one actuator in [actuators]; of mechanisms in the plane several degrees of freedom are exported as C";
    scene_error(scene, message, help, labels)
}

/// Fits the functions of a machine in space for export.
///
/// # Errors
/// [`StudyError::Scene`] if the scene cannot be exported; the error states the reason and a change.
pub(super) fn fit_in_space(
    scene: &SpaceScene,
    asked: &ExportRequest,
) -> Result<Export, StudyError> {
    let friction = scene.loads.iter().position(|l| l.friction().is_some());
    reject_friction(scene, friction)?;
    reject_stops(scene)?;
    let prepared = PreparedSpaceScene::new(scene)?;
    let domain = domain(
        &scene.file,
        prepared.model.range(),
        prepared.is_angle(),
        asked.interval,
    )?;
    let machine = describe(&prepared, domain);
    if asked.exact {
        let reason = "loops in space are closed by Newton's method";
        return Err(no_operations(&scene.file, reason));
    }
    let mut sampler = SpaceSampler::new(&prepared, &machine);
    Export::new(machine.clone(), asked.request, &mut sampler).map_err(|error| match error {
        FitError::Sampler(error) => explain_position(scene, prepared.model.model().plan(), &error),
        other => explain_fit(&scene.file, &machine, asked, &other),
    })
}

/// The shapes of the loads, then of the drives.
fn load_kinds(scene: &SpaceScene) -> Vec<LoadKind> {
    let drives = scene.drives.iter();
    let drives = drives.map(|drive| LoadKind::Along(drive.coordinate, Strength::Direct));
    let loads = scene.loads.iter().map(|load| load.kind);
    loads.chain(drives).collect()
}

fn describe(prepared: &PreparedSpaceScene<'_>, domain: Domain) -> MachineDescription {
    let scene = prepared.scene;
    let units = load_units(load_kinds(scene).into_iter());
    let mut left_out = Vec::new();
    let loads = describe_loads(scene, &units, &scene.loads, &mut left_out);
    let open = prepared.indeterminate.iter();
    let open = open.map(|&reaction| scene.reaction_name(reaction));
    left_out.extend(missing_parts(open, scene.motion.as_ref()));
    // A position that cannot be reached is reported when it is sampled.
    let found = prepared.coefficients(&parts_of(domain)).unwrap_or_default();
    let mass = scene.masses.iter().map(|mass| mass.mass).sum();
    let inertias = found.iter().map(|at| at.m);
    let sizes = reference_sizes(inertias, mass, prepared.size(), &units);
    MachineDescription {
        loads,
        reactions: prepared.reaction_units(),
        left_out,
        ..machine_of(scene, domain, sizes)
    }
}

/// The exact functions of a machine in space.
struct SpaceSampler<'a> {
    prepared: &'a PreparedSpaceScene<'a>,
    loads: Vec<LoadKind>,
    workspace: Workspace<f64>,
    coefficients: Coefficients,
    response: InverseDynamics<f64>,
    curves: [Vec<Function>; 3],
    columns: [Vec<Function>; 3],
}

impl<'a> SpaceSampler<'a> {
    fn new(prepared: &'a PreparedSpaceScene<'a>, machine: &MachineDescription) -> Self {
        let model = prepared.model.model();
        Self {
            workspace: model.workspace(),
            coefficients: model.coefficient_buffer(),
            response: model.result_buffer(),
            curves: PartKind::ALL.map(|kind| machine.curves(kind)),
            columns: PartKind::ALL.map(|kind| machine.columns(kind)),
            loads: load_kinds(prepared.scene),
            prepared,
        }
    }

    /// The response to one unit of a load.
    fn respond(&mut self, load: usize, q: f64) -> Result<Option<f64>, PositionError> {
        let model = self.prepared.model.model();
        let kind = &self.loads[load];
        model.unit_load_response(&[q], kind, &mut self.workspace, &mut self.response)?;
        Ok(model.potential_energy(kind, &self.workspace))
    }
}

impl FunctionSampler for SpaceSampler<'_> {
    type Error = PositionError;

    fn sample(
        &mut self,
        part: PartKind,
        q: f64,
        curves: &mut [[f64; 2]],
        columns: &mut [f64],
    ) -> Result<(), PositionError> {
        let model = self.prepared.model.model();
        model.reduce(q, &mut self.workspace, &mut self.coefficients)?;
        for (k, out) in curves.iter_mut().enumerate() {
            *out = match self.curves[part as usize][k] {
                Function::Potential(load) => {
                    let potential = self.respond(load, q)?;
                    [potential.unwrap_or(f64::NAN), 0.5 * self.response.tau[0]]
                }
                // The others are columns.
                _ => [self.coefficients.m, self.coefficients.half_dm],
            };
        }
        let mut evaluated = None;
        for (k, out) in columns.iter_mut().enumerate() {
            let function = self.columns[part as usize][k];
            if let Function::W(load) | Function::C(load, _) = function
                && evaluated != Some(load)
            {
                self.respond(load, q)?;
                evaluated = Some(load);
            }
            *out = match function {
                Function::W(_) => -self.response.tau[0],
                Function::A(k) => self.coefficients.a[k],
                Function::B(k) => self.coefficients.b[k],
                Function::C(_, k) => self.response.reactions[k],
                // They are curves, or there are none.
                Function::Inertia | Function::Potential(_) | Function::Position(..) => f64::NAN,
            };
        }
        Ok(())
    }
}
