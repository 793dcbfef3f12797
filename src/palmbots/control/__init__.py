# SPDX-License-Identifier: Apache-2.0
"""The controller interface, the shipped controllers, and their timing and dead-band laws."""

from typing import TYPE_CHECKING

from palmbots._util.lazy_names import lazy_names

if TYPE_CHECKING:
    from palmbots.control.dead_band import overrun_m as overrun_m
    from palmbots.control.dead_band import warnings_before as warnings_before
    from palmbots.control.dead_band import zero_zone_edges_m as zero_zone_edges_m
    from palmbots.control.dead_band import zero_zone_m as zero_zone_m
    from palmbots.control.interface import Controller as Controller
    from palmbots.control.interface import DistributedController as DistributedController
    from palmbots.control.interface import MessageKind as MessageKind
    from palmbots.control.interface import Move as Move
    from palmbots.control.interface import Palm as Palm
    from palmbots.control.interface import StepInput as StepInput
    from palmbots.control.interface import StepOutput as StepOutput
    from palmbots.control.python_source import ControllerSource as ControllerSource
    from palmbots.control.registry import ControllerEntry as ControllerEntry
    from palmbots.control.registry import ControllerLike as ControllerLike
    from palmbots.control.registry import controller_names as controller_names
    from palmbots.control.registry import describe as describe
    from palmbots.control.registry import register as register
    from palmbots.control.registry import resolve as resolve
    from palmbots.control.registry import unregister as unregister
    from palmbots.control.resilient_timing import Bounds as Bounds
    from palmbots.control.resilient_timing import bounds_of as bounds_of
    from palmbots.control.stepped_by_hand import SilentController as SilentController
else:
    __getattr__, __dir__ = lazy_names(__name__)
