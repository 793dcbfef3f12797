"""The compiled core of palmbots: mechanics, world, controllers, carries."""

from collections.abc import Sequence
import enum
from typing import Annotated

import numpy
from numpy.typing import NDArray

from palmbots._core import (
    runtime as runtime,
    serial as serial,
    wire as wire
)


def tangent(angle: float) -> float:
    """
    Tangent of an angle [rad], |angle| < pi/2, the same bits on every system.
    """

def supports_x86_level(level: int) -> bool:
    """
    Has this processor the instructions of that level of x86-64, 3 (AVX2) or 4 (AVX-512)?
    """

class PalmSpec:
    """One palm, in SI units and radians."""

    def __init__(self) -> None: ...

    @property
    def length(self) -> float: ...

    @length.setter
    def length(self, arg: float, /) -> None: ...

    @property
    def offset(self) -> float: ...

    @offset.setter
    def offset(self, arg: float, /) -> None: ...

    @property
    def friction(self) -> float: ...

    @friction.setter
    def friction(self, arg: float, /) -> None: ...

    @property
    def shallow(self) -> float: ...

    @shallow.setter
    def shallow(self, arg: float, /) -> None: ...

    @property
    def steep(self) -> float: ...

    @steep.setter
    def steep(self, arg: float, /) -> None: ...

    @property
    def rate(self) -> float: ...

    @rate.setter
    def rate(self, arg: float, /) -> None: ...

class RobotSpec:
    """One robot's wheels, in SI units."""

    def __init__(self) -> None: ...

    @property
    def speed(self) -> float: ...

    @speed.setter
    def speed(self, arg: float, /) -> None: ...

    @property
    def correction(self) -> float: ...

    @correction.setter
    def correction(self, arg: float, /) -> None: ...

    @property
    def acceleration(self) -> float: ...

    @acceleration.setter
    def acceleration(self, arg: float, /) -> None: ...

    @property
    def max_speed(self) -> float: ...

    @max_speed.setter
    def max_speed(self, arg: float, /) -> None: ...

    @property
    def noise(self) -> float: ...

    @noise.setter
    def noise(self, arg: float, /) -> None: ...

    @property
    def noise_tau(self) -> float: ...

    @noise_tau.setter
    def noise_tau(self, arg: float, /) -> None: ...

    @property
    def bias(self) -> float: ...

    @bias.setter
    def bias(self, arg: float, /) -> None: ...

    @property
    def clock_drift(self) -> float: ...

    @clock_drift.setter
    def clock_drift(self, arg: float, /) -> None: ...

    @property
    def stride(self) -> int: ...

    @stride.setter
    def stride(self, arg: int, /) -> None: ...

