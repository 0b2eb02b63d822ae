//! Commands that nobody gets.

use std::time::Duration;

use super::{Command, CommandCounts, CommandSink, Silence};

/// For recordings: what would have been commanded is in the run log.
#[derive(Debug, Clone, Copy)]
pub(in crate::live) struct Nowhere;

impl CommandSink for Nowhere {
    fn send(&mut self, _commands: &[Command]) {}

    fn stop(&mut self, _patience: Duration) -> Vec<usize> {
        Vec::new()
    }

    fn silence(&self) -> Option<Silence> {
        None
    }

    fn counts(&self) -> CommandCounts {
        CommandCounts::default()
    }
}
