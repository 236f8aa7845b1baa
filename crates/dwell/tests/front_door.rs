//! What a program receives through the front door, against closed forms and against the same by another way.

use dwell::{
    Actuator, Coordinate, Drive, Error, Friction, Joint, Law, Load, Magnitude, Mechanism,
    MechanismBuilder, Method, Motion, Scene, Solver, Stability, Sweep,
};

const G: f64 = 9.81;

/// A bob of 2 kg at 0.5 m on a massless rod; its angle is from the horizontal.
fn pendulum(motion: Motion) -> MechanismBuilder {
    let mut m = Mechanism::builder("Pendulum");
    m.ground().point("O", [0.0, 0.0]);
    m.body("bob").bar("O", "P", 0.5).mass(2.0, "P", 0.0);
    m.pin("O", "ground", "bob");
    m.actuator("phi", Actuator::angle("ground", "bob"));
    m.load("weight", Load::gravity([0.0, -G]));
    m.motion(motion);
    m
}

#[test]
fn a_pendulum_built_has_its_closed_form() -> Result<(), Error> {
    let bob = pendulum(Motion::seconds(1.0)).assemble()?;
    let (q, speed, acceleration) = (0.3_f64, 2.0, -1.5);
    let at = bob.inverse_dynamics(0.0, &[q], &[speed], &[acceleration])?;
    // Torque m r² q̈ + m g r cos q; reaction of the ground on the bob: m a + m g.
    let torque = 2.0 * 0.25 * acceleration + 2.0 * G * 0.5 * q.cos();
    let a = [
        -0.5 * (acceleration * q.sin() + speed * speed * q.cos()),
        0.5 * (acceleration * q.cos() - speed * speed * q.sin()),
    ];
    assert!((at.actuator_force("phi")? - torque).abs() < 1e-12);
    assert!((at.reaction("O.x")? - 2.0 * a[0]).abs() < 1e-12);
    assert!((at.reaction("O.y")? - 2.0 * (a[1] + G)).abs() < 1e-12);
    let [x, y] = at.kinematics().position("bob.P")?;
    assert!((x - 0.5 * q.cos()).abs() < 1e-15 && (y - 0.5 * q.sin()).abs() < 1e-15);
    let [x, y] = at.kinematics().acceleration("bob.P")?;
    assert!((x - a[0]).abs() < 1e-14 && (y - a[1]).abs() < 1e-14);
    Ok(())
}

/// The same load as an expression and as a function: the same motion, equilibrium and linearised motion.
#[test]
fn a_function_of_ones_own_does_what_the_expression_does() -> Result<(), Error> {
    let build = |spring: Magnitude| {
        let mut m = pendulum(Motion::seconds(3.0).initial_coordinate("phi", 0.3));
        m.load("spring", Load::torque("bob", spring));
        m.assemble()
    };
    let by_expression =
        build("-6*phi - 0.8*phi.velocity*phi.velocity*phi.velocity + 0.5*sin(phi)".into())?;
    let own = |s: &[f64]| -6.0 * s[0] - 0.8 * s[1] * s[1] * s[1] + 0.5 * s[0].sin();
    let by_function = build(Magnitude::function(&["phi", "phi.velocity"], own))?;
    for solver in [Solver::accuracy(1e-9), Solver::method(Method::Bdf, 1e-10)] {
        let [one, two] = [&by_expression, &by_function].map(|m| m.simulate(&solver));
        let (one, two) = (one?.column("phi")?, two?.column("phi")?);
        let difference = one.iter().zip(&two).map(|(a, b)| (a - b).abs());
        // Two motions of the same equation at the same tolerance.
        assert!(difference.fold(0.0, f64::max) < 1e-13);
        assert!(two.iter().any(|phi| *phi < -0.3), "it moves");
    }
    let [one, two] = [&by_expression, &by_function].map(Mechanism::linearise);
    let (one, two) = (one?, two?);
    assert!((one.a[1][0] - two.a[1][0]).abs() < 1e-12 * one.a[1][0].abs());
    Ok(())
}

/// The text of a scene does not hold a function: a variant of the scene does.
#[test]
fn variants_keep_functions_and_texts_without_them_fail_loudly() -> Result<(), Error> {
    let mut m = pendulum(Motion::seconds(1.0));
    m.load(
        "push",
        Load::torque("bob", Magnitude::function(&["t"], |s| 3.0 + s[0])),
    );
    let heavier = m.scene()?.with_value("bob.mass", 4.0)?.assemble()?;
    let torque = heavier.inverse_dynamics(1.0, &[0.0], &[0.0], &[0.0])?;
    assert!((torque.actuator_force("phi")? - (4.0 * G * 0.5 - 4.0)).abs() < 1e-12);
    assert!(
        m.to_toml()
            .contains("# The magnitude of `push` is a function")
    );
    let without = Scene::parse(&m.to_toml()).and_then(|scene| scene.assemble());
    let forces = without.and_then(|m| m.inverse_dynamics(1.0, &[0.0], &[0.0], &[0.0]));
    let error = forces.err().map(|e| e.to_string()).unwrap_or_default();
    assert!(error.contains("push"), "{error}");
    Ok(())
}

