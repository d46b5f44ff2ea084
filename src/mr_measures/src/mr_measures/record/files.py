"""Mission records as JSON files: one file for each, with the version of its form as `format`."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from mr_measures.record.json_form import FormError, from_json, to_json
from mr_measures.record.mission_record import READABLE, SCHEMA, MissionRecord

STACK_RECORD = "record.json"
"""In the output folder of every mission of the ROS stack."""


class RecordError(ValueError):
    """A record or a folder of records that cannot be used; the text names the file and what is wrong with it."""


def document_of(record: MissionRecord) -> dict[str, Any]:
    """Plain values, as they are written."""
    return {"format": SCHEMA, **to_json(record)}


def record_of_document(document: Any) -> MissionRecord:
    """Raises RecordError for another form of record or for one that is damaged."""
    if not isinstance(document, Mapping) or "format" not in document:
        raise RecordError("no record of a mission: it has no format number")
    if document["format"] not in READABLE:
        known = " and ".join(map(str, READABLE))
        raise RecordError(f"the record has format {document['format']!r}; this version reads formats {known}")
    try:
        return from_json(MissionRecord, document)
    except FormError as error:
        raise RecordError(f"damaged record: {error}") from None


def write_record(record: MissionRecord, path: Path) -> None:
    """Whole or not at all."""
    partial = path.with_suffix(f".{os.getpid()}.partial")
    text = json.dumps(document_of(record), separators=(",", ":"), allow_nan=False)
    try:
        partial.write_text(text + "\n", encoding="utf-8")
        os.replace(partial, path)
    except OSError:
        partial.unlink(missing_ok=True)
        raise


def read_record(path: Path) -> MissionRecord:
    """Raises RecordError."""
    try:
        return record_of_document(json.loads(path.read_text(encoding="utf-8")))
    except FileNotFoundError:
        raise RecordError(f"{path} is not there") from None
    except OSError as error:
        raise RecordError(f"{path} cannot be read: {error.strerror}") from None
    except (UnicodeDecodeError, json.JSONDecodeError) as error:
        raise RecordError(f"{path} cannot be read as JSON: {error}") from None
    except RecordError as error:
        raise RecordError(f"{path}: {error}") from None
