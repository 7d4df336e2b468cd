//! The process that runs foreign texts: what the system lets it use, and its end with the one that started it.
//!
//! The budget ends work by name; these limits hold where no work looks at it. The engine of the workbench begins
//! with this.

use crate::{Limits, limits, set_limits};

/// What a process takes besides models, in address space: the program itself, stacks of its threads, what allocators keep.
#[cfg(unix)]
const OWN: u64 = 2 << 30;

/// How soon a process ends after the one that started it.
#[cfg(unix)]
const LOOK: std::time::Duration = std::time::Duration::from_millis(500);

/// Confines this process: no more memory than that for models, no file written, no core left behind, no life after its
/// parent. Where the system has no such limit, the budget alone holds.
///
/// Its output must be a pipe: a file as standard output or error would be one that is written.
pub fn confine(memory: u64) {
    set_limits(Limits { memory, ..limits() });
    #[cfg(unix)]
    {
        use rlimit::{Resource, setrlimit};
        let space = memory.saturating_add(OWN);
        for (what, most) in [(Resource::AS, space), (Resource::CORE, 0), (Resource::FSIZE, 0)] {
            // A lower limit that was there before stays: it cannot be raised.
            let _ = setrlimit(what, most, most);
        }
        // Work that is under way goes on after its input has ended, but not without a parent.
        let parent = std::os::unix::process::parent_id();
        let watch = move || {
            while std::os::unix::process::parent_id() == parent {
                std::thread::sleep(LOOK);
            }
            std::process::exit(0);
        };
        // Without a thread for this there is none for a model either.
        let _ = std::thread::Builder::new().stack_size(256 << 10).spawn(watch);
    }
}