class Spec:
    """Everything that defines a carry, as plain numbers."""

    def __init__(self) -> None: ...

    @property
    def width(self) -> float: ...

    @width.setter
    def width(self, arg: float, /) -> None: ...

    @property
    def com_left(self) -> float: ...

    @com_left.setter
    def com_left(self, arg: float, /) -> None: ...

    @property
    def com_right(self) -> float: ...

    @com_right.setter
    def com_right(self, arg: float, /) -> None: ...

    @property
    def com_height(self) -> float: ...

    @com_height.setter
    def com_height(self, arg: float, /) -> None: ...

    @property
    def outline(self) -> list[tuple[float, float, float]]:
        """
        Vertices as (from left contact, from right contact, height); the first is the left contact.
        """

    @outline.setter
    def outline(self, arg: Sequence[tuple[float, float, float]], /) -> None: ...

    @property
    def contact_right(self) -> int: ...

    @contact_right.setter
    def contact_right(self, arg: int, /) -> None: ...

    @property
    def palms(self) -> tuple[PalmSpec, PalmSpec]: ...

    @palms.setter
    def palms(self, arg: tuple[PalmSpec, PalmSpec], /) -> None: ...

    @property
    def robots(self) -> tuple[RobotSpec, RobotSpec]: ...

    @robots.setter
    def robots(self, arg: tuple[RobotSpec, RobotSpec], /) -> None: ...

    @property
    def zones(self) -> list[tuple[int, float, float]]: ...

    @zones.setter
    def zones(self, arg: Sequence[tuple[int, float, float]], /) -> None: ...

    @property
    def false_rate(self) -> float: ...

    @false_rate.setter
    def false_rate(self, arg: float, /) -> None: ...

    @property
    def period(self) -> float: ...

    @period.setter
    def period(self, arg: float, /) -> None: ...

    @property
    def latency(self) -> float: ...

    @latency.setter
    def latency(self, arg: float, /) -> None: ...

    @property
    def jitter(self) -> float: ...

    @jitter.setter
    def jitter(self, arg: float, /) -> None: ...

    @property
    def loss(self) -> float: ...

    @loss.setter
    def loss(self, arg: float, /) -> None: ...

    @property
    def duplicate(self) -> float: ...

    @duplicate.setter
    def duplicate(self, arg: float, /) -> None: ...

    @property
    def corruption(self) -> float: ...

    @corruption.setter
    def corruption(self, arg: float, /) -> None: ...

    @property
    def reorders(self) -> bool: ...

    @reorders.setter
    def reorders(self, arg: bool, /) -> None: ...

    @property
    def sessions(self) -> bool: ...

    @sessions.setter
    def sessions(self, arg: bool, /) -> None: ...

    @property
    def burst_share(self) -> float: ...

    @burst_share.setter
    def burst_share(self, arg: float, /) -> None: ...

    @property
    def burst_mean(self) -> float: ...

    @burst_mean.setter
    def burst_mean(self, arg: float, /) -> None: ...

    @property
    def airtime(self) -> float: ...

    @airtime.setter
    def airtime(self, arg: float, /) -> None: ...

    @property
    def beacon(self) -> float: ...

    @beacon.setter
    def beacon(self, arg: float, /) -> None: ...

    @property
    def lease(self) -> float: ...

    @lease.setter
    def lease(self, arg: float, /) -> None: ...

    @property
    def brake(self) -> bool: ...

    @brake.setter
    def brake(self, arg: bool, /) -> None: ...

    @property
    def start_by_touch(self) -> bool: ...

    @start_by_touch.setter
    def start_by_touch(self, arg: bool, /) -> None: ...

    @property
    def watchdog(self) -> float: ...

    @watchdog.setter
    def watchdog(self, arg: float, /) -> None: ...

    @property
    def random_reboots(self) -> int: ...

    @random_reboots.setter
    def random_reboots(self, arg: int, /) -> None: ...

    @property
    def reboot(self) -> float: ...

    @reboot.setter
    def reboot(self, arg: float, /) -> None: ...

    @property
    def outages(self) -> list[tuple[int, float, float]]:
        """(sender, from, to) in s; sender 0: left, 1: right, 2: station."""

    @outages.setter
    def outages(self, arg: Sequence[tuple[int, float, float]], /) -> None: ...

    @property
    def message_faults(self) -> list[tuple[int, int, int, float]]:
        """
        (link, message, effect, late) of single messages: link 0: from left, 1: from right, 2: from the station to left, 3: to right; message from 1; effect 0: lost, 1: late, 2: copied; late in s.
        """

    @message_faults.setter
    def message_faults(self, arg: Sequence[tuple[int, int, int, float]], /) -> None: ...

    @property
    def faults(self) -> list[tuple[int, int, float, float, int, float, int]]:
        """
        (kind, side, at, lasts, reads, rate, marks) in s, in order of FaultKind.
        """

    @faults.setter
    def faults(self, arg: Sequence[tuple[int, int, float, float, int, float, int]], /) -> None: ...

    @property
    def distance(self) -> float: ...

    @distance.setter
    def distance(self, arg: float, /) -> None: ...

    @property
    def slope(self) -> float: ...

    @slope.setter
    def slope(self, arg: float, /) -> None: ...

    @property
    def inertia(self) -> float: ...

    @inertia.setter
    def inertia(self, arg: float, /) -> None: ...

    @property
    def inertia_lag(self) -> float: ...

    @inertia_lag.setter
    def inertia_lag(self, arg: float, /) -> None: ...

    @property
    def direction(self) -> float: ...

    @direction.setter
    def direction(self, arg: float, /) -> None: ...

    @property
    def timeout_ticks(self) -> int: ...

    @timeout_ticks.setter
    def timeout_ticks(self, arg: int, /) -> None: ...

    @property
    def start(self) -> tuple[float, float]: ...

    @start.setter
    def start(self, arg: tuple[float, float], /) -> None: ...

    @property
    def bumps(self) -> list[tuple[int, bool, float, float]]: ...

    @bumps.setter
    def bumps(self, arg: Sequence[tuple[int, bool, float, float]], /) -> None: ...

    @property
    def pushes(self) -> list[tuple[int, float, float, float]]:
        """(side, at, lasts, speed) in s and m/s, outward."""

    @pushes.setter
    def pushes(self, arg: Sequence[tuple[int, float, float, float]], /) -> None: ...

    @property
    def bump_rate(self) -> float: ...

    @bump_rate.setter
    def bump_rate(self, arg: float, /) -> None: ...

    @property
    def bump_max(self) -> float: ...

    @bump_max.setter
    def bump_max(self, arg: float, /) -> None: ...

    @property
    def safe_reach(self) -> float: ...

    @safe_reach.setter
    def safe_reach(self, arg: float, /) -> None: ...

    @property
    def directions(self) -> list[tuple[float, float, float]]:
        """
        (latency, jitter, loss) of what left, right and station send; < 0: as for all.
        """

    @directions.setter
    def directions(self, arg: Sequence[tuple[float, float, float]], /) -> None: ...

    @property
    def replay(self) -> float: ...

    @replay.setter
    def replay(self, arg: float, /) -> None: ...

    @property
    def replay_delay(self) -> float: ...

    @replay_delay.setter
    def replay_delay(self, arg: float, /) -> None: ...

    @property
    def longest_delay(self) -> float:
        """The longest delay of any link [s]."""

    @property
    def may_go_limp(self) -> bool:
        """A palm may go limp: carries of this spec do not run side by side."""

    def to_bytes(self) -> bytes:
        """The spec as it lies in memory, for C++ programs on the same machine."""

    @staticmethod
    def list_from_bytes(bytes: bytes) -> list[Spec]:
        """The specs of which these are the bytes, one after the other."""