#[test]
fn the_reduced_model_and_its_table_give_the_reactions() -> Result<(), Error> {
    let mut m = pendulum(Motion::seconds(1.0));
    m.load("damper", Load::rotational_damper("ground", "bob", 0.4));
    let bob = m.assemble()?;
    let reduced = bob.reduced(["O"])?;
    let (q, speed, acceleration) = (0.7, 3.0, 2.0);
    let at = reduced.at(q)?;
    // Weight and damper: their magnitudes are g and the damping torque (per unit of its resistance).
    let magnitudes = [G, -0.4 * speed];
    let reaction = |k: usize| {
        let loads = at.c.iter().zip(magnitudes).map(|(c, f)| c[k] * f);
        at.a[k] * acceleration + at.b[k] * speed * speed + loads.sum::<f64>()
    };
    let exact = bob.inverse_dynamics(0.0, &[q], &[speed], &[acceleration])?;
    assert!((reaction(0) - exact.reaction("O.x")?).abs() < 1e-12);
    assert!((reaction(1) - exact.reaction("O.y")?).abs() < 1e-12);
    let table = reduced.table(1e-10)?;
    let tabulated = table.at(q)?;
    for (a, b) in [
        (at.m, tabulated.m),
        (at.a[0], tabulated.a[0]),
        (at.w[0], tabulated.w[0]),
    ] {
        assert!((a - b).abs() < 1e-10, "{a} {b}");
    }
    assert!(matches!(table.at(f64::NAN), Err(Error::OutOfTable { .. })));
    Ok(())
}

#[test]
fn the_period_is_that_of_the_motion() -> Result<(), Error> {
    let bob = pendulum(Motion::periods(1.0).initial_coordinate("phi", -0.4)).assemble()?;
    let period = bob.period()?.period;
    let motion = bob.simulate(&Solver::accuracy(1e-10))?;
    let (t, phi) = (motion.column("t")?, motion.column("phi")?);
    assert!((t[t.len() - 1] - period).abs() < 1e-12);
    assert!((phi[phi.len() - 1] + 0.4).abs() < 1e-13);
    let stable = bob
        .equilibria()?
        .into_iter()
        .find(|e| e.stability == Stability::Centre);
    let hanging = stable.expect("it hangs").coordinates[0];
    assert!((hanging.sin() + 1.0).abs() < 1e-14);
    Ok(())
}

/// Every part of the builder is a part that the scene's reader knows, and quotes in names do no harm.
#[test]
fn every_part_is_one_that_the_reader_knows() -> Result<(), Error> {
    let mut m = Mechanism::builder("All \"parts\"\n");
    m.ground()
        .point("A", [0.0, 0.0])
        .point("G", [0.0, 0.0])
        .point("T", [0.0, -0.1]);
    m.body("crank 1").bar("A", "B", 0.1).mass(1.0, "A", 0.01);
    m.body("rod")
        .bar("B", "C", 0.3)
        .mass(0.5, [0.1, 0.0], 0.002);
    m.body("piston").point("C", [0.0, 0.0]).mass(0.4, "C", 0.0);
    m.pin("A", "ground", "crank 1")
        .pin("B", "crank 1", "rod")
        .pin("C", "rod", "piston");
    m.joint(
        "guide",
        Joint::prismatic("ground.G", "piston.C", [1.0, 0.0]),
    );
    m.actuator("phi", Actuator::angle("ground", "crank 1"));
    m.coordinate("stroke", Coordinate::travel("guide"));
    m.coordinate("gap", Coordinate::length("ground.T", "piston.C"));
    m.assembly("phi", 0.2).assembly("rod", -0.1);
    m.load(
        "gas",
        Load::force(
            "piston.C",
            [-1.0, 0.0],
            Magnitude::table("phi", &[[-9.0, 1.0], [9.0, 2.0]]),
        ),
    );
    m.load("spring", Load::spring("ground.T", "piston.C", 100.0, 0.2));
    m.load(
        "torsion",
        Load::torsion_spring("ground", "crank 1", 1.0, 0.0),
    );
    m.load(
        "cylinder",
        Load::point_to_point_force("ground.T", "piston.C", 3.0),
    );
    m.load("cutting", Load::slide_force("guide", "-2*stroke.velocity"));
    m.load("damper", Load::damper("ground.T", "piston.C", 1.0));
    m.load("between", Load::torque_between("rod", "crank 1", 0.1));
    m.friction("guide", Friction::slide(0.05).with("viscous", 0.1));
    m.friction("A", Friction::pin(0.05, 0.01));
    m.drive(
        "governor",
        Drive::speed_controller("phi", 3.0, 2.0).with("limit", 10.0),
    );
    m.drive(
        "motor",
        Drive::motor("phi", "min(12, 6*t)", 0.05, 1.2).with("gear-ratio", 20.0),
    );
    m.drive("engine", Drive::applied_force("phi", 0.1));
    m.prescribed(
        0.5,
        "phi",
        Law::trapezoidal(2.0, 0.4, 0.1).with("delay", 0.05),
    );
    m.motion(
        Motion::seconds(0.1)
            .initial_velocity("phi", 1.0)
            .event("out", dwell::Event::reaches("stroke", 0.39))
            .event("back", dwell::Event::reverses("phi"))
            .event("heavy", dwell::Event::reaction("guide.normal", 1e9).stop()),
    );
    m.request_reactions(&["guide", "A.x"]);
    let built = m.assemble()?;
    assert_eq!(built.scene().title(), "All \"parts\"");
    let along = built.kinetostatics()?;
    assert!(along.early_stop.is_none());
    let phi = along.column("phi")?;
    assert!((phi[phi.len() - 1] - 2.2).abs() < 1e-12);
    let motion = built.simulate(&Solver::method(Method::Tsit45, 1e-8))?;
    assert!(motion.early_stop.is_none(), "{:?}", motion.early_stop);
    Ok(())
}

