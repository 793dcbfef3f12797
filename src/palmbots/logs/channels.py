# SPDX-License-Identifier: Apache-2.0
"""The channels of a carry log, and the protobuf types of their messages.

States: ``/left``, ``/right`` and ``/pair`` at every tick. The fields of their messages are the
variables of the trace, so a world may add variables of its own. The attribute ``log_field`` of a
variable is the name of its field, which contains the unit, such as ``contact_m``. A field
``dynamics/force_n`` belongs to the channels ``/left/dynamics`` and ``/right/dynamics``. A variable
without ``log_field`` is not logged. The log contains the list of its variables, so reading it needs
no world.

Events: ``/messages`` and ``/corrections``.

Protobuf stores a double exactly. Every schema is in the log.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from palmbots._types import SIDES
from palmbots.errors import PalmbotsError
from palmbots.logs.message_types import FIELD, message_type
from palmbots.simulation.trace import VARIABLES, trace_dataset

if TYPE_CHECKING:
    import xarray as xr
    from google.protobuf.descriptor import Descriptor

_STRING = FIELD.TYPE_STRING
_DOUBLE = FIELD.TYPE_DOUBLE
_TYPES = {"f": _DOUBLE, "i": FIELD.TYPE_SINT64, "U": _STRING}  # by the kind of the NumPy type


@dataclass(frozen=True, slots=True)
class Variable:
    """A variable of the trace, as the log describes it."""

    name: str
    field: str
    """Field of the message, with its unit; before a slash the channel, if it is not the main one.
    """
    by_side: bool
    """One value for each robot; otherwise one for the pair."""
    dtype: str
    attrs: dict[str, str]

    def __post_init__(self) -> None:
        """Refuse a type that no field can hold."""
        if np.dtype(self.dtype).kind not in _TYPES:
            raise PalmbotsError(f"log: the trace variable {self.name} has type {self.dtype}")


def variables_of(trace: "xr.Dataset") -> list[Variable]:
    """The variables of a trace that are logged, its time included, in their order."""
    variables = []
    for name in ("time", *map(str, trace.data_vars)):
        column = trace[name]
        attrs = {str(key): str(value) for key, value in column.attrs.items()}
        field = attrs.get("log_field")
        if field is None:
            continue
        variables.append(Variable(name, field, "side" in column.dims, column.dtype.str, attrs))
    return variables


class StateChannel:
    """The variables that share a message: those of one robot, or those of the pair."""

    def __init__(self, topics: tuple[str, ...], name: str, variables: list[Variable]) -> None:
        """`topics`: one for each robot, or one for the pair; `name`: of the message's type."""
        self.topics = topics
        self.variables = variables
        self._fields = [variable.field.rpartition("/")[2] for variable in variables]
        fields = {
            field: _TYPES[np.dtype(variable.dtype).kind]
            for field, variable in zip(self._fields, variables, strict=True)
        }
        if len(fields) < len(variables):
            raise PalmbotsError(f"log: two trace variables share a field of {name}: {self._fields}")
        self._message = message_type(name, fields)

    def messages(self, trace: "xr.Dataset") -> list[list[Any]]:
        """The messages of each topic, one for each row of the trace."""
        columns = [_values(trace, variable) for variable in self.variables]
        return [
            [
                self._message(**dict(zip(self._fields, row, strict=True)))
                for row in zip(*(column[k] for column in columns), strict=True)
            ]
            for k in range(len(self.topics))
        ]

    @property
    def descriptor(self) -> "Descriptor":
        """The protobuf description of the message."""
        return self._message.DESCRIPTOR

    def message(self, values: dict[str, Any]) -> Any:
        """The message of one instant, from the values of variables by their names."""
        pairs = zip(self._fields, self.variables, strict=True)
        return self._message(**{field: values[v.name] for field, v in pairs if v.name in values})

    def columns(self, messages: dict[str, list[bytes]]) -> dict[str, np.ndarray]:
        """The values of each variable, by its name, from the messages of each topic."""
        states = [[self._message.FromString(m) for m in messages[topic]] for topic in self.topics]
        columns = {}
        for field, variable in zip(self._fields, self.variables, strict=True):
            rows = [[getattr(state, field) for state in some] for some in states]
            values = np.array(rows, dtype=variable.dtype)
            columns[variable.name] = values.T if variable.by_side else values[0]
        return columns


def state_channels(variables: Iterable[Variable]) -> list[StateChannel]:
    """The channels that hold these variables."""
    groups: dict[tuple[bool, str], list[Variable]] = {}
    for variable in variables:
        key = (variable.by_side, variable.field.rpartition("/")[0])
        groups.setdefault(key, []).append(variable)
    channels = []
    for (by_side, channel), group in groups.items():
        names = SIDES if by_side else ("pair",)
        topics = tuple(f"/{name}/{channel}" if channel else f"/{name}" for name in names)
        kind = f"{'Robot' if by_side else 'Pair'}{channel.capitalize() or 'State'}"
        channels.append(StateChannel(topics, kind, group))
    return channels


def channels_of_worlds(more: Mapping[str, Mapping[str, str]] | None = None) -> list[StateChannel]:
    """The channels for the variables that every world records, and for more of them.

    Args:
        more: attributes of variables that a world adds or replaces: numbers, one for each robot.
    """
    pairs, single = np.zeros((1, 2)), np.zeros(1)
    kinds = {
        "separation": single,
        "midpoint": single,
        "object": single,
        "sign": np.zeros((1, 2), np.int64),
        "motion": np.zeros((1, 2), np.int64),
        "case": np.full((1, 2), b" ", "S1"),
    }
    arrays = {attrs["log_field"]: kinds.get(name, pairs) for name, attrs in VARIABLES.items()}
    added = {name: (pairs, attrs) for name, attrs in (more or {}).items()}
    return state_channels(variables_of(trace_dataset(arrays | {"time_s": single}, added)))


def _values(trace: "xr.Dataset", variable: Variable) -> list[list[Any]]:
    """The values for each topic."""
    column = trace[variable.name]
    if variable.by_side:
        return column.transpose("side", "time").to_numpy().tolist()
    return [column.to_numpy().tolist()]


MessageEvent: Any = message_type(
    "MessageEvent",
    {
        "sent_s": _DOUBLE,
        "received_s": _DOUBLE,
        "sender": _STRING,
        "receiver": _STRING,
        "kind": _STRING,
    },
)
"""A message between the robots; ``received_s`` is NaN if the message was lost."""

CorrectionEvent: Any = message_type(
    "CorrectionEvent",
    {
        "label": _STRING,
        "robot": _STRING,
        "case": _STRING,
        "assistant": _STRING,
        "start_s": _DOUBLE,
        "end_s": _DOUBLE,
    },
)
"""A correction, logged at its start; ``assistant`` is empty if no robot assists."""
