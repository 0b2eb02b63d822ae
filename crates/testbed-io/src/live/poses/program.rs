//! Poses as JSON lines from a program: one that is started here, or the one that started this.

use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::json_udp::take;
use super::{Receiver, receiver};
use crate::Error;
use crate::live::counts::Dropped;
use crate::live::inbox::Inbox;
use crate::live::json_lines::{LONGEST, PoseLine};

/// A program that moves the robots.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProgramSpec {
    /// The program and its arguments, started for the session; without them poses come on standard input, and commands go to
    /// standard output
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub command: Vec<String>,
    /// How old a pose is when it is written, in s
    #[serde(default)]
    pub latency_s: f64,
}

impl ProgramSpec {
    /// For messages.
    pub(in crate::live) fn name(&self) -> String {
        match self.command.first() {
            Some(program) => format!("program `{program}`"),
            None => "standard input".to_owned(),
        }
    }
}

/// How long a program has to end after its input has.
const PATIENCE: Duration = Duration::from_secs(2);

/// The program and what it reads and writes.
pub(in crate::live) struct Program {
    pub(in crate::live) poses: Receiver,
    pub(in crate::live) commands: Box<dyn Write + Send>,
    pub(in crate::live) child: Option<Running>,
}

/// A program that was started here; it is ended when this is dropped.
pub(in crate::live) struct Running(Child);

impl Program {
    /// The program is told in `DRIVEKIT_STARTS` where the scenario's robots start, as pose lines in an array, for simulators.
    pub(in crate::live) fn start(
        spec: &ProgramSpec,
        starts: &[PoseLine],
        inbox: Inbox,
    ) -> Result<Self, Error> {
        let Some((program, arguments)) = spec.command.split_first() else {
            return Ok(Self {
                poses: read(std::io::stdin(), inbox, spec.latency_s)?,
                commands: Box::new(std::io::stdout()),
                child: None,
            });
        };
        let failed = |problem: String| Error::Link {
            peer: spec.name(),
            problem,
            help: "check `command` in the settings of the link".to_owned(),
        };
        let starts = serde_json::to_string(starts).unwrap_or_default();
        let mut command = Command::new(program);
        command
            .args(arguments)
            .env("DRIVEKIT_STARTS", starts)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped());
        // Ctrl-C is for this program, which then tells the robots to stand: theirs must live to hear it.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let child = command.spawn();
        let mut child = child.map_err(|source| failed(source.to_string()))?;
        let pipes = child.stdin.take().zip(child.stdout.take());
        let child = Some(Running(child));
        let (stdin, stdout) = pipes.ok_or_else(|| failed("no pipes".to_owned()))?;
        Ok(Self {
            poses: read(stdout, inbox, spec.latency_s)?,
            commands: Box::new(stdin),
            child,
        })
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let start = Instant::now();
        while start.elapsed() < PATIENCE {
            match self.0.try_wait() {
                Ok(None) => std::thread::sleep(Duration::from_millis(10)),
                _ => return,
            }
        }
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Reads to the end of the stream.
fn read(
    stream: impl Read + Send + 'static,
    inbox: Inbox,
    latency_s: f64,
) -> Result<Receiver, Error> {
    receiver("json poses", inbox, move |inbox| {
        let mut stream = BufReader::new(stream);
        let mut line = Vec::new();
        while !inbox.has_ended() {
            line.clear();
            let longest = LONGEST as u64 + 1;
            let bytes = stream.by_ref().take(longest).read_until(b'\n', &mut line);
            let arrival_s = inbox.clock().now_s();
            match bytes {
                Ok(0) | Err(_) => return,
                Ok(_) => inbox.packet(),
            }
            if line.last() != Some(&b'\n') {
                inbox.dropped(Dropped::Malformed);
            } else if !line.iter().all(u8::is_ascii_whitespace) {
                take(inbox, arrival_s, &line, latency_s, None);
            }
        }
    })
}
