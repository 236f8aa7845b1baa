//! From what a file says to a mechanism that can be drawn: its pose, its drives, and one body for all that is fixed together.

use crate::error::DoorError;
use crate::finding::Effect;
use crate::mobility::freedoms;
use crate::model::{Drive, End, GROUND, Joint, Kind, Load, Model};
use crate::options::{Closing, ImportOptions};
use crate::pose::{Matrix, Pose, Vector, scaled};
use crate::xml::Coverage;
use std::f64::consts::TAU;

/// A joint is moved before it is drawn: to a value of the file's coordinate, or by a turn of its second body in that body's axes.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Move {
    To(f64),
    Turn(Matrix),
}

/// What a reader returns.
pub(crate) struct Read {
    pub(crate) model: Model,
    pub(crate) moves: Vec<(usize, Move)>,
    pub(crate) coverage: Coverage,
}

/// Moves, closes, holds and merges as the options ask, and selects the drives.
pub(crate) fn settle(read: Read, options: &ImportOptions) -> Result<Model, DoorError> {
    let Read {
        mut model,
        mut moves,
        ..
    } = read;
    for closing in &options.close {
        close(&mut model, closing)?;
    }
    if let Some(name) = &options.fix {
        fix(&mut model, name)?;
    }
    check_floating(&mut model)?;
    for (name, value) in &options.start {
        moves.push((driveable(&model, name)?, Move::To(*value)));
    }
    for (joint, by) in moves {
        move_joint(&mut model, joint, by);
    }
    for coupling in model.couplings.clone() {
        let [value, _] = coupling.at(model.joints[coupling.independent].drawn);
        move_joint(&mut model, coupling.dependent, Move::To(value));
    }
    select_drives(&mut model, options)?;
    merge_fixed(&mut model);
    keep_armatures(&mut model);
    let (needed, drives) = (freedoms(&model), model.drives.len());
    if drives == 0 {
        let joints = driveable_names(&model).map(str::to_owned).collect();
        return Err(DoorError::NoDrive { needed, joints });
    }
    if drives < needed {
        let all = driveable_names(&model).collect::<Vec<_>>().join(", ");
        let freedoms = crate::error::freedoms(needed);
        let text = format!(
            "{freedoms}, of which {drives} driven: give --drive for each of {needed} joints among {all}"
        );
        let place = model.bodies[GROUND].place.clone();
        model.note(&place, Effect::Kept, text);
    }
    Ok(model)
}

fn driveable_names(model: &Model) -> impl Iterator<Item = &str> {
    let joints = model.joints.iter().filter(|joint| joint.is_driveable());
    joints.map(|joint| joint.name.as_str())
}

/// A joint with one coordinate by its name.
fn driveable(model: &Model, name: &str) -> Result<usize, DoorError> {
    let what = "joint with one coordinate";
    let joint = model.driveable(name);
    joint.ok_or_else(|| DoorError::unknown(what, name, driveable_names(model)))
}

fn close(model: &mut Model, closing: &Closing) -> Result<(), DoorError> {
    let ends = [
        frame(model, &closing.frames[0])?,
        frame(model, &closing.frames[1])?,
    ];
    let kind = match closing.kind.as_str() {
        "revolute" => Kind::Hinge,
        "spherical" => Kind::Ball,
        _ => Kind::Fixed,
    };
    let place = model.bodies[ends[0].body].place.clone();
    let name = model.loop_name(None);
    model.joints.push(Joint::new(name, place, kind, ends));
    Ok(())
}

/// A frame of the file by its name.
pub(crate) fn frame(model: &Model, name: &str) -> Result<End, DoorError> {
    let found = model.frames.iter().find(|(one, ..)| one == name);
    let end = found.map(|(_, body, frame)| End::new(*body, *frame));
    let names = model.frames.iter().map(|(one, ..)| one.as_str());
    end.ok_or_else(|| DoorError::unknown("frame", name, names))
}

/// Holds a floating body where it is.
fn fix(model: &mut Model, name: &str) -> Result<(), DoorError> {
    let names = model.bodies.iter().skip(1).map(|body| body.name.as_str());
    let Some(body) = names.clone().position(|one| one == name) else {
        return Err(DoorError::unknown("body", name, names));
    };
    let place = model.bodies[body + 1].place.clone();
    model.note(
        &place,
        Effect::Kept,
        format!("body {name}: held where it is drawn"),
    );
    model.hold(body + 1);
    Ok(())
}

