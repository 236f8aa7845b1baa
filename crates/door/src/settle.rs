//! From what a file says to a mechanism that can be drawn: its pose, its drives, and one body for all that is fixed together.

use crate::error::{DoorError, Result};
use crate::finding::Effect;
use crate::mobility::freedoms;
use crate::model::{Action, Coupling, Drive, End, GROUND, Joint, Kind, Model, Move};
use crate::options::{Closing, ImportOptions};
use crate::pose::{Matrix, Pose, scaled};
use std::f64::consts::TAU;

/// Moves, closes, holds and merges as the options ask, and selects the drives.
pub(crate) fn settle(model: &mut Model, options: &ImportOptions) -> Result<()> {
    model.span();
    for closing in &options.close {
        close(model, closing)?;
    }
    if let Some(name) = &options.fix {
        let names = model.bodies.iter().map(|body| body.name.as_str());
        let body = names.clone().skip(1).position(|one| one == name);
        let body = body.ok_or_else(|| DoorError::unknown("body", name, names.skip(1)))? + 1;
        let place = model.bodies[body].place.clone();
        place.kept(format!("body {name}: held where it is drawn"));
        model.hold(body);
    }
    model.span();
    check_floating(model)?;
    for (name, value) in &options.start {
        let joint = driveable(model, name)?;
        model.moves.push((joint, Move::To(*value)));
    }
    for (joint, by) in model.moves.clone() {
        move_joint(model, joint, by);
    }
    for coupling in model.couplings.clone() {
        let [value, _] = coupling.at(model.joints[coupling.independent].drawn);
        move_joint(model, coupling.dependent, Move::To(value));
    }
    select_drives(model, options)?;
    merge_fixed(model);
    keep_armatures(model);
    count_drives(model)
}

fn driveable_names(model: &Model) -> impl Iterator<Item = &str> {
    let joints = model.joints.iter().filter(|joint| joint.is_driveable());
    joints.map(|joint| joint.name.as_str())
}

/// A joint with one coordinate by its name.
pub(crate) fn driveable(model: &Model, name: &str) -> Result<usize> {
    let what = "joint with one coordinate";
    let joint = model.driveable(name);
    joint.ok_or_else(|| DoorError::unknown(what, name, driveable_names(model)))
}

fn close(model: &mut Model, closing: &Closing) -> Result<()> {
    let [first, second] = &closing.frames;
    let ends = [frame(model, first)?, frame(model, second)?];
    let kind = match closing.kind.as_str() {
        "revolute" => Kind::Hinge,
        "spherical" => Kind::Ball,
        _ => Kind::Fixed,
    };
    let place = model.bodies[ends[0].body].place.clone();
    let joint = Joint::new(model.loop_name(None), place, kind, ends);
    model.joints.push(joint);
    Ok(())
}

/// A frame of the file by its name: that of a body, another, or that of a joint.
pub(crate) fn frame(model: &Model, name: &str) -> Result<End> {
    let bodies = model.bodies.iter().enumerate();
    let bodies = bodies.map(|(body, of)| (&of.name, End::new(body, of.pose)));
    let joints = model.joints.iter();
    let joints = joints.map(|joint| (&joint.name, joint.ends[1]));
    let others = model.frames.iter().map(|(name, end)| (name, *end));
    let mut all = bodies.chain(others).chain(joints);
    let known = all.clone().map(|(one, _)| one.as_str());
    let found = all.find(|(one, _)| *one == name);
    let end = found.map(|(_, end)| end);
    end.ok_or_else(|| DoorError::unknown("frame", name, known))
}

/// Bodies that no joint connects with anything are left out; others have to be held.
fn check_floating(model: &Model) -> Result<()> {
    let component = model.components(|_, _| true);
    let roots = (1..component.len()).filter(|body| component[*body] == *body);
    let (floating, free): (Vec<usize>, Vec<usize>) = roots.partition(|body| model.is_used(*body));
    for body in free {
        let body = &model.bodies[body];
        let text = format!("body {}, free, joined to nothing: left out", body.name);
        body.place.note(Effect::Changes, text);
    }
    if floating.is_empty() {
        return Ok(());
    }
    let name = |body: &usize| model.bodies[*body].name.as_str();
    let names: Vec<&str> = floating.iter().map(name).collect();
    let message = format!("nothing holds {}: the base floats", names.join(", "));
    let help = "--fix BODY holds a body where it is drawn";
    Err(DoorError::new(message, help))
}

/// Moves what hangs on a joint. What the tree without it connects with the ground stays.
fn move_joint(model: &mut Model, joint: usize, by: Move) {
    let of = &model.joints[joint];
    let (origin, axis) = (of.origin(), of.axis());
    let turn = |angle| Pose::turn_about(origin, Matrix::about(axis, angle));
    let slide = |travel| Pose::new(scaled(axis, travel), Matrix::IDENTITY);
    let motion = match (by, of.kind) {
        (Move::To(value), Kind::Hinge | Kind::Cylinder) => turn(value - of.drawn),
        (Move::To(value), Kind::Slide) => slide(value - of.drawn),
        (Move::To(value), Kind::Screw(pitch)) => {
            let angle = value - of.drawn;
            slide(pitch * angle / TAU).then(turn(angle))
        }
        (Move::Turn(turn), Kind::Ball) => {
            let axes = model.bodies[of.ends[1].body].pose.turn;
            Pose::turn_about(origin, turn.turned(axes))
        }
        _ => return,
    };
    let component = model.components(|k, one| one.in_tree && k != joint);
    let (side, motion) = match of.bodies().map(|body| component[body]) {
        [first, GROUND] => (first, motion.inverse()),
        [_, second] => (second, motion),
    };
    let moves = |body: usize| component[body] == side && side != GROUND;
    let bodies = model.bodies.iter_mut().enumerate();
    for (_, body) in bodies.filter(|(body, _)| moves(*body)) {
        body.move_by(motion);
    }
    let ends = model.joints.iter_mut().flat_map(|joint| &mut joint.ends);
    for end in ends.filter(|end| moves(end.body)) {
        end.frame = motion.then(end.frame);
    }
    for load in &mut model.loads {
        for (_, point) in load.at.iter_mut().filter(|(body, _)| moves(*body)) {
            *point = motion.point(*point);
            if let Action::Force { force, turns: true } = &mut load.action {
                *force = motion.turn.apply(*force);
            }
        }
    }
    if let Move::To(value) = by {
        model.joints[joint].drawn = value;
    }
}

