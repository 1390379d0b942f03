"""``python -m concio``: the command line."""

from __future__ import annotations

from concio.cli.main import main

if __name__ == "__main__":
    main()
