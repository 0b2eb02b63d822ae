//! One renderer per format.

pub(crate) mod chart;
pub(crate) mod json;
pub(crate) mod table;
