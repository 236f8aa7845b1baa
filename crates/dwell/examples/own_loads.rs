//! Loads computed by one's own program: a pendulum that swings through water below the horizontal.
//!
//!     cargo run --release --example own_loads

use dwell::{Actuator, Load, Magnitude, Mechanism, Motion, Solver};

/// The torque of the water, N·m: quadratic in the speed, growing with the depth.
fn water(angle: f64, speed: f64) -> f64 {
    let depth = (-angle.sin()).max(0.0);
    -0.3 * depth * speed * speed.abs()
}

fn main() -> Result<(), dwell::Error> {
    let mut m = Mechanism::builder("Pendulum in water");
    m.ground().point("O", [0.0, 0.0]);
    m.body("bob")
        .point("O", [0.0, 0.0])
        .mass(2.0, [0.5, 0.0], 0.01);
    m.pin("O", "ground", "bob");
    m.actuator("phi", Actuator::angle("ground", "bob"));
    m.load("weight", Load::gravity([0.0, -9.81]));
    let torque = Magnitude::function(&["phi", "phi.velocity"], |s| water(s[0], s[1]));
    m.load("water", Load::torque("bob", torque));
    m.motion(Motion::seconds(4.0).initial_coordinate("phi", 0.3));
    let pendulum = m.assemble()?;

    let motion = pendulum.simulate(&Solver::accuracy(1e-8).sample_interval(0.5))?;
    let columns = ["t", "phi", "phi.velocity", "water.work", "O.magnitude"];
    println!("{}", columns.map(|name| format!("{name:>13}")).join(" "));
    let values = columns.map(|name| motion.column(name));
    let [t, phi, speed, work, force] = values;
    let (t, phi, speed, work, force) = (t?, phi?, speed?, work?, force?);
    for k in 0..t.len() {
        let row = [t[k], phi[k], speed[k], work[k], force[k]];
        println!("{}", row.map(|value| format!("{value:>13.6}")).join(" "));
    }
    Ok(())
}
