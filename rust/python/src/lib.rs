//! Python bindings: NumPy in, NumPy out, the work in a thread without the GIL.

mod accuracy;
mod arrays;
mod caricature;
mod decomposition;
mod deformation;
mod deformer;
mod eigenpairs;
mod eigenset;
mod error;
mod estimate;
mod findings;
mod flow;
mod flowing;
mod image;
mod job;
mod mesh;
mod parameters;
mod pickling;
mod segmentation;
mod settings;
mod threads;

use pyo3::prelude::*;
use spectral_tv::solver::warm_up;
use spectral_tv_system::{Heap, keep_a_little};

#[global_allocator]
static HEAP: Heap = Heap;

/// Native part of the package `spectral_tv`.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    keep_a_little();
    warm_up();
    let py = module.py();
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    error::prepare(py)?;
    module.add("MeshError", py.get_type::<error::MeshError>())?;
    module.add("MeshWarning", py.get_type::<error::MeshWarning>())?;
    module.add("Cancelled", py.get_type::<error::Cancelled>())?;
    module.add_class::<mesh::Mesh>()?;
    module.add_class::<findings::Findings>()?;
    module.add_class::<flow::Flow>()?;
    module.add_class::<decomposition::Decomposition>()?;
    module.add_class::<accuracy::Accuracy>()?;
    module.add_class::<deformation::Deformation>()?;
    module.add_class::<deformer::Deformer>()?;
    module.add_class::<eigenset::EigensetTest>()?;
    module.add_class::<estimate::Estimate>()?;
    module.add_class::<job::Job>()?;
    module.add_function(wrap_pyfunction!(accuracy::accuracy, module)?)?;
    module.add_function(wrap_pyfunction!(accuracy::start_accuracy, module)?)?;
    module.add_function(wrap_pyfunction!(caricature::caricature, module)?)?;
    module.add_function(wrap_pyfunction!(caricature::start_caricature, module)?)?;
    module.add_function(wrap_pyfunction!(decomposition::decompose, module)?)?;
    module.add_function(wrap_pyfunction!(decomposition::start_decompose, module)?)?;
    module.add_function(wrap_pyfunction!(deformation::deform, module)?)?;
    module.add_function(wrap_pyfunction!(deformation::start_deform, module)?)?;
    module.add_function(wrap_pyfunction!(eigenpairs::eigenpairs, module)?)?;
    module.add_function(wrap_pyfunction!(eigenset::eigenset_test, module)?)?;
    module.add_function(wrap_pyfunction!(eigenset::start_eigenset_test, module)?)?;
    module.add_function(wrap_pyfunction!(estimate::estimate, module)?)?;
    module.add_function(wrap_pyfunction!(flowing::flow, module)?)?;
    module.add_function(wrap_pyfunction!(flowing::start_flow, module)?)?;
    module.add_function(wrap_pyfunction!(flowing::conformal_flow, module)?)?;
    module.add_function(wrap_pyfunction!(flowing::total_variation, module)?)?;
    module.add_function(wrap_pyfunction!(image::decompose_image, module)?)?;
    module.add_function(wrap_pyfunction!(image::start_decompose_image, module)?)?;
    module.add_function(wrap_pyfunction!(segmentation::cosegment, module)?)?;
    module.add_function(wrap_pyfunction!(segmentation::start_cosegment, module)?)?;
    module.add_function(wrap_pyfunction!(settings::default_base_time, module)?)?;
    module.add_function(wrap_pyfunction!(settings::default_scales, module)?)?;
    module.add_function(wrap_pyfunction!(settings::graded_times, module)?)?;
    module.add_function(wrap_pyfunction!(threads::set_threads, module)?)?;
    module.add_function(wrap_pyfunction!(threads::threads, module)?)?;
    module.add_function(wrap_pyfunction!(threads::_use_threads, module)?)?;
    module.add_function(wrap_pyfunction!(pickling::_restore, module)?)?;
    Ok(())
}
