//! One renderer per format.

pub(crate) mod json;
