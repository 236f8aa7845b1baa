//! From a mechanism to its plan: how each group is solved, and when each vector is rotated.

use super::frame_vectors::FrameVectorTable;
use crate::error::StructureError;
use crate::mechanism::{ActuatorKind, BodyId, Mechanism};
use crate::plan::range::Range;
use crate::plan::stored_poses::StoredPoses;
use crate::plan::{
    ActuatedFrame, AssurGroup, FactoredGroup, GroupKind, GuidedPoint, KnownTerms, LoopClosure,
    PairRole, PlacementMethod, Plan, RrrDyad, Step,
};
use crate::plane::Vec2;
use crate::structure::coupling::CouplingEquation;
use crate::structure::frames::{Frame, Frames, RotationSource};
use crate::structure::groups::{self, Group, PositionProblem, Unknown};
use crate::structure::lower::{self, Lowered};
use crate::structure::tree::{LoopJoint, Tree};
use std::collections::HashMap;

/// Two points of a body are one within this part of the mechanism's size: no rotation separates them.
const SAME_POINT: f64 = 1e-12;

impl Plan {
    /// The plan without branches, range and stored poses.
    //
    // Long: it fills the fields of a plan one after another.
    pub(super) fn structure(
        mechanism: &Mechanism,
        counted_bodies: &[BodyId],
        allow_redundant: bool,
    ) -> Result<Self, StructureError> {
        let lowered = Lowered::new(mechanism);
        let frames = Frames::find(&lowered)?;
        let tree = Tree::find(&lowered, &frames)?;
        let loops: Vec<LoopJoint> = tree
            .loop_joints
            .iter()
            .map(|&loop_joint| tree.loop_joint(&lowered, &frames, loop_joint))
            .collect();
        let couplings = CouplingEquation::all(&lowered, &frames, &tree);
        let actuated_slides = actuated_slides(&lowered, &tree);
        let problem = PositionProblem {
            lowered: &lowered,
            frames: &frames,
            tree: &tree,
            loops: &loops,
            couplings: &couplings,
            actuated_slides: &actuated_slides,
        };
        let groups = groups::order_groups(&problem, allow_redundant)?;
        let mut class_frames = vec![0; frames.orientation_classes];
        for (f, frame) in frames.frames.iter().enumerate() {
            if frame.rotation_source == RotationSource::Unknown {
                class_frames[frame.orientation_class] = f;
            }
        }
        let carrier_phases = carrier_phases(&lowered, &frames);
        let revolution_counted =
            revolution_counted(&frames, &couplings, &carrier_phases, counted_bodies);
        let all_actuated_frames = all_actuated_frames(&frames, &class_frames, &revolution_counted);
        let mut table =
            FrameVectorTable::new(&frames, &class_frames, &groups, &all_actuated_frames);
        let loop_closures: Vec<LoopClosure> = loops.iter().map(|l| table.loop_closure(l)).collect();
        let moving_bodies = tree
            .joints
            .iter()
            .map(|c| table.moving_body(&frames, &tree, c))
            .collect();
        let angular = mechanism
            .actuators
            .iter()
            .map(|a| a.kind == ActuatorKind::Angle);
        let mut plan = Self {
            actuated_frames: actuated_frames(&all_actuated_frames, |class| class == 0),
            class_frames,
            angular: angular.collect(),
            assembly_coordinates: vec![0.0; mechanism.actuators.len()],
            range: Range::Full,
            range_limits: [None; 2],
            near_branches: Vec::new(),
            assembly_pose: None,
            group_modes: Vec::new(),
            determinate: Vec::new(),
            size: mechanism.size(),
            frame_vectors: Vec::new(),
            groups: Vec::new(),
            steps: Vec::new(),
            solve_steps: Vec::new(),
            pair_roles: pair_roles(&lowered, &tree),
            lowered,
            frames,
            tree,
            moving_bodies,
            loop_closures,
            couplings,
            revolution_counted,
            revolution_offsets: Vec::new(),
            carrier_phases,
            actuated_slides,
        };
        plan.frame_vectors.clone_from(&table.vectors);
        let (mut lu, mut pivots) = (0, 0);
        for group in groups {
            let assur = plan.prepare_group(group, &all_actuated_frames, lu, pivots);
            if let GroupKind::Factored(factored_group) = &assur.kind {
                lu += factored_group.factor_len();
                pivots += factored_group.columns;
            }
            plan.groups.push(assur);
        }
        plan.steps = table.steps(&plan.groups, &plan.actuated_slides);
        let steps = plan.steps.iter().enumerate();
        plan.solve_steps = steps
            .filter(|(_, step)| matches!(step, Step::SolveGroup(_)))
            .map(|(i, _)| i)
            .collect();
        Ok(plan)
    }

