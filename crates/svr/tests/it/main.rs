//! Integration tests of support vector regression.

mod reference;
