//! The mechanisms that general statements are tested on: those of `validation/`, and some with
//! prismatic joints where those have none.

use crate::fixtures::repository_root;
use dwell_scene::PlaneScene;

/// A mechanism, and the number of unknowns of its largest structural group.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    pub name: &'static str,
    pub largest: usize,
}

const fn case(name: &'static str, largest: usize) -> Case {
    Case { name, largest }
}

pub const CASES: [Case; 7] = [
    case("single-dwell", 2),
    case("crank-rocker", 2),
    case("slotted-rocker", 1),
    case("class-three-six-bar", 4),
    case("skew-yoke", 1),
    case("driven-slot", 1),
    case("oldham-coupling", 1),
];

/// A Scotch yoke whose slot is not square to its guide: the only way from the ground to the yoke is
/// over a prismatic joint, and no two bodies measure the guide's direction alike.
const SKEW_YOKE: &str = r#"
    [bodies]
    ground.points = { A = [0, 0], G = [0.3, -0.05] }
    crank = { points = { A = [0, 0], B = [0.08, 0] }, mass = 0.7, center = [0.03, 0.005], inertia = 5e-4 }
    block = { points = { B = [0, 0] }, mass = 0.4, center = [0.004, 0.007], inertia = 2e-4 }
    yoke = { points = { S = [0, 0.02], R = [0.1, 0] }, mass = 1.3, center = [0.05, 0.03], inertia = 4e-3 }
    [joints]
    A = { revolute = ["ground.A", "crank.A"] }
    B = { revolute = ["crank.B", "block.B"] }
    slot = { prismatic = ["yoke.S", "block.B"], axes = [[-0.4, 1], [1, 0.1]] }
    guide = { prismatic = ["ground.G", "yoke.R"], axes = [[1, 0.3], [1, -0.2]] }
    [actuators]
    phi = { angle = ["ground", "crank"] }
"#;

/// A quick-return (Whitworth): the driven wheel has the slot, 20 mm beside its pivot, and the block
/// in it turns a rocker.
const DRIVEN_SLOT: &str = r#"
    [bodies]
    ground.points = { A = [0, 0], D = [0.1, 0.03] }
    wheel = { points = { A = [0, 0], S = [0.05, 0.02] }, mass = 0.7, center = [0.03, 0.005], inertia = 5e-4 }
    block = { points = { B = [0, 0] }, mass = 0.4, center = [0.004, 0.007], inertia = 2e-4 }
    rocker = { points = { D = [0, 0], B = [0.25, 0] }, mass = 1.3, center = [0.1, 0.03], inertia = 9e-3 }
    [joints]
    A = { revolute = ["ground.A", "wheel.A"] }
    D = { revolute = ["rocker.D", "ground.D"] }
    B = { revolute = ["rocker.B", "block.B"] }
    slot = { prismatic = ["wheel.S", "block.B"], axes = [[1, 0.1], [1, -0.2]] }
    [actuators]
    phi = { angle = ["ground", "wheel"] }
    [assembly]
    rocker = 0.1
"#;

/// An Oldham coupling whose slots are not square to each other: a cross, held by two turning slots
/// alone, between two discs with distant axes.
const OLDHAM_COUPLING: &str = r#"
    [bodies]
    ground.points = { A = [0, 0], E = [0.03, 0.01] }
    disc = { points = { A = [0, 0], S = [0, 0.004] }, mass = 0.7, center = [0.003, 0.005], inertia = 5e-4 }
    cross = { points = { M = [0, 0], N = [0.01, 0.006] }, mass = 0.4, center = [0.004, 0.007], inertia = 2e-4 }
    other = { points = { E = [0, 0] }, mass = 0.9, center = [0.002, -0.003], inertia = 8e-4 }
    [joints]
    A = { revolute = ["ground.A", "disc.A"] }
    E = { revolute = ["ground.E", "other.E"] }
    one = { prismatic = ["cross.M", "disc.S"], axes = [[1, 0.3], [1, -0.2]] }
    two = { prismatic = ["other.E", "cross.N"], axes = [[0.1, 1], [-0.4, 1]] }
    [actuators]
    phi = { angle = ["ground", "disc"] }
"#;

impl Case {
    /// The text of its scene.
    pub fn text(self) -> String {
        match self.name {
            "skew-yoke" => SKEW_YOKE.to_owned(),
            "driven-slot" => DRIVEN_SLOT.to_owned(),
            "oldham-coupling" => OLDHAM_COUPLING.to_owned(),
            name => {
                let folder = repository_root().join("validation").join(name);
                std::fs::read_to_string(folder.join("scene.toml")).expect("a scene")
            }
        }
    }

    /// Its scene.
    pub fn scene(self) -> PlaneScene {
        let file = format!("{}.toml", self.name);
        PlaneScene::parse(&file, &self.text()).unwrap_or_else(|e| panic!("{}: {e:?}", self.name))
    }
}
