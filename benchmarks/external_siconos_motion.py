"""Siconos on a stack of rocking blocks; run by the system's Python (Debian package ``python3-siconos``).

    /usr/bin/python3 external_siconos_motion.py problem.npz answer.npz

Knows nothing of concio: reads half widths b (k,), half heights h (k,), masses and polar moments of the blocks, all of
them standing on each other, friction, gravity, the step and the acceleration of the ground at the middle of each
step (n,); writes the coordinates (x, y, angle) of all blocks (n, k, 3) at the end of each step, and processor seconds.

The scheme is Siconos' own Moreau-Jean time stepping with theta = 1/2; contact is Coulomb friction in the plane with
Newton's impact law, e = 0, solved by its Lemke method. Each block touches what is below it with its two lower corners;
their gaps and slips are linear relations that this script writes again before every step, half a step ahead. (Relations
that Python classes evaluate end in a segmentation fault in Siconos 4.4.0 as Debian builds it.)
"""

import sys
import time

import numpy as np
import siconos.kernel as sk
import siconos.numerics as sn


class Corner:
    """Gap and slip of a lower corner over the ground, or over the upper side of another block: y = C q + e.

    C and e are those of the geometry half a step ahead, written again before every step.
    """

    def __init__(self, block, arm, below=None, top=0.0):
        self.C_of, self.e_of = np.zeros((2, 3 if below is None else 6)), np.zeros(2)
        self.relation = sk.LagrangianLinearTIR(self.C_of, self.e_of)
        self.block, self.arm, self.below, self.top = block, arm, below, top

    def look(self, step):
        """Write the geometry half a step ahead."""
        q = self.block.q() + 0.5 * step * self.block.velocity()
        c, s = np.cos(q[2]), np.sin(q[2])
        arm = np.array([c * self.arm[0] - s * self.arm[1], s * self.arm[0] + c * self.arm[1]])
        away, both = q[:2] + arm, q
        normal, tangent = np.array([0.0, 1.0]), np.array([1.0, 0.0])
        if self.below is not None:
            low = self.below.q() + 0.5 * step * self.below.velocity()
            away, both = away - low[:2], np.concatenate([q, low])
            normal = np.array([-np.sin(low[2]), np.cos(low[2])])
            tangent = np.array([normal[1], -normal[0]])
        for row, axis in enumerate((normal, tangent)):
            self.C_of[row, :2], self.C_of[row, 2] = axis, arm[0] * axis[1] - arm[1] * axis[0]
            if self.below is not None:
                self.C_of[row, 3:5], self.C_of[row, 5] = -axis, -(away[0] * axis[1] - away[1] * axis[0])
        self.e_of[:] = np.array([normal @ away - self.top, 0.0]) - self.C_of @ both
        self.relation.setCPtr(self.C_of)
        self.relation.setEPtr(self.e_of)


def main():
    """Compute the motion of the first file, write it to the second."""
    data = np.load(sys.argv[1])
    b, h, mass, moment = (data[name] for name in ("b", "h", "mass", "moment"))
    ground, step, gravity = data["ground"], float(data["step"]), float(data["gravity"])
    model = sk.NonSmoothDynamicalSystem(0.0, step * len(ground))
    law = sk.NewtonImpactFrictionNSL(0.0, 0.0, float(data["friction"]), 2)
    contacts, blocks, forces, bottom = [], [], [], 0.0
    for k in range(len(b)):
        block = sk.LagrangianLinearTIDS(
            [0.0, bottom + h[k], 0.0], [0.0, 0.0, 0.0], np.diag([mass[k], mass[k], moment[k]])
        )
        force = np.array([0.0, -mass[k] * gravity, 0.0])
        block.setFExtPtr(force)
        model.insertDynamicalSystem(block)
        for side in (-b[k], b[k]):
            below = blocks[-1] if blocks else None
            corner = Corner(block, (side, -h[k]), below, h[k - 1] if blocks else 0.0)
            contact = sk.Interaction(law, corner.relation)
            model.link(contact, block, *([below] if blocks else []))
            contacts.append((corner, contact))
        blocks.append(block)
        forces.append(force)
        bottom += 2 * h[k]
    scheme, instants = sk.MoreauJeanOSI(0.5), sk.TimeDiscretisation(0.0, step)
    contact_solver = sk.FrictionContact(2, sn.SICONOS_FRICTION_2D_LEMKE)
    simulation = sk.TimeStepping(model, instants, scheme, contact_solver)
    path = np.zeros((len(ground), len(b), 3))
    begun = time.process_time()
    for i, acceleration in enumerate(ground):
        for k, force in enumerate(forces):
            force[0] = -mass[k] * acceleration
            blocks[k].setFExtPtr(force)
        for corner, contact in contacts:
            corner.look(step)
            contact.computeOutput(i * step, 0)
        simulation.computeOneStep()
        path[i] = [block.q() for block in blocks]
        if simulation.hasNextEvent():
            simulation.nextStep()
    seconds = time.process_time() - begun
    np.savez(sys.argv[2], path=path, seconds=seconds)


if __name__ == "__main__":
    main()
