//! The joint reactions of a four-bar linkage over one revolution of its crank.
//!
//!     cargo run --release --example four_bar_reactions

use dwell::{Actuator, Load, Mechanism};

fn main() -> Result<(), dwell::Error> {
    let mut m = Mechanism::builder("Four-bar linkage");
    m.ground().bar("A", "D", 0.3);
    let crank = m.body("crank").bar("A", "B", 0.1);
    crank.mass(1.0, [0.05, 0.0], 8e-4); // kg, m, kg m2
    let coupler = m.body("coupler").bar("B", "C", 0.25);
    coupler.mass(1.5, [0.125, 0.0], 8e-3);
    let rocker = m.body("rocker").bar("D", "C", 0.2);
    rocker.mass(1.2, [0.1, 0.0], 4e-3);
    m.pin("A", "ground", "crank").pin("B", "crank", "coupler");
    m.pin("C", "coupler", "rocker").pin("D", "ground", "rocker");
    m.actuator("phi", Actuator::angle("ground", "crank"));
    m.assembly("phi", 0.0).assembly("rocker", 1.8); // roughly: C is above the ground
    m.load("weight", Load::gravity([0.0, -9.81]));
    let four_bar = m.assemble()?;

    println!("  phi torque [N m]  forces in A, B, C and D [N]");
    for degrees in (0..360).step_by(30) {
        let q = f64::from(degrees).to_radians();
        let at = four_bar.inverse_dynamics(0.0, &[q], &[20.0], &[0.0])?; // 20 rad/s
        let torque = at.actuator_force("phi")?;
        let [a, b, c, d] = ["A", "B", "C", "D"].map(|pin| at.reaction(&format!("{pin}.magnitude")));
        println!(
            "{degrees:>4}° {torque:>11.3} {:>7.2} {:>7.2} {:>7.2} {:>7.2}",
            a?, b?, c?, d?
        );
    }
    Ok(())
}
