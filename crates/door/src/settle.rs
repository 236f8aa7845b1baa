//! From what a file says to a mechanism that can be drawn: its pose, its drives, and one body for all that is fixed together.

use crate::error::DoorError;
use crate::finding::Effect;
use crate::mobility::freedoms;
use crate::model::{Drive, End, GROUND, Joint, Kind, Load, Model, Motion};
use crate::options::{Closing, ImportOptions};
use crate::pose::{Matrix, Pose, scaled};
use crate::xml::Coverage;

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
pub(crate) fn settle(
    mut model: Model,
    mut moves: Vec<(usize, Move)>,
    options: &ImportOptions,
) -> Result<Model, DoorError> {
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
    if model.drives.is_empty() {
        let joints = model.joints.iter().filter(|joint| joint.is_driveable());
        return Err(DoorError::NoDrive {
            needed: freedoms(&model),
            joints: joints.map(|joint| joint.name.clone()).collect(),
        });
    }
    Ok(model)
}

/// A joint with one coordinate by its name.
fn driveable(model: &Model, name: &str) -> Result<usize, DoorError> {
    let joint = model
        .joint_named(name)
        .filter(|joint| model.joints[*joint].is_driveable());
    joint.ok_or_else(|| {
        let known = model.joints.iter().filter(|joint| joint.is_driveable());
        DoorError::Unknown {
            what: "joint with one coordinate",
            name: name.to_owned(),
            known: known
                .map(|joint| joint.name.as_str())
                .collect::<Vec<_>>()
                .join(", "),
        }
    })
}

fn close(model: &mut Model, closing: &Closing) -> Result<(), DoorError> {
    let [first, second] = [
        frame(model, &closing.frames[0])?,
        frame(model, &closing.frames[1])?,
    ];
    let kind = match closing.kind.as_str() {
        "revolute" => Kind::Hinge,
        "spherical" => Kind::Ball,
        _ => Kind::Fixed,
    };
    let count = model.joints.iter().filter(|joint| !joint.in_tree).count();
    model.joints.push(Joint {
        name: format!("loop{}", count + 1),
        place: model.bodies[first.body].place.clone(),
        kind,
        first,
        second,
        in_tree: false,
        drawn: 0.0,
        along: crate::model::Along::default(),
    });
    Ok(())
}

/// A frame of the file by its name.
pub(crate) fn frame(model: &Model, name: &str) -> Result<End, DoorError> {
    let found = model.frames.iter().find(|(one, ..)| one == name);
    let end = found.map(|(_, body, frame)| End {
        body: *body,
        frame: *frame,
    });
    end.ok_or_else(|| DoorError::Unknown {
        what: "frame",
        name: name.to_owned(),
        known: model
            .frames
            .iter()
            .map(|(one, ..)| one.as_str())
            .collect::<Vec<_>>()
            .join(", "),
    })
}

/// Holds a floating body where it is.
fn fix(model: &mut Model, name: &str) -> Result<(), DoorError> {
    let body = model.bodies.iter().position(|body| body.name == name);
    let Some(body) = body.filter(|body| *body != GROUND) else {
        let names = model.bodies.iter().skip(1).map(|body| body.name.as_str());
        return Err(DoorError::Unknown {
            what: "body",
            name: name.to_owned(),
            known: names.collect::<Vec<_>>().join(", "),
        });
    };
    model.floating.retain(|one| *one != body);
    let second = End {
        body,
        frame: Pose::IDENTITY,
    };
    let place = model.bodies[body].place.clone();
    model.findings.add(
        &place,
        Effect::Kept,
        format!("body {name}: held where it is drawn"),
    );
    model.joints.push(Joint {
        name: format!("{name}_held"),
        place,
        kind: Kind::Fixed,
        first: model.seen_from(GROUND, &second),
        second,
        in_tree: true,
        drawn: 0.0,
        along: crate::model::Along::default(),
    });
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
        let [a, b] = [joint.first.body, joint.second.body].map(|body| root(&least, body));
        least[a.max(b)] = a.min(b);
    }
    (0..model.bodies.len())
        .map(|body| root(&least, body))
        .collect()
}

/// Selects the joints of the tree: first those that fix, then those with a coordinate. The others close loops.
pub(crate) fn span(model: &mut Model) {
    let rank = |joint: &Joint| match joint.kind {
        Kind::Fixed => 0,
        _ if joint.is_driveable() => 1,
        _ => 2,
    };
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
    for body in 1..model.bodies.len() {
        let joined = |joint: &Joint| joint.first.body == body || joint.second.body == body;
        let loaded = |load: &Load| load.bodies().contains(&body);
        if component[body] == GROUND || model.left_out.contains(&body) {
            continue;
        }
        let of = &model.bodies[body];
        if component[body] == body
            && (model.joints.iter().any(joined) || model.loads.iter().any(loaded))
        {
            floating.push(of.name.clone());
        } else if component[body] == body {
            let text = format!("body {}, joined to nothing: left out", of.name);
            model.findings.add(&of.place.clone(), Effect::Changes, text);
            model.left_out.push(body);
        }
    }
    match floating.is_empty() {
        true => Ok(()),
        false => Err(DoorError::Floating(floating)),
    }
}

