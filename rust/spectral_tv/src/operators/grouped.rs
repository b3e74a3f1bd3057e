//! Groups places by the keys that stand there.

use crate::error::Result;
use crate::monitor::Stage;

/// The places of each of the `count` keys in `keys`, one after the other, and where each key's
/// begin.
pub(crate) fn grouped(keys: &[u32], count: usize, stage: Stage) -> Result<(Vec<u32>, Vec<u32>)> {
    let mut starts = vec![0_u32; count + 1];
    stage.for_each(keys, |&key| starts[key as usize + 1] += 1)?;
    for key in 0..count {
        starts[key + 1] += starts[key];
    }
    let mut next = starts.clone();
    let mut places = vec![0; keys.len()];
    stage.for_each(keys.iter().enumerate(), |(place, &key)| {
        places[next[key as usize] as usize] = place as u32;
        next[key as usize] += 1;
    })?;
    Ok((starts, places))
}
