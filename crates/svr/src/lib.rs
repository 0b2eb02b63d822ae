//! Support vector regression: a function within a tube around the data, as flat as possible.
//!
//! For samples `x_i` with responses `y_i`, box constraint `C`, half width of the tube `ε` and weights `c_i` (thesis 4.17)
//!
//! ```text
//! minimise   ½‖w‖² + C Σ c_i max(0, |y_i − f(x_i)| − ε),   f(x) = w·φ(x) + b
//! ```
//!
//! or, in `β = α* − α` (4.21, whose negative minimum is the same number),
//!
//! ```text
//! minimise   ½ βᵀKβ − yᵀβ + ε‖β‖₁   subject to   Σ β = 0,  |β_i| ≤ C c_i,   f(x) = Σ β_i K(x_i, x) + b
//! ```
//!
//! | kernel | `K(x, z)`, `s` the kernel scale | solver |
//! |---|---|---|
//! | [`Kernel::Linear`] | `x·z/s²` | interior point method in `d + 1` variables; the kernel matrix is never formed |
//! | [`Kernel::Quadratic`], [`Kernel::Cubic`] | `(1 + x·z/s²)^q` | working sets of 512 samples, in each the two-variable method with second-order selection |
//! | [`Kernel::Rbf`] | `exp(−‖x − z‖²/s²)` | the same |
//!
//! Beyond 100,000 samples kernels are approximated by landmarks (Nyström) and solved as linear ones. [`fit_least_squares`] has
//! squares in place of the tube: least-squares support vector machines, and ridge regression.
//!
//! Every [`Fit`] says how it ended ([`Status`]), its duality gap and its KKT residual. Rows of the kernel matrix are in single precision and
//! kept as long as the memory limit allows; objectives, gradients and predictions are in double precision. There is no
//! separate shrinking: a working set leaves out all samples but 512 and is solved in the cache, and only rows of samples that
//! ever violated optimality are computed.
//!
//! ```
//! use svr::{Kernel, Penalty, Response, Samples, Settings, Status, fit};
//!
//! let x: Vec<f64> = (0..200).map(|i| f64::from(i) / 20.0).collect();
//! let y: Vec<f64> = x.iter().map(|x| x.sin()).collect();
//! let samples = Samples::new(&x, 1)?;
//! let settings = Settings { kernel: Kernel::Rbf, kernel_scale: Some(0.5), ..Settings::default() };
//! let fit = fit(&samples, &Response::new(&y)?, &settings, &Penalty::default())?;
//!
//! assert_eq!(fit.status, Status::Optimal);
//! let predicted = fit.model.predict(&samples)?;
//! assert!(predicted.iter().zip(&y).all(|(p, y)| (p - y).abs() < 0.15));
//! # Ok::<(), svr::Error>(())
//! ```
//!
//! # References
//!
//! - Equation numbers are those of the thesis that drivekit implements, chapter 4, with its corrections.
//! - S. Mehrotra: On the implementation of a primal-dual interior point method. SIAM Journal on Optimization 2, 1992.
//! - R.-E. Fan, P.-H. Chen, C.-J. Lin: Working set selection using second order information for training support vector
//!   machines. Journal of Machine Learning Research 6, 2005.
//! - J. Nocedal, S. Wright: Numerical Optimization, 2nd edition, 2006. Active sets.
//! - T. Joachims: Making large-scale SVM learning practical. Advances in Kernel Methods, 1999. Decomposition.
//! - C. Williams, M. Seeger: Using the Nyström method to speed up kernel machines. NIPS 2000.

mod deadline;
mod error;
mod expansion;
mod face;
mod folds;
mod kernel;
mod kernel_rows;
mod least_squares;
mod linear;
mod linear_rows;
mod model;
mod multipliers;
mod nystrom;
mod quadratic_form;
mod quantile;
mod samples;
mod scaler;
mod search;
mod settings;
mod status;
mod subproblem;
mod trainer;
mod two_variable;
mod vectorised;

pub use error::Error;
pub use folds::{Fold, blocked_folds, grouped_folds, hold_out};
pub use kernel::Kernel;
pub use least_squares::fit_least_squares;
pub use model::{Model, Predictor};
pub use samples::{Response, Samples};
pub use scaler::Scaler;
pub use search::{Candidate, Grid, search};
pub use settings::{Landmarks, Penalty, Scaling, Settings, Stopping, UsedPenalty};
pub use status::Status;
pub use trainer::{Fit, Trainer, fit};