def safe_reach(spec: Spec) -> float:
    """
    How far from the middle of their palms both contacts are certain to be held at any angles [m]; -1: unknown.
    """

def modes(columns: Sequence[Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]], n: int) -> tuple:
    """
    For n states: ends of I_L and I_R, bits of the feasible modes, and the bits of the modes on closing and opening (-1: not held, -2: jammed).
    """

def margin(values: Sequence[float], friction_angle_left: float, friction_angle_right: float) -> float:
    """
    The angle [rad] by which both friction cones may shrink with the object still held.
    """

def feasible_modes(columns: Sequence[Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]], n: int) -> Annotated[NDArray[numpy.uint16], dict(shape=(None,))]:
    """For n states: bits of the modes that balance. Columns as in `modes`."""

class OperatingEnvelope:
    """Everything under which the properties have to hold."""

    def __init__(self, spec: Spec, com_y: tuple[float, float], friction: Sequence[tuple[float, float]], common: bool, slope: tuple[float, float], contacts: Sequence[tuple[float, float]], beyond: float) -> None: ...

    def com_x_of(self, property: int, shallow: int, angles: Sequence[tuple[float, float]]) -> tuple[float, float]: ...

    def com_x_held(self, angles: Sequence[tuple[float, float]]) -> tuple[float, float]: ...

    def com_x_all(self, angles: Sequence[tuple[float, float]], wanted: tuple[float, float]) -> tuple[float, float]: ...

    def clearance(self, angles: Sequence[tuple[float, float]]) -> float: ...

    def map(self, shallow: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], steep: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], com_x: tuple[float, float], quantity: int, most: float, reach: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)]) -> tuple:
        """
        Tolerance of a quantity (0 COM, 1 friction, 2 slope, 3 contacts, 4 angle) and clearance [rad] at every pair of angles, alike for both palms.
        """