/// Moves what hangs on a joint.
fn move_joint(model: &mut Model, joint: usize, by: Move) {
    let of = &model.joints[joint];
    let here = model.drawn(&of.second);
    let axis = here.turn.column(2);
    let motion = match (by, of.kind) {
        (Move::To(value), Kind::Hinge | Kind::Cylinder) => {
            Pose::turn_about(here.origin, Matrix::about(axis, value - of.drawn))
        }
        (Move::To(value), Kind::Slide) => Pose::at(scaled(axis, value - of.drawn)),
        (Move::To(value), Kind::Screw(pitch)) => {
            let angle = value - of.drawn;
            let along = scaled(axis, pitch * angle / std::f64::consts::TAU);
            Pose::at(along).then(Pose::turn_about(here.origin, Matrix::about(axis, angle)))
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
    let (side, motion) = if component[of.second.body] == GROUND {
        (component[of.first.body], motion.inverse())
    } else {
        (component[of.second.body], motion)
    };
    for (body, _) in component
        .iter()
        .enumerate()
        .filter(|(_, one)| **one == side && side != GROUND)
    {
        model.bodies[body].pose = motion.then(model.bodies[body].pose);
    }
    if let Move::To(value) = by {
        model.joints[joint].drawn = value;
    }
}

fn select_drives(model: &mut Model, options: &ImportOptions) -> Result<(), DoorError> {
    let asked = options.drives.iter().map(|name| driveable(model, name));
    let asked = asked.collect::<Result<Vec<_>, _>>()?;
    if !asked.is_empty() {
        let known = std::mem::take(&mut model.drives);
        model.drives = asked
            .into_iter()
            .map(|joint| {
                let of_file = known.iter().find(|drive| drive.joint == joint).cloned();
                of_file.unwrap_or(Drive {
                    joint,
                    motion: Motion::Unknown,
                    servo: None,
                })
            })
            .collect();
    }
    let dependent = |joint: usize| {
        model
            .couplings
            .iter()
            .any(|coupling| coupling.dependent == joint)
    };
    let joints = &model.joints;
    model
        .drives
        .retain(|drive| joints[drive.joint].is_driveable() && !dependent(drive.joint));
    Ok(())
}

/// One body in place of bodies that are fixed to each other.
fn merge_fixed(model: &mut Model) {
    let is_merged = |joint: &Joint| joint.in_tree && joint.kind == Kind::Fixed;
    let fixed: Vec<Joint> = model
        .joints
        .iter()
        .filter(|joint| is_merged(joint))
        .cloned()
        .collect();
    let component = components(model, &fixed);
    let place = |body: usize| {
        model.bodies[component[body]]
            .pose
            .inverse()
            .then(model.bodies[body].pose)
    };
    let places: Vec<Pose> = (0..model.bodies.len()).map(place).collect();
    for joint in fixed
        .iter()
        .filter(|joint| joint.place != model.bodies[joint.second.body].place)
    {
        let [a, b] = [&joint.first, &joint.second].map(|end| model.bodies[end.body].name.clone());
        model.findings.add(
            &joint.place,
            Effect::Kept,
            format!("{b} is fixed to {a}: one body"),
        );
    }
    for body in 0..model.bodies.len() {
        let (root, pose) = (component[body], places[body]);
        if root == body {
            continue;
        }
        let part = model.bodies[body].clone();
        let inertia = part.inertia.turned(pose.turn);
        model.bodies[root].add_mass(part.mass, pose.point(part.center), inertia);
        let points = part
            .points
            .into_iter()
            .map(|(name, point)| (name, pose.point(point)));
        model.bodies[root].points.extend(points);
    }
    for joint in &mut model.joints {
        for end in [&mut joint.first, &mut joint.second] {
            *end = end.moved(component[end.body], places[end.body]);
        }
    }
    for load in &mut model.loads {
        match load {
            Load::Spring { ends, .. } => {
                for (body, point) in ends {
                    (*point, *body) = (places[*body].point(*point), component[*body]);
                }
            }
            Load::Force {
                at, force, turns, ..
            } => {
                if *turns {
                    *force = places[at.0].turn.apply(*force);
                }
                *at = (component[at.0], places[at.0].point(at.1));
            }
        }
    }
    // The other joints keep their numbers for drives and couplings: they follow what is left.
    let kept: Vec<usize> = (0..model.joints.len())
        .filter(|k| !is_merged(&model.joints[*k]))
        .collect();
    let number = |joint: usize| kept.iter().position(|k| *k == joint);
    model
        .drives
        .retain_mut(|drive| number(drive.joint).map(|k| drive.joint = k).is_some());
    model.couplings.retain_mut(|one| {
        let both = number(one.dependent).zip(number(one.independent));
        both.map(|pair| (one.dependent, one.independent) = pair)
            .is_some()
    });
    model.joints = kept.iter().map(|k| model.joints[*k].clone()).collect();
}

/// The armature of a hinge of the ground is inertia of its body about the axis; elsewhere it has no counterpart.
fn keep_armatures(model: &mut Model) {
    for joint in model.joints.clone() {
        let armature = joint.along.armature;
        if armature == 0.0 {
            continue;
        }
        let label = format!("joint {} armature {armature}", joint.name);
        let end = match [joint.first.body, joint.second.body] {
            [GROUND, _] => Some(joint.second),
            [_, GROUND] => Some(joint.first),
            _ => None,
        };
        let (effect, text) = match (end, joint.kind) {
            (Some(end), Kind::Hinge) => {
                let axis = end.frame.turn.column(2);
                let rotor = Matrix::outer(axis, axis).scaled(armature);
                let body = &mut model.bodies[end.body];
                body.inertia = body.inertia.plus(rotor);
                (
                    Effect::Kept,
                    format!(
                        "{label} on a joint of the ground: kept (in the inertia about the axis)"
                    ),
                )
            }
            (Some(_), _) => (
                Effect::Changes,
                format!(
                    "{label}: no exact counterpart: left out (changes the force by {armature} × its acceleration)"
                ),
            ),
            (None, _) => (
                Effect::Changes,
                format!(
                    "{label}, not on the ground: no exact counterpart: left out (changes the torque by {armature} × its acceleration)"
                ),
            ),
        };
        model.findings.add(&joint.place, effect, text);
    }
}
