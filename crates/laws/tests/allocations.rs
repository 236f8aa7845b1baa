//! Evaluation allocates nothing, whatever the law.

use allocation_counter::measure;
use dwell_laws::{Expression, Law, Profile, Rise, Shape, Spline};

#[test]
fn evaluation_allocates_nothing() {
    let names = ["t", "phi", "phi.speed"];
    let text = "if(phi.speed > 0, clamp(100*sin(2*pi*t)^2, 1, 50), hypot(phi, 1e-3))";
    let expression = Expression::parse(text, &names).expect("an expression");
    let rise = Rise {
        start: 0.0,
        rise: 1.0,
        duration: 2.0,
        delay: 0.0,
    };
    let laws = [
        Law::Spline(Spline::through(&[[0.0, 1.0], [1.0, 0.0], [3.0, 2.0]]).expect("a spline")),
        Law::Profile(Profile::new(Shape::Polynomial345, rise).expect("a profile")),
    ];
    // The counter itself is seen to count.
    assert!(measure(|| drop(expression.clone())).count_total > 0);
    let counted = measure(|| {
        for i in 0..100 {
            let x = 0.1 * f64::from(i) - 3.0;
            std::hint::black_box(expression.eval(&[x, 1.0 - x, x * x - 1.0]));
            std::hint::black_box(expression.derivatives_wrt(&[x, 1.0 - x, x * x - 1.0], 1));
            for law in &laws {
                std::hint::black_box(law.eval(x));
            }
        }
    });
    assert_eq!(counted.count_total, 0);
}
