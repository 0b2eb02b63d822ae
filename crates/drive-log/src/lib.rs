//! Recorded drives: read, checked, resampled.
//!
//! A recording is samples `x(τ_k)` of some channels at times `τ_0 ≤ τ_1 ≤ …` that are as regular as
//! the logger made them, with values missing, frozen or impossible. Models of drivers and vehicles
//! need every channel on a grid,
//!
//! ```text
//! t_i = t_0 + i·h,   v_i = Σ_j w_j v(t_{i+j}),   a_i = (v_{i+1} − v_i)/h
//! ```
//!
//! with the speed `v` smoothed by a Hann window `w` and the acceleration `a` its forward difference
//! (thesis eq. 3.21; section 3.4: `h` = 0.1 s, five samples). Between samples, `v(t)` is linear;
//! where there is no valid speed for more than 2 s it is unknown, and the drive is cut.
//!
//! [`read_file`] turns CSV or Parquet into [`RawLog`]s, [`check`] finds and repairs what is wrong
//! with one, and [`prepare()`] turns it into [`DriveLog`]s, whose speed is present and finite
//! everywhere. Units are SI throughout.
//!
//! ```
//! use drive_log::{Channel, LayoutChoice, Preparation, prepare, read_bytes};
//!
//! let csv = "time_s;speed_kmh;elevation_m\n0;36;100\n0,5;39,6;\n1;36;102\n";
//! let file = read_bytes("trip.csv".as_ref(), csv.as_bytes(), &LayoutChoice::Auto)?;
//! assert_eq!(file.layout, "canonical");
//!
//! for log in file.logs {
//!     let drive = prepare(log, &Preparation::default())?;
//!     for finding in &drive.findings {
//!         println!("{:?} in {}: {}", finding.kind, finding.channel, finding.detail);
//!     }
//!     let trip = &drive.pieces[0];
//!     assert_eq!((trip.name(), trip.len(), trip.step_s()), ("trip", 11, 0.1));
//!     assert!((trip.speed_mps()[5] - 10.833).abs() < 0.001); // the peak of 11 m/s, smoothed
//!     assert!((trip.channel(Channel::Elevation).unwrap()[5] - 101.0).abs() < 1e-9);
//! }
//! # Ok::<(), drive_log::Error>(())
//! ```
//!
//! # References
//!
//! - Section numbers and equations are those of the thesis that drivekit implements.
//! - F. J. Harris, *On the use of windows for harmonic analysis with the discrete Fourier
//!   transform*, Proc. IEEE 66 (1978): the Hann window.
//! - M. Steinstraeter, J. Buberger, D. Trifonov, *Battery and heating data in real driving cycles*,
//!   IEEE DataPort (2020), doi:10.21227/6jr9-5235: the layout `bmw-i3`.
//! - M. Makridis et al., *OpenACC. An open database of car-following experiments to study the
//!   properties of commercial ACC systems*, Transp. Res. C 125 (2021): the layout `openacc`.

mod agreement;
mod assemble;
mod body;
mod canonical;
mod cells;
mod channel;
mod clock;
pub mod collection;
mod columns;
mod compressed;
mod cycle_table;
mod derivative;
mod described;
mod error;
mod finding;
mod head;
mod header;
mod layout;
pub mod limit_map;
mod lines;
mod log;
mod longitude;
mod note;
mod number;
mod openacc;
mod origin;
mod parquet;
mod plan;
mod preparation;
mod prepare;
mod quality;
mod raw;
mod read;
mod resample;
mod row_width;
mod rows;
mod smooth;
mod source;
mod stamp;
mod statistics;
mod summary;
mod text;
mod tidy;
mod time_unit;
mod top;
mod twin;
mod unit;
mod write;

pub use channel::Channel;
pub use collection::{Collection, SourcedDrive};
pub use derivative::forward_difference;
pub use error::{Error, TableError};
pub use finding::{Action, Finding, FindingKind};
pub use layout::{Layout, LayoutChoice};
pub use log::DriveLog;
pub use preparation::Preparation;
pub use prepare::{Drive, prepare};
pub use quality::{Checked, check};
pub use raw::RawLog;
pub use read::{LogFile, constants_of_column, read_bytes, read_file, read_from, sha256};
pub use rows::{Row, RowReader};
pub use smooth::{Smoothing, SmoothingStream, hann};
pub use summary::ChannelSummary;
pub use twin::{DriveIndex, Kinship};
pub use write::{write_csv, write_parquet};