def com_interval(property: int, shallow: int, width: float, slope: float, friction: Sequence[tuple[float, float]], common: bool, angles: Sequence[float], rise: float) -> tuple[float, float, float, float, int, int]:
    """
    The permitted COMs (x, y, low, high, what binds at low, at high) at one height difference.
    """

def rise_over(property: int, shallow: int, contacts: Sequence[tuple[float, float]], beyond: float, angles: Sequence[float], offset: Sequence[float]) -> tuple[float, float]:
    """The height differences of the contacts over a property's region."""

class World:
    """Two palms and an object: exact motion under given robot motions."""

    def __init__(self, spec: Spec) -> None: ...

    @property
    def contacts(self) -> tuple[float, float]: ...

    @property
    def separation(self) -> float: ...

    @property
    def palms(self) -> tuple[float, float]: ...

    @property
    def contact_vector(self) -> tuple[float, float]: ...

    @property
    def lift(self) -> tuple[float, float]: ...

    @property
    def constraints(self) -> list[tuple[int, bool, int, float]]:
        """
        Contacts as (side, tip, vertex or edge, p of the tip); empty: the two vertices alone.
        """

    @property
    def contact_events(self) -> int: ...

    def check(self) -> str:
        """Why the object is not held here; empty if it is."""

    def shift(self, side: int, by: float) -> str:
        """A bump: shifts one contact [m]; the robots give way."""

    def advance(self, change: float, palms: tuple[float, float], push: float = 0.0) -> tuple[str, float, int, int, int]:
        """
        Changes the separation [m] and turns the palms to the given angles [rad], both at constant rates. Returns (reason, fraction done, motion left, motion right, segments).
        """

class Palm(enum.IntEnum):
    """Which of its two angles a palm is commanded to."""

    steep = 0

    shallow = 1

class Move(enum.IntEnum):
    """The speed a robot adds to its nominal one."""

    hold = 0

    away = 1

    closer = 2

class MessageKind(enum.IntEnum):
    """What robots say to each other."""

    none = 0

    TiltUp = 1

    TiltDown = 2

    Ack = 3

    Closing = 4

    Raised = 5

    Zero = 6

    Plus = 7

    PlusShallow = 8

    Minus = 9

    MinusShallow = 10

def controllers() -> list:
    """
    The controllers of the core, in order: the rows of sim/team_registry.hpp.
    """

def table1() -> list[tuple[list[int], str, tuple[str, str, str], tuple[str, str, str]]]:
    """
    Table 1 as it runs: per case the signs, the palm to tilt up, and two actions (move, whose contact, until).
    """

def table2() -> tuple[list[tuple[str, str, str, str, bool]], list[list[str]]]:
    """
    Table 2 as it runs: per state (name, case, palm, move, waits), and the rows (state, contact, message, palm turned, next state, message sent).
    """

def resilient_table() -> tuple[list[tuple[str, str, str, str, str]], list[list[str]]]:
    """
    The resilient algorithm as it runs: per state (name, case, palm, move, message), and the rows (state, contact, message heard, condition, next state).
    """

def resilient_timing(spec: Spec) -> dict:
    """
    The time bounds of the resilient algorithm (control/resilient_timing.hpp).
    """

