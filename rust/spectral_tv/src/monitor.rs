//! Progress and cancellation, shared between the thread that works and those that watch.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use crate::error::{Error, Result};

/// Steps in which the fraction done is counted.
const RESOLUTION: f64 = 1e6;

/// Items of a pass that are worked on without a look at the request: less than a millisecond.
const UNCHECKED: usize = 1 << 14;

/// A fraction of work done and a request to stop; lock-free, so that watching costs nothing.
#[derive(Debug, Default)]
pub struct Monitor {
    fraction: AtomicU32,
    cancelled: AtomicBool,
    stopped: AtomicBool,
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

    /// Refuses to go on once cancelled.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    pub fn check(&self) -> Result<()> {
        if self.cancelled.load(Ordering::Relaxed) {
            self.stopped.store(true, Ordering::Relaxed);
            return Err(Error::Cancelled);
        }
        Ok(())
    }

    /// Whether the work has seen that it is cancelled: all that it still does is to free what it
    /// took.
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
    /// [`Error::Cancelled`] once the monitor was cancelled.
    pub fn report(&self, fraction: f64) -> Result<()> {
        let overall = self.from + (self.to - self.from) * fraction.clamp(0.0, 1.0);
        let counted = (overall * RESOLUTION) as u32;
        self.monitor.fraction.store(counted, Ordering::Relaxed);
        self.check()
    }

    /// Refuses to go on once cancelled.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    pub fn check(&self) -> Result<()> {
        self.monitor.check()
    }

    /// Does `work` on every item, unless cancelled meanwhile: for passes over millions of them.
    ///
    /// # Errors
    /// [`Error::Cancelled`] once the monitor was cancelled.
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
