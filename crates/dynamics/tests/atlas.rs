//! Dead points: whatever coordinate a motion begins in, it is the one that the crank makes.
#![allow(clippy::expect_used, reason = "tests")]

mod parts;

use dwell_dynamics::{ChartChangeReason, Event, EventKind, Method, Options, solve};
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{Actuator, BodyId, Joint, Mechanism, Vec2, vec2};
use dwell_kinetostatics::{Load, Mass};
use parts::{
    Setup, angle, energy_lost, four_bar, gravity, length, mechanism, motor, samples, slider_crank,
    solve_setup, torsion_spring,
};

const CRANK: CoordinateFunction = CoordinateFunction::Angle([BodyId(0), BodyId(1)]);

/// A motion in the crank's angle and the same one begun in another coordinate.
struct Pair {
    crank: Setup,
    other: Setup,
    /// Speed of the crank, rad/s.
    speed: f64,
    end: f64,
}

impl Pair {
    /// The other coordinate's setup starts from the pose of the crank's.
    fn new(crank: Setup, other: Actuator, speed: f64, end: f64) -> Self {
        let atlas = crank.atlas();
        let machine = &atlas.charts()[0].machine;
        let mut workspace = machine.workspace();
        let initial_state = crank.initial_state(&atlas, speed);
        let mut state = machine
            .evaluate(0.0, &initial_state.y, &mut workspace)
            .expect("a state");
        let states = state.bodies();
        let coordinate = other.coordinate();
        let measured =
            CoordinateFunction::find(&crank.mechanism, coordinate).expect("a coordinate");
        let [q, ..] = states.coordinate(measured);
        let bodies = crank.mechanism.bodies.len();
        let initial_guess: Vec<f64> = (0..bodies)
            .map(|b| states.body(BodyId(b)).rotation.angle())
            .collect();
        let other = Setup::new(&crank.mechanism, other, &crank.masses, q, &initial_guess)
            .with_loads(&crank.loads, &crank.drives);
        Self {
            crank,
            other,
            speed,
            end,
        }
    }

    /// Both motions agree, with their events; the number of the crank's turns.
    fn check_agreement(&self, folds: usize) -> usize {
        let sample_interval = self.end / 500.0;
        let times = [self.end, sample_interval];
        let revolution = Event {
            kind: EventKind::Revolution(CRANK),
            terminal: None,
        };
        let mut one = self.crank.atlas();
        let initial_state = self.crank.initial_state(&one, self.speed);
        let direct = solve_setup(
            &mut one,
            &initial_state,
            times,
            Method::Tsit45,
            &[revolution],
        );
        // The speed of the other coordinate, as the crank's motion has it.
        let actuator_coordinate = {
            let atlas = self.other.atlas();
            atlas.actuator_coordinate()
        };
        let [_, q_dot, _] = one
            .coordinate_history(&direct, actuator_coordinate)
            .expect("a track")
            .steps[0][0];
        let mut two = self.other.atlas();
        let initial_state = self.other.initial_state(&two, q_dot);
        let reversal = Event {
            kind: EventKind::Reversal(actuator_coordinate),
            terminal: None,
        };
        let motion = solve_setup(
            &mut two,
            &initial_state,
            times,
            Method::Tsit45,
            &[revolution, reversal],
        );
        let folded = |w: &ChartChangeReason| matches!(w, ChartChangeReason::CoordinateFold { .. });
        let changes = motion.changes.iter().filter(|c| folded(&c.reason));
        assert_eq!(changes.count(), folds);
        self.same_crank(
            &one.coordinate_history(&direct, CRANK),
            &two.coordinate_history(&motion, CRANK),
        );
        // No seam in the other coordinate: a trapezium with its end correction errs as every⁵.
        let seams = two
            .coordinate_history(&motion, actuator_coordinate)
            .expect("a track")
            .samples
            .concat();
        for w in seams.windows(2) {
            let [a, b] = [w[0], w[1]];
            let by_speed = 0.5 * (a[1] + b[1]) - (b[2] - a[2]) * sample_interval / 12.0;
            assert!(
                (b[0] - a[0] - by_speed * sample_interval).abs() < 1e-5,
                "{w:?}"
            );
        }
        let at = |event: usize| -> Vec<f64> {
            let all = motion.event_occurrences().filter(|(_, o)| o.event == event);
            all.map(|(_, o)| o.state.t).collect()
        };
        let wanted: Vec<f64> = direct.event_occurrences().map(|(_, o)| o.state.t).collect();
        assert_eq!(at(0).len(), wanted.len());
        for (t, wanted) in at(0).iter().zip(&wanted) {
            assert!((t - wanted).abs() < 1e-9, "{t} {wanted}");
        }
        // A rocking coordinate turns back twice a turn of the crank.
        assert!(at(1).len() >= 2 * wanted.len());
        if self.crank.drives.is_empty() {
            // Tsit45 errs by hundreds of its tolerance over ten turns.
            assert!(energy_lost(&two, &motion) < 1e-10);
        }
        wanted.len()
    }

