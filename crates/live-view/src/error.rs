//! Why a view cannot be served.

use std::net::SocketAddr;

/// What keeps a page from being served.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The address cannot be listened on, or there are too many threads.
    #[error("cannot serve the view on {address}")]
    Serve {
        /// Where it was to be served.
        address: SocketAddr,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// The system gives no random numbers for the tokens.
    #[error("no random numbers for the tokens of the view")]
    RandomNumbers(#[from] getrandom::Error),
}