    /// Chooses how a group is solved.
    fn prepare_group(
        &self,
        group: Group,
        all_actuated_frames: &[(usize, ActuatedFrame)],
        lu: usize,
        pivots: usize,
    ) -> AssurGroup {
        let in_group = |frame: usize| self.is_unknown_in(&group, frame);
        let kind = self
            .closed_form(&group)
            .unwrap_or_else(|| self.factored_group(&group, lu, pivots));
        let is_moved_before = |frame: usize| match self.frames.frames[frame].rotation_source {
            RotationSource::Ground => false,
            RotationSource::Actuated { .. } => true,
            RotationSource::Unknown => !in_group(frame),
        };
        let loops = group.loops.iter();
        let known_terms = loops.map(|&l| self.known_terms(l, is_moved_before));
        let known_terms = known_terms.collect();
        let size = self.group_size(&group);
        let class_frames = || group.classes().map(|c| self.class_frames[c]);
        let by_carrier = |frame: &usize| self.carrier_phases.contains_key(frame);
        let counts_revolutions =
            class_frames().any(|f| self.revolution_counted[f] && !by_carrier(&f));
        let counts_by_carrier = class_frames().any(|f| by_carrier(&f));
        let uses_stored_poses = match kind.placement_method() {
            Some(PlacementMethod::Newton) => true,
            Some(PlacementMethod::Linear | PlacementMethod::GearTrain) => false,
            _ => counts_revolutions,
        };
        AssurGroup {
            has_table: group
                .couplings
                .iter()
                .any(|&r| self.couplings[r].has_table()),
            actuated_frames: actuated_frames(all_actuated_frames, |c| group.contains_class(c)),
            group,
            kind,
            known_terms,
            size,
            scale: size.log2().round().exp2(),
            stored_poses: StoredPoses::default(),
            counts_revolutions: counts_revolutions || counts_by_carrier,
            uses_stored_poses,
            pruned: false,
        }
    }

    /// Whether the rotation of a frame depends on an unknown of a group.
    fn is_unknown_in(&self, group: &Group, frame: usize) -> bool {
        let class = self.frames.frames[frame].orientation_class;
        class > 0 && group.contains_class(class)
    }

    /// The terms of a loop on frames that earlier groups or actuators move.
    fn known_terms(&self, l: usize, is_moved_before: impl Fn(usize) -> bool) -> KnownTerms {
        let closure = &self.loop_closures[l];
        let vectors = closure.vectors.iter().copied();
        let axis_frame = closure.axis.map(|(_, f)| f);
        KnownTerms {
            closure: l,
            axis: closure.axis.map(|(a, _)| a),
            axis_frame: axis_frame.filter(|&f| is_moved_before(f)),
            vectors: vectors.filter(|&(_, f)| is_moved_before(f)).collect(),
            slides: closure.slides.clone(),
        }
    }

    /// Sum of the lengths in a group's loops, m; that of the mechanism where there are none.
    fn group_size(&self, group: &Group) -> f64 {
        let closures = || group.loops.iter().map(|&l| &self.loop_closures[l]);
        let vectors = closures().flat_map(|c| &c.vectors);
        let size: f64 = vectors
            .map(|&(a, _)| self.frame_vectors[a].local.norm())
            .chain(closures().map(|c| c.fixed.norm()))
            .sum();
        if size > 0.0 { size } else { self.size }
    }

    /// The two closed forms whose motion and forces are closed forms too.
    fn closed_form(&self, group: &Group) -> Option<GroupKind> {
        let (&[first], true) = (group.loops.as_slice(), group.couplings.is_empty()) else {
            return None;
        };
        if !group.is_rotational() || group.rows != group.unknowns.len() {
            return None;
        }
        let in_group = |frame: usize| self.is_unknown_in(group, frame);
        let closure = &self.loop_closures[first];
        let is_class_frame =
            |frame: usize| self.frames.frames[frame].rotation_source == RotationSource::Unknown;
        let (rotating, known): (Vec<_>, Vec<_>) =
            closure.vectors.iter().partition(|&&(_, f)| in_group(f));
        if !rotating.iter().all(|&(_, f)| is_class_frame(f)) || !closure.slides.is_empty() {
            return None;
        }
        match (closure.axis, rotating.as_slice()) {
            (None, &[one, two]) => {
                let dyad = self.prepare_rrr_dyad(first, [one, two], known);
                Some(GroupKind::RrrDyad(dyad))
            }
            (Some(axis), vectors) if group.unknowns.len() == 1 && vectors.len() <= 1 => {
                let (turns, vector) = (in_group(axis.1), vectors.first());
                let guided = self.prepare_guided_point(first, axis, turns, vector, known);
                guided.map(GroupKind::GuidedPoint)
            }
            _ => None,
        }
    }

