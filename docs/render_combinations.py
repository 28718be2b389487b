"""Write docs/combinations.md from the registries of the code."""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from solvers.combinations import markdown  # noqa: E402

(ROOT / "docs" / "combinations.md").write_text(markdown(), encoding="utf-8")
