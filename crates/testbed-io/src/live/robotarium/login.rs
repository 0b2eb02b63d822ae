//! Who we are at the broker. The link stands in every run log, and a password must not.

use std::fmt;

use serde::Deserialize;

use super::RobotariumSpec;
use crate::Error;

/// A password; it is neither printed nor written.
#[derive(Clone, PartialEq, Eq, Deserialize)]
#[serde(transparent)]
pub struct Password(String);

impl Password {
    pub(super) fn as_str(&self) -> &str {
        &self.0
    }
}

impl From<&str> for Password {
    fn from(text: &str) -> Self {
        Self(text.to_owned())
    }
}

impl fmt::Debug for Password {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Password(…)")
    }
}

impl RobotariumSpec {
    /// With the password out of its file.
    pub(super) fn with_password(&self) -> Result<Self, Error> {
        let mut spec = self.clone();
        if self.user.as_deref() == Some("") {
            return Err(self.error("`user` is empty".to_owned(), "name the user"));
        }
        if self.user.is_none() && (self.password.is_some() || self.password_file.is_some()) {
            let problem = "a password and no user".to_owned();
            return Err(self.error(problem, "give `user` too"));
        }
        let Some(file) = &self.password_file else {
            return Ok(spec);
        };
        if self.password.is_some() {
            let problem = "`password` and `password_file`".to_owned();
            return Err(self.error(problem, "give one of them"));
        }
        let text = std::fs::read_to_string(file).map_err(|source| Error::Read {
            path: file.clone(),
            source,
        })?;
        let first = text.lines().next().filter(|line| !line.is_empty());
        let Some(first) = first else {
            let problem = format!("no password in the first line of `{}`", file.display());
            return Err(self.error(problem, "write it there"));
        };
        spec.password = Some(first.into());
        Ok(spec)
    }
}
