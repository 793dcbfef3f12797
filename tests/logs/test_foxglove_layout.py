# SPDX-License-Identifier: Apache-2.0
"""The layout for Foxglove names only topics and fields that a carry log has."""

import json

from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

import palmbots as pb
from palmbots import write_log
from palmbots.logs.foxglove_layout import layout_text


def test_every_topic_and_field_exists(tmp_path):
    write_log(
        pb.carry("paper", record=True, overrides={"task.distance_m": 0.1}), tmp_path / "c.mcap"
    )
    known: dict[str, set[str]] = {}
    with (tmp_path / "c.mcap").open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        known["/robot_description"] = set()
        summary = reader.get_summary()
        assert summary is not None
        topics = {channel.topic for channel in summary.channels.values()} - set(known)
        for _, channel, _, message in reader.iter_decoded_messages(topics=sorted(topics)):
            known[channel.topic] = {field.name for field in message.DESCRIPTOR.fields}
    layout = json.loads(layout_text())
    panels = layout["configById"]
    leaves: set[str] = set()

    def walk(node):
        if isinstance(node, str):
            leaves.add(node)
        else:
            walk(node["first"])
            walk(node["second"])

    walk(layout["layout"])
    assert leaves == set(panels)
    assert set(panels["3D!carry"]["topics"]) <= set(known)
    paths = [path["value"] for panel in panels.values() for path in panel.get("paths", ())]
    assert len(paths) == 6
    for path in paths:
        topic, field = path.split(".")
        assert field in known[topic]
    assert panels["RawMessages!corrections"]["topicPath"] in known
