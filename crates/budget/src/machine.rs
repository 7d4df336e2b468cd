//! Memory of the machine, and limits that the system sets for a process.

use crate::Limits;
use std::time::Duration;

/// Maximum default memory limit, in bytes.
const MOST: u64 = 8 << 30;

/// A quarter of the memory available to the process, if the system reports it; the rest is for
/// memory outside the budget and for other programs.
/// On Linux the available memory is the minimum of machine memory, control group limit and address
/// space; elsewhere the result is that of [`Limits::USUAL`].
pub fn usual_memory() -> u64 {
    let known = [machine(), control_group(), address_space()];
    known.into_iter().flatten().min().map_or(Limits::USUAL.memory, |bytes| (bytes / 4).min(MOST))
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

/// Processor time of all threads of the process; `None` except on Linux.
pub(crate) fn processor_time() -> Option<Duration> {
    /// The unit of the file, on every machine.
    const TICK: Duration = Duration::from_millis(10);
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The program name may contain any character; the fields follow the last parenthesis.
    let (_, fields) = text.rsplit_once(')')?;
    let mut ticks = fields.split_whitespace().skip(11).map(str::parse::<u32>);
    Some(TICK * (ticks.next()?.ok()?.checked_add(ticks.next()?.ok()?)?))
}

/// Bytes that the heap, now `held` large, may have under the system's limit of address space: three
/// quarters of the rest, since stacks and allocator overhead use address space as well.
/// [`u64::MAX`] without a limit.
pub(crate) fn room(held: u64) -> u64 {
    let read = |name| std::fs::read_to_string(name).unwrap_or_default();
    room_of(&read("/proc/self/limits"), &read("/proc/self/status"), held)
}

fn room_of(limits: &str, status: &str, held: u64) -> u64 {
    let Some(space) = number_after(limits, "Max address space") else { return u64::MAX };
    let taken = number_after(status, "VmSize:").unwrap_or(0) << 10;
    held.saturating_add(space.saturating_sub(taken) / 4 * 3)
}

/// The number that follows a word; `None` for "unlimited".
fn number_after(text: &str, word: &str) -> Option<u64> {
    text.lines().find_map(|line| line.strip_prefix(word))?.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_heap_keeps_below_the_address_space() {
        let limits = |space| {
            format!("Max cpu time  unlimited\nMax address space  {space}  {space}  bytes\n")
        };
        let status = "VmPeak:  600 kB\nVmSize:  500 kB\n";
        assert_eq!(room_of(&limits("unlimited"), status, 7), u64::MAX);
        assert_eq!(room_of("", "", 7), u64::MAX);
        assert_eq!(room_of(&limits("912000"), status, 7), 7 + 300_000);
        assert_eq!(room_of(&limits("100000"), status, 7), 7);
    }
}