fn select_drives(model: &mut Model, options: &ImportOptions) -> Result<()> {
    if !options.drives.is_empty() {
        let former = std::mem::take(&mut model.drives);
        for name in &options.drives {
            let joint = driveable(model, name)?;
            let drive = model.drive(joint);
            if let Some(known) = former.iter().find(|one| one.joint == joint) {
                *drive = known.clone();
            }
        }
    }
    let (joints, couplings) = (&model.joints, &model.couplings);
    let depends = |joint: usize| couplings.iter().any(|one| one.dependent == joint);
    let drives = |one: &Drive| joints[one.joint].is_driveable() && !depends(one.joint);
    model.drives.retain(drives);
    Ok(())
}

/// One body in place of bodies that are fixed to each other.
fn merge_fixed(model: &mut Model) {
    let is_merged = |joint: &Joint| joint.in_tree && joint.kind == Kind::Fixed;
    for joint in model.joints.iter().filter(|joint| is_merged(joint)) {
        let [a, b] = joint.bodies().map(|body| &model.bodies[body]);
        if joint.place.line != b.place.line {
            let text = format!("{} is fixed to {}: one body", b.name, a.name);
            joint.place.kept(text);
        }
    }
    let root = model.components(|_, joint| is_merged(joint));
    for body in (0..root.len()).filter(|body| root[*body] != *body) {
        let part = model.bodies[body].clone();
        let frame = Pose::new(part.center, Matrix::IDENTITY);
        let whole = &mut model.bodies[root[body]];
        whole.add_mass(part.mass, frame, part.inertia);
        whole.points.extend(part.points);
    }
    for end in model.joints.iter_mut().flat_map(|joint| &mut joint.ends) {
        end.body = root[end.body];
    }
    for (body, _) in model.loads.iter_mut().flat_map(|load| &mut load.at) {
        *body = root[*body];
    }
    // Drives and couplings follow the joints that are left.
    let mut numbers = Vec::new();
    let mut count = 0;
    model.joints.retain(|joint| {
        let [first, second] = joint.bodies();
        if first == second && !is_merged(joint) {
            let text = format!("joint {}, between parts of one body: left out", joint.name);
            joint.place.note(Effect::Nothing, text);
        }
        numbers.push((first != second).then_some(count));
        count += usize::from(first != second);
        first != second
    });
    let kept = |joint: &mut usize| match numbers[*joint] {
        Some(number) => {
            *joint = number;
            true
        }
        None => false,
    };
    model.drives.retain_mut(|drive| kept(&mut drive.joint));
    let both = |one: &mut Coupling| kept(&mut one.dependent) && kept(&mut one.independent);
    model.couplings.retain_mut(both);
}

/// The armature of a hinge of the ground is inertia of its body about the axis; elsewhere it has no counterpart.
fn keep_armatures(model: &mut Model) {
    for joint in &model.joints {
        let armature = joint.along.armature;
        let label = format!("joint {} armature {armature}", joint.name);
        if armature == 0.0 {
            continue;
        }
        let bodies = joint.bodies();
        if joint.kind == Kind::Hinge && bodies.contains(&GROUND) {
            let axis = joint.axis();
            let tensor = Matrix::outer(axis, axis).scaled(armature);
            let body = &mut model.bodies[bodies[0].max(bodies[1])];
            body.add_mass(0.0, Pose::IDENTITY, tensor);
            let how = "on a joint of the ground: kept (in the inertia about the axis)";
            joint.place.kept(format!("{label} {how}"));
        } else {
            let what = format!("{label}, not on the ground: no exact counterpart: left out");
            let text = format!("{what} (changes the torque by {armature} × its acceleration)");
            joint.place.note(Effect::Changes, text);
        }
    }
}

/// As many joints have to drive as there are degrees of freedom.
fn count_drives(model: &Model) -> Result<()> {
    let joints = driveable_names(model).collect::<Vec<_>>().join(", ");
    if joints.is_empty() {
        return Err(DoorError::new("the model has no joint that may drive", ""));
    }
    let counted = |count: usize, one: &str, more: &str| match count {
        0 => format!("no {more}"),
        1 => format!("1 {one}"),
        _ => format!("{count} {more}"),
    };
    let (needed, drives) = (freedoms(model), model.drives.len());
    let has = counted(needed, "degree of freedom", "degrees of freedom");
    let text = format!(
        "the model has {has} and {}",
        counted(drives, "drive", "drives")
    );
    let wanted = counted(needed, "joint", "joints");
    let help = format!("give --drive for {wanted} among {joints}");
    if drives == 0 {
        return Err(DoorError::new(text, if needed == 0 { "" } else { &help }));
    }
    if drives < needed {
        let text = format!("{text}: {help}");
        model.bodies[GROUND].place.kept(text);
    } else if drives > needed {
        model.bodies[GROUND].place.kept(text);
    }
    Ok(())
}
