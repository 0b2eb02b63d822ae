//! A broker of its own for every test.

use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

/// A mosquitto on a loopback port; killed when dropped.
pub struct Mosquitto {
    program: PathBuf,
    folder: TempDir,
    port: u16,
    child: Option<Child>,
}

impl Mosquitto {
    /// None, with a note, where mosquitto is not installed; then a panic instead if `DRIVEKIT_REQUIRE_MOSQUITTO` is set.
    pub fn start() -> Option<Self> {
        Self::start_with(|_| "allow_anonymous true\n".to_owned())
    }

    /// One that lets only this user in.
    pub fn start_for(user: &str, password: &str) -> Option<Self> {
        Self::start_with(|folder| {
            let file = folder.join("passwords");
            let mut command = Command::new("mosquitto_passwd");
            let made = command.args(["-c", "-b"]).arg(&file).args([user, password]);
            assert!(made.status().unwrap().success());
            // It would become a user who may not read the file.
            format!(
                "user root\nallow_anonymous false\npassword_file {}\n",
                file.display()
            )
        })
    }

    fn start_with(access: impl FnOnce(&Path) -> String) -> Option<Self> {
        let Some(program) = program() else {
            let required = std::env::var_os("DRIVEKIT_REQUIRE_MOSQUITTO").is_some();
            assert!(!required, "mosquitto is not installed");
            println!("skipped: mosquitto is not installed");
            return None;
        };
        let port = free_port();
        let folder = tempfile::tempdir().unwrap();
        let access = access(folder.path());
        let settings =
            format!("listener {port} 127.0.0.1\npersistence false\nlog_dest none\n{access}");
        std::fs::write(folder.path().join("mosquitto.conf"), settings).unwrap();
        let mut broker = Self {
            program,
            folder,
            port,
            child: None,
        };
        broker.restart();
        Some(broker)
    }

    pub fn port(&self) -> u16 {
        self.port
    }

    /// Kills it at once.
    pub fn kill(&mut self) {
        if let Some(mut child) = self.child.take() {
            child.kill().unwrap();
            child.wait().unwrap();
        }
    }

    /// Starts it on the same port, and waits until it answers.
    pub fn restart(&mut self) {
        self.kill();
        let mut command = Command::new(&self.program);
        command
            .arg("-c")
            .arg(self.folder.path().join("mosquitto.conf"));
        command
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        self.child = Some(command.spawn().unwrap());
        let until = Instant::now() + Duration::from_secs(5);
        while TcpStream::connect(("127.0.0.1", self.port)).is_err() {
            assert!(Instant::now() < until, "mosquitto does not start");
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

impl Drop for Mosquitto {
    fn drop(&mut self) {
        self.kill();
    }
}

/// A port of the loopback that nobody listens on.
pub fn free_port() -> u16 {
    let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
    listener.local_addr().unwrap().port()
}

/// Debian has it where only root looks.
fn program() -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path)
        .chain([Path::new("/usr/sbin").to_owned()])
        .map(|folder| folder.join("mosquitto"))
        .find(|program| program.is_file())
}
