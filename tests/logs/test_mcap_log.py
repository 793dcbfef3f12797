# SPDX-License-Identifier: Apache-2.0
"""Carry logs: they keep every bit, say when they are damaged, and replay to the same bits."""

import dataclasses
import json
import math
import struct
from xml.etree import ElementTree

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer
from mcap_protobuf.decoder import DecoderFactory

import palmbots as pb
from palmbots import read_log, replay, write_log
from palmbots.errors import PalmbotsError
from palmbots.logs import decoder_factories


@pytest.fixture(scope="module")
def done():
    overrides = {"task.distance_m": 0.3, "radio.loss": 0.1}
    carries = (pb.carry("paper", "distributed", seed=k, overrides=overrides) for k in range(50))
    return next(c for c in carries if any(m.received_s is None for m in c.message_log))


@pytest.fixture(scope="module")
def path(done, tmp_path_factory):
    path = tmp_path_factory.mktemp("log") / "carry.mcap"
    write_log(done, path)
    return path


FOREIGN = "not a carry log of palmbots: its records are incomplete or malformed"


def refusal(path):
    with pytest.raises(PalmbotsError) as error:
        read_log(path)
    text = str(error.value)
    assert "\n" not in text
    assert text.startswith(f"{path}: ")
    return text.removeprefix(f"{path}: ")


def same_bits(one, other):
    """Of the logged variables; the pose follows from them."""
    one, other = (trace.drop_vars(("object_x", "object_height")) for trace in (one, other))
    assert list(one.data_vars) == list(other.data_vars)
    assert set(one.coords) == set(other.coords)
    for name in one.variables:
        a, b = one[name], other[name]
        assert (a.dims, a.dtype, a.attrs) == (b.dims, b.dtype, b.attrs), name
        assert a.to_numpy().tobytes() == b.to_numpy().tobytes(), name


# --- what is written is read ------------------------------------------------------------------


def test_log_contains_every_field_of_the_carry(done, path):
    log = read_log(path)
    assert done.corrections and done.message_log
    for field in dataclasses.fields(done):
        if field.name != "trace" and field.compare:
            assert getattr(log, field.name) == getattr(done, field.name), field.name
    same_bits(log.trace, done.trace)


@pytest.mark.parametrize(
    ("scene", "world", "keys"),
    [("lift", "quasistatic", {"task.to": "palms"}), ("paper", "mujoco", {"task.distance_m": 0.02})],
)
def test_phases_of_a_job_and_slip_of_wheels_are_kept(tmp_path, scene, world, keys):
    done = pb.carry(scene, "shared-sign", world=world, overrides=keys)
    write_log(done, tmp_path / "c.mcap")
    again = replay(tmp_path / "c.mcap")
    assert again.identical and again.log.summary() == done.summary() | {"format": again.log.format}
    assert done.floor_job is not None or done.wheel_slip_m is not None


@pytest.mark.parametrize("controller", ["none", "centralized", "distributed"])
@pytest.mark.parametrize("precision", ["double", "float"])
def test_log_replays_identically(tmp_path, controller, precision):
    overrides = {"task.distance_m": 0.3, "radio.jitter_s": 0.02, "tactile.false_rate": 0.01}
    done = pb.carry("paper", controller, seed=5, precision=precision, overrides=overrides)
    write_log(done, tmp_path / "c.mcap")
    again = replay(tmp_path / "c.mcap")
    assert again.identical
    assert again.difference is None
    assert again.trace_hash == again.logged_hash == done.trace_hash
    assert done.trace is not None
    assert again.samples == done.trace.sizes["time"]


@pytest.mark.parametrize(
    "value", [-0.0, 5e-324, -5e-324, math.inf, -math.inf, 1 / 3, 1.7976931348623157e308, "nan"]
)
def test_every_bit_of_a_double_survives(tmp_path, done, value):
    if value == "nan":  # one with a payload
        value = struct.unpack("<d", struct.pack("<Q", 0x7FF8_0000_DEAD_BEEF))[0]
    trace = done.trace.copy(deep=True)
    trace["speed"][3, 1] = value
    trace["separation"][4] = value
    write_log(dataclasses.replace(done, trace=trace), tmp_path / "c.mcap")
    same_bits(read_log(tmp_path / "c.mcap").trace, trace)


def test_the_same_carry_gives_the_same_file(tmp_path, done, path):
    write_log(done, tmp_path / "c.mcap")
    assert (tmp_path / "c.mcap").read_bytes() == path.read_bytes()


def test_carry_that_ends_in_the_first_tick_is_handled(tmp_path):
    done = pb.carry("paper", "distributed", overrides={"task.slope_deg": 20.0})
    write_log(done, tmp_path / "c.mcap")
    same_bits(read_log(tmp_path / "c.mcap").trace, done.trace)
    assert replay(tmp_path / "c.mcap").identical


# --- what other programs find in it ------------------------------------------------------------


