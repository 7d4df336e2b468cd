//! A part of the work of a request, with its own time limit.

use crate::machine::processor_time;
use crate::{Budget, Spent, elapsed};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Default time limit of work on a set (facets, a measure, a picture), in seconds.
/// The smaller of elapsed and processor time counts, so that neither other programs nor other
/// threads use it up. A development build, which is several times slower, gets more.
pub const SET_SECONDS: f64 = if cfg!(debug_assertions) { 60.0 } else { 10.0 };

/// Interval between readings of the processor time.
const LOOK: Duration = Duration::from_millis(20);

/// The time of a part, and the budget of the whole.
#[derive(Debug)]
pub(crate) struct Portion {
    pub whole: Arc<Budget>,
    allowed: Duration,
    /// Processor time of the process at the start of the part; `None` if the system does not report
    /// it.
    before: Option<Duration>,
    /// Time of the next reading of the processor time, in nanoseconds.
    due: AtomicU64,
}

impl Portion {
    pub fn new(whole: Arc<Budget>, seconds: f64) -> Self {
        let allowed = Duration::from_secs_f64(seconds);
        Self {
            whole,
            allowed,
            before: processor_time(),
            due: AtomicU64::new(nanoseconds(elapsed() + allowed)),
        }
    }

    /// Checks that the part and the whole may continue.
    #[inline]
    pub fn poll(&self) -> Result<(), Spent> {
        self.whole.poll()?;
        let now = elapsed();
        if nanoseconds(now) > self.due.load(Ordering::Relaxed) && self.is_over(now) {
            return Err(Spent::Time { allowed: self.allowed.as_secs_f64() });
        }
        Ok(())
    }

    #[cold]
    fn is_over(&self, now: Duration) -> bool {
        let used =
            self.before.zip(processor_time()).map(|(before, now)| now.saturating_sub(before));
        let over = used.is_none_or(|used| used > self.allowed);
        if !over {
            self.due.store(nanoseconds(now + LOOK), Ordering::Relaxed);
        }
        over
    }
}

/// Nanoseconds, saturated at about 580 years.
fn nanoseconds(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_no_time(before: Option<Duration>) -> Portion {
        Portion { before, ..Portion::new(Arc::default(), 0.0) }
    }

    #[test]
    fn a_part_ends_by_its_own_time_and_with_the_whole() {
        for before in [None, Some(Duration::ZERO)] {
            let part = of_no_time(before);
            // The processor time, if known, is that of this process and not zero.
            while part.poll().is_ok() {}
            assert_eq!(part.poll(), Err(Spent::Time { allowed: 0.0 }));
            assert_eq!(part.whole.poll(), Ok(()));
        }
        let long = Portion::new(Arc::default(), 1e6);
        assert_eq!(long.poll(), Ok(()));
        long.whole.cancel();
        assert_eq!(long.poll(), Err(Spent::Cancelled));
    }

    #[test]
    fn time_in_which_others_have_the_processor_is_not_used_up() {
        if processor_time().is_some() {
            let part = of_no_time(Some(Duration::MAX));
            assert!((0..1000).all(|_| part.poll().is_ok()));
        }
    }
}
