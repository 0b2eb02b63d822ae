//! Why there is no connection to the broker, and what to do.

use std::io::ErrorKind;

use rumqttc::{ConnectReturnCode, ConnectionError, StateError};

use super::RobotariumSpec;
use crate::Error;

/// What went wrong last.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Problem {
    /// Nobody answers, or not any more
    NoAnswer(String),
    /// Somebody answers who does not speak MQTT, or hangs up
    Stranger(String),
    /// The broker does not let this user in
    Login,
    /// The broker refuses the connection for another reason
    Refused(String),
    /// The broker does not give the topic of the poses
    Topic,
}

impl Problem {
    /// Whether trying again cannot help.
    pub(super) fn is_final(&self) -> bool {
        matches!(self, Self::Login | Self::Refused(_))
    }

    /// As the settings have to be corrected.
    pub(super) fn error(self, spec: &RobotariumSpec) -> Error {
        let user = spec.user.as_deref();
        let (problem, help) = match self {
            Self::NoAnswer(what) => (
                what,
                "start the broker, or correct its address and port (1883 for older trackers)",
            ),
            Self::Stranger(what) => (
                what,
                "is this the port of an MQTT broker, and one without TLS, which is not supported?",
            ),
            Self::Login => login(user),
            Self::Refused(what) => (
                format!("the broker refuses the connection: {what}"),
                "it has to speak MQTT 3.1.1 and to let every client in by the name it gives itself",
            ),
            Self::Topic => (
                format!("the broker refuses the topic {}", spec.pose_topic),
                "correct `pose_topic`, or give a user that may read it and write the commands",
            ),
        };
        spec.error(problem, help)
    }
}

fn login(user: Option<&str>) -> (String, &'static str) {
    match user {
        None => (
            "the broker lets nobody in without a password".to_owned(),
            "give `user` and `password` or `password_file` under [poses]",
        ),
        Some(user) => (
            format!("the broker refuses user `{user}` with this password"),
            "correct `user` and `password` or `password_file` under [poses]",
        ),
    }
}

impl From<ConnectionError> for Problem {
    fn from(error: ConnectionError) -> Self {
        use ConnectReturnCode::{BadUserNamePassword, NotAuthorized};
        match error {
            ConnectionError::ConnectionRefused(BadUserNamePassword | NotAuthorized) => Self::Login,
            ConnectionError::ConnectionRefused(code) => Self::Refused(format!("{code:?}")),
            ConnectionError::NotConnAck(_)
            | ConnectionError::MqttState(
                StateError::Deserialization(_) | StateError::ConnectionAborted,
            ) => Self::Stranger(error.to_string()),
            ConnectionError::Io(ref source) if hangs_up(source.kind()) => {
                Self::Stranger(error.to_string())
            }
            error => Self::NoAnswer(error.to_string()),
        }
    }
}

fn hangs_up(kind: ErrorKind) -> bool {
    matches!(
        kind,
        ErrorKind::ConnectionAborted
            | ErrorKind::ConnectionReset
            | ErrorKind::UnexpectedEof
            | ErrorKind::InvalidData
    )
}