def test_channels_are_typed_and_in_order(done, path):
    with open(path, "rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics is not None
        types = {c.topic: summary.schemas[c.schema_id].name for c in summary.channels.values()}
        counts = {
            summary.channels[k].topic: n
            for k, n in summary.statistics.channel_message_counts.items()
        }
        times = [message.log_time for _, _, message in reader.iter_messages(log_time_order=False)]
        facts = {record.name: record.metadata for record in reader.iter_metadata()}["palmbots"]
        topics = ["/left", "/right", "/pair"]
        decoded = [(c.topic, m) for _, c, _, m in reader.iter_decoded_messages(topics=topics)]
    assert types == {
        "/left": "palmbots.RobotState",
        "/right": "palmbots.RobotState",
        "/pair": "palmbots.PairState",
        "/messages": "palmbots.MessageEvent",
        "/corrections": "palmbots.CorrectionEvent",
        "/tf": "foxglove.FrameTransforms",
        "/solids": "foxglove.SceneUpdate",
        "/contacts": "foxglove.SceneUpdate",
        "/robot_description": "std_msgs/msg/String",
    }
    samples = done.trace.sizes["time"]
    assert counts["/left"] == counts["/right"] == counts["/pair"] == samples
    assert counts["/tf"] == counts["/contacts"] == pytest.approx(samples / 4, abs=2)
    assert times == sorted(times)
    assert times[-1] == round(float(done.trace["time"][-1]) * 1e9)
    contact = [message.contact_m for topic, message in decoded if topic == "/right"]
    assert contact == done.trace["contact"].sel(side="right").to_numpy().tolist()
    assert facts["trace_hash"] == done.trace_hash
    assert json.loads(facts["scene"]) == done.scene.model_dump(mode="json")


def test_package_mcap_decodes_every_channel(path):
    with open(path, "rb") as stream:
        reader = make_reader(stream, decoder_factories=decoder_factories())
        summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics is not None
        decoded = [(channel.topic, m) for _, channel, _, m in reader.iter_decoded_messages()]
    assert len(decoded) == summary.statistics.message_count
    assert {topic for topic, _ in decoded} == {c.topic for c in summary.channels.values()}
    robot = ElementTree.fromstring(dict(decoded)["/robot_description"])
    assert (robot.tag, robot.get("name")) == ("robot", "palmbots")
    assert dict(decoded)["/left"].palm_rad > 0


def test_carry_log_is_small_and_quickly_written(tmp_path):
    write_log(pb.carry("paper", seed=0), tmp_path / "c.mcap")
    assert (tmp_path / "c.mcap").stat().st_size < 1e6


# --- damage ------------------------------------------------------------------------------------


def test_every_truncation_is_noticed(tmp_path, path):
    data = path.read_bytes()
    cut = tmp_path / "cut.mcap"
    for length in {*range(0, len(data), 997), *range(40), *range(len(data) - 400, len(data))}:
        cut.write_bytes(data[:length])
        reason = refusal(cut)
        assert reason == "the file is empty" if length == 0 else reason


def test_every_changed_byte_is_noticed(tmp_path, path):
    data = path.read_bytes()
    changed = tmp_path / "changed.mcap"
    places = {*range(0, len(data), 997), *range(100), *range(len(data) - 400, len(data))}
    random = np.random.default_rng(0)
    for place in places:
        flipped = bytearray(data)
        flipped[place] ^= 1 << int(random.integers(8))
        changed.write_bytes(flipped)
        refusal(changed)


def test_appended_bytes_are_noticed(tmp_path, path):
    longer = tmp_path / "longer.mcap"
    longer.write_bytes(path.read_bytes() + b"\0")
    assert "damaged at its end" in refusal(longer)


def foreign(path, metadata, crcs=True):
    with open(path, "wb") as stream:
        writer = Writer(
            stream, compression=CompressionType.NONE, enable_crcs=crcs, enable_data_crcs=crcs
        )
        writer.start()
        for name, record in metadata.items():
            writer.add_metadata(name, record)
        writer.finish()


@pytest.mark.parametrize("crcs", [True, False])
def test_foreign_mcap_files_are_refused(tmp_path, crcs):
    there = tmp_path / "foreign.mcap"
    foreign(there, {}, crcs)
    assert refusal(there) == "not a carry log of palmbots: it has no metadata record of that name"
    foreign(there, {"palmbots": {}}, crcs)
    assert refusal(there) == FOREIGN


def with_facts(path, there, **changes):
    """Copy the metadata of a log, with these changes, into a log without messages."""
    with open(path, "rb") as stream:
        facts = {record.name: record.metadata for record in make_reader(stream).iter_metadata()}
    foreign(there, {"palmbots": facts["palmbots"] | changes})


def test_other_format_is_refused_with_both_versions(tmp_path, path):
    there = tmp_path / "old.mcap"
    with_facts(path, there, format="2", version="0.0.9")
    assert refusal(there) == (
        "a carry log of format 2, written by palmbots 0.0.9; "
        f"palmbots {pb.__version__} reads format 4"
    )


def test_log_without_its_messages_is_refused(tmp_path, path):
    there = tmp_path / "empty.mcap"
    with_facts(path, there)
    assert refusal(there).startswith("samples are missing: ")
    with_facts(path, there, samples="{\n")
    assert refusal(there) == FOREIGN
    with_facts(path, there, variables='[{"name": "x"}]')
    assert refusal(there) == FOREIGN


def rewritten(path, there, **options):
    """The log, written again record by record by the package mcap."""
    with open(path, "rb") as source, open(there, "wb") as goal:
        reader = make_reader(source)
        writer = Writer(goal, **options)
        writer.start()
        for record in reader.iter_metadata():
            writer.add_metadata(record.name, record.metadata)
        channels = {}
        for schema, channel, message in reader.iter_messages(log_time_order=False):
            assert schema is not None
            if channel.topic not in channels:
                number = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.topic] = writer.register_channel(
                    channel.topic, channel.message_encoding, number
                )
            writer.add_message(
                channels[channel.topic], message.log_time, message.data, message.publish_time
            )
        writer.finish()


