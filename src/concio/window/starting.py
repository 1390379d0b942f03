"""Model texts for files that are opened: a drawing, solids, or a picture of a wall.

A value that no drawing has is marked by a comment, ``# begun with 0.6: state yours``. The page lists values that are
still those of their comments; a button there removes the comments.
"""

from __future__ import annotations

from pathlib import Path

from concio.window.folder import PICTURES, SOLIDS
from concio.window.toml_edits import literal

TO_FILL = {
    "site": """
[site]                            # of concio assess; every value is to be stated
soil = ""                         # A to E
topography = ""                   # T1 to T4
nominal_life = ""                 # years
use_class = ""                    # I to IV

[site.hazard.SLV]
a_g = ""                          # in g, or with a unit: 1.96 m/s2
F0 = ""
Tc = ""                           # s

[assessment]
knowledge = ""                    # LC1, LC2 or LC3

[assessment.report]
project = ""
place = ""
author = ""
date = ""
""",
}
"""Tables that a question needs, with their values to be stated."""


def model_text(file: Path) -> str | None:
    """Return the text of a model that names a file; None for a model file itself."""
    suffix = file.suffix.lower()
    if suffix == ".dxf":
        return _drawing(file)
    if suffix in SOLIDS:
        return _solids(file)
    return _picture(file) if suffix in PICTURES else None


def _drawing(drawing: Path) -> str:
    return f"""# Blocks of the drawing {drawing.name}.
# State what its layers mean, the thickness, the material and the joints.
title = {literal(drawing.stem)}
blocks_file = {literal(drawing.name)}

[analysis]
thickness = 1.0                   # out of plane; begun with 1.0: state yours

[materials.block]
kind = "rigid"
unit_weight = "20 kN/m3"          # begun with 20 kN/m3: state yours

[joints.joint]
friction = 0.6                    # begun with 0.6: state yours

[drawing.layers]
"""


def _solids(file: Path) -> str:
    return f"""# Solids of {file.name}. State the unit, the material and the joints.
title = {literal(file.stem)}
solids_file = {literal(file.name)}

[solids]
ground = true                     # a fixed body under the lowest blocks
mend = "1 mm"                     # faces that nearly touch are moved together within

[materials.block]
kind = "rigid"
unit_weight = "20 kN/m3"          # begun with 20 kN/m3: state yours

[joints.joint]
friction = 0.6                    # begun with 0.6: state yours
# The self-weight acts in the load group "dead".
"""


def _picture(file: Path) -> str:
    return f"""# Blocks of the picture {file.name}: give it its scale, then trace its stones under Picture.
title = {literal(file.stem)}

[record.picture]
file = {literal(file.name)}

[analysis]
thickness = 1.0                   # out of plane; begun with 1.0: state yours

[materials.block]
kind = "rigid"
unit_weight = "20 kN/m3"          # begun with 20 kN/m3: state yours

[joints.joint]
friction = 0.6                    # begun with 0.6: state yours

[[loads]]
kind = "weight"
value = [0, -1]
group = "dead"
"""
