//! Who is answered what.

use std::io::{ErrorKind, Read as _};
use std::sync::atomic::Ordering;

use super::{Served, token};

#[test]
fn page_is_read_without_a_token_here() {
    let served = Served::local();
    assert_eq!(
        served.view.watch_url(),
        format!("http://127.0.0.1:{}/", served.port)
    );
    let (status, answer) = served.ask("GET /", &[]);
    assert_eq!(status, 200);
    let (head, body) = answer.split_once("\r\n\r\n").unwrap();
    let nonce = head.split_once("script-src 'nonce-").unwrap().1;
    let nonce = nonce.split_once('\'').unwrap().0;
    assert!(body.contains(&format!("<script nonce=\"{nonce}\">")));
    for header in [
        "default-src 'none'",
        "frame-ancestors 'none'",
        "x-content-type-options: nosniff",
        "referrer-policy: no-referrer",
        "cache-control: no-store",
        "x-frame-options: DENY",
    ] {
        assert!(head.contains(header), "{header}: {head}");
    }
    assert!(!head.contains("access-control"));
    assert!(!answer.contains(&served.control()));
    let (_, again) = served.ask("GET /", &[]);
    assert!(!again.contains(nonce));
}

#[test]
fn page_reaches_for_nothing_outside() {
    let page = report::live("0").replace("http://www.w3.org/2000/svg", "");
    for external in [
        "http:",
        "https:",
        "@import",
        "url(",
        "innerHTML",
        "{nonce}",
        "style=\"",
    ] {
        assert!(!page.contains(external), "{external}");
    }
}

#[test]
fn only_the_control_token_stops() {
    let served = Served::local();
    let stop = |headers: &[&str]| served.ask("POST /stop", headers).0;
    let control = served.control();
    let right = format!("Authorization: Bearer {control}");
    let wrong = format!("Authorization: Bearer {}", "0".repeat(control.len()));
    assert_eq!(stop(&[]), 403);
    assert_eq!(stop(&[&wrong]), 403);
    assert_eq!(stop(&[&right[..right.len() - 1]]), 403);
    let in_query = format!("POST /stop?token={control}");
    assert_eq!(served.ask(&in_query, &[]).0, 403);
    assert_eq!(served.ask("GET /stop", &[&right]).0, 404);
    assert_eq!(served.stops.load(Ordering::SeqCst), 0);
    assert_eq!(stop(&[&right]), 200);
    assert_eq!(served.stops.load(Ordering::SeqCst), 1);
    let origin = "Origin: http://127.0.0.1:PORT";
    assert_eq!(stop(&[&right, origin, "Content-Length: 0"]), 200);
    assert_eq!(served.stops.load(Ordering::SeqCst), 2);
}

#[test]
fn other_sites_are_refused() {
    let served = Served::local();
    let right = format!("Authorization: Bearer {}", served.control());
    for host in [
        "Host: example.org",
        "Host: 127.0.0.1.example.org:PORT",
        "Host: 192.168.1.1:PORT",
        "Host: localhost@example.org",
        "Host:",
        "X-Host: localhost",
    ] {
        assert_eq!(served.ask_raw("GET /", &[host]).0, 421, "{host}");
        assert_eq!(served.ask_raw("POST /stop", &[host, &right]).0, 421);
    }
    for host in ["localhost", "LOCALHOST:1", "127.0.0.1", "[::1]:PORT"] {
        let host = format!("Host: {host}");
        assert_eq!(served.ask_raw("GET /", &[&host]).0, 200, "{host}");
    }
    for origin in [
        "Origin: http://example.org",
        "Origin: http://127.0.0.1:1",
        "Origin: null",
        "Sec-Fetch-Site: cross-site",
        "Sec-Fetch-Site: same-site",
    ] {
        let stopped = served.ask("POST /stop", &[&right, origin]).0;
        assert_eq!(stopped, 403, "{origin}");
        assert_eq!(served.ask("GET /events", &[origin]).0, 403, "{origin}");
    }
    assert_eq!(served.ask("GET /", &["Sec-Fetch-Site: cross-site"]).0, 200);
    assert_eq!(served.stops.load(Ordering::SeqCst), 0);
}

#[test]
fn elsewhere_reading_needs_a_token() {
    let served = Served::everywhere();
    assert_eq!(served.ask("GET /", &[]).0, 401);
    assert_eq!(served.ask("GET /?token=", &[]).0, 401);
    assert_eq!(served.ask("GET /events", &[]).0, 401);
    assert_eq!(served.ask("POST /stop", &[]).0, 403);
    let watch = token(served.view.watch_url());
    for token in [&watch, &served.control()] {
        assert_eq!(served.ask(&format!("GET /?token={token}"), &[]).0, 200);
    }
    let mut watching = served.events(&format!("?token={watch}"));
    assert_eq!(watching.next("hello")["may_stop"], false);
    let mut controlling = served.events(&format!("?token={}", served.control()));
    assert_eq!(controlling.next("hello")["may_stop"], true);
    let watch = format!("Authorization: Bearer {watch}");
    assert_eq!(served.ask("GET /", &[&watch]).0, 200);
    assert_eq!(served.ask("POST /stop", &[&watch]).0, 403);
    let host = "Host: robots.example.org";
    let right = format!("Authorization: Bearer {}", served.control());
    assert_eq!(served.ask_raw("POST /stop", &[host, &right]).0, 200);
    assert_eq!(served.stops.load(Ordering::SeqCst), 1);
}

#[test]
fn nothing_else_is_found() {
    let served = Served::local();
    for line in [
        "GET /x",
        "GET /events/",
        "POST /",
        "DELETE /stop",
        "GET /../",
    ] {
        assert_eq!(served.ask(line, &[]).0, 404, "{line}");
    }
}

#[test]
fn long_heads_are_refused() {
    let served = Served::local();
    let long = format!("X-Long: {}", "x".repeat(64 * 1024));
    let mut stream = served.send("GET /", &["Host: localhost", &long]);
    let mut answer = [0; 12];
    match stream.read(&mut answer) {
        Ok(count) => assert!(!answer[..count].ends_with(b"200"), "{answer:?}"),
        Err(error) => assert_eq!(error.kind(), ErrorKind::ConnectionReset),
    }
}
