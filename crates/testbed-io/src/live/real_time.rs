//! Threads that must not wait for others that compute.

use thread_priority::ThreadPriority;

/// Puts the thread into the real-time class, until its end. The system may refuse: on Linux it takes root or a limit `rtprio`; the
/// thread then stays as it is.
#[cfg(unix)]
pub(super) fn into_real_time_class() -> bool {
    use thread_priority::{RealtimeThreadSchedulePolicy, ThreadSchedulePolicy};
    let class = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::RoundRobin);
    let thread = thread_priority::thread_native_id();
    // The lowest of the class: every thread of the normal one waits for it.
    thread_priority::set_thread_priority_and_policy(thread, ThreadPriority::Min, class).is_ok()
}

/// Gives the thread the highest priority, until its end.
#[cfg(not(unix))]
pub(super) fn into_real_time_class() -> bool {
    thread_priority::set_current_thread_priority(ThreadPriority::Max).is_ok()
}