/// For each body a body that all bodies joined with it by some joints share: the first.
pub(crate) fn components(model: &Model, joints: &[Joint]) -> Vec<usize> {
    let mut least: Vec<usize> = (0..model.bodies.len()).collect();
    let root = |least: &[usize], mut body: usize| {
        while least[body] != body {
            body = least[body];
        }
        body
    };
    for joint in joints {
        let [a, b] = joint.ends().map(|end| root(&least, end.body));
        least[a.max(b)] = a.min(b);
    }
    (0..model.bodies.len())
        .map(|body| root(&least, body))
        .collect()
}

/// Selects the joints of the tree: first those that fix, then those with a coordinate. The others close loops.
pub(crate) fn span(model: &mut Model) {
    let rank =
        |joint: &Joint| u8::from(joint.kind != Kind::Fixed) + u8::from(!joint.is_driveable());
    let mut order: Vec<usize> = (0..model.joints.len()).collect();
    order.sort_by_key(|joint| rank(&model.joints[*joint]));
    let mut tree: Vec<Joint> = Vec::new();
    for joint in order {
        let component = components(model, &tree);
        let of = &mut model.joints[joint];
        of.in_tree = component[of.first.body] != component[of.second.body];
        if of.in_tree {
            tree.push(of.clone());
        }
    }
}

/// Bodies that no joint connects with anything are left out; others have to be held.
fn check_floating(model: &mut Model) -> Result<(), DoorError> {
    let component = components(model, &model.joints);
    let mut floating: Vec<String> = Vec::new();
    for (body, root) in component.into_iter().enumerate().skip(1) {
        if root != body || model.left_out.contains(&body) {
            continue;
        }
        let name = model.bodies[body].name.clone();
        let loaded = model.loads.iter().any(|load| load.bodies().contains(&body));
        if loaded || model.joints.iter().any(|joint| joint.touches(body)) {
            floating.push(name);
        } else {
            let place = model.bodies[body].place.clone();
            let text = format!("body {name}, joined to nothing: left out");
            model.note(&place, Effect::Changes, text);
            model.left_out.push(body);
        }
    }
    if floating.is_empty() {
        Ok(())
    } else {
        Err(DoorError::Floating(floating))
    }
}

/// Moves what hangs on a joint.
fn move_joint(model: &mut Model, joint: usize, by: Move) {
    let of = &model.joints[joint];
    let here = model.drawn(&of.second);
    let axis = here.turn.column(2);
    let turn = |angle| Pose::turn_about(here.origin, Matrix::about(axis, angle));
    let motion = match (by, of.kind) {
        (Move::To(value), Kind::Hinge | Kind::Cylinder) => turn(value - of.drawn),
        (Move::To(value), Kind::Slide) => Pose::at(scaled(axis, value - of.drawn)),
        (Move::To(value), Kind::Screw(pitch)) => {
            let angle = value - of.drawn;
            Pose::at(scaled(axis, pitch * angle / TAU)).then(turn(angle))
        }
        (Move::Turn(turn), Kind::Ball) => {
            let body = model.bodies[of.second.body].pose.turn;
            Pose::turn_about(here.origin, turn.turned(body))
        }
        _ => return,
    };
    // What the tree without this joint connects with the ground stays.
    let others = model
        .joints
        .iter()
        .enumerate()
        .filter(|(k, one)| *k != joint && one.in_tree);
    let others: Vec<Joint> = others.map(|(_, one)| one.clone()).collect();
    let component = components(model, &others);
    let [first, second] = of.ends().map(|end| component[end.body]);
    let (side, motion) = match second {
        GROUND => (first, motion.inverse()),
        side => (side, motion),
    };
    for (body, root) in component.iter().enumerate() {
        if *root == side && side != GROUND {
            model.bodies[body].pose = motion.then(model.bodies[body].pose);
        }
    }
    if let Move::To(value) = by {
        model.joints[joint].drawn = value;
    }
}

