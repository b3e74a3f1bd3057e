//! Progress, cancellation and memory, shared between the thread that works and those that watch.

use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use spectral_tv_system::{Ration, keep_a_little};

use crate::error::{Error, Result};
use crate::memory;

/// Steps in which the fraction done is counted.
const RESOLUTION: f64 = 1e6;

/// Items of a pass that are worked on without a look at the request: less than a millisecond.
const UNCHECKED: usize = 1 << 14;

/// The least that is set aside for work to end on, in bytes: what threads take that are used once.
const LEAST_RATION: u64 = 1 << 24;

/// Bytes that need nothing set aside but what is kept for all.
const SMALL: u64 = 1 << 20;

/// A fraction of work done and a request to stop; lock-free, so that watching costs nothing. And
/// what memory the work was granted.
#[derive(Debug, Default)]
pub struct Monitor {
    fraction: AtomicU32,
    cancelled: AtomicBool,
    stopped: AtomicBool,
    granted: AtomicU64,
    /// Whether the work has taken more memory than there is, and goes on by what was set aside.
    ran_out: Arc<AtomicBool>,
    claim: Mutex<Option<Claim>>,
}

/// What work was granted memory for.
#[derive(Debug)]
struct Claim {
    what: String,
    advice: String,
    /// Held for as long as the work may take; `None` for little.
    ration: Option<Ration>,
}

impl Monitor {
    /// A monitor at 0, not cancelled.
    pub fn new() -> Self {
        Self::default()
    }

    /// The fraction of the work done, in [0, 1].
    pub fn fraction(&self) -> f64 {
        f64::from(self.fraction.load(Ordering::Relaxed)) / RESOLUTION
    }

    /// Asks the work to stop at its next check.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Refuses to go on once cancelled, or out of memory.
    ///
    /// # Errors
    /// [`Error::Cancelled`]; [`Error::Memory`] once the system had no more.
    pub fn check(&self) -> Result<()> {
        if self.cancelled.load(Ordering::Relaxed) {
            self.stopped.store(true, Ordering::Relaxed);
            return Err(Error::Cancelled);
        }
        match self.ran_out.load(Ordering::Relaxed) {
            true => Err(self.shortage()),
            false => Ok(()),
        }
    }

    #[cold]
    fn shortage(&self) -> Error {
        let claim = self.claim.lock().unwrap_or_else(PoisonError::into_inner);
        let (what, advice) = match &*claim {
            Some(claim) => (&*claim.what, &*claim.advice),
            None => ("the work", "take less"),
        };
        Error::Memory(format!("{what} took more memory than there is; {advice}"))
    }

    /// Grants the work `needed` bytes in all, and sets a reserve aside. If memory runs out all the
    /// same, the work gets to its next check on the reserve, and ends there. Refuses if the system
    /// does not promise both. What was granted before is not asked for again. `what` begins the
    /// message, `advice` ends it.
    ///
    /// # Errors
    /// [`Error::Memory`].
    pub fn claim(&self, needed: u64, what: &str, advice: &str) -> Result<()> {
        if needed <= self.granted.load(Ordering::Relaxed) {
            return Ok(());
        }
        let refusal = || memory::refusal(needed, what, advice);
        let mut claim = self.claim.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(former) = claim.as_mut() {
            former.ration = None;
        }
        let ration = match needed {
            ..SMALL => keep_a_little().then_some(None),
            // Half as much suffices to get from anywhere in the work to its next check.
            _ => {
                keep_a_little();
                let bytes = usize::try_from((needed / 2).max(LEAST_RATION)).ok();
                bytes.and_then(|bytes| Ration::new(bytes, Arc::clone(&self.ran_out)).map(Some))
            }
        };
        let ration = ration.ok_or_else(refusal)?;
        memory::check_promise(needed, what, advice)?;
        *claim = Some(Claim {
            what: what.into(),
            advice: advice.into(),
            ration,
        });
        self.granted.store(needed, Ordering::Relaxed);
        Ok(())
    }

    /// The same, and refuses if fewer are available, however much the system promises.
    ///
    /// # Errors
    /// [`Error::Memory`].
    pub fn require(&self, needed: u64, what: &str, advice: &str) -> Result<()> {
        if needed > self.granted.load(Ordering::Relaxed) {
            memory::check(needed, what, advice)?;
        }
        self.claim(needed, what, advice)
    }

    /// Gives back what was set aside: the work has ended.
    pub fn end(&self) {
        *self.claim.lock().unwrap_or_else(PoisonError::into_inner) = None;
        self.granted.store(0, Ordering::Relaxed);
    }

