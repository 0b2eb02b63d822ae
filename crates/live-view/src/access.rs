//! Who may read, and who may stop.
//!
//! - Stopping needs the control token in the header `Authorization`, which no form of another site can set.
//! - Reading is free on a loopback address; on any other it needs one of the two tokens.
//! - On a loopback address only hosts that name it are answered, or else a site whose name is made to resolve to it could read.
//! - Requests that another site makes are refused, but for opening the page itself.

use std::hint::black_box;
use std::net::SocketAddr;

use axum::http::header::{AUTHORIZATION, HOST, HeaderMap, HeaderValue, ORIGIN};
use axum::http::uri::{Authority, Uri};
use axum::http::{Method, StatusCode};

const TOKEN_BYTES: usize = 16;

/// Random bytes from the operating system, as hexadecimal digits.
pub(super) fn random_hex<const N: usize>() -> Result<String, getrandom::Error> {
    let mut bytes = [0; N];
    getrandom::fill(&mut bytes)?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// The tokens of a session and the rules for them at its address.
pub(super) struct Access {
    watch: String,
    control: String,
    is_loopback: bool,
}

impl Access {
    pub(super) fn new(address: SocketAddr) -> Result<Self, getrandom::Error> {
        Ok(Self {
            watch: random_hex::<TOKEN_BYTES>()?,
            control: random_hex::<TOKEN_BYTES>()?,
            is_loopback: address.ip().is_loopback(),
        })
    }

    /// The addresses of the page for those who watch and for those who may stop.
    pub(super) fn urls(&self, address: SocketAddr) -> (String, String) {
        let mut reached = address;
        if address.ip().is_unspecified() {
            reached.set_ip(match address {
                SocketAddr::V4(_) => std::net::Ipv4Addr::LOCALHOST.into(),
                SocketAddr::V6(_) => std::net::Ipv6Addr::LOCALHOST.into(),
            });
        }
        let with = |token: &str| format!("http://{reached}/?token={token}");
        let watch = match self.is_loopback {
            true => format!("http://{reached}/"),
            false => with(&self.watch),
        };
        (watch, with(&self.control))
    }

    /// Why a request gets no answer. Stopping has to be checked with [`Access::may_stop`] as well.
    pub(super) fn refusal(
        &self,
        method: &Method,
        uri: &Uri,
        headers: &HeaderMap,
    ) -> Option<StatusCode> {
        let host = headers.get(HOST).and_then(|host| host.to_str().ok());
        if self.is_loopback && !host.is_some_and(names_loopback) {
            return Some(StatusCode::MISDIRECTED_REQUEST);
        }
        if comes_from_elsewhere(uri, headers, host) {
            return Some(StatusCode::FORBIDDEN);
        }
        let reads = method != Method::POST;
        (reads && !self.may_read(uri, headers)).then_some(StatusCode::UNAUTHORIZED)
    }

    fn may_read(&self, uri: &Uri, headers: &HeaderMap) -> bool {
        let known = |token: &str| is_same(&self.watch, token) | is_same(&self.control, token);
        self.is_loopback || bearer(headers).or_else(|| in_query(uri)).is_some_and(known)
    }

    /// Whether a page opened with this address may offer to stop.
    pub(super) fn offers_stop(&self, uri: &Uri) -> bool {
        in_query(uri).is_some_and(|token| is_same(&self.control, token))
    }

    pub(super) fn may_stop(&self, headers: &HeaderMap) -> bool {
        bearer(headers).is_some_and(|token| is_same(&self.control, token))
    }
}

fn bearer(headers: &HeaderMap) -> Option<&str> {
    let value = headers.get(AUTHORIZATION)?.to_str().ok()?;
    value.strip_prefix("Bearer ")
}

fn in_query(uri: &Uri) -> Option<&str> {
    let mut pairs = uri.query()?.split('&');
    pairs.find_map(|pair| pair.strip_prefix("token="))
}

/// In a time that does not depend on where the texts differ.
fn is_same(token: &str, offered: &str) -> bool {
    if token.len() != offered.len() {
        return false;
    }
    let pairs = token.bytes().zip(offered.bytes());
    pairs.fold(0, |differing, (a, b)| black_box(differing | (a ^ b))) == 0
}

/// Any port will do: it may be forwarded.
fn names_loopback(host: &str) -> bool {
    let Ok(authority) = host.parse::<Authority>() else {
        return false;
    };
    let name = authority.host().trim_matches(['[', ']']);
    let is_address = |address: std::net::IpAddr| address.is_loopback();
    name.eq_ignore_ascii_case("localhost") || name.parse().is_ok_and(is_address)
}

/// What a page of another site asks for in the background: to stop, or to hold the event streams that others wait for.
fn comes_from_elsewhere(uri: &Uri, headers: &HeaderMap, host: Option<&str>) -> bool {
    let foreign_origin = headers.get(ORIGIN).is_some_and(|origin| {
        let place = origin.to_str().ok().and_then(|text| text.split_once("://"));
        !matches!((place, host), (Some((_, place)), Some(host)) if place.eq_ignore_ascii_case(host))
    });
    let site = headers.get("sec-fetch-site").map(HeaderValue::as_bytes);
    let foreign_site = matches!(site, Some(b"cross-site" | b"same-site"));
    foreign_origin || (foreign_site && uri.path() != "/")
}
