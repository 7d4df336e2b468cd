//! Counts of the allocator, limits and cancellation.

use moldloft_budget::{Budget, Counting, FLUSH, Limits, Spent, held, limits, set_limits, settle};
use std::sync::{Mutex, MutexGuard, PoisonError};

#[global_allocator]
static ALLOCATOR: Counting = Counting::new();

/// Limits and counts are the process's: one test at a time.
fn alone() -> MutexGuard<'static, ()> {
    static LOCK: Mutex<()> = Mutex::new(());
    LOCK.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Puts the limits back.
struct Restored(Limits);

impl Drop for Restored {
    fn drop(&mut self) {
        set_limits(self.0);
    }
}

/// What the test program itself may hold more or less, and each thread's own count.
const SLACK: u64 = 8 * FLUSH as u64;

#[test]
fn bytes_are_counted() {
    let _alone = alone();
    let before = held();
    let block = vec![1u8; 10 << 20];
    assert!(held().abs_diff(before + (10 << 20)) < SLACK);
    let mut grown = block;
    grown.reserve_exact(20 << 20);
    assert!(held().abs_diff(before + (30 << 20)) < SLACK);
    drop(grown);
    assert!(held().abs_diff(before) < SLACK);
    let zeros = vec![0u64; 1 << 20];
    assert!(held().abs_diff(before + (8 << 20)) < SLACK);
    drop(zeros);
}

#[test]
fn blocks_may_be_freed_by_other_threads() {
    let _alone = alone();
    let before = held();
    for _ in 0..20 {
        let blocks: Vec<Vec<u8>> = (0..100).map(|_| vec![1; 50_000]).collect();
        let free = move || {
            drop(blocks);
            settle();
        };
        std::thread::spawn(free).join().unwrap();
    }
    assert!(held().abs_diff(before) < SLACK);
}

#[test]
fn memory_is_limited() {
    let _alone = alone();
    let _limits = Restored(limits());
    let budget = Budget::default();
    set_limits(Limits { memory: held() + (1 << 20), ..limits() });
    assert_eq!(budget.grow(1 << 10), Ok(()));
    assert!(matches!(budget.grow(1 << 22), Err(Spent::Memory { .. })));
    let block = vec![0u8; 4 << 20];
    let spent = budget.poll().unwrap_err();
    assert_eq!(spent.id(), "out-of-memory");
    assert!(Spent::is_id(spent.id()));
    drop(block);
    assert_eq!(budget.poll(), Ok(()));
    assert!(matches!(budget.grow(u64::MAX), Err(Spent::Memory { needed: u64::MAX, .. })));
}

#[test]
fn time_is_limited_while_it_is_counted() {
    let _alone = alone();
    let _limits = Restored(limits());
    let budget = Budget::default();
    set_limits(Limits { seconds: 0.0, ..limits() });
    assert_eq!(budget.poll(), Ok(()));
    {
        let _timed = budget.timed();
        std::thread::sleep(std::time::Duration::from_millis(2));
        assert_eq!(budget.poll(), Err(Spent::Time { allowed: 0.0 }));
    }
    assert_eq!(budget.poll(), Ok(()));
    for endless in [f64::INFINITY, f64::NAN, -1.0] {
        set_limits(Limits { seconds: endless, ..limits() });
        let _timed = budget.timed();
        assert_eq!(budget.poll(), Ok(()));
    }
}

#[test]
fn a_cancelled_budget_can_be_used_again() {
    let _alone = alone();
    let budget = Budget::default();
    budget.cancel();
    assert!(budget.is_spent());
    assert_eq!(budget.poll(), Err(Spent::Cancelled));
    budget.resume();
    assert_eq!(budget.poll(), Ok(()));
}
