# SPDX-License-Identifier: Apache-2.0
"""What a command printed with `--json`, checked against its schema."""

import json
from functools import cache
from typing import Any

from jsonschema import Draft202012Validator

from palmbots.cli.json_schemas import schema_of


@cache
def validator(command: str) -> Draft202012Validator:
    return Draft202012Validator(schema_of(command))


def read_json(command: str, text: str) -> Any:
    """The object, after it was found to have the form of its schema."""
    table = json.loads(text)
    validator(command).validate(table)
    return table
