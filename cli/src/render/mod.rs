//! One renderer per format.

pub(crate) mod chart;
pub(crate) mod json;
pub(crate) mod model_svg;
pub(crate) mod svg;
pub(crate) mod table;
