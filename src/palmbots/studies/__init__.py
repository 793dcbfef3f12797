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
else:
    __getattr__, __dir__ = lazy_names(__name__)
