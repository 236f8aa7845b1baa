//! Draws sample figures and a film into a folder and says how long each took: `gallery FOLDER`.

mod charts;
mod corners;
mod grids;
mod kinematics;
mod linkage;

use dwell_report::{Files, OutputFolder, ReportError, png};
use std::path::Path;
use std::time::Instant;

fn main() -> Result<(), ReportError> {
    let folder = std::env::args()
        .nth(1)
        .unwrap_or_else(|| "gallery".to_owned());
    let figures = [
        linkage::linkage(),
        charts::curves(),
        charts::precision(),
        charts::time(),
        charts::errors(),
        corners::corners(),
        kinematics::ratios(),
        kinematics::path(),
        kinematics::motion(),
        kinematics::cost(),
        kinematics::profile(),
        grids::mutations(),
        grids::digits(),
    ];
    let mut files = Files::new();
    for figure in &figures {
        let start = Instant::now();
        let bytes = png(figure)?;
        println!(
            "{:<24} {:6.1} ms  {:4} kB",
            figure.name,
            start.elapsed().as_secs_f64() * 1e3,
            bytes.len() / 1000
        );
        files.add(format!("{}.png", figure.name), bytes);
    }
    let animation = linkage::animation();
    let start = Instant::now();
    let bytes = animation.gif()?;
    println!(
        "{:<24} {:6.1} ms  {:4} kB",
        animation.name,
        start.elapsed().as_secs_f64() * 1e3,
        bytes.len() / 1000
    );
    files.add(format!("{}.gif", animation.name), bytes);
    let start = Instant::now();
    std::thread::scope(|scope| {
        for half in figures.chunks(figures.len().div_ceil(2)) {
            scope.spawn(|| half.iter().all(|figure| png(figure).is_ok()));
        }
    });
    println!(
        "{:<24} {:6.1} ms",
        "all again on two threads",
        start.elapsed().as_secs_f64() * 1e3
    );
    OutputFolder::open(Path::new(&folder))?
        .write(&files)
        .map(|_| ())
}
