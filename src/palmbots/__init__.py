# SPDX-License-Identifier: Apache-2.0
"""palmbots: two mobile robots carry an object between two tilting palms, without grippers.

>>> import palmbots as pb
>>> pb.carry("paper", "distributed", seed=0).outcome
'delivered'
"""

from typing import TYPE_CHECKING as _TYPE_CHECKING

from palmbots._util.lazy_names import lazy_names as _lazy_names
from palmbots._util.offers import offer_entry as _offer_entry
from palmbots._util.offers import offer_module as _offer_module
from palmbots._version import __version__ as __version__

if _TYPE_CHECKING:
    from palmbots import control as control
    from palmbots import learn as learn
    from palmbots import logs as logs
    from palmbots import mechanics as mechanics
    from palmbots import mujoco as mujoco
    from palmbots import optimum as optimum
    from palmbots import simulation as simulation
    from palmbots import stability as stability
    from palmbots import studies as studies
    from palmbots import viz as viz
    from palmbots import wire as wire
    from palmbots.errors import PalmbotsError as PalmbotsError
    from palmbots.errors import SceneError as SceneError
    from palmbots.logs.mcap_reader import read_log as read_log
    from palmbots.logs.mcap_writer import write_log as write_log
    from palmbots.logs.replaying import replay as replay
    from palmbots.mechanics.contact_points import contacts as contacts
    from palmbots.mechanics.mode_analysis import feasible_modes as feasible_modes
    from palmbots.mechanics.mode_analysis import modes as modes
    from palmbots.mechanics.mode_analysis import modes_batch as modes_batch
    from palmbots.mujoco.validation.validation import validate as validate
    from palmbots.optimum.drop_bound import bound as bound
    from palmbots.scene.object_library import object_names as object_names
    from palmbots.scene.scene import Scene as Scene
    from palmbots.scene.scene import load_scene as load_scene
    from palmbots.simulation.noise_limit import noise_limit as noise_limit
    from palmbots.simulation.rare_events import estimate_drop_rate as estimate_drop_rate
    from palmbots.simulation.single import carry as carry
    from palmbots.simulation.sweep import compare as compare
    from palmbots.stability.analysis import analyze as analyze
    from palmbots.stability.certificates.checker.verify import check as check
    from palmbots.stability.certificates.prover import certify as certify
    from palmbots.stability.palm_angles import design as design
    from palmbots.studies.study_reader import open_study as open_study
    from palmbots.studies.study_runner import study as study

__all__ = [
    "PalmbotsError",
    "Scene",
    "SceneError",
    "__version__",
    "analyze",
    "bound",
    "carry",
    "certify",
    "check",
    "compare",
    "contacts",
    "control",
    "design",
    "estimate_drop_rate",
    "feasible_modes",
    "learn",
    "load_scene",
    "logs",
    "mechanics",
    "modes",
    "modes_batch",
    "mujoco",
    "noise_limit",
    "object_names",
    "open_study",
    "optimum",
    "read_log",
    "replay",
    "simulation",
    "stability",
    "studies",
    "study",
    "validate",
    "viz",
    "wire",
    "write_log",
]

# Where each name is defined. All are loaded on first use: most modules import numpy and pydantic,
# which take a quarter of a second, and `palmbots --help` and Ctrl-C must not wait for them.
_PLACES = {
    "analyze": ".stability.analysis",
    "bound": ".optimum.drop_bound",
    "carry": ".simulation.single",
    "certify": ".stability.certificates.prover",
    "check": ".stability.certificates.checker.verify",
    "compare": ".simulation.sweep",
    "contacts": ".mechanics.contact_points",
    "control": ".control",
    "design": ".stability.palm_angles",
    "estimate_drop_rate": ".simulation.rare_events",
    "feasible_modes": ".mechanics.mode_analysis",
    "learn": ".learn",
    "load_scene": ".scene.scene",
    "logs": ".logs",
    "mechanics": ".mechanics",
    "modes": ".mechanics.mode_analysis",
    "modes_batch": ".mechanics.mode_analysis",
    "mujoco": ".mujoco",
    "noise_limit": ".simulation.noise_limit",
    "object_names": ".scene.object_library",
    "open_study": ".studies.study_reader",
    "optimum": ".optimum",
    "PalmbotsError": ".errors",
    "read_log": ".logs.mcap_reader",
    "replay": ".logs.replaying",
    "Scene": ".scene.scene",
    "SceneError": ".errors",
    "simulation": ".simulation",
    "stability": ".stability",
    "studies": ".studies",
    "study": ".studies.study_runner",
    "validate": ".mujoco.validation.validation",
    "viz": ".viz",
    "wire": ".wire",
    "write_log": ".logs.mcap_writer",
}

# What higher rooms add to the registries of lower ones; imported on first use.
_OPTIMAL = "palmbots.optimum.optimal_controllers"
_offer_entry("world", "mujoco", "palmbots.mujoco.carry_runner:WORLD")
_offer_entry("driver", "ros2", "palmbots.ros2.ros2_driver:open_ros2")
_offer_entry("controller file", ".toml", "palmbots.derivation.policy_controller:load_policy")
_offer_entry(
    "controller file", ".toml@station", "palmbots.derivation.policy_controller:load_station_policy"
)
_offer_entry("reference controller", "optimal", f"{_OPTIMAL}:OPTIMAL")
_offer_entry("reference controller", "optimal-stopping", f"{_OPTIMAL}:OPTIMAL_STOPPING")
_LINEAR = "palmbots.optimum.linear_controllers"
_offer_entry("reference controller", "exact-p", f"{_LINEAR}:EXACT_P")
_offer_entry("reference controller", "exact-p-stopping", f"{_LINEAR}:EXACT_P_STOPPING")
_offer_entry("reference controller", "kalman", f"{_LINEAR}:KALMAN")
_offer_entry("reference controller", "kalman-stopping", f"{_LINEAR}:KALMAN_STOPPING")
_offer_module("figure", "palmbots.viz")
_offer_module("writer", "palmbots.viz")

__getattr__, __dir__ = _lazy_names(__name__, _PLACES)
