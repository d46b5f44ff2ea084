"""What a benchmark has measured, as it is told and kept: rows {what, bar, value, unit, holds, detail}."""

import json
from pathlib import Path
from typing import Any, Dict, List, Union

Row = Dict[str, Any]
"""`holds`: None for a figure without a bar."""


def conclude(rows: List[Row], path: Union[str, Path]) -> int:
    """Prints the rows and writes them to the file. Returns the exit code: 0 if every bar holds, else 1."""
    for row in rows:
        mark = {None: "      ", True: "holds ", False: "MISSED"}[row["holds"]]
        print(f"{mark} {row['what']}: {row['value']} {row['unit']} ({row['bar']})")
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    barred = [row["holds"] for row in rows if row["holds"] is not None]
    print(f"{sum(barred)} of {len(barred)} bars hold; rows in {path}")
    return 0 if all(barred) else 1