fn select_drives(model: &mut Model, options: &ImportOptions) -> Result<(), DoorError> {
    let asked = options.drives.iter().map(|name| driveable(model, name));
    let asked = asked.collect::<Result<Vec<_>, _>>()?;
    if !asked.is_empty() {
        asked.iter().for_each(|joint| {
            model.drive(*joint);
        });
        model.drives.retain(|drive| asked.contains(&drive.joint));
        let place = |drive: &Drive| asked.iter().position(|joint| *joint == drive.joint);
        model.drives.sort_by_key(place);
    }
    let (joints, couplings) = (&model.joints, &model.couplings);
    let dependent = |joint: usize| couplings.iter().any(|one| one.dependent == joint);
    model
        .drives
        .retain(|one| joints[one.joint].is_driveable() && !dependent(one.joint));
    Ok(())
}

/// One body in place of bodies that are fixed to each other.
fn merge_fixed(model: &mut Model) {
    let is_merged = |joint: &Joint| joint.in_tree && joint.kind == Kind::Fixed;
    let fixed = model.joints.iter().filter(|joint| is_merged(joint));
    let fixed: Vec<Joint> = fixed.cloned().collect();
    let component = components(model, &fixed);
    let pose = |body: usize| model.bodies[body].pose;
    let bodies = 0..model.bodies.len();
    let place = |body: usize| pose(component[body]).inverse().then(pose(body));
    let places: Vec<Pose> = bodies.clone().map(place).collect();
    for joint in fixed
        .iter()
        .filter(|joint| joint.place != model.bodies[joint.second.body].place)
    {
        let [a, b] = joint.ends().map(|end| &model.bodies[end.body].name);
        model.note(
            &joint.place,
            Effect::Kept,
            format!("{b} is fixed to {a}: one body"),
        );
    }
    for body in bodies.filter(|body| component[*body] != *body) {
        let (part, pose) = (model.bodies[body].clone(), places[body]);
        let root = &mut model.bodies[component[body]];
        root.add_mass(
            part.mass,
            pose.point(part.center),
            part.inertia.turned(pose.turn),
        );
        let points = part
            .points
            .into_iter()
            .map(|(name, point)| (name, pose.point(point)));
        root.points.extend(points);
    }
    move_to_roots(model, &component, &places);
    // Drives and couplings follow the joints that are left.
    let joints = 0..model.joints.len();
    let kept: Vec<usize> = joints.filter(|k| !is_merged(&model.joints[*k])).collect();
    let number = |joint: usize| kept.iter().position(|k| *k == joint);
    model
        .drives
        .retain_mut(|one| number(one.joint).map(|k| one.joint = k).is_some());
    model.couplings.retain_mut(|one| {
        let both = number(one.dependent).zip(number(one.independent));
        both.map(|both| (one.dependent, one.independent) = both)
            .is_some()
    });
    model.joints.retain(|joint| !is_merged(joint));
}

/// Joints and loads of merged bodies are those of the body that is left, in its frame.
fn move_to_roots(model: &mut Model, component: &[usize], places: &[Pose]) {
    let moved = |(body, point): (usize, Vector)| (component[body], places[body].point(point));
    for joint in &mut model.joints {
        for end in [&mut joint.first, &mut joint.second] {
            *end = End::new(component[end.body], places[end.body].then(end.frame));
        }
    }
    for load in &mut model.loads {
        match load {
            Load::Spring { ends, .. } => *ends = ends.map(moved),
            Load::Force {
                at, force, turns, ..
            } => {
                let turn = if *turns {
                    places[at.0].turn
                } else {
                    Matrix::IDENTITY
                };
                (*force, *at) = (turn.apply(*force), moved(*at));
            }
        }
    }
}

/// The armature of a hinge of the ground is inertia of its body about the axis; elsewhere it has no counterpart.
fn keep_armatures(model: &mut Model) {
    for joint in model.joints.clone() {
        let armature = joint.along.armature;
        let [first, second] = joint.ends();
        let on_ground = joint.kind == Kind::Hinge && joint.touches(GROUND);
        let label = format!("joint {} armature {armature}", joint.name);
        if armature == 0.0 {
            continue;
        }
        if on_ground {
            let end = if second.body == GROUND { first } else { second };
            let axis = end.frame.turn.column(2);
            model.bodies[end.body].add_mass(0.0, axis, Matrix::outer(axis, axis).scaled(armature));
            let text =
                format!("{label} on a joint of the ground: kept (in the inertia about the axis)");
            model.note(&joint.place, Effect::Kept, text);
        } else {
            let what = format!("{label}, not on the ground: no exact counterpart: left out");
            let text = format!("{what} (changes the torque by {armature} × its acceleration)");
            model.note(&joint.place, Effect::Changes, text);
        }
    }
}
