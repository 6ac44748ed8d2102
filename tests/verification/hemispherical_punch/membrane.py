#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Stretching of a clamped circular membrane over a hemispherical punch and the shoulder of a die, without friction.

Axisymmetric two-node elements on the middle surface, logarithmic strains along the meridian and the circumference,
plane stress, von Mises, Swift, backward Euler. The tools are offset by half of the thickness that the sheet has; a
node in contact is pressed out by a penalty. No bending and no shear: what shells and solids have besides.
"""
import numpy as np

YOUNG, POISSON, STRENGTH, START, POWER = 69004.0, 0.3, 589.0, 1e-4, 0.216
RADIUS, THICKNESS, PUNCH, SHOULDER = 59.18, 1.0, 50.8, 6.35  # mm
STIFFNESS, LAYER = 1e6, 2e-3  # of the contact at a node, N/mm; gap over which its force falls to nothing, mm


def update(strain, stress, plastic):
    """Return stress and plastic strain of the elements after a strain increment (2, elements).

    Sum and difference of the two stresses fall independently: each by its elastic modulus times the plastic flow.
    """
    modulus = YOUNG/(1 - POISSON), YOUNG/(1 + POISSON)
    both = stress[0] + stress[1] + modulus[0]*(strain[0] + strain[1])
    apart = stress[0] - stress[1] + modulus[1]*(strain[0] - strain[1])
    flow = np.maximum(np.sqrt(0.25*both**2 + 0.75*apart**2)/(1.5*modulus[1]), 1e-12)
    for _ in range(12):  # Newton's method for the size of the stress less the yield stress
        limit = STRENGTH*(START + plastic + flow)**POWER
        slope = POWER*limit/(START + plastic + flow)
        one, three = 1 + 0.5*modulus[0]*flow/limit, 1 + 1.5*modulus[1]*flow/limit
        size = np.sqrt(0.25*(both/one)**2 + 0.75*(apart/three)**2)
        fall = (0.25*(both/one)**2*0.5*modulus[0]/one + 0.75*(apart/three)**2*1.5*modulus[1]/three)
        rate = -fall*(1 - flow*slope/limit)/limit/np.maximum(size, 1e-30) - slope
        flow = np.maximum(flow - (size - limit)/rate, 0.1*flow)
    flow = np.where(0.25*both**2 + 0.75*apart**2 > (STRENGTH*(START + plastic)**POWER)**2, flow, 0.0)
    limit = STRENGTH*(START + plastic + flow)**POWER
    both, apart = both/(1 + 0.5*modulus[0]*flow/limit), apart/(1 + 1.5*modulus[1]*flow/limit)
    return np.array([both + apart, both - apart])/2, plastic + flow


class Membrane:
    """The membrane from the pole to the clamped edge; x: radii and heights of the nodes (2, nodes)."""

    def __init__(self, elements):
        self.start = np.linspace(0, RADIUS, elements + 1)
        self.length, self.middle = np.diff(self.start), 0.5*(self.start[1:] + self.start[:-1])
        self.volume = 2*np.pi*self.middle*self.length*THICKNESS
        self.x = np.array([self.start, np.zeros(elements + 1)])
        self.free = np.ones((2, elements + 1), bool)
        self.free[:, -1], self.free[0, 0] = False, False
        self.strain, self.stress, self.plastic = np.zeros((2, elements)), np.zeros((2, elements)), np.zeros(elements)

    def strains(self, x):
        """Return the strains of the elements, and their derivatives by the nodes (strain, node, direction, element)."""
        step, mean = np.diff(x), 0.5*(x[0, 1:] + x[0, :-1])
        length = np.hypot(*step)
        slope = np.zeros((2, 2, 2, len(mean)))
        slope[0, 1], slope[0, 0] = step/length**2, -step/length**2
        slope[1, :, 0] = 0.5/mean
        return np.array([np.log(length/self.length), np.log(mean/self.middle)]), slope

    def half(self):
        """Return half of the thickness at the nodes."""
        own = 0.5*THICKNESS*np.exp(-self.strain.sum(axis=0))
        return np.concatenate([own[:1], 0.5*(own[1:] + own[:-1]), own[-1:]])

    def forces(self, x):
        """Return the inner forces of the nodes and their stiffness by differences of the stress."""
        strain, slope = self.strains(x)
        change = strain - self.strain
        stress, _ = update(change, self.stress, self.plastic)
        tangent = np.empty((2, 2, len(self.plastic)))
        for j in range(2):
            shifted = change.copy()
            shifted[j] += 1e-7
            tangent[:, j] = (update(shifted, self.stress, self.plastic)[0] - stress)/1e-7
        nodal = self.volume*np.einsum("se,snde->nde", stress, slope)
        step, mean = np.diff(x), 0.5*(x[0, 1:] + x[0, :-1])
        square = (step**2).sum(axis=0)
        second = (np.eye(2)[:, :, None] - 2*step[:, None]*step[None]/square)/square
        local = np.einsum("ande,abe,bmce->ndmce", slope, tangent, slope)
        sign = np.array([[1, -1], [-1, 1]])
        local += np.einsum("nm,dce->ndmce", sign, second*stress[0])
        local[:, 0, :, 0] -= 0.25*stress[1]/mean**2
        return nodal, self.volume*local

    def contact(self, x, height, offset):
        """Return the contact forces of the nodes, their stiffness (2, 2, nodes), and the force on the punch."""
        force, stiffness, punch = np.zeros_like(x), np.zeros((2, 2, x.shape[1])), 0.0
        for centre, radius in (((0.0, height - PUNCH - 0.5*THICKNESS), PUNCH),
                                ((RADIUS, SHOULDER + 0.5*THICKNESS), SHOULDER)):
            away = x - np.array(centre)[:, None]
            distance = np.maximum(np.hypot(*away), 1e-12)
            gap = np.maximum((radius + offset - distance)/LAYER, -40.0)
            side = x[1] > centre[1] if centre[0] == 0 else (x[0] <= RADIUS) & (x[1] < centre[1])
            normal, press = away/distance, np.where(side, STIFFNESS*LAYER*np.logaddexp(0.0, gap), 0.0)
            slope, across = np.where(side, STIFFNESS/(1 + np.exp(-gap)), 0.0), normal[:, None]*normal[None]
            own = -press*normal
            force += own
            stiffness += slope*across - press/distance*(np.eye(2)[:, :, None] - across)
            punch = -own[1].sum() if centre[0] == 0 else punch
        return force, stiffness, punch

    def residual(self, x, height, offset):
        """Return the residual of all nodes and its matrix, as of one vector, and the force on the punch."""
        count = x.shape[1]
        nodal, local = self.forces(x)
        touching, stiffness, punch = self.contact(x, height, offset)
        total, matrix = touching.copy(), np.zeros((2*count, 2*count))
        places = np.arange(count - 1)
        for n in range(2):
            total[:, places + n] += nodal[n]
            for d, m, c in np.ndindex(2, 2, 2):
                np.add.at(matrix, (d*count + places + n, c*count + places + m), local[n, d, m, c])
        for d, c in np.ndindex(2, 2):
            matrix[d*count + np.arange(count), c*count + np.arange(count)] += stiffness[d, c]
        return total.ravel(), matrix, punch

    def advance(self, height):
        """Move the punch to a height; return its force."""
        x, offset, free = self.x.copy(), self.half(), np.flatnonzero(self.free.ravel())
        for iteration in range(100):
            total, matrix, punch = self.residual(x, height, offset)
            if iteration and np.abs(total[free]).max() < 1e-6*max(punch, 1.0):
                break
            move = np.linalg.solve(matrix[np.ix_(free, free)], -total[free])
            x.ravel()[free] += move*min(1.0, 1.0/np.abs(move).max())
        else:
            raise ArithmeticError(f"no equilibrium at {height} mm")
        strain, _ = self.strains(x)
        self.stress, self.plastic = update(strain - self.strain, self.stress, self.plastic)
        self.x, self.strain = x, strain
        return punch


def move(membrane, start, height):
    """Move the punch from one height to another, in halves where there is no equilibrium; return its force."""
    try:
        return membrane.advance(height)
    except ArithmeticError:
        if height - start < 1e-3:
            raise
        move(membrane, start, 0.5*(start + height))
        return move(membrane, 0.5*(start + height), height)


def stretch(depth, elements=60, step=0.1):
    """Return heights, mm, forces, kN, and thickness strains of the pole to a depth."""
    membrane, rows, start = Membrane(elements), [(0.0, 0.0, 0.0)], 0.0
    membrane.x[1] = 1e-3*(1 - (membrane.start/RADIUS)**2)  # a flat membrane has no stiffness across
    for height in np.linspace(0, depth, round(depth/step) + 1)[1:]:
        force = move(membrane, start, height)
        rows.append((height, force/1000, -membrane.strain[:, 0].sum()))
        start = height
    return map(list, zip(*rows))


if __name__ == "__main__":
    for number in (30, 60, 120):
        found, powers, pole = stretch(46.0, number)
        for wanted in (10.0, 20.0, 30.0, 37.4, 40.0, 44.0, 46.0):
            print(number, wanted, *(f"{np.interp(wanted, found, values):.4f}" for values in (powers, pole)))
