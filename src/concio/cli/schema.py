"""``concio schema``: the JSON Schema of model files."""

from __future__ import annotations

import json

from concio.cli.outcome import guarded, say


@guarded
def schema() -> int:
    """Print the JSON Schema of model files.

    Example: concio schema > concio.schema.json
    """
    from concio.model.file.file_table import json_schema

    say(json.dumps(json_schema(), indent=2, ensure_ascii=False))
    return 0
