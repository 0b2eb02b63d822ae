//! Segmentation of multivariate time series, and merging of similar segments.
//!
//! Given `n` samples of `m` variables `x_i` with weights `w_i`, find boundaries `0 = b_0 < b_1 < … < b_k = n` such that
//! every segment `[b_{j−1}, b_j)` is homogeneous, that is, has a low [`Cost`] `H`. With `x̄_i` the mean on a segment of
//! `l` samples,
//!
//! ```text
//! H = Σ_i w_i Σ_j |x_ij − x̄_i| / S_i,   S_i² = Σ_j (x_ij − x̄_i)² / (l − 1)     z-scale
//! H = Σ_i w_i Σ_j |x_ij − x̄_i| / l                                             mean deviation
//! H = Σ_i w_i Σ_j (x_ij − x̄_i)²                                                squared error
//! ```
//!
//! The result is a [`Segmentation`], a partition of `0..n` by construction, which all parts of this crate return or
//! take:
//!
//! - [`Dynamic`] finds the least total cost for a number of segments, [`PenaltyPath`] how many segments pay;
//! - [`BottomUp`] merges the cheapest pair of neighbours until the cheapest costs more than a threshold;
//! - [`Swab`] does so in a sliding window, in one pass over the samples, and [`SwabStream`] as they arrive;
//! - [`SlidingWindow`] grows one segment after the other, without looking back;
//! - [`runs`] groups neighbours of equal label;
//! - [`merge_similar`] joins neighbours afterwards where a [`Similarity`] says so, [`Merging`] does it in a stream;
//! - [`Metrics`] says how long and how pure the segments are.
//!
//! Samples are indexed from 0, segments are half-open. The units of the variables are the caller's; [`Scale`] makes
//! them comparable. Nothing here is random: equal input gives equal output.
//!
//! # Example
//!
//! ```
//! use tseg::{Cost, Metrics, Segmentation, Series, Similarity, Swab, merge_similar};
//!
//! let speed = [0.0, 0.0, 0.0, 0.5, 1.5, 2.5, 3.5, 4.0, 4.0, 4.0];
//! let accel = [0.0, 0.0, 0.5, 1.0, 1.0, 1.0, 0.5, 0.0, 0.0, 0.0];
//! let series = Series::new(&[(&speed, 1.8), (&accel, 1.0)])?;
//!
//! let fine: Segmentation = Swab::new(Cost::MeanDeviation, 0.4, 100)?.segment(&series);
//! assert_eq!(fine.boundaries(), [0, 3, 4, 5, 6, 7, 10]);
//!
//! let coarse = merge_similar(&accel, &fine, Similarity::percentile())?;
//! assert_eq!(coarse.boundaries(), [0, 3, 7, 10]);
//! assert_eq!(Metrics::new(&accel, &coarse)?.positive_share_pct, Some(100.0));
//! # Ok::<(), tseg::Error>(())
//! ```
//!
//! # References
//!
//! - E. Keogh, S. Chu, D. Hart, M. Pazzani: An online algorithm for segmenting time series. Proc. IEEE International
//!   Conference on Data Mining, 2001.
//! - Equation, table and algorithm numbers are those of the thesis that drivekit implements, section 3.1.

mod association;
mod bottom_up;
mod cost;
mod deviation;
mod dynamic;
mod error;
mod heuristic;
mod mean_comparison;
mod merge;
mod merger;
mod metrics;
mod multiset;
mod percentile;
mod scale;
mod segmentation;
mod series;
mod sliding_window;
mod stream;
mod swab;
mod tournament;
mod window;

pub use association::association_similarity;
pub use bottom_up::{BottomUp, Stop};
pub use cost::Cost;
pub use dynamic::{Certificate, Dynamic, Optimum, PathPoint, PenaltyPath, Progress};
pub use error::Error;
pub use heuristic::runs;
pub use merge::{Merging, Similarity, merge_similar};
pub use metrics::Metrics;
pub use percentile::percentile_similarity;
pub use scale::Scale;
pub use segmentation::Segmentation;
pub use series::Series;
pub use sliding_window::SlidingWindow;
pub use stream::SwabStream;
pub use swab::{Refill, Swab};