class Distributed:
    """Table 2 of the paper, one robot."""

    def __init__(self) -> None: ...

    def step(self, sign: int, message: int, palm_at_target: bool) -> tuple[int, int, int, bool]:
        """One tick; returns (palm, move, message sent, message read)."""

    def __copy__(self) -> Distributed: ...

    @property
    def memory(self) -> bytes:
        """All that it remembers."""

    @property
    def state(self) -> int: ...

    @property
    def name(self) -> str: ...

    @property
    def waits(self) -> bool: ...

class Resilient:
    """The resilient distributed algorithm, one robot."""

    def __init__(self, lease: int, hold: int, join: int, yields: bool) -> None:
        """Times in ticks; a beacon goes out every tick, and wheels stop at once."""

    def step(self, sign: int, palm_at_target: bool, message: int, stopped: bool, ready: bool, age: int) -> tuple[int, int, int, bool, bool]:
        """
        One tick with what a new beacon said and how old it may be (message 0: none came); returns (palm, move, message, stop, ready).
        """

    def __copy__(self) -> Resilient: ...

    @property
    def memory(self) -> bytes:
        """All that it remembers."""

    @property
    def name(self) -> str: ...

class Centralized:
    """Table 1 of the paper, the station."""

    def __init__(self) -> None: ...

    def step(self, left: tuple[int, int, bool], right: tuple[int, int, bool]) -> tuple[int, int, int, int]:
        """
        One tick with each robot's (sign, palm commanded, palm at target); returns (palm, move) of both.
        """

    def __copy__(self) -> Centralized: ...

    @property
    def memory(self) -> bytes:
        """All that it remembers."""

    @property
    def case_number(self) -> int: ...

    @property
    def stage(self) -> int: ...

def transition_table(controller: str, spec: Spec) -> dict | None:
    """
    The table of a controller as it runs, with its times in a scene [s]; None if it is not made of a table.
    """

class TableRobot:
    """One robot whose program is a table."""

    def step(self, sign: int, palm_at_target: bool, message: int, age: int) -> tuple:
        """
        One tick with a new word of the partner and how old it may be [ticks] (message 0: none came); returns (palm, move, stop, own word, whether it is sent now).
        """

    @property
    def state(self) -> str: ...

def table_robot(controller: str, spec: Spec, leads: bool) -> TableRobot:
    """A robot with the program of this controller."""

class Machines:
    """The controllers of both robots as tables (control/machine_table.hpp)."""

    def __init__(self, left: tuple[Sequence[tuple[str, str, str, bool, str]], Sequence[tuple[int, str, str, str, int, str]]], right: tuple[Sequence[tuple[str, str, str, bool, str]], Sequence[tuple[int, str, str, str, int, str]]]) -> None:
        """
        Per robot the states (case, palm, move, waits, awaited message) and the rows (state, contact, message, palm turned, next state, message sent), in the words of table2().
        """

    def image(self, side: int) -> bytes:
        """The table of a robot as the firmware of a board has it in its memory."""

class RowPolicy:
    """The station's program as nine rows (control/row_policy.hpp)."""

    def __init__(self, rows: Sequence[tuple[tuple[str, str], tuple[str, str]]]) -> None:
        """
        Rows ((palm, palm), (drive, drive)), left first, in the order (+, +), (+, 0), (+, -), (0, +) to (-, -).
        """

class MachineRobot:
    """One robot whose controller is a table."""

    def __init__(self, machines: object, side: int) -> None: ...

    def step(self, sign: int, message: int, palm_at_target: bool) -> tuple[int, int, int, bool]:
        """One tick; returns (palm, move, message sent, message read)."""

    def __copy__(self) -> MachineRobot: ...

    @property
    def memory(self) -> bytes:
        """All that it remembers."""

    @property
    def name(self) -> str: ...

    @property
    def waits(self) -> bool: ...

carry_outcomes: tuple = ('running', 'delivered', 'dropped', 'stalled')