    fn same_crank(
        &self,
        one: &Result<dwell_dynamics::CoordinateHistory, dwell_dynamics::DynamicsError>,
        two: &Result<dwell_dynamics::CoordinateHistory, dwell_dynamics::DynamicsError>,
    ) {
        let [one, two] = [one, two].map(|t| t.as_ref().expect("a track").samples.concat());
        assert_eq!(one.len(), two.len());
        let difference = two[0][0] - one[0][0];
        for (a, b) in one.iter().zip(&two) {
            // Two integrations of different equations, each to hundreds of its tolerance.
            assert!((b[0] - difference - a[0]).abs() < 1e-9, "{a:?} {b:?}");
            assert!(
                (b[1] - a[1]).abs() < 1e-8 * (1.0 + a[1].abs()),
                "{a:?} {b:?}"
            );
        }
    }
}

fn with_flywheel(mut masses: Vec<Mass>) -> Vec<Mass> {
    masses[1].inertia = 0.2;
    masses
}

/// A crank that turns, with a rocker that folds back.
fn crank_rocker(loads: &[Load], speed: f64, end: f64) -> Pair {
    let chain = four_bar([0.4, 0.1, 0.35, 0.25]);
    let masses = [
        Mass::default(),
        Mass::uniform_bar(1.0, 0.1),
        Mass::uniform_bar(0.8, 0.35),
        Mass::uniform_bar(0.5, 0.25),
    ];
    let masses = with_flywheel(masses.to_vec());
    let crank = Setup::new(&chain, angle([0, 1]), &masses, 1.0, &[0.0, 1.0, 0.2, 1.5]);
    Pair::new(crank.with_loads(loads, &[]), angle([0, 3]), speed, end)
}

#[test]
fn a_slider_is_followed_through_its_dead_points() {
    let chain = slider_crank(0.1, 0.35, 0.02);
    let piston = Mass {
        mass: 0.6,
        ..Mass::default()
    };
    let masses = with_flywheel(vec![
        Mass::default(),
        Mass::uniform_bar(1.0, 0.1),
        Mass::uniform_bar(0.8, 0.35),
        piston,
    ]);
    let crank = Setup::new(&chain, angle([0, 1]), &masses, 1.0, &[0.0, 1.0, -0.2, 0.0])
        .with_loads(&[gravity()], &[]);
    let cylinder = length([0, 3], [vec2(-0.1, 0.02), Vec2::ZERO]);
    assert!(Pair::new(crank, cylinder, 7.0, 10.0).check_agreement(1) >= 10);
}

#[test]
fn a_rocker_is_followed_through_its_dead_points() {
    assert!(crank_rocker(&[gravity()], 7.0, 10.0).check_agreement(1) >= 10);
}

