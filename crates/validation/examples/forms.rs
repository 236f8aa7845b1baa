//! t
use dwell_validation::extremes::forms::{Form, series};
use dwell_validation::extremes::{ResultCell, evaluate};
fn main() {
    let pick = std::env::args()
        .nth(1)
        .and_then(|k| k.parse::<usize>().ok());
    let key = std::env::args().nth(2);
    for (k, form) in Form::OTHERS.into_iter().enumerate() {
        if pick.is_some_and(|p| p != k) {
            continue;
        }
        println!("== {}", form.name());
        for one in series(form) {
            if key.as_ref().is_some_and(|key| *key != one.key) {
                continue;
            }
            let t = std::time::Instant::now();
            let s = evaluate(vec![one]).pop().unwrap();
            let time = t.elapsed().as_secs_f64();
            let bad: Vec<_> = s.cells.iter().filter(|c| !c.meets_requirement()).collect();
            let low: Vec<_> = s
                .cells
                .iter()
                .filter(|c| c.estimate_ratio().is_some_and(|r| r < 1.0))
                .collect();
            let ratios: Vec<f64> = s.cells.iter().filter_map(|c| c.estimate_ratio()).collect();
            let max = ratios.iter().fold(0.0_f64, |a, b| a.max(*b));
            let fewest = s
                .cells
                .iter()
                .filter_map(|c| Some(c.digits()? + c.requirement.condition_number.log10().max(0.0)))
                .fold(99.0_f64, f64::min);
            let errors = s.cells.iter().filter(|c| c.result.is_err()).count();
            println!(
                "{:24} {time:6.2} s digits+cond {fewest:5.1}  errors {errors}/{}  below floor {}  low estimates {}  max ratio {max:.1e}",
                s.series.key,
                s.cells.len(),
                bad.len(),
                low.len()
            );
            let show = |c: &ResultCell| {
                println!(
                    "      {:e} {} floor {:.1} cond {:.1e} from {:.1e}: {} {:?} est/true {:?}",
                    c.parameter,
                    s.series.quantities[c.quantity],
                    c.requirement.min_digits,
                    c.requirement.condition_number,
                    c.requirement.refusable_from,
                    c.digits().map_or("-".into(), |d| format!("{d:.1}")),
                    c.result.as_ref().map(|r| r.value),
                    c.estimate_ratio()
                )
            };
            if key.is_some() {
                s.cells.iter().for_each(show);
            } else {
                bad.iter().take(3).for_each(|c| show(c));
                low.iter().take(3).for_each(|c| show(c));
            }
        }
    }
}