drop_reasons: tuple = ...

class Run:
    """A finished carry."""

    @property
    def outcome(self) -> str: ...

    @property
    def reason(self) -> object: ...

    @property
    def time_s(self) -> float: ...

    @property
    def distance_m(self) -> float: ...

    @property
    def contact_rms_m(self) -> tuple[float, float]: ...

    @property
    def contact_peak_m(self) -> tuple[float, float]: ...

    @property
    def messages(self) -> int: ...

    @property
    def links(self) -> list: ...

    @property
    def stopped(self) -> tuple[bool, bool]: ...

    @property
    def messages_lost(self) -> int: ...

    @property
    def waiting_s(self) -> tuple[float, float]: ...

    @property
    def hanging(self) -> list: ...

    @property
    def limit_cycle(self) -> tuple[bool, bool]: ...

    @property
    def bumps(self) -> int: ...

    @property
    def correction_count(self) -> int: ...

    @property
    def corrections(self) -> list: ...

    @property
    def contact_event_count(self) -> int: ...

    @property
    def contact_events(self) -> list: ...

    @property
    def message_log(self) -> list: ...

    @property
    def trace(self) -> object: ...

    @property
    def trace_hash(self) -> str: ...

def run(spec: Spec, controller: object, seed: int, precision: str, record: bool, forks: Sequence[tuple[float, int]] = []) -> Run:
    """
    One carry. controller: a name, Machines, a RowPolicy, an OptimalController, LinearFeedback, RemoteControllers, or a pair of Python step functions. forks: times [s] in their order, from which on the carry continues with the random numbers of another seed.
    """

def choose_levels(spec: Spec, controller: object, seed: int, effort: int, share: float) -> list[float]:
    """
    Heights, as parts of the palm's half-length, each reached by about `share` of the carries from the one before.
    """

def replicates(spec: Spec, controller: object, seed: int, effort: int, levels: Sequence[float], first: int, count: int, threads: int) -> tuple:
    """
    Of each replicate and stage (reached, drops); and the ticks of all together.
    """

class WorldObservation:
    """What is seen of a world at the end of a tick (sim/cosimulation.hpp)."""

    def __init__(self, contacts: tuple[float, float], lift: tuple[float, float], touched: tuple[float, float], pressed: tuple[bool, bool], palms: tuple[float, float], wrists: tuple[float, float], separation: float, midpoint: float, rise: float, motion: tuple[int, int], reason: str = '', fraction: float = 1.0) -> None: ...

    @property
    def contacts(self) -> tuple[float, float]: ...

    @property
    def lift(self) -> tuple[float, float]: ...

    @property
    def palms(self) -> tuple[float, float]: ...

    @property
    def motion(self) -> tuple[int, int]: ...

    @property
    def separation(self) -> float: ...

    @property
    def midpoint(self) -> float: ...

    @property
    def rise(self) -> float: ...

class CoSimulation:
    """Both robots without their world: step_controllers, move, observe."""

    def __init__(self, spec: Spec, controller: object, seed: int, first: WorldObservation, slack: float = 0.0) -> None:
        """
        controller: a name, Machines, or a pair of Python step functions; slack: how far from the angle commanded [rad] a wrist counts as turned.
        """

    @property
    def done(self) -> bool: ...

    def step_controllers(self) -> tuple[tuple[float, float], tuple[float, float], float, float, float]:
        """
        Decides: (speeds [m/s] towards +x, palm angles [rad] at the end of the tick, change of the separation [m], push [1], travel of the midpoint [m]).
        """

    def observe(self, sight: WorldObservation) -> None:
        """What became of it, once for each step_controllers()."""

    def run(self) -> Run:
        """The finished carry; takes the trace with it."""

