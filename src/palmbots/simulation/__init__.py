# SPDX-License-Identifier: Apache-2.0
"""One carry, many carries, a sweep, rare events; the worlds and the results.

`palmbots` exports the functions that run carries; this room exports the types of their results,
batches of carries, whether a drop could have been prevented, palms that a program moves
(`FloorWorld`), and what registers a world.
"""

from typing import TYPE_CHECKING

from palmbots._util.lazy_names import lazy_names

if TYPE_CHECKING:
    from palmbots.simulation.batch import run_batch as run_batch
    from palmbots.simulation.batch import run_seeds as run_seeds
    from palmbots.simulation.final_place import FinalPlace as FinalPlace
    from palmbots.simulation.floor_world import FloorState as FloorState
    from palmbots.simulation.floor_world import FloorWorld as FloorWorld
    from palmbots.simulation.noise_limit import NoiseLimit as NoiseLimit
    from palmbots.simulation.noise_limit import NoisePoint as NoisePoint
    from palmbots.simulation.outcome_counts import OutcomeCounts as OutcomeCounts
    from palmbots.simulation.outcome_counts import SceneStatistics as SceneStatistics
    from palmbots.simulation.outcome_counts import better_controllers as better_controllers
    from palmbots.simulation.outcome_counts import count_outcomes as count_outcomes
    from palmbots.simulation.prepare import Prepared as Prepared
    from palmbots.simulation.rare_events import DropRate as DropRate
    from palmbots.simulation.result import Carry as Carry
    from palmbots.simulation.result import ContactEvent as ContactEvent
    from palmbots.simulation.result import Correction as Correction
    from palmbots.simulation.result import LinkStatistics as LinkStatistics
    from palmbots.simulation.result import Message as Message
    from palmbots.simulation.sweep import Comparison as Comparison
    from palmbots.simulation.sweep import Refusal as Refusal
    from palmbots.simulation.sweep import Row as Row
    from palmbots.simulation.unavoidable_drops import is_unavoidable as is_unavoidable
    from palmbots.simulation.worlds import WorldEntry as WorldEntry
    from palmbots.simulation.worlds import WorldRun as WorldRun
    from palmbots.simulation.worlds import register_world as register_world
    from palmbots.simulation.worlds import unregister_world as unregister_world
    from palmbots.simulation.worlds import world_names as world_names
else:
    __getattr__, __dir__ = lazy_names(__name__)
