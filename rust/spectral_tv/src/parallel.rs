//! Work that threads share: how much each takes at a time, and sums that do not depend on the
//! number of threads.

use std::ops::Range;

use ndarray::{Array2, ArrayView2, ArrayViewMut2, Axis, Slice};
use rayon::prelude::*;

/// Elements of which one thread adds up one part of a sum. Another number rounds sums otherwise.
const CHUNK: usize = 1 << 13;

/// Elements that are worth handing to another thread.
const SHARE: usize = 1 << 12;

/// The values of a function of 0 … `count` − 1, in order.
pub(crate) fn values<T: Send>(count: usize, value: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    map(0..count, value)
}

/// The images of all items, in order.
pub(crate) fn map<I, T: Send>(items: I, image: impl Fn(I::Item) -> T + Sync + Send) -> Vec<T>
where
    I: IntoParallelIterator<Iter: IndexedParallelIterator>,
{
    let items = items.into_par_iter().with_min_len(SHARE);
    items.map(image).collect()
}

/// `values` after `change`, which threads do part by part.
pub(crate) fn changed(values: &[f64], change: impl Fn(&mut [f64]) + Sync + Send) -> Vec<f64> {
    let mut result = filled(0.0, values.len());
    let parts = result.par_chunks_mut(SHARE).zip(values.par_chunks(SHARE));
    parts.for_each(|(result, values)| {
        result.copy_from_slice(values);
        change(result);
    });
    result
}

/// `count` times the same value. All threads write it: memory that an allocator has cleared, on one thread, may
/// besides be one shared page of zeros, which is copied where something is added to it.
pub(crate) fn filled<T: Copy + Send + Sync>(value: T, count: usize) -> Vec<T> {
    values(count, |_| value)
}

/// Zeros of the given shape, of which the same is true.
pub(crate) fn zeros<T: Copy + Send + Sync + Default>(shape: (usize, usize)) -> Array2<T> {
    let zeros = filled(T::default(), shape.0 * shape.1);
    Array2::from_shape_vec(shape, zeros).expect("as many as it has")
}

/// Does `work` on every item.
pub(crate) fn for_each<I>(items: I, work: impl Fn(I::Item) + Sync + Send)
where
    I: IntoParallelIterator<Iter: IndexedParallelIterator>,
{
    items.into_par_iter().with_min_len(SHARE).for_each(work);
}

/// What each chunk of 0 … `count` − 1 gives, in order.
pub(crate) fn parts<T: Send>(
    count: usize,
    part: impl Fn(Range<usize>) -> T + Sync + Send,
) -> Vec<T> {
    let chunks = (0..count.div_ceil(CHUNK)).into_par_iter();
    let range = |chunk: usize| chunk * CHUNK..count.min((chunk + 1) * CHUNK);
    chunks.map(|chunk| part(range(chunk))).collect()
}

/// The sum of what each chunk of 0 … `count` − 1 gives, added up in order.
pub(crate) fn sum(count: usize, part: impl Fn(Range<usize>) -> f64 + Sync + Send) -> f64 {
    parts(count, part).iter().sum()
}

/// The largest of what each chunk of 0 … `count` − 1 gives, and 0.
pub(crate) fn largest(count: usize, part: impl Fn(Range<usize>) -> f64 + Sync + Send) -> f64 {
    parts(count, part).into_iter().fold(0.0, f64::max)
}

/// Parts of the given `range` that one thread works on at a time.
pub(crate) fn split(range: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    let end = range.end;
    range
        .step_by(CHUNK)
        .map(move |start| start..end.min(start + CHUNK))
}

/// Some columns of an array.
pub(crate) fn columns<'a, T>(array: ArrayView2<'a, T>, range: Range<usize>) -> ArrayView2<'a, T> {
    array.slice_axis_move(Axis(1), Slice::from(range))
}

/// The columns of an array, a chunk at a time: where each chunk begins and itself.
pub(crate) fn columns_mut<'a, T: Send + Sync>(
    array: &'a mut ArrayViewMut2<T>,
) -> impl IndexedParallelIterator<Item = (usize, ArrayViewMut2<'a, T>)> {
    let chunks = array.axis_chunks_iter_mut(Axis(1), CHUNK).into_par_iter();
    chunks
        .enumerate()
        .map(|(chunk, columns)| (chunk * CHUNK, columns))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    fn on(threads: usize, work: impl FnOnce() -> Vec<f64> + Send) -> Vec<f64> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(work)
    }

    #[test]
    fn sums_are_the_same_on_any_number_of_threads() {
        let terms = values(5 * CHUNK + 7, |k| 1.0 / (1 + k) as f64);
        let total = || {
            let of = |part: Range<usize>| terms[part].iter().sum::<f64>();
            vec![sum(terms.len(), of), largest(terms.len(), of)]
        };
        let alone = on(1, total);
        assert_eq!(alone, on(3, total));
        assert!((alone[0] - terms.iter().sum::<f64>()).abs() < 1e-12);
    }

    #[test]
    fn every_element_is_in_one_part() {
        for count in [0, 1, CHUNK - 1, CHUNK, CHUNK + 1, 3 * CHUNK] {
            let found: Vec<usize> = parts(count, |part| part).into_iter().flatten().collect();
            assert!(found.into_iter().eq(0..count));
            assert!(split(5..5 + count).flatten().eq(5..5 + count));
        }
        let mut array = Array2::zeros((2, CHUNK + 3));
        columns_mut(&mut array.view_mut()).for_each(|(first, mut columns)| {
            for (place, mut column) in (first..).zip(columns.columns_mut()) {
                column.fill(place);
            }
        });
        assert!(array.row(1).into_iter().copied().eq(0..CHUNK + 3));
    }
}