    fn factored_group(&self, group: &Group, lu: usize, pivots: usize) -> GroupKind {
        let columns = group.unknowns.len();
        GroupKind::Factored(FactoredGroup {
            method: match self.placement_method(group) {
                // Redundant equations that are linear agree everywhere if they do at assembly.
                method @ (PlacementMethod::Linear | PlacementMethod::GearTrain) => method,
                method if group.rows == columns => method,
                _ => PlacementMethod::Newton,
            },
            rows: group.rows,
            columns,
            lu_offset: lu,
            pivots_offset: pivots,
            branch: 1.0,
            root_sign: 1.0,
        })
    }

    /// How the positions of a group that is not a closed form throughout are found.
    fn placement_method(&self, group: &Group) -> PlacementMethod {
        let class = |c: usize| group.contains_class(c);
        let slide = |s: usize| group.unknowns.contains(&Unknown::SlideTravel(s));
        let linear = |&r: &usize| self.couplings[r].linear_in(&self.frames, class, slide);
        let has_angle = group.classes().next().is_some();
        if (!has_angle || group.loops.is_empty()) && group.couplings.iter().all(linear) {
            return PlacementMethod::Linear;
        }
        // Loops that only follow lines of centres: the angles of the carriers give their directions.
        let follows_carrier = |&l: &usize| {
            let axis = self.loop_closures[l].axis;
            let by_carrier = |(_, frame)| self.carrier_phases.contains_key(&frame);
            axis.map_or_else(|| self.closes_in_any_pose(l, group), by_carrier)
        };
        if group.is_rotational()
            && group.loops.iter().all(follows_carrier)
            && group.couplings.iter().all(linear)
        {
            return PlacementMethod::GearTrain;
        }
        let &[l] = group.loops.as_slice() else {
            return PlacementMethod::Newton;
        };
        let closure = &self.loop_closures[l];
        let once = |s: usize| closure.slides.iter().filter(|x| x.0 == s).count() == 1;
        match (group.unknowns.as_slice(), closure.axis) {
            _ if !group.couplings.is_empty() => PlacementMethod::Newton,
            (&[Unknown::ClassAngle(one), Unknown::ClassAngle(two)], None) => {
                PlacementMethod::Triangle(one, two)
            }
            (&[Unknown::ClassAngle(c), Unknown::SlideTravel(s)], None) if once(s) => {
                PlacementMethod::LineCircle(c, s)
            }
            (&[Unknown::ClassAngle(c)], Some(_)) => PlacementMethod::PointOnLine(c),
            _ => PlacementMethod::Newton,
        }
    }

    /// Whether no unknown of a group can open a loop, as in the loop of a pin that is written twice.
    fn closes_in_any_pose(&self, l: usize, group: &Group) -> bool {
        let closure = &self.loop_closures[l];
        let is_constant = |&(vector, frame): &(usize, usize)| {
            let length = self.frame_vectors[vector].local.norm();
            length <= SAME_POINT * self.size || !self.is_unknown_in(group, frame)
        };
        closure.slides.is_empty() && closure.vectors.iter().all(is_constant)
    }

    fn prepare_rrr_dyad(
        &self,
        closure: usize,
        rotating: [(usize, usize); 2],
        known: Vec<(usize, usize)>,
    ) -> RrrDyad {
        let mut dyad = RrrDyad {
            closure,
            vectors: rotating.map(|(a, _)| a),
            frames: rotating.map(|(_, f)| f),
            known,
            branch: 1.0,
            ..RrrDyad::default()
        };
        let local = dyad.vectors.map(|a| self.frame_vectors[a].local);
        dyad.set_lengths(local, self.loop_closures[closure].fixed);
        dyad
    }

