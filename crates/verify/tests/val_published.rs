//! Published values of two mechanisms, computed elsewhere in 40 and 50 digits.

#![allow(
    clippy::excessive_precision,
    reason = "published digits stay as published"
)]

mod subjects;

use dwell_geometry::{BodyId, vec2};
use dwell_verify::checks::{PublishedPoint, PublishedSample, published};
use dwell_verify::{Subject, verify_all};
use subjects::mechanisms::{Setup, crank_rocker, single_dwell};
use subjects::mutated::MutatedSubject;

/// Every reaction of the crank-rocker in its order: (q in degrees, m, ½m′, [a, b] of A.x … D.y).
/// Source: independent 40-digit code, confirmed by a second one.
type Row = (f64, f64, f64, [[f64; 2]; 8]);
const CRANK_ROCKER: [Row; 3] = [
    (
        60.0,
        1.4762144108580858072,
        1.032227550952006069,
        [
            [-1.88694484512425181, -2.4792374727442942416],
            [0.017477812214114508486, -2.2297101649177651112],
            [-1.4539321432320324866, -2.2292374727442942416],
            [-0.23252218778588549151, -1.7966974630255457878],
            [-0.15713964495574404414, -0.63641947884400042689],
            [-0.63393988970027003358, -0.61380175010346663374],
            [-0.27362744953610575158, -0.4563985150562933878],
            [0.53535759161465457564, 0.29693144096582612644],
        ],
    ),
    (
        200.0,
        1.2893164303862429499,
        -0.55170241669649747088,
        [
            [-0.17129191779185944578, 2.2166736987722003891],
            [-1.6117700084309553133, 1.3939126943035032183],
            [-0.3423019894546938123, 1.7468273883792461971],
            [-1.1419236980380011213, 1.2229026226406688517],
            [-0.45251158157025579228, 0.31096567943047621202],
            [0.070863502438174295063, 0.3624440619976352813],
            [0.22070103036014903922, 0.185203408732385389],
            [-0.34395808212844132735, 0.15599435531972955611],
        ],
    ),
    (
        300.0,
        2.6801262319078963253,
        1.1586719132426462634,
        [
            [1.9738296968697118931, 0.13805726306221113347],
            [2.2748124766825092298, 2.0782216325076407997],
            [1.5408169949774925697, 0.38805726306221113347],
            [2.0248124766825092298, 1.6452089306154214763],
            [-0.01028173842196915315, 0.17319784904357412352],
            [0.93584556321227838721, 0.52340094322950488254],
            [0.69535506803699222922, 0.54166156497506288643],
            [-0.34687864974204754466, -0.26761835962802693554],
        ],
    ),
];

/// The single-dwell reconstruction: (q, m, ½m′, P, [a, b] of A.x, A.y, C.x, slide.normal, and of
/// slide.moment). Source: independent 50-digit code in reference-point coordinates.
type Dwell = (f64, f64, f64, [f64; 2], [[f64; 2]; 5]);
const SINGLE_DWELL: [Dwell; 4] = [
    (
        0.0,
        0.91017356052489065347,
        0.026707756413197009667,
        [0.2, 0.48989794855663561964],
        [
            [0.11581403908210906779, -0.27999986816593763922],
            [2.8417356052489065347, 0.26707756413197009667],
            [-0.54462669449954254693, -0.32462101432166907128],
            [0.21921441175239826784, 0.5455295972814485537],
            [0.0, 0.0],
        ],
    ),
    (
        2.0,
        0.6553379824475175586,
        0.0037688121765155969715,
        [0.35082199262337872579, 0.40075784843122885214],
        [
            [-0.2134825523710688789, -0.016681657975762949311],
            [-0.23852323318271642604, -0.054114392120478196319],
            [0.011142104283556876724, -0.006141478463688068086],
            [-0.0021349855934893964585, 0.0054700190441318830606],
            [0.0, 0.0],
        ],
    ),
    (
        5.0,
        0.63412605410183739523,
        0.005255186652140444068,
        [-0.024226711106399514735, 0.40133386281864666881],
        [
            [0.04607693257542558057, -0.34789030392067698372],
            [0.13070565542331752172, 1.3613105435265670555],
            [0.056742067814626963313, -0.51703479525555919699],
            [-0.13115285361686130492, -0.77988421540458845364],
            [0.0, 0.0],
        ],
    ),
    (
        6.0,
        0.8054254175849529951,
        0.22193864939427333988,
        [0.073290735031426055864, 0.47154169872572071471],
        [
            [-0.35138640318476133739, -1.0012161810673508864],
            [1.9709389147602688616, 2.6028110291758324311],
            [-0.82136438250110608463, -2.2143097235113867943],
            [-0.059981638726566042674, 1.6398011321086801462],
            [0.0, 0.0],
        ],
    ),
];

