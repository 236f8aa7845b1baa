//! t
use dwell_validation::extremes::{all_series, evaluate, forms};
fn main() {
    let t = std::time::Instant::now();
    let plane = evaluate(all_series(false));
    eprintln!("plane {:.1}", t.elapsed().as_secs_f64());
    let mut outcome = dwell_study::Outcome::default();
    forms::add_to(&mut outcome, &plane, "extremes");
    eprintln!("forms {:.1}", t.elapsed().as_secs_f64());
    println!("{}", outcome.summary);
    let outcome = outcome
        .draw(
            (dwell_study::Pictures::Main, Default::default()),
            &dwell_study::no_progress,
        )
        .unwrap();
    let out = std::path::Path::new("/tmp/h8-reports");
    for (path, bytes) in outcome.files.iter() {
        let p = out.join(path);
        std::fs::create_dir_all(p.parent().unwrap()).unwrap();
        std::fs::write(p, bytes).unwrap();
    }
}