class Episode:
    """
    A carry in the quasistatic world whose robots are commanded from outside.
    """

    def __init__(self, spec: Spec, seed: int, record: bool = False) -> None: ...

    @property
    def outcome(self) -> str:
        """running, delivered, dropped or stalled."""

    @property
    def ticks(self) -> int: ...

    @property
    def contacts(self) -> tuple[float, float]: ...

    @property
    def lift(self) -> tuple[float, float]: ...

    @property
    def palms(self) -> tuple[float, float]: ...

    @property
    def motion(self) -> tuple[int, int]:
        """Over the last tick: contacts slide down -1, stick 0, slide up +1."""

    @property
    def separation(self) -> float: ...

    @property
    def rise(self) -> float:
        """Of the right contact vertex over the left one [m]."""

    @property
    def midpoint(self) -> float: ...

    @property
    def sent(self) -> int:
        """Messages so far."""

    def observations(self) -> tuple[tuple[int, bool, int, bool, bool], tuple[int, bool, int, bool, bool]]:
        """
        Of each robot (sign, palm turned, message that is there, program runs, it has just begun anew) in the tick to come.
        """

    def step(self, left: tuple[int, int, int], right: tuple[int, int, int], ticks: int = 1) -> tuple[str, int, int, float, tuple[float, float]]:
        """
        So many ticks with (palm, move, message to send) of each robot. What is there to be read is read in the first of them, in which messages go out too. Returns (outcome, ticks and messages so far, midpoint [m], contacts [m]).
        """

    def stop(self, left: bool, right: bool) -> None:
        """
        Whether each robot rests, from the next step on, until it is called again.
        """

    def run(self) -> Run:
        """What became of it; takes the trace with it."""