    /// Whether the work has seen that it is cancelled. Then all that it still does is to free its
    /// memory.
    pub fn has_stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }

    /// The part [`from`, `to`] of the whole, to be handed to one stage of the work.
    pub fn stage(&self, from: f64, to: f64) -> Stage<'_> {
        Stage {
            monitor: self,
            from,
            to,
        }
    }

    /// The whole as one stage.
    pub fn whole(&self) -> Stage<'_> {
        self.stage(0.0, 1.0)
    }
}

/// A share of a [`Monitor`]'s range, reported to from 0 to 1 by one stage of the work.
#[derive(Debug, Clone, Copy)]
pub struct Stage<'a> {
    monitor: &'a Monitor,
    from: f64,
    to: f64,
}

impl Stage<'_> {
    /// Records that `fraction` of this stage is done.
    ///
    /// # Errors
    /// As [`Monitor::check`].
    pub fn report(&self, fraction: f64) -> Result<()> {
        let overall = self.from + (self.to - self.from) * fraction.clamp(0.0, 1.0);
        let counted = (overall * RESOLUTION) as u32;
        self.monitor.fraction.store(counted, Ordering::Relaxed);
        self.check()
    }

    /// Refuses to go on once cancelled, or out of memory.
    ///
    /// # Errors
    /// As [`Monitor::check`].
    pub fn check(&self) -> Result<()> {
        self.monitor.check()
    }

    /// Has the work granted `needed` bytes, if they are available.
    ///
    /// # Errors
    /// As [`Monitor::require`].
    pub fn require(&self, needed: u64, what: &str, advice: &str) -> Result<()> {
        self.monitor.require(needed, what, advice)
    }

    /// Has short work granted `needed` bytes, without a look at how much is available.
    ///
    /// # Errors
    /// As [`Monitor::claim`].
    pub fn claim(&self, needed: u64, what: &str, advice: &str) -> Result<()> {
        self.monitor.claim(needed, what, advice)
    }

    /// Does one part of the work, unless cancelled before.
    ///
    /// # Errors
    /// As [`Monitor::check`].
    pub fn pass<T>(&self, work: impl FnOnce() -> T) -> Result<T> {
        self.check()?;
        Ok(work())
    }

    /// Does `work` on every item, unless cancelled meanwhile: for passes over millions of them.
    ///
    /// # Errors
    /// As [`Monitor::check`].
    pub fn for_each<T>(
        &self,
        items: impl IntoIterator<Item = T>,
        mut work: impl FnMut(T),
    ) -> Result<()> {
        for (index, item) in items.into_iter().enumerate() {
            if index % UNCHECKED == 0 {
                self.check()?;
            }
            work(item);
        }
        Ok(())
    }

    /// The part [`from`, `to`] of this stage.
    pub fn stage(&self, from: f64, to: f64) -> Self {
        let width = self.to - self.from;
        Self {
            monitor: self.monitor,
            from: self.from + width * from,
            to: self.from + width * to,
        }
    }

    /// One of `count` equal parts of this stage, from 0.
    pub fn part(&self, index: usize, count: usize) -> Self {
        let end = |index: usize| index as f64 / count as f64;
        self.stage(end(index), end(index + 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pass_ends_within_a_few_thousand_items_of_being_cancelled() {
        let monitor = Monitor::new();
        let mut done = 0;
        let outcome = monitor.whole().for_each(0..10 * UNCHECKED, |item| {
            done += 1;
            if item == UNCHECKED {
                monitor.cancel();
            }
        });
        assert!(matches!(outcome, Err(Error::Cancelled)));
        assert!(monitor.has_stopped());
        assert!(done <= 2 * UNCHECKED);
    }

    #[test]
    fn work_that_is_granted_memory_ends_where_it_runs_out() {
        let monitor = Monitor::new();
        let stage = monitor.whole();
        let (what, advice) = ("this work", "take less");
        stage.require(1 << 20, what, advice).unwrap();
        stage.claim(1 << 10, "less", advice).unwrap();
        stage.check().unwrap();
        let refused = [
            stage.require(1 << 60, what, advice),
            stage.claim(u64::MAX, what, advice),
        ];
        for outcome in refused {
            assert!(matches!(outcome, Err(Error::Memory(text)) if text.starts_with("this work")));
        }
        stage.check().unwrap();
        monitor.ran_out.store(true, Ordering::Relaxed);
        let expected = "this work took more memory than there is; take less";
        assert_eq!(stage.check(), Err(Error::Memory(expected.into())));
        assert!(!monitor.has_stopped());
    }

    #[test]
    fn a_stage_covers_its_share_of_the_whole() {
        let monitor = Monitor::new();
        let stage = monitor.stage(0.2, 0.6).stage(0.5, 1.0);
        stage.report(0.5).unwrap();
        assert!((monitor.fraction() - 0.5).abs() < 1e-5);
        let mut sum = 0;
        stage.for_each(1..=4, |item| sum += item).unwrap();
        assert_eq!(sum, 10);
    }
}