@pytest.mark.parametrize(
    "options",
    [
        {},  # the defaults of the package leave out the checksum of the data
        {"enable_crcs": False},
        {"use_chunking": False},
        {"enable_crcs": False, "use_chunking": False},
    ],
)
def test_log_without_checksums_is_read_and_replays(tmp_path, done, path, options):
    there = tmp_path / "rewritten.mcap"
    rewritten(path, there, **options)
    same_bits(read_log(there).trace, done.trace)
    assert replay(there).identical


def test_damaged_chunk_is_noticed_without_checksum_of_the_data(tmp_path, path):
    there = tmp_path / "rewritten.mcap"
    rewritten(path, there, compression=CompressionType.NONE)
    data = bytearray(there.read_bytes())
    data[len(data) // 2] ^= 1
    there.write_bytes(data)
    assert refusal(there) == "the log is damaged: a checksum of its data is wrong"


# --- replay states what differs -----------------------------------------------------------------


def differing(tmp_path, done, **changes):
    """What replay says of a log in which something was changed before it was written."""
    write_log(dataclasses.replace(done, **changes), tmp_path / "c.mcap")
    found = replay(tmp_path / "c.mcap")
    assert not found.identical
    assert found.difference is not None
    assert "\n" not in found.difference
    return found.difference


def test_the_first_sample_that_differs_is_named(tmp_path, done):
    trace = done.trace.copy(deep=True)
    trace["midpoint"][30] = 0.5
    trace["palm"][21, 0] = np.nextafter(float(trace["palm"][21, 0]), 1.0)
    trace["contact"][21, 1] = float(trace["contact"][21, 1]) + 1.0
    report = differing(tmp_path, done, trace=trace)
    assert report.startswith("sample 21 (t = 0.21 s): contact right was 1.0")
    trace = done.trace.copy(deep=True)
    trace["case"][21, 0] = "x"
    assert "case left was 'x'" in differing(tmp_path, done, trace=trace)
    fewer = done.trace.isel(time=slice(-1))
    assert "samples, the new run" in differing(tmp_path, done, trace=fewer)


def test_other_differences_are_named(tmp_path, done):
    first = done.message_log[0]
    moved = (dataclasses.replace(first, sent_s=first.sent_s + 1e-9), *done.message_log[1:])
    assert differing(tmp_path, done, message_log=moved) == "message_log: number 1 differs"
    gone = done.corrections[:-1]
    number = len(done.corrections)
    report = differing(tmp_path, done, corrections=gone)
    assert report == f"corrections: number {number} differs"
    assert differing(tmp_path, done, outcome="stalled").startswith("outcome was 'stalled'")
    assert differing(tmp_path, done, trace_hash="0" * 16).startswith("trace_hash was 0000")
    report = differing(tmp_path, done, outcome="stalled", version="0.0.1")
    assert report.endswith(f"(logged by version 0.0.1, run again by {done.version})")


# --- variables of a world ------------------------------------------------------------------------


def test_variables_of_a_world_are_logged_by_their_attributes(tmp_path, done):
    trace = done.trace.copy(deep=True)
    rows = trace.sizes["time"]
    heat = np.arange(2.0 * rows).reshape(rows, 2)
    attrs = {"units": "K", "long_name": "heat of the motors", "log_field": "heat/heat_k"}
    trace["heat"] = (("time", "side"), heat, attrs)
    trace["load"] = (("time",), np.arange(rows) % 5, {"units": "1", "log_field": "load"})
    trace["private"] = (("time",), np.zeros(rows), {"units": "1"})
    write_log(dataclasses.replace(done, trace=trace), tmp_path / "c.mcap")
    same_bits(read_log(tmp_path / "c.mcap").trace, trace.drop_vars("private"))
    with open(tmp_path / "c.mcap", "rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        decoded = reader.iter_decoded_messages(topics=["/right/heat", "/pair"])
        messages = [(channel.topic, message) for _, channel, _, message in decoded]
    assert [m.heat_k for topic, m in messages if topic == "/right/heat"] == heat[:, 1].tolist()
    assert [m.load for topic, m in messages if topic == "/pair"][:7] == [0, 1, 2, 3, 4, 0, 1]
