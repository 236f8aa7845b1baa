//! Computes columns, sections and peak forces along a trajectory.

mod along;
mod analysis;
mod column;
mod columns;
mod corners;
mod distances;
mod dyads;
mod early_stop;
mod evaluator;
mod extra_columns;
mod extrema;
mod followed_scene;
mod force_evaluator;
mod in_plane;
mod long_rows;
mod maximum;
mod mechanical_advantage;
mod monitor;
mod plane_columns;
mod requested_columns;
mod results;
mod rounding_error;
mod row_evaluator;
mod row_scene;
mod row_source;
mod second_rows;
mod sectioned_link;
mod selection;
mod statistic;
mod trajectory;
mod unit_references;
mod unit_scales;
mod weighted;

#[cfg(feature = "output")]
pub(crate) use along::curve_along;
pub(crate) use along::{analysis_along, peak_analysis, statistics_along};
pub use analysis::Analysis;
pub(crate) use column::{Column, ColumnList, Quantity, is_prefix_of, units};
pub(crate) use columns::all_columns;
pub(crate) use distances::Distance;
pub(crate) use dyads::{Dyad, dyads};
pub(crate) use early_stop::{EarlyStop, StopCause, unreachable_error};
pub(crate) use evaluator::PositionEvaluator;
pub(crate) use extra_columns::extra_columns;
pub(crate) use extrema::Extremum;
pub(crate) use extrema::{BetweenRows, Extrema, ExtremaSearch, SamplePrecision, Sampler};
pub(crate) use followed_scene::FollowedScene;
pub(crate) use force_evaluator::ForceEvaluator;
#[cfg(feature = "output")]
pub(crate) use in_plane::lifted;
pub(crate) use in_plane::requested_bodies;
pub(crate) use long_rows::{LongRows, RowStorage, not_stored};
pub(crate) use maximum::{
    Point, extremum_with_ties, high_points, highest_between, stationary_near,
};
pub(crate) use mechanical_advantage::SpeedScale;
pub(crate) use monitor::CouplingMonitor;
pub(crate) use requested_columns::RequestedColumns;
pub(crate) use results::MotionBetweenRows;
pub use results::{ComputedTrajectory, TrajectoryResults};
pub(crate) use rounding_error::{BodyNumbers, LargestErrors, RoundingError};
pub(crate) use row_evaluator::RowEvaluator;
pub(crate) use row_scene::{ColumnRequests, Layout, RowScene};
pub(crate) use row_source::{RowSource, compute_trajectory_in};
pub(crate) use second_rows::SecondRows;
pub use sectioned_link::SectionedLink;
pub(crate) use selection::{check_variables, reject_unknown_variables};
pub(crate) use statistic::{STATISTICS, Signal, Statistic};
pub use trajectory::Trajectory;
pub(crate) use trajectory::{
    BALANCE, FreeTrajectory, KINETIC, POTENTIAL, Spacing, SweepLimits, TrajectorySample,
    default_limits, one_revolution, range_to_draw,
};
pub(crate) use unit_references::UnitReferences;
pub(crate) use unit_scales::{UnitScales, force_scales};
pub(crate) use weighted::{Weighted, weighted_along};
