//! Robotarium robots behind a broker.

use std::time::Duration;

use super::{Command, CommandCounts, CommandSink, Silence};
use crate::live::robotarium::Robotarium;

/// The commands' side of the connection to a broker.
#[derive(Debug)]
pub(in crate::live) struct RobotariumCommands {
    broker: Robotarium,
    counts: CommandCounts,
}

impl RobotariumCommands {
    /// Takes the connection over.
    #[must_use]
    pub(in crate::live) fn new(broker: Robotarium) -> Self {
        Self {
            broker,
            counts: CommandCounts::default(),
        }
    }
}

impl CommandSink for RobotariumCommands {
    fn send(&mut self, commands: &[Command]) {
        let sent = if self.broker.connected() {
            &mut self.counts.sent
        } else {
            &mut self.counts.failed
        };
        *sent += commands.len() as u64;
        for command in commands {
            self.broker.send(command.robot, command.speeds);
        }
    }

    fn stop(&mut self, patience: Duration) -> Vec<usize> {
        self.broker.stop(patience)
    }

    fn silence(&self) -> Option<Silence> {
        Some(Silence {
            peer: "the broker".to_owned(),
            for_s: self.broker.disconnected_for_s()?,
        })
    }

    fn counts(&self) -> CommandCounts {
        self.counts
    }
}
