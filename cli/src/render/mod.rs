//! One renderer per format.

pub(crate) mod html;
pub(crate) mod json;
pub(crate) mod svg;
pub(crate) mod table;
