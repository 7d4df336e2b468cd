//! What the machine leaves to a process: its memory, and the limits that the system sets.

use crate::Limits;

/// The most memory that a program takes unasked.
const MOST: u64 = 8 << 30;

/// Half of the memory that the process may have, as far as the system says it.
///
/// On Linux that is the least of the machine's memory, the control group's and the address space; elsewhere
/// [`Limits::USUAL`] is all that is known.
pub fn usual_memory() -> u64 {
    let known = [machine(), control_group(), address_space()];
    known.into_iter().flatten().min().map_or(Limits::USUAL.memory, |bytes| (bytes / 2).min(MOST))
}

fn machine() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    number_after(&text, "MemTotal:").map(|kilobytes| kilobytes << 10)
}

fn control_group() -> Option<u64> {
    let text = std::fs::read_to_string("/sys/fs/cgroup/memory.max").ok()?;
    text.trim().parse().ok()
}

fn address_space() -> Option<u64> {
    number_after(&std::fs::read_to_string("/proc/self/limits").ok()?, "Max address space")
}

/// The number that follows a word; `None` for "unlimited".
fn number_after(text: &str, word: &str) -> Option<u64> {
    text.lines().find_map(|line| line.strip_prefix(word))?.split_whitespace().next()?.parse().ok()
}
