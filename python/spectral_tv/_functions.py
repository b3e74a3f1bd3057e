"""What of the package is read when it is first asked for: the functions, and their results.

To read it takes longer than all else, as the documentation of functions is made of their options.
"""

# ruff: noqa: F401 - the package passes all of it on
# mypy: implicit-reexport

from spectral_tv._accuracy import accuracy, start_accuracy
from spectral_tv._bars import progress_bar
from spectral_tv._caricature import caricature, start_caricature
from spectral_tv._carry import Carried, carry
from spectral_tv._cosegment import cosegment, start_cosegment
from spectral_tv._decompose import (
    decompose,
    default_base_time,
    default_scales,
    estimate,
    graded_times,
    start_decompose,
)
from spectral_tv._deform import deform, start_deform
from spectral_tv._eigen import eigenpairs, eigenset_test, start_eigenset_test
from spectral_tv._flow import conformal_flow, flow, start_flow
from spectral_tv._guard import (
    folds,
    safe_displacement,
    self_intersections,
    start_safe_displacement,
    start_self_intersections,
)
from spectral_tv._image import decompose_image, start_decompose_image
from spectral_tv._pose import pose, start_pose
from spectral_tv._results import (
    Accuracy,
    Deformation,
    EigensetTest,
    Estimate,
    Findings,
    Folds,
    Pose,
    Rig,
    SafeDisplacement,
)
from spectral_tv._rig import rig, start_rig
from spectral_tv._sequence import decompose_sequence
from spectral_tv._surfaces import in_kind
from spectral_tv._thickness import start_thickness, thickness
from spectral_tv._threads import use_threads
from spectral_tv._transfer import Transfer, transfer
