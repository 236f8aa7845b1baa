//! Where a sprung and damped wheel suspension rests, and how it vibrates there.
//!
//!     cargo run --release --example equilibrium_and_eigenfrequencies

use dwell::{Actuator, Joint, Load, Mechanism};
use std::f64::consts::TAU;

fn main() -> Result<(), dwell::Error> {
    let mut m = Mechanism::builder("Trailing arm");
    m.ground().point("O", [0.0, 0.0]).point("S", [0.15, 0.3]);
    let arm = m.body("arm").bar("O", "W", 0.4).point("S", [0.25, 0.0]);
    arm.mass(6.0, [0.2, 0.0], 0.1);
    m.body("wheel").point("W", [0.0, 0.0]).mass(18.0, "W", 0.4);
    m.pin("O", "ground", "arm");
    m.joint("W", Joint::weld("arm.W", "wheel.W"));
    m.actuator("phi", Actuator::angle("ground", "arm"));
    m.load("weight", Load::gravity([0.0, -9.81]));
    m.load("spring", Load::spring("ground.S", "arm.S", 12e3, 0.35));
    m.load("damper", Load::damper("ground.S", "arm.S", 400.0));
    let suspension = m.assemble()?;

    for at in suspension.equilibria()? {
        let degrees = at.coordinates[0].to_degrees();
        println!("phi = {degrees:+.3}°: {:?}", at.stability);
        for mode in &at.modes {
            let (hertz, damping) = (mode.angular_frequency / TAU, mode.damping_ratio);
            println!("    {hertz:.4} Hz undamped, damping ratio {damping:.4}");
        }
    }
    let linear = suspension.linearise()?;
    println!("state matrix about the equilibrium nearest to phi = 0:");
    for (state, row) in linear.states.iter().zip(&linear.a) {
        println!("{state:>22} {row:10.3?}");
    }
    Ok(())
}
