use dwell_study::extremes::{judge, measure, rows};
fn main() {
    let wanted = std::env::args().nth(1);
    let long = std::env::args().nth(2).is_some();
    let rows = rows(long)
        .into_iter()
        .filter(|r| {
            wanted
                .as_ref()
                .is_none_or(|w| r.key.contains(w.as_str()) || w == "all")
        })
        .collect();
    let t = std::time::Instant::now();
    let grid = measure(rows);
    for m in &grid {
        println!("== {} : {}", m.row.key, m.row.what);
        for c in &m.cells {
            match &c.told {
                Ok(r) => println!(
                    "  {:8.1e} {:22} digits {:6.2} floor {:5.2} {} ratio {:9.2e} {}",
                    c.at,
                    m.row.quantities[c.quantity],
                    c.digits().unwrap(),
                    c.stated.floor,
                    if c.holds() { "" } else { "BELOW" },
                    c.ratio().unwrap(),
                    if c.ratio().unwrap() < 1.0 {
                        "LOW"
                    } else if c.ratio().unwrap() > 100.0 {
                        "high"
                    } else {
                        ""
                    }
                )
                .to_owned(),
                Err(e) => println!(
                    "  {:8.1e} {:22} refused (condition {:.1e}){} {e}",
                    c.at,
                    m.row.quantities[c.quantity],
                    c.stated.condition,
                    if c.holds() { "" } else { " LAZY" }
                ),
            }
            let _ = &c;
        }
    }
    for f in judge(&grid) {
        if !f.pass {
            println!("FAIL {} {:e} {}", f.key, f.relative, f.worst);
        }
    }
    if wanted.as_deref() == Some("all") {
        let o = dwell_study::extremes::outcome(&grid).unwrap();
        o.files
            .write(std::path::Path::new("/tmp/keep/extremes-out"))
            .unwrap();
        print!("{}", o.summary);
    }
    eprintln!("{:?}", t.elapsed());
}
