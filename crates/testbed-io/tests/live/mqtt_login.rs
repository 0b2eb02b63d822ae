//! Brokers that ask for a password, and ports at which no broker is.

use std::net::TcpListener;
use std::time::{Duration, Instant};

use testbed_io::live::robotarium::{Password, RobotariumSpec, connect};
use testbed_io::live::{CommandsSpec, LinkSpec, PosesSpec};

use super::mosquitto::Mosquitto;
use super::mqtt::{IDS, inbox, spec};

const SECRET: &str = "open sesame";

fn with(port: u16, user: Option<&str>, password: Option<&str>) -> RobotariumSpec {
    RobotariumSpec {
        user: user.map(str::to_owned),
        password: password.map(Password::from),
        ..spec(port)
    }
}

/// What is said, and that it is said at once.
fn refused(spec: &RobotariumSpec) -> String {
    let start = Instant::now();
    let error = connect(spec, &IDS, inbox()).unwrap_err().to_string();
    let took_s = start.elapsed().as_secs_f64();
    println!("{took_s:.2} s: {error}");
    assert!(
        took_s < 3.0 && !error.contains("start the broker"),
        "{error}"
    );
    error
}

#[test]
fn a_user_with_the_password_is_let_in_and_others_are_told_why_not() {
    let Some(broker) = Mosquitto::start_for("lab", SECRET) else {
        return;
    };
    let port = broker.port();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("password");
    std::fs::write(&file, format!("{SECRET}\n")).unwrap();
    let by_file = RobotariumSpec {
        password_file: Some(file),
        ..with(port, Some("lab"), None)
    };
    for spec in [with(port, Some("lab"), Some(SECRET)), by_file] {
        let mut robotarium = connect(&spec, &IDS, inbox()).unwrap();
        assert!(robotarium.connected());
        assert!(robotarium.stop(Duration::from_secs(2)).is_empty());
    }
    let nobody = refused(&with(port, None, None));
    assert!(nobody.contains("without a password") && nobody.contains("`user` and `password`"));
    let wrong = refused(&with(port, Some("lab"), Some("abracadabra")));
    assert!(wrong.contains("refuses user `lab`") && !wrong.contains("abracadabra"));
}

#[test]
fn passwords_that_cannot_be_are_refused_before_anything_is_sent() {
    let folder = tempfile::tempdir().unwrap();
    let empty = folder.path().join("empty");
    std::fs::write(&empty, "\n").unwrap();
    assert!(refused(&with(1, None, Some(SECRET))).contains("give `user` too"));
    let file = |name: &str, password| RobotariumSpec {
        password_file: Some(folder.path().join(name)),
        ..with(1, Some("lab"), password)
    };
    assert!(refused(&file("empty", None)).contains("no password in the first line"));
    assert!(refused(&file("none", None)).contains("none"));
    assert!(refused(&file("empty", Some(SECRET))).contains("give one of them"));
}

#[test]
fn a_password_is_read_from_a_link_and_written_nowhere() {
    let text = format!(
        "robots = [5, 12]\n[poses]\nkind = \"robotarium\"\nuser = \"lab\"\npassword = \"{SECRET}\"\n\
         [commands]\nkind = \"robotarium\"\n"
    );
    let link: LinkSpec = toml::from_str(&text).unwrap();
    assert_eq!(link.commands, CommandsSpec::Robotarium);
    let PosesSpec::Robotarium(spec) = &link.poses else {
        panic!("{link:?}");
    };
    assert_eq!(spec.password, Some(Password::from(SECRET)));
    let written = serde_json::to_string(&link).unwrap();
    let again: LinkSpec = serde_json::from_str(&written).unwrap();
    for text in [
        written,
        format!("{link:?}"),
        toml::to_string(&link).unwrap(),
    ] {
        assert!(text.contains("lab") && !text.contains("sesame"), "{text}");
    }
    let PosesSpec::Robotarium(again) = &again.poses else {
        panic!("{again:?}");
    };
    assert_eq!((&again.user, &again.password), (&spec.user, &None));
}

#[test]
fn a_server_that_hangs_up_is_no_broker() {
    let server = TcpListener::bind(("127.0.0.1", 0)).unwrap();
    let port = server.local_addr().unwrap().port();
    std::thread::spawn(move || server.incoming().for_each(drop));
    let error = refused(&spec(port));
    assert!(error.contains("TLS"), "{error}");
}