fn crank_rocker_samples() -> Vec<PublishedSample> {
    let sample = |&(degrees, m, half_dm, reactions): &Row| PublishedSample {
        q: f64::to_radians(degrees),
        m: Some(m),
        half_dm: Some(half_dm),
        reactions: (0..8).zip(reactions).map(|(k, [a, b])| (k, a, b)).collect(),
        points: Vec::new(),
    };
    CRANK_ROCKER.iter().map(sample).collect()
}

fn single_dwell_samples() -> Vec<PublishedSample> {
    // Two rows each of A, B, C, O, Q, the slide, P.
    let order = [0, 1, 4, 10, 11];
    let sample = |&(q, m, half_dm, [x, y], reactions): &Dwell| PublishedSample {
        q,
        m: Some(m),
        half_dm: Some(half_dm),
        reactions: order
            .into_iter()
            .zip(reactions)
            .map(|(k, [a, b])| (k, a, b))
            .collect(),
        points: vec![PublishedPoint {
            body: BodyId(2),
            local: vec2(0.5, 0.0),
            position: vec2(x, y),
        }],
    };
    SINGLE_DWELL.iter().map(sample).collect()
}

fn assert_agrees(title: &str, setup: &Setup, samples: &[PublishedSample], kinds: usize) {
    let findings = verify_all(&setup.case(3), &setup.subject(), samples);
    let published = findings.iter().filter(|f| f.key.starts_with("published"));
    assert_eq!(published.clone().count(), kinds);
    for f in published {
        println!(
            "{title:<13} {:<17} {:8.1e} {}",
            f.key, f.relative_difference, f.worst_at
        );
        assert!(f.pass && f.tolerance == 1e-12, "{f:#?}");
    }
}

#[test]
fn val_published_values() {
    assert_agrees("crank-rocker", &crank_rocker(), &crank_rocker_samples(), 4);
    assert_agrees("single-dwell", &single_dwell(), &single_dwell_samples(), 5);
}

fn failing(setup: &Setup, subject: &dyn Subject, samples: &[PublishedSample]) -> Vec<String> {
    let findings = published(&setup.case(0), subject, samples);
    findings
        .into_iter()
        .filter(|f| !f.pass)
        .map(|f| f.key)
        .collect()
}

/// A part in 1e9 of each kind is seen in its own finding.
#[test]
fn published_values_are_held_to() {
    const BY: f64 = 1.0 + 1e-9;
    let setup = single_dwell();
    let (subject, samples) = (setup.subject(), single_dwell_samples());
    let mutated = MutatedSubject::new(&subject).coefficients(|c| {
        c.m *= BY;
        c.b[10] *= BY;
    });
    assert_eq!(
        failing(&setup, &mutated, &samples),
        ["published-m", "published-b"]
    );
    let mutated = MutatedSubject::new(&subject)
        .coefficients(|c| {
            c.half_dm *= BY;
            c.a[1] *= BY;
        })
        .poses(|_, poses| poses[2][0] += 1e-9);
    let keys = ["published-half-dm", "published-a", "published-points"];
    assert_eq!(failing(&setup, &mutated, &samples), keys);
}

/// A reaction that is not there, and nothing at all.
#[test]
fn what_was_not_published() {
    let setup = crank_rocker();
    let subject = setup.subject();
    let mut samples = crank_rocker_samples();
    samples[0].reactions.push((99, 0.0, 0.0));
    assert_eq!(
        failing(&setup, &subject, &samples),
        ["published-a", "published-b"]
    );
    assert!(published(&setup.case(0), &subject, &[]).is_empty());
}
