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
mod flow;
mod flowing;
mod guard;
mod handles;
mod image;
mod job;
mod mesh;
mod nearest;
mod owned;
mod parameters;
mod pickling;
mod poser;
mod posing;
mod results;
mod rig;
mod segmentation;
mod settings;
mod shape;
mod thickness;
mod threads;

use pyo3::prelude::*;
use spectral_tv::guard::DEFAULT_STRETCH;
use spectral_tv::solver::warm_up;
use spectral_tv_system::{Heap, keep_a_little};

#[global_allocator]
static HEAP: Heap = Heap;

/// Native part of the package `spectral_tv`.
///
/// Objects are frozen, and what changes in them is behind locks of their own: no GIL is needed.
#[pymodule(gil_used = false)]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    keep_a_little();
    warm_up();
    let py = module.py();
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("_POSING", posing::defaults(py)?)?;
    module.add("_STRETCH", DEFAULT_STRETCH)?;
    error::prepare(py)?;
    module.add("MeshError", py.get_type::<error::MeshError>())?;
    module.add("MeshWarning", py.get_type::<error::MeshWarning>())?;
    module.add("Cancelled", py.get_type::<error::Cancelled>())?;
    module.add_class::<mesh::Mesh>()?;
    module.add_class::<nearest::Nearest>()?;
    module.add_class::<flow::Flow>()?;
    module.add_class::<decomposition::Decomposition>()?;
    module.add_class::<deformer::Deformer>()?;
    module.add_class::<poser::Poser>()?;
    module.add_class::<job::Job>()?;
    for function in [
        wrap_pyfunction!(accuracy::start_accuracy, module)?,
        wrap_pyfunction!(caricature::start_caricature, module)?,
        wrap_pyfunction!(decomposition::start_decompose, module)?,
        wrap_pyfunction!(deformation::start_deform, module)?,
        wrap_pyfunction!(eigenpairs::start_eigenpairs, module)?,
        wrap_pyfunction!(eigenset::start_eigenset_test, module)?,
        wrap_pyfunction!(estimate::estimate, module)?,
        wrap_pyfunction!(flowing::start_conformal_flow, module)?,
        wrap_pyfunction!(flowing::start_flow, module)?,
        wrap_pyfunction!(flowing::suiting_elements, module)?,
        wrap_pyfunction!(flowing::total_variation, module)?,
        wrap_pyfunction!(guard::folds, module)?,
        wrap_pyfunction!(guard::start_safe_displacement, module)?,
        wrap_pyfunction!(guard::start_self_intersections, module)?,
        wrap_pyfunction!(image::start_decompose_image, module)?,
        wrap_pyfunction!(posing::start_pose, module)?,
        wrap_pyfunction!(pickling::_reduced, module)?,
        wrap_pyfunction!(pickling::_restore, module)?,
        wrap_pyfunction!(rig::start_rig, module)?,
        wrap_pyfunction!(segmentation::start_cosegment, module)?,
        wrap_pyfunction!(settings::_facts, module)?,
        wrap_pyfunction!(settings::default_base_time, module)?,
        wrap_pyfunction!(settings::default_scales, module)?,
        wrap_pyfunction!(settings::graded_times, module)?,
        wrap_pyfunction!(thickness::start_thickness, module)?,
        wrap_pyfunction!(threads::_use_threads, module)?,
        wrap_pyfunction!(threads::set_threads, module)?,
        wrap_pyfunction!(threads::threads, module)?,
    ] {
        module.add_function(function)?;
    }
    // The package says what is public.
    module.delattr("__all__")
}
