# SPDX-License-Identifier: Apache-2.0
"""palmbots: two mobile robots carry an object between two tilting palms, without grippers.

>>> import palmbots as pb
>>> pb.carry("paper", "distributed", seed=0).outcome
'delivered'
"""

from typing import TYPE_CHECKING

from palmbots._util.lazy_names import lazy_names

if TYPE_CHECKING:
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
    from palmbots._version import __version__ as __version__
    from palmbots.assessment.assess import assess as assess
    from palmbots.assessment.carry_command import carry_and_report as carry_and_report
    from palmbots.control.controller_list import controllers as controllers
    from palmbots.derivation.deriving import derive_policy as derive_policy
    from palmbots.errors import PalmbotsError as PalmbotsError
    from palmbots.errors import SceneError as SceneError
    from palmbots.fitting.fit import fit as fit
    from palmbots.interchange.export import export as export
    from palmbots.logs.mcap_reader import read_log as read_log
    from palmbots.logs.mcap_writer import write_log as write_log
    from palmbots.logs.replaying import replay as replay
    from palmbots.mechanics.consistent_modes import consistent_modes as consistent_modes
    from palmbots.mechanics.contact_modes import contact_modes as contact_modes
    from palmbots.mechanics.contact_modes import contact_modes_batch as contact_modes_batch
    from palmbots.mechanics.contact_modes import feasible_contact_modes as feasible_contact_modes
    from palmbots.mechanics.contact_points import contacts as contacts
    from palmbots.mechanics.load_limits import load_limits as load_limits
    from palmbots.mujoco.carry_files import save_carry as save_carry
    from palmbots.mujoco.validation.validation import validate as validate
    from palmbots.optimum.drop_bound import bound as bound
    from palmbots.probing.probe import probe as probe
    from palmbots.scene.lists import keys as keys
    from palmbots.scene.lists import objects as objects
    from palmbots.scene.lists import scenes as scenes
    from palmbots.scene.object_library import object_names as object_names
    from palmbots.scene.scene import Scene as Scene
    from palmbots.scene.scene import load_scene as load_scene
    from palmbots.shapes.importing import import_object as import_object
    from palmbots.simulation.carry_ends import ends as ends
    from palmbots.simulation.final_place import final_place as final_place
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
else:
    __getattr__, __dir__ = lazy_names(__name__)

# What higher rooms add to the registries of lower ones (`palmbots._util.named_registry`), by kind.
_OFFERS = {
    "world": {"mujoco": "palmbots.mujoco.carry_runner:WORLD"},
    "driver.kind": {"ros2": "palmbots.ros2.ros2_driver:open_ros2"},
    "controller file": {
        ".toml": "palmbots.derivation.policy_controller:load_policy",
        ".toml@station": "palmbots.derivation.policy_controller:load_station_policy",
    },
    "reference controller": {
        "optimal": "palmbots.optimum.optimal_controllers:OPTIMAL",
        "optimal-stopping": "palmbots.optimum.optimal_controllers:OPTIMAL_STOPPING",
        "exact-p": "palmbots.optimum.linear_controllers:EXACT_P",
        "exact-p-stopping": "palmbots.optimum.linear_controllers:EXACT_P_STOPPING",
        "kalman": "palmbots.optimum.linear_controllers:KALMAN",
        "kalman-stopping": "palmbots.optimum.linear_controllers:KALMAN_STOPPING",
        "standing": "palmbots.optimum.standing_controllers:STANDING",
        "creeping": "palmbots.optimum.standing_controllers:CREEPING",
    },
    "file kind": {
        "pair": "palmbots.pair.pair_file:PAIR_FILE",
        "study": "palmbots.studies.study_file:STUDY_FILE",
        "policy": "palmbots.derivation.policy_file:POLICY_FILE",
        "probed object": "palmbots.stability.probed_object:PROBED_FILE",
        "imperfections": "palmbots.simulation.imperfections:IMPERFECTIONS_FILE",
        "controller": "palmbots.control.registry:CONTROLLER",
    },
    "figure": {"those of viz": "palmbots.viz"},
    "lines": {"load": "palmbots.stability.holding:load_lines"},
    "writer": {"figure": "palmbots.viz:write_figure"},
}
