//! Tables and curves as text, for terminals.

mod chart;
mod table;

pub use chart::speed_over_time;
pub use table::{Table, number};
