//! What the operating system is asked for: memory, and how much of it is free.
//!
//! All unsafe code of the project is here: an allocator ([`Heap`]) in front of the system's, and
//! the foreign functions that tell how much memory is free, where no file tells it.

mod heap;
mod pages;
mod physical;
mod ration;
mod reuse;

pub use heap::{Heap, give_back, largest_of_pages};
pub use physical::free_memory;
pub use ration::{Ration, is_promised, keep_a_little, room};
pub use reuse::Reuse;