#[test]
fn couplings_take_their_laws() -> Result<(), Error> {
    let mut m = Mechanism::builder("Cam");
    m.ground().point("O", [0.0, 0.0]);
    m.body("cam").point("O", [0.0, 0.0]).mass(1.0, "O", 0.01);
    m.body("follower")
        .point("F", [0.0, 0.0])
        .mass(0.2, "F", 0.0);
    m.pin("O", "ground", "cam");
    m.joint(
        "guide",
        Joint::prismatic("ground.O", "follower.F", [0.0, 1.0]),
    );
    m.actuator("phi", Actuator::angle("ground", "cam"));
    m.coordinate("lift", Coordinate::travel("guide"));
    m.joint(
        "profile",
        Joint::coupling("lift", "phi", Law::cycloidal(0.02, 2.0).with("start", 0.05)),
    );
    let cam = m.assemble()?;
    let [_, lift] = cam.positions(&[1.0])?.position("follower.F")?;
    assert!((lift - 0.06).abs() < 1e-15); // half the rise at half its duration
    Ok(())
}

#[test]
fn a_sweep_computes_what_each_variant_computes() -> Result<(), Error> {
    let scene = Scene::read("../../docs/slider.toml")?;
    let table = Sweep::new(&scene)
        .vary("rod.mass", "=0.8,1.2")
        .result("m")
        .run()?;
    let most = table.column("m.max")?;
    for (mass, most) in [0.8, 1.2].into_iter().zip(most) {
        let reduced = scene
            .with_value("rod.mass", mass)?
            .assemble()?
            .reduced([])?;
        let mut evaluator = reduced.evaluator();
        let mut largest = 0.0_f64;
        // A sweep looks between its 721 positions, too.
        for k in 0..=72_000 {
            largest = largest.max(
                evaluator
                    .at(std::f64::consts::TAU * f64::from(k) / 72_000.0)?
                    .m,
            );
        }
        assert!((largest - most).abs() < 1e-8 * most);
    }
    Ok(())
}

#[test]
fn mistakes_are_named() {
    let text = |error: Error| error.to_string();
    let bob = pendulum(Motion::seconds(1.0))
        .assemble()
        .expect("a pendulum");
    let unknown = bob
        .positions(&[0.0])
        .and_then(|at| at.position::<2>("bob.Q"));
    assert_eq!(
        unknown.map_err(text),
        Err("there is no point `bob.Q`: did you mean `bob.O`?".to_owned())
    );
    let count = bob.positions(&[0.0, 1.0]).map(|_| ()).map_err(text);
    assert_eq!(
        count,
        Err("2 numbers given as coordinates, where 1 are needed: one for each actuator".to_owned())
    );
    let mut twice = pendulum(Motion::seconds(1.0));
    twice.load("weight", Load::torque("bob", 1.0));
    let error = twice.assemble().map(|_| ()).map_err(text);
    assert_eq!(
        error,
        Err("`weight` is given twice among the loads".to_owned())
    );
    let signal = {
        let mut m = pendulum(Motion::seconds(1.0));
        m.load(
            "drag",
            Load::torque("bob", Magnitude::function(&["psi"], |s| s[0])),
        );
        m.assemble().map(|_| ()).map_err(text).unwrap_err()
    };
    assert!(
        signal.contains("`drag`") && signal.contains("`psi`"),
        "{signal}"
    );
    let mut m = pendulum(Motion::seconds(1.0));
    m.body("rod").point("P", [0.0, f64::NAN]);
    let error = m.assemble().map(|_| ()).map_err(text).unwrap_err();
    assert!(error.contains("rod"), "{error}");
}
