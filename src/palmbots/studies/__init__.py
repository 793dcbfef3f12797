# SPDX-License-Identifier: Apache-2.0
"""Studies: many carries over scene keys, controllers and seeds, stored chunk by chunk.

Modules, in the order of a study:

- axes, designs, study_file, points: what is asked, down to the scene at a point
- variables, exact_sums, statistics, stopping, sobol: what is stored and computed
- chunking, chunk_task: what a chunk of carries is, and how it is carried
- zarr_arrays, store, schedule: the chunks on the disk, and which of them are due
- local_runner, dask_runner, study_runner: who carries them
- study_reader, study_figures: the results
"""

from typing import TYPE_CHECKING

from palmbots._util.lazy_names import lazy_names

if TYPE_CHECKING:
    from palmbots.studies.cost_estimate import Cost as Cost
    from palmbots.studies.cost_estimate import estimate_cost as estimate_cost
    from palmbots.studies.points import Points as Points
    from palmbots.studies.points import design_points as design_points
    from palmbots.studies.sobol import SobolIndex as SobolIndex
    from palmbots.studies.sobol import sobol_indices as sobol_indices
    from palmbots.studies.study_file import Plan as Plan
    from palmbots.studies.study_file import StudyLike as StudyLike
    from palmbots.studies.study_file import built_in_studies as built_in_studies
    from palmbots.studies.study_file import load_plan as load_plan
    from palmbots.studies.study_runner import StudyResult as StudyResult
    from palmbots.studies.study_runner import run_study as run_study

__all__ = [
    "Cost",
    "Plan",
    "Points",
    "SobolIndex",
    "StudyLike",
    "StudyResult",
    "built_in_studies",
    "design_points",
    "estimate_cost",
    "load_plan",
    "run_study",
    "sobol_indices",
]

# Loaded on first use: `import palmbots` must not import the modules behind these names.
_PLACES = {
    "Cost": ".cost_estimate",
    "Plan": ".study_file",
    "Points": ".points",
    "SobolIndex": ".sobol",
    "StudyLike": ".study_file",
    "StudyResult": ".study_runner",
    "built_in_studies": ".study_file",
    "design_points": ".points",
    "estimate_cost": ".cost_estimate",
    "load_plan": ".study_file",
    "run_study": ".study_runner",
    "sobol_indices": ".sobol",
}

__getattr__, __dir__ = lazy_names(__name__, _PLACES)
