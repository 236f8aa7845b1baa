//! The study of Jordi, Zayas and Cardona (2008): the free motion of a single-dwell mechanism from its reduced model.
//!
//!     cargo run --release --example single_dwell_study

use dwell::{Scene, Solver};

fn main() -> Result<(), dwell::Error> {
    let scene = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../validation/single-dwell/scene.toml"
    );
    let mechanism = Scene::read(scene)?.assemble()?;

    // The reduced parameters: two kinetostatic runs give m, ½m′ and, of each reaction, a and b.
    let reduced = mechanism.reduced(["slide.normal"])?;
    for degrees in (0..360).step_by(60) {
        let at = reduced.at(f64::from(degrees).to_radians())?;
        println!(
            "{degrees:>3}°: m = {:.6} kg m2, ½m′ = {:+.6}, slide.normal: a = {:+.4} kg m, b = {:+.4} kg m",
            at.m, at.half_dm, at.a[0], at.b[0]
        );
    }

    // The period by quadrature, and from the integrated motion.
    let period = mechanism.period()?.period;
    let motion = mechanism.simulate(&Solver::accuracy(1e-10))?;
    let (t, phi) = (motion.column("t")?, motion.column("phi")?);
    let (last_t, last_phi) = (t[t.len() - 1], phi[phi.len() - 1]);
    let revolutions = last_phi / std::f64::consts::TAU;
    println!(
        "period {period:.12} s; after {last_t:.6} s the crank has made {revolutions:.9} revolutions"
    );
    let normal = motion.column("slide.normal")?;
    let largest = normal
        .iter()
        .fold(0.0_f64, |max, force| max.max(force.abs()));
    println!("largest normal force of the slide: {largest:.4} N");
    Ok(())
}