class ExternalCoSimulation:
    """A co-simulation whose robots are commanded from outside."""

    def __init__(self, spec: Spec, seed: int, first: WorldObservation, slack: float = 0.0) -> None: ...

    @property
    def done(self) -> bool: ...

    @property
    def outcome(self) -> str: ...

    @property
    def ticks(self) -> int: ...

    @property
    def sent(self) -> int: ...

    def observations(self) -> tuple[tuple[int, bool, int, bool, bool], tuple[int, bool, int, bool, bool]]: ...

    def set_commands(self, left: tuple[int, int, int], right: tuple[int, int, int]) -> None:
        """(palm, move, message to send) of each robot, from the next command on."""

    def stop(self, left: bool, right: bool) -> None:
        """
        Whether each robot rests, from the next command on, until it is called again.
        """

    def step_controllers(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """(Speeds [m/s] towards +x, palm angles [rad] at the end of the tick.)"""

    def observe(self, sight: WorldObservation) -> None: ...

    def run(self) -> Run:
        """What became of it; takes the trace with it."""

def mode_table() -> list[tuple[list[str], str, str, str, str]]:
    """
    The mode machine of a robot as it runs: per row the modes in which it starts, what happens, the next mode, what becomes of the fault code (keep, set, refusal), and the code.
    """

contact_kinds: tuple = ('', 'vertex', 'flush', 'tip')

contact_tolerance: float = 1e-05

wrench_tolerance: float = 1e-09

def contacts(spec: Spec, angles: tuple[float, float], places: tuple[float, float]) -> tuple:
    """
    All contacts as (kind, place, object x, object y, support), how many there are (at most 8 are listed), how deep either palm is in the object [m], and the pivots from the COM [m].
    """

def palm_velocities(supports: Sequence[tuple[int, float, float, float, float, float]], pivots: tuple[tuple[float, float], tuple[float, float]], palms: tuple[tuple[float, float, float], tuple[float, float, float]]) -> list[tuple[float, float]]:
    """Of the palms at the supports; a palm moves by (vx, vy, spin)."""

def imbalance(supports: Sequence[tuple[int, float, float, float, float, float]], motions: Sequence[int], slope: float = 0.0) -> float:
    """
    What these contacts lack for balance, in weights; 0 but for rounding: they hold. A motion is 0 stick, 1 up, -1 down, 2 leave.
    """

def twist_exists(supports: Sequence[tuple[int, float, float, float, float, float]], motions: Sequence[int], velocities: Sequence[tuple[float, float]]) -> bool:
    """Can a rigid body move like this on palms with these velocities?"""

def possible_motions(supports: Sequence[tuple[int, float, float, float, float, float]], velocities: Sequence[tuple[float, float]]) -> list[list[int]]:
    """
    Every way in which a rigid body can move on palms with these velocities.
    """

def outcomes(supports: Sequence[tuple[int, float, float, float, float, float]], velocities: Sequence[tuple[float, float]], slope: float = 0.0) -> list[list[int]]:
    """Those of them that balance."""

class OpeningProblem:
    """The separation of the robots under noise, in SI units."""

    def __init__(self) -> None: ...

    @property
    def lowest(self) -> float: ...

    @lowest.setter
    def lowest(self, arg: float, /) -> None: ...

    @property
    def highest(self) -> float: ...

    @highest.setter
    def highest(self, arg: float, /) -> None: ...

    @property
    def start(self) -> float: ...

    @start.setter
    def start(self, arg: float, /) -> None: ...

    @property
    def slowest(self) -> float: ...

    @slowest.setter
    def slowest(self, arg: float, /) -> None: ...

    @property
    def fastest(self) -> float: ...

    @fastest.setter
    def fastest(self, arg: float, /) -> None: ...

    @property
    def change(self) -> float: ...

    @change.setter
    def change(self, arg: float, /) -> None: ...

    @property
    def bias(self) -> float: ...

    @bias.setter
    def bias(self, arg: float, /) -> None: ...

    @property
    def noise(self) -> float: ...

    @noise.setter
    def noise(self, arg: float, /) -> None: ...

    @property
    def memory(self) -> float: ...

    @memory.setter
    def memory(self, arg: float, /) -> None: ...

    @property
    def period(self) -> float: ...

    @period.setter
    def period(self, arg: float, /) -> None: ...

    @property
    def duration(self) -> float: ...

    @duration.setter
    def duration(self, arg: float, /) -> None: ...

    @property
    def distance(self) -> float: ...

    @distance.setter
    def distance(self, arg: float, /) -> None: ...

    @property
    def price(self) -> float: ...

    @price.setter
    def price(self, arg: float, /) -> None: ...

    @property
    def most(self) -> tuple[float, float]:
        """Largest commanded speed of the follower and of the leader."""

    @most.setter
    def most(self, arg: tuple[float, float], /) -> None: ...

class OptimalController:
    """A reference with full information, for one scene."""

    def __init__(self, policy: bytes, may_stop: bool) -> None: ...

class LinearFeedback:
    """A reference with linear feedback of the contact coordinates."""

    def __init__(self, exact: bool, may_stop: bool) -> None:
        """
        exact: it reads the coordinates; otherwise a Kalman filter estimates them from signs.
        """

    @property
    def time_s(self) -> float:
        """In which the sum of the contact coordinates is to vanish."""

class OpeningSolution:
    """What value iteration found, in SI units."""

    @property
    def drop(self) -> float:
        """Probability of a drop in a carry."""

    @property
    def hazard(self) -> float:
        """Probability of a drop per second."""

    @property
    def speed(self) -> float:
        """Of the midpoint; 0: progress does not count."""

    @property
    def duration(self) -> float:
        """Of the carry."""

    @property
    def decisions(self) -> int:
        """After which the hazard was constant."""

    @property
    def policy(self) -> bytes:
        """The table of costs, for OptimalController."""

def opening_problem(spec: Spec, speeds: str) -> OpeningProblem:
    """The opening problem of a carry; speeds: corrections or stopping."""

def solve_opening(problem: OpeningProblem, positions: int, noises: int, speeds: float) -> OpeningSolution:
    """Solves it on a grid (OpeningGrid)."""
