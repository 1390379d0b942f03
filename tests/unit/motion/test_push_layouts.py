"""Equilibria of a push are kept with the contact pairs of their own, whatever was tried after them."""

from __future__ import annotations

import numpy as np
import pytest

import concio
from concio.analysis.motion.statics import Statics

PILLAR = concio.column(width=0.5, height=2.0, blocks=2, block="rigid")


@pytest.mark.parametrize("model", [PILLAR, concio.extrude(PILLAR, 0.4)], ids=["plane", "space"])
def test_a_trial_elsewhere_changes_nothing_of_what_is_kept(model, monkeypatch):
    """Where bodies meet is located by trials: an earlier one may count, and a later one may have seen other pairs."""
    alone = concio.push(model, step=0.05)
    balance = Statics.balance

    def tried_elsewhere(self, state, *args, **options):
        found = balance(self, state, *args, **options)
        shift = np.zeros_like(state.centre)
        shift[-1, -1] = 5.0
        if self.maker.search.update(state.placement.moved(shift, np.zeros_like(state.spin))):
            self.solver.new_layout()
        return found

    monkeypatch.setattr(Statics, "balance", tried_elsewhere)
    found = concio.push(model, step=0.05)
    assert found.certified
    np.testing.assert_allclose(found.multiplier, alone.multiplier, atol=1e-9)
    np.testing.assert_allclose(found.reaction, alone.reaction, atol=1e-6)
    weight = sum(body.volume * 20.0 for body in model.free_bodies)
    np.testing.assert_allclose(found.reaction.sum(axis=1)[:, -1], weight, rtol=1e-9)
    assert [str(event) for event in found.events] == [str(event) for event in alone.events]