/// A spring on the angle that is left, and one that the crank winds up over several turns, are the same
/// in every chart; so are a motor's current and rotor.
#[test]
fn loads_and_drives_go_on_in_another_chart() {
    assert!(crank_rocker(&[gravity(), torsion_spring([0, 3])], 7.0, 10.0).check_agreement(1) >= 10);
    let mut wound = crank_rocker(&[gravity(), torsion_spring([0, 1])], -7.0, 5.0);
    for setup in [&mut wound.crank, &mut wound.other] {
        setup.drives = vec![motor([0, 1])];
    }
    wound.check_agreement(1);
}

/// The diagonal of a parallelogram folds where that is flat: past the fold, a bridge.
#[test]
fn a_diagonal_leads_to_a_bridge() {
    let chain = four_bar([0.4, 0.2, 0.4, 0.2]);
    let masses = [
        Mass::default(),
        Mass::uniform_bar(1.0, 0.2),
        Mass::uniform_bar(0.8, 0.4),
        Mass::uniform_bar(0.5, 0.2),
    ];
    let crank = Setup::new(&chain, angle([0, 1]), &masses, 1.0, &[0.0, 1.0, 0.0, 1.0]);
    let diagonal = length([0, 2], [Vec2::ZERO, vec2(0.4, 0.0)]);
    let pair = Pair::new(crank.with_loads(&[gravity()], &[]), diagonal, 14.0, 4.0);
    assert!(pair.check_agreement(1) >= 9);
}

/// Where the first chart is enough, the journey is the plain motion.
#[test]
fn nothing_changes_where_nothing_must() {
    let rocker = crank_rocker(&[gravity()], 0.1, 0.2).other;
    let mut atlas = rocker.atlas();
    let start = rocker.initial_state(&atlas, 0.05);
    let options = Options {
        sample_interval: Some(0.01),
        ..Options::new(Method::Bdf, 1e-9)
    };
    let motion = atlas.solve(&start, 0.2, &options, &[]).expect("a run");
    let chart = &atlas.charts()[0];
    let plain = solve(
        &chart.machine,
        &chart.output_model,
        &start,
        0.2,
        &options,
        &[],
    )
    .expect("a run");
    assert_eq!(motion.segments.len(), 1);
    assert_eq!(motion.segments[0].solution, plain);
    assert_eq!(samples(&motion).len(), 21);
}

/// A lever turns at a constant speed through the dead points of its cylinder, in few and rough steps: some
/// would lead right over a fold, to where the way back looks like the way on.
#[test]
fn no_step_leads_over_a_fold() {
    let lever = Mass {
        mass: 1.0,
        center: Vec2::ZERO,
        inertia: 0.3,
    };
    let chain: Mechanism = mechanism(
        &["ground", "lever"],
        vec![Joint::revolute("A", [0, 1], [Vec2::ZERO; 2])],
    );
    for anchor in [0.9, 3.0] {
        let cylinder = length([0, 1], [vec2(anchor, 0.0), Vec2::IDENTITY]);
        for part in 5..=28 {
            let phi = 0.1 * f64::from(part);
            let s = (1.0 + anchor * anchor - 2.0 * anchor * phi.cos()).sqrt();
            let masses = [Mass::default(), lever];
            let setup = Setup::new(&chain, cylinder.clone(), &masses, s, &[0.0, phi]);
            let mut atlas = setup.atlas();
            let start = setup.initial_state(&atlas, -anchor * phi.sin() / s);
            for tolerance in [1e-1, 1e-2, 1e-3] {
                for method in Method::ALL {
                    let options = Options::new(method, tolerance);
                    let motion = atlas.solve(&start, 6.0, &options, &[]).expect("a run");
                    assert_eq!(motion.error, None);
                    let track = atlas.coordinate_history(&motion, CRANK).expect("a track");
                    let mut speeds = track.steps.iter().flatten().map(|[_, speed, _]| *speed);
                    // BDF at 0.1 loses a third of it.
                    assert!(
                        speeds.all(|s| s < -0.1),
                        "{method:?} {tolerance} {anchor} {phi}"
                    );
                }
            }
        }
    }
}
