//! What is asked of an import.

use std::str::FromStr;

/// A format of models.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// The format of MuJoCo.
    Mjcf,
    /// The format of ROS, with the elements by which several programs close loops.
    Urdf,
    /// The format of Gazebo.
    Sdf,
    /// The format of OndselSolver and FreeCAD.
    Asmt,
    /// A link of PMKS+.
    Pmks,
}

impl FromStr for Format {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "mjcf" => Ok(Self::Mjcf),
            "urdf" => Ok(Self::Urdf),
            "sdf" => Ok(Self::Sdf),
            "asmt" => Ok(Self::Asmt),
            "pmks" => Ok(Self::Pmks),
            _ => Err(format!(
                "there is no format `{name}`: mjcf, urdf, sdf, asmt or pmks"
            )),
        }
    }
}

/// A joint that closes a loop between two named frames.
#[derive(Debug, Clone, PartialEq)]
pub struct Closing {
    /// The frames: links, joints, sites or frames of the file.
    pub frames: [String; 2],
    /// `revolute`, `spherical` or `fixed`.
    pub kind: String,
}

impl FromStr for Closing {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.rsplit_once(':').and_then(|(frames, kind)| {
            let (first, second) = frames.split_once('=')?;
            let known = ["revolute", "spherical", "fixed"].contains(&kind);
            known.then(|| Self {
                frames: [first.to_owned(), second.to_owned()],
                kind: kind.to_owned(),
            })
        });
        let help = "write FRAME=FRAME:KIND; the kind is revolute, spherical or fixed";
        parts.ok_or_else(|| help.to_owned())
    }
}

/// The options of an import. By default the file decides.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ImportOptions {
    /// The format; otherwise the ending or the beginning of the file shows it.
    pub from: Option<Format>,
    /// The joints that drive, in place of those that the file names.
    pub drives: Vec<String>,
    /// The keyframe that is drawn.
    pub key: Option<String>,
    /// Coordinates of joints as drawn, in the file's coordinate, in rad or m.
    pub start: Vec<(String, f64)>,
    /// Joints that close loops.
    pub close: Vec<Closing>,
    /// The text of a YAML file beside a URDF file that closes its loops.
    pub loops: Option<String>,
    /// A floating body that is held where it is drawn.
    pub fix: Option<String>,
    /// A scene in space, even if the mechanism moves in a plane.
    pub spatial: bool,
    /// How far, in m, points may be from the plane of a planar mechanism; 1e-6 of its size by default.
    pub tolerance: Option<f64>,
}
