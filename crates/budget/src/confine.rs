//! Confinement of the process that runs untrusted programs: operating system limits, and
//! termination with its parent.
//! The budget ends work with an error; these limits also hold for code that does not check the
//! budget. The engine of the workbench starts with this call.

use crate::{Limits, limits, set_limits};

/// Address space that a process needs besides models: code, thread stacks, allocator overhead.
#[cfg(unix)]
const OWN: u64 = 2 << 30;

/// Maximum time between the end of the parent process and that of this one.
#[cfg(unix)]
const LOOK: std::time::Duration = std::time::Duration::from_millis(500);

/// Confines this process: at most `memory` bytes for models, no writing of files, no core dump, and
/// termination with the parent. Where the system lacks such a limit, only the budget applies.
/// Standard output and error must be pipes, since writing to a file is denied.
pub fn confine(memory: u64) {
    set_limits(Limits { memory, ..limits() });
    #[cfg(unix)]
    {
        use rlimit::{Resource, setrlimit};
        let space = memory.saturating_add(OWN);
        for (what, most) in [(Resource::AS, space), (Resource::CORE, 0), (Resource::FSIZE, 0)] {
            // A lower existing limit stays: it cannot be raised.
            let _ = setrlimit(what, most, most);
        }
        // Running work continues after the end of its input, but not without a parent.
        let parent = std::os::unix::process::parent_id();
        let watch = move || {
            while std::os::unix::process::parent_id() == parent {
                std::thread::sleep(LOOK);
            }
            std::process::exit(0);
        };
        // If this thread cannot be created, none can be for a model.
        let _ = std::thread::Builder::new().stack_size(256 << 10).spawn(watch);
    }
}
