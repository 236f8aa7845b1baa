//! A row of a motion: all forces by the second reading, with the reactions as written, and what they must balance.

use super::drives::{Drive, drives};
use crate::written::poses::difference::Differences;
use crate::written::poses::equilibrium::{
    add_residuals, body_residuals, reaction, written_joint_wrenches,
};
use crate::written::poses::motion::Motion;
use crate::written::poses::reading::{Coordinate, Reading};
use crate::written::poses::rows::{self, Rows};
use crate::written::poses::scene_text::table_of;
use crate::written::poses::wrenches::{Wrench, along};

/// The scene of a motion, read once more.
#[derive(Debug)]
pub(crate) struct MotionReading {
    pub(crate) reading: Reading,
    pub(crate) drives: Vec<Drive>,
}

/// What the rows of a file give.
#[derive(Debug, Default)]
pub(crate) struct ComparedRows {
    /// Newton's and Euler's equations of every body.
    pub(crate) equations: Differences,
    /// Written forces and powers of drives and friction with those of the second reading.
    pub(super) forces: Differences,
    /// By row: kinetic energy with rotors, J, and the power of all forces but the joints', W.
    pub(super) energies: Vec<[f64; 2]>,
    /// By row: the power of the loads without a column of work, W.
    pub(super) conservative_power: Vec<f64>,
    /// By drive and row: the power before that which accelerates its rotor, W.
    pub(super) drive_power: Vec<Vec<f64>>,
    /// By drive and row: the current's rate, A/s.
    pub(super) current_rates: Vec<Vec<f64>>,
}

impl MotionReading {
    /// Reads a scene; why it cannot, in words.
    pub(crate) fn new(text: &str) -> Result<Self, String> {
        let scene = table_of(text)?;
        let reading = Reading::new(text)?;
        let drives = drives(&scene, &reading)?;
        Ok(Self { reading, drives })
    }

    /// Compares every row; none of a file without the columns of the bodies.
    pub(crate) fn compare(&self, rows: &Rows, file: &str) -> Option<ComparedRows> {
        let mut found = ComparedRows {
            drive_power: vec![Vec::new(); self.drives.len()],
            current_rates: vec![Vec::new(); self.drives.len()],
            ..ComparedRows::default()
        };
        let mut residuals = Vec::new();
        let mut compared = Vec::new();
        for row in 0..rows.count {
            let motion = Motion::new(&self.reading, rows, row)?;
            let mut wrenches = self.loads(&motion, &mut found)?;
            let mut power: f64 = wrenches.iter().map(|w| w.power(&motion)).sum();
            for (k, drive) in self.drives.iter().enumerate() {
                let force = drive.force(&motion)?;
                let coordinate = motion.measure(drive.measure);
                power += force * coordinate.0[1];
                found.drive_power[k].push(force * coordinate.0[1]);
                let net = force - drive.rotor_inertia * coordinate.0[2];
                wrenches.extend(along(&motion, drive.measure, net));
                compared.push((row, &drive.name, drive.written_force(&motion), net));
                found.current_rates[k].extend(drive.current_rate(&motion));
            }
            for friction in &self.reading.frictions {
                let joint = &self.reading.joints[friction.joint];
                let reaction = reaction(&motion, joint, "").unwrap_or_default();
                let of = friction.wrenches(&motion, &reaction)?;
                let lost: f64 = of.iter().map(|w| w.power(&motion)).sum();
                let column = |kind: &str| motion.get(&format!("{}.{kind}.power", joint.name));
                let written = [column("friction"), column("viscous")];
                let sum = written.iter().flatten().sum::<f64>();
                let is_there = written.iter().any(Option::is_some);
                compared.push((row, &joint.name, is_there.then_some(sum), lost));
                power += lost;
                wrenches.extend(of);
            }
            // A free one has none.
            let force = |c: &Coordinate| motion.get(&format!("{}.actuator_force", c.name));
            let actuators = self.reading.actuators().iter();
            let actuators: Vec<f64> = actuators.map(|c| force(c).unwrap_or(0.0)).collect();
            for (coordinate, force) in self.reading.coordinates.iter().zip(&actuators) {
                power += force * motion.measure(coordinate.measure).0[1];
            }
            found.energies.push([self.kinetic(&motion), power]);
            // Statically indeterminate reactions are in no file.
            if let Some(joints) = written_joint_wrenches(&motion, "", &actuators) {
                wrenches.extend(joints);
                residuals.push((row, body_residuals(&motion, &wrenches, Some(2))));
            }
        }
        add_residuals(&mut found.equations, &self.reading, &residuals, file);
        add_compared(&mut found.forces, &compared, file);
        Some(found)
    }

    /// The forces of all loads.
    fn loads(&self, motion: &Motion<'_>, found: &mut ComparedRows) -> Option<Vec<Wrench>> {
        let mut all = Vec::new();
        let mut conservative = 0.0;
        for load in &self.reading.loads {
            let of = load.wrenches(motion)?;
            if !motion
                .rows
                .columns
                .contains_key(&format!("{}.work", load.name))
            {
                conservative += of.iter().map(|w| w.power(motion)).sum::<f64>();
            }
            all.extend(of);
        }
        found.conservative_power.push(conservative);
        Some(all)
    }

    /// The kinetic energy of bodies and rotors, J.
    fn kinetic(&self, motion: &Motion<'_>) -> f64 {
        let bodies = self.reading.bodies.iter().enumerate().map(|(b, body)| {
            let [vx, vy] = motion.center(b).order(1);
            let [angle, omega, _] = motion.bodies[b].angle.0;
            let inertia = body.inertia_at(angle)[0];
            0.5 * (body.mass * (vx * vx + vy * vy) + inertia * omega * omega)
        });
        let rotors = self.drives.iter().map(|drive| {
            let speed = motion.measure(drive.measure).0[1];
            0.5 * drive.rotor_inertia * speed * speed
        });
        bodies.sum::<f64>() + rotors.sum::<f64>()
    }
}

/// Written values of several rows with their references, each relative to the largest of its name.
fn add_compared(to: &mut Differences, compared: &[(usize, &String, Option<f64>, f64)], file: &str) {
    let largest = |name: &str| {
        let same = compared.iter().filter(|(_, of, ..)| *of == name);
        rows::largest(same.map(|(.., value)| value))
    };
    let mut scales: Vec<(&str, f64)> = Vec::new();
    for (row, name, written, expected) in compared {
        let Some(written) = written else {
            to.fail(format!("{file}: `{name}` has no column"));
            return;
        };
        let known = scales.iter().find(|(of, _)| of == name).map(|(_, s)| *s);
        let scale = known.unwrap_or_else(|| {
            scales.push((name, largest(name)));
            largest(name)
        });
        to.add(written - expected, scale, "", || {
            format!("{file}, row {row}, {name}")
        });
    }
}
