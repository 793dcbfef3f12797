"""palmbots: two robots that cannot grasp carry an object together, on a flat tiltable palm each.

>>> import palmbots as pb
>>> pb.carry("paper", "distributed", seed=0).outcome
'delivered'
"""

import importlib
from typing import TYPE_CHECKING, Any

from palmbots.carry import carry
from palmbots.check import Checked, check
from palmbots.compare import Comparison, compare
from palmbots.controllers import Controller, Distributed, StepInput, StepOutput
from palmbots.errors import PalmbotsError, SceneError
from palmbots.feasibility import feasible_modes
from palmbots.modes import MODES, ContactModes, States, modes, states
from palmbots.object_files import objects
from palmbots.rare import DropRate, rare
from palmbots.replay import Replay, replay
from palmbots.result import Carry, Correction, Letter, Touch
from palmbots.scene import Scene, load_scene
from palmbots.stability.analysis import Analysis, analyze
from palmbots.touching import Contact, contacts
from palmbots.version import __version__

if TYPE_CHECKING:
    from palmbots import wire
    from palmbots.dynamic.validation import Validation, validate
    from palmbots.log import Log, read_log, write_log
    from palmbots.stability.certificate import Certificate, certify
    from palmbots.stability.design import Design, design
    from palmbots.studies.run import open_results as open_study
    from palmbots.studies.run import study

__all__ = [
    "MODES",
    "Analysis",
    "Carry",
    "Certificate",
    "Checked",
    "Comparison",
    "Contact",
    "ContactModes",
    "Controller",
    "Correction",
    "Design",
    "Distributed",
    "DropRate",
    "Letter",
    "Log",
    "PalmbotsError",
    "Replay",
    "Scene",
    "SceneError",
    "States",
    "StepInput",
    "StepOutput",
    "Touch",
    "Validation",
    "__version__",
    "analyze",
    "carry",
    "certify",
    "check",
    "compare",
    "contacts",
    "design",
    "feasible_modes",
    "load_scene",
    "modes",
    "objects",
    "open_study",
    "rare",
    "read_log",
    "replay",
    "states",
    "study",
    "validate",
    "wire",
    "write_log",
]

# Where names come from whose modules take long to import and that few programs use.
_LATER = {
    "Certificate": ("palmbots.stability.certificate", "Certificate"),
    "Design": ("palmbots.stability.design", "Design"),
    "Log": ("palmbots.log", "Log"),
    "Validation": ("palmbots.dynamic.validation", "Validation"),
    "certify": ("palmbots.stability.certificate", "certify"),
    "design": ("palmbots.stability.design", "design"),
    "open_study": ("palmbots.studies.run", "open_results"),
    "read_log": ("palmbots.log", "read_log"),
    "study": ("palmbots.studies.run", "study"),
    "validate": ("palmbots.dynamic.validation", "validate"),
    "wire": ("palmbots.wire", ""),
    "write_log": ("palmbots.log", "write_log"),
}


def __getattr__(name: str) -> Any:
    if name not in _LATER:
        raise AttributeError(f"module 'palmbots' has no attribute {name!r}")
    module, attribute = _LATER[name]
    found = importlib.import_module(module)
    return getattr(found, attribute) if attribute else found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
