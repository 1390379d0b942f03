"""Periodic cells: homogenised moduli, unilateral response, strength, and the wall that they stand for."""
