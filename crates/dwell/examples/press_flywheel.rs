//! A crank press with a motor: the flywheel that keeps the coefficient of fluctuation to 5 %.
//!
//!     cargo run --release --example press_flywheel

use dwell::{Actuator, Coordinate, Drive, Joint, Load, Mechanism, Motion, Solver};

fn main() -> Result<(), dwell::Error> {
    let mut m = Mechanism::builder("Crank press");
    m.ground().point("A", [0.0, 0.0]);
    m.body("crank").bar("A", "B", 0.06).mass(12.0, "A", 0.9);
    m.body("rod").bar("B", "C", 0.3).mass(4.0, [0.1, 0.0], 0.04);
    m.body("ram").point("C", [0.0, 0.0]).mass(15.0, "C", 0.0);
    m.pin("A", "ground", "crank")
        .pin("B", "crank", "rod")
        .pin("C", "rod", "ram");
    m.joint("guide", Joint::prismatic("ground.A", "ram.C", [0.0, -1.0]));
    m.actuator("phi", Actuator::angle("ground", "crank"));
    m.coordinate("stroke", Coordinate::travel("guide"));
    m.assembly("phi", 0.0).assembly("guide", 0.3); // the ram is below the crank
    m.load("weight", Load::gravity([0.0, -9.81]));
    // 3 kN, reached smoothly within 12 mm above the lower dead point (0.36 m), on the way down.
    let forming = "3000*max(0, (stroke - 0.348)/0.012)*max(0, tanh(stroke.velocity/0.01))";
    m.load("forming", Load::force("ram.C", [0.0, 1.0], forming));
    m.load("bearings", Load::torque("crank", "-0.4*phi.velocity"));
    let motor = Drive::motor_line("phi", 4.0, 150.0).with("gear-ratio", 12.0);
    m.drive("motor", motor);
    m.motion(Motion::seconds(5.0).initial_velocity("phi", 10.0));

    let cycle = m.assemble()?.cycle(&Solver::accuracy(1e-8), Some(0.05))?;
    println!("mean speed {:.3} rad/s", cycle.mean_speed);
    println!("coefficient of fluctuation {:.4}", cycle.fluctuation);
    for (name, work) in &cycle.works {
        println!("{name}: {work:+.3} J in a cycle");
    }
    let flywheel = cycle.flywheel.unwrap_or(0.0);
    println!("flywheel to be added for 5 %: {flywheel:.4} kg m2");
    Ok(())
}
