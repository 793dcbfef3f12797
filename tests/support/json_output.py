# SPDX-License-Identifier: Apache-2.0
"""What a command printed with `--json`, and the records of a log, for checks by their schemas."""

import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

from google.protobuf.json_format import MessageToDict
from jsonschema import Draft202012Validator
from jsonschema.protocols import Validator
from mcap.reader import make_reader

from palmbots.cli.json_schemas import schema_of
from palmbots.logs import decoder_factories


@cache
def validator(command: str) -> Validator:
    return Draft202012Validator(schema_of(command))


def read_json(command: str, text: str) -> Any:
    """The object, after it was found to have the form of its schema."""
    table = json.loads(text)
    validator(command).validate(table)
    return table


def records(path: Path) -> Iterator[dict[str, Any]]:
    """The messages of a log, as the schema `log` describes them."""
    with path.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=decoder_factories())
        for _, channel, _, message in reader.iter_decoded_messages():
            table = (
                message
                if isinstance(message, str)
                else MessageToDict(message, preserving_proto_field_name=True)
            )
            yield {"topic": channel.topic, "message": table}
