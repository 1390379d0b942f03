"""Every tolerance that decides what is said of an answer, with what it means.

Numbers that only steer a method (step lengths, budgets) stay with the method. What stands here decides whether a thing
*is* something: certified, exact, rough, zero. All are relative: forces to the total load or the largest force, lengths
to the largest displacement, velocities to the largest velocity; the sentence of each says to which.
"""

from __future__ import annotations

import numpy as np

# -- the problem ----------------------------------------------------------------------------------------------------

SMOOTH = 1e-12
"""Friction coefficients up to this are none, and c - mu T below this share of c is zero."""

# -- answers --------------------------------------------------------------------------------------------------------

CERTIFIED = 1e-9
"""Largest worst entry of the certificate of an answer that may be called solved; relative to load and displacement."""

ROUNDING = 4.0 * float(np.finfo(float).eps)
"""Share of |K| |u| by which rounding of displacements may put the balance at a node wrong."""

GRANTED = 1e-7
"""Largest share of the load that is granted to rounding."""

EXACT = 1e-11
"""Largest natural-map residual of an exact answer: its states are the right ones, what is left is rounding.

Relative to the largest force and displacement, in units of the problem's own. A structure that drifts off may come
near, never here."""

AT_BOUND = 1e-9
"""Forces, gaps and slips below this share of the largest count as zero where the state of a pair is read off."""

CONSTANTS_STAY = 1e-10
"""Largest change of a constant of joint laws, relative to the largest of its kind at first, up to which constants that
depend on the answer belong to it."""

# -- proofs ---------------------------------------------------------------------------------------------------------

ADMISSIBLE = 1e-9
"""Largest violation of a motion, relative to its largest velocity, that is accepted in a proof."""

BALANCED = 1e-11
"""Largest imbalance of forces, relative to the load, that prove that the loads can be carried: well below the power at
which a mechanism proves the contrary, so that both cannot be shown."""

CLEARLY = 1e-9
"""A power counts as positive when it exceeds this share of the sum of |f_i v_i|."""

CHECKED = 1e-8
"""Largest residual, violation and duality gap of a limit load or collapse state that counts as checked from both
sides; largest entry of the certificate of homogenised moduli."""
