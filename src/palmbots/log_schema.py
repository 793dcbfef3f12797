"""What the channels of a carry log hold, as protobuf messages made at run time.

Units are in the names of the fields; left and right robot have a channel of the same type each.
Protobuf keeps a double to the last bit. A field's number must never change its meaning: logs are
kept, and a later version reads the earlier ones.
"""

from typing import Any

from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

__all__ = ["CorrectionEvent", "LetterEvent", "PairState", "RobotDynamics", "RobotState"]

_Field = descriptor_pb2.FieldDescriptorProto
_KINDS = {
    "double": _Field.TYPE_DOUBLE,
    "sint32": _Field.TYPE_SINT32,
    "string": _Field.TYPE_STRING,
}

_MESSAGES = {
    # One robot at one tick. contact_m > 0 is outward, lift_m is the height of the contact vertex
    # above the palm, palm_rad > 0 rises outward; speeds are along the world's x. sign: the sensor's
    # reading. motion: −1 slides inward, 0 sticks, +1 outward.
    "RobotState": (
        ("contact_m", "double"),
        ("lift_m", "double"),
        ("palm_rad", "double"),
        ("speed_m_s", "double"),
        ("commanded_m_s", "double"),
        ("sign", "sint32"),
        ("motion", "sint32"),
        ("case", "string"),
    ),
    # What only the dynamic world knows of one robot at one tick: the object's force on the palm
    # along its normal and along it outward, how far wheels run ahead, how the body leans and heads,
    # where the contact is across the palm, and the pivot and the contact edge on the floor.
    "RobotDynamics": (
        ("force_n", "double"),
        ("drag_n", "double"),
        ("slip_m_s", "double"),
        ("pitch_rad", "double"),
        ("yaw_rad", "double"),
        ("across_m", "double"),
        ("pivot_x_m", "double"),
        ("pivot_y_m", "double"),
        ("vertex_x_m", "double"),
        ("vertex_y_m", "double"),
    ),
    # Both: time, distance of the pivots, way of their midpoint, angle of the object.
    "PairState": (
        ("time_s", "double"),
        ("separation_m", "double"),
        ("midpoint_m", "double"),
        ("object_rad", "double"),
    ),
    # A message between the robots; received_s is not a number where it was lost.
    "LetterEvent": (
        ("sent_s", "double"),
        ("received_s", "double"),
        ("sender", "string"),
        ("receiver", "string"),
        ("letter", "string"),
    ),
    # A correction, logged at its start; assistant is empty where nobody assists.
    "CorrectionEvent": (
        ("label", "string"),
        ("robot", "string"),
        ("case", "string"),
        ("assistant", "string"),
        ("start_s", "double"),
        ("end_s", "double"),
    ),
}


def _classes() -> dict[str, Any]:
    file = descriptor_pb2.FileDescriptorProto(
        name="palmbots/log.proto", package="palmbots", syntax="proto3"
    )
    for name, fields in _MESSAGES.items():
        message = file.message_type.add(name=name)
        for number, (field, kind) in enumerate(fields, start=1):
            message.field.add(
                name=field, number=number, type=_KINDS[kind], label=_Field.LABEL_OPTIONAL
            )
    pool = descriptor_pool.DescriptorPool()  # of its own: names cannot clash with another package
    pool.Add(file)
    return {
        name: message_factory.GetMessageClass(pool.FindMessageTypeByName(f"palmbots.{name}"))
        for name in _MESSAGES
    }


_made = _classes()
RobotState: Any = _made["RobotState"]
RobotDynamics: Any = _made["RobotDynamics"]
PairState: Any = _made["PairState"]
LetterEvent: Any = _made["LetterEvent"]
CorrectionEvent: Any = _made["CorrectionEvent"]
