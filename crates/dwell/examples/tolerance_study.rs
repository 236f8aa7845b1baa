//! What manufacturing tolerances do to a slider-crank: 2000 random variants of its dimensions.
//!
//!     cargo run --release --example tolerance_study

use dwell::{Scene, Sweep};

fn main() -> Result<(), dwell::Error> {
    let scene = Scene::read(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../docs/slider.toml"
    ))?;
    let table = Sweep::new(&scene)
        .vary("crank.points.B[0]", "~normal(80, 0.05)") // mm
        .vary("rod.points.C[0]", "~normal(280, 0.1)")
        .vary("ground.points.G[1]", "±0.5")
        .vary("piston.mass", "±3%")
        .samples(2000, 1)
        .result("phi.actuator_force.max_abs")
        .result("guide.normal.max_abs")
        .run()?;
    if let Some(message) = table.messages.iter().flatten().next() {
        println!("a variant fails: {message}");
    }
    for (name, unit) in table.columns() {
        let mut values = table.column(name)?;
        values.sort_by(f64::total_cmp);
        let quantile = |part: f64| values[(part * (values.len() - 1) as f64) as usize];
        let [low, median, high] = [0.01, 0.5, 0.99].map(quantile);
        println!("{name:>28}: 1 % {low:.4}, median {median:.4}, 99 % {high:.4} {unit}");
    }
    Ok(())
}
