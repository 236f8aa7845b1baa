//! Rates of the frames and slides.

/// Rates of every frame and slide: their velocities, or their accelerations.
#[derive(Debug, Clone, PartialEq)]
pub struct Rates<T> {
    /// By frame: rad/s, or rad/s².
    pub angular: Vec<T>,
    /// By slide: m/s, or m/s².
    pub slide: Vec<T>,
}