    fn prepare_guided_point(
        &self,
        closure: usize,
        axis: (usize, usize),
        line_rotates: bool,
        vector: Option<&(usize, usize)>,
        known: Vec<(usize, usize)>,
    ) -> Option<GuidedPoint> {
        let local = vector.map_or(Vec2::ZERO, |&(a, _)| self.frame_vectors[a].local);
        let is_class_frame = self.frames.frames[axis.1].rotation_source == RotationSource::Unknown;
        let (found_vector, frame) = match (line_rotates, vector) {
            (true, _) if is_class_frame => axis,
            (false, Some(&rotated)) => rotated,
            _ => return None,
        };
        let mut guided = GuidedPoint {
            closure,
            frame,
            axis,
            line_rotates,
            found_vector,
            vectors: self.loop_closures[closure].vectors.clone(),
            known,
            branch: 1.0,
            ..GuidedPoint::default()
        };
        let line = self.frame_vectors[axis.0].local;
        guided.set_lengths(line, local, self.loop_closures[closure].fixed);
        Some(guided)
    }
}

/// The role of each pair in the plan.
fn pair_roles(lowered: &Lowered, tree: &Tree) -> Vec<PairRole> {
    let mut roles = vec![PairRole::LoopJoint(0); lowered.pairs.len()];
    for (c, &loop_joint) in tree.loop_joints.iter().enumerate() {
        roles[loop_joint] = PairRole::LoopJoint(c);
    }
    for (i, tree_joint) in tree.joints.iter().enumerate() {
        roles[tree_joint.pair] = PairRole::TreeJoint(i);
    }
    roles
}

/// By slide: the actuator that drives it.
fn actuated_slides(lowered: &Lowered, tree: &Tree) -> Vec<Option<usize>> {
    let mut actuated = vec![None; tree.slide_pairs.len()];
    for (i, coordinate) in lowered.actuated_coordinates.iter().enumerate() {
        if let lower::ActuatedCoordinate::Travel(pair) = *coordinate
            && let Some(slide) = tree.slide_of_pair(pair)
        {
            actuated[slide] = Some(i);
        }
    }
    actuated
}

/// By frame: whether it belongs to a class that a coupling names, or to that of a body whose revolutions are counted.
/// Angles of the ground's class are known from the actuators already.
fn revolution_counted(
    frames: &Frames,
    couplings: &[CouplingEquation],
    carrier_phases: &HashMap<usize, (usize, f64)>,
    counted_bodies: &[BodyId],
) -> Vec<bool> {
    let mut classes = vec![false; frames.orientation_classes];
    for body in counted_bodies {
        let class = frames.frames[frames.orientations[body.0].frame].orientation_class;
        classes[class] |= class != 0;
    }
    let named = couplings.iter().flat_map(CouplingEquation::frames);
    for frame in named.chain(carrier_phases.values().map(|(carrier, _)| *carrier)) {
        classes[frames.frames[frame].orientation_class] = true;
    }
    let is_counted = |f: &Frame| classes[f.orientation_class];
    frames.frames.iter().map(is_counted).collect()
}

/// The lines of centres that turn with a carrier, with the carrier's frame.
fn carrier_phases(lowered: &Lowered, frames: &Frames) -> HashMap<usize, (usize, f64)> {
    let of = |body: usize| frames.orientations[body];
    let lines = lowered
        .couplings
        .iter()
        .filter_map(|lowered_coupling| lowered_coupling.line_of_centres);
    let phases = lines.map(|(line, carrier, phase)| {
        let phase = phase + of(carrier).offset_angle - of(line).offset_angle;
        (of(line).frame, (of(carrier).frame, phase))
    });
    phases
        .filter(|(line, _)| frames.frames[*line].rotation_source == RotationSource::Unknown)
        .collect()
}

/// Every actuated frame with its class, each after the one it is turned from.
fn all_actuated_frames(
    frames: &Frames,
    class_frames: &[usize],
    revolution_counted: &[bool],
) -> Vec<(usize, ActuatedFrame)> {
    let all = frames.frames.iter().enumerate();
    let actuated = |(frame, described): (usize, &Frame)| {
        let class = described.orientation_class;
        let RotationSource::Actuated {
            parent,
            actuator,
            sign,
        } = described.rotation_source
        else {
            return None;
        };
        let class_frame = class_frames[class];
        let revolution_counted = revolution_counted[frame];
        let one = ActuatedFrame {
            frame,
            parent,
            actuator,
            sign,
            class_frame,
            revolution_counted,
        };
        Some((class, one))
    };
    all.filter_map(actuated).collect()
}

/// The actuated frames of some classes.
pub(super) fn actuated_frames(
    all: &[(usize, ActuatedFrame)],
    of: impl Fn(usize) -> bool,
) -> Vec<ActuatedFrame> {
    let picked = all.iter().filter(|(class, _)| of(*class));
    picked.map(|(_, actuated)| *actuated).collect()
}
