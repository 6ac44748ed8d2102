# SPDX-License-Identifier: GPL-3.0-or-later
"""An elastic strip on a contact layer, plane strain: one half, from the middle to the free end, by multiple shooting.

The strip is a rod that bends, shears and stretches with large rotations (Reissner, J. Appl. Math. Phys. 23 (1972)
795-804): its middle line r(s) and the angle a of its sections, with the unit vectors t = (cos a, sin a) and b at right
angles to it. With the force n and the moment m of a section, the load f of a unit of length and its moment c,

    r' = (1 + n.t/(E' A)) t + n.b/(G A_s) b,    a' = m/(E' I),    n' = -f,    m' = -(r' x n) - c.

The layer of height h presses on the lower face, at q = r - t/2 b, along the normal of the tool, by p_0 (h/g - 2 + g/h)
of the gap g at q. A pressure on the upper face follows the face.
"""
import math

THICKNESS, YOUNG, POISSON = 1.0, 2.1e5, 0.3
PLANE = YOUNG / (1 - POISSON**2)
BENDING = PLANE * THICKNESS**3 / 12
SHEAR = 5 / 6 * THICKNESS * YOUNG / 2 / (1 + POISSON)
REFERENCE = 1e-5 * YOUNG  # pressure p_0 of the layer, MPa
PARTS = (0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 0.7)  # beginnings of the parts, over the length
LEAST = 0.03  # part of the layer below which its law goes on as a line, for the trial states


def layer_pressure(gap, height):
    """Return the pressure at a gap."""
    left = gap / height
    if left >= 1:
        return 0.0
    if left < LEAST:
        return REFERENCE * ((1 / LEAST - 2 + LEAST) + (LEAST - left) * (1 / LEAST**2 - 1))
    return REFERENCE * (1 / left - 2 + left)


def flat(x, z):
    """Return the gap to the plane z = 0 and its normal."""
    return z, 0.0, 1.0


def cylinder(radius):
    """Return the function of the gap to a cylinder with its top at z = 0, and of its normal."""
    def place(x, z):
        distance = math.hypot(x, z + radius)
        return distance - radius, x / distance, (z + radius) / distance
    return place


class Strip:
    """Half a strip of a length, on a tool with a layer of a height, under a pressure and loads per unit of width."""

    def __init__(self, length, tool, height, pressure=0.0, middle=0.0, end=0.0, steps=800):
        self.length, self.tool, self.height, self.pressure = length, tool, height, pressure
        self.middle, self.end, self.steps = middle, end, steps

    def gap(self, state):
        """Return the lower face's gap, and the normal of the tool there."""
        x, z, angle = state[:3]
        return self.tool(x + THICKNESS / 2 * math.sin(angle), z - THICKNESS / 2 * math.cos(angle))

    def derivative(self, state):
        """Return the derivatives of x, z, angle, horizontal and vertical force, and moment."""
        _, _, angle, along, up, moment = state
        c, s = math.cos(angle), math.sin(angle)
        gap, nx, nz = self.gap(state)
        p = layer_pressure(gap, self.height)
        stretch, shear = 1 + (along * c + up * s) / (PLANE * THICKNESS), (up * c - along * s) / SHEAR
        dx, dz = stretch * c - shear * s, stretch * s + shear * c
        fx, fz = p * nx + self.pressure * s, p * nz - self.pressure * c
        # moment of the layer's pressure about the middle line: (q - r) x f with q - r = t/2 (s, -c)
        couple = THICKNESS / 2 * p * (s * nz + c * nx)
        return dx, dz, moment / BENDING, -fx, -fz, -(dx * up - dz * along) - couple

    def integrate(self, state, first, last):
        """Return the states of the steps from the first to the last."""
        step, states = self.length / self.steps, [tuple(state)]
        for _ in range(first, last):
            k1 = self.derivative(state)
            k2 = self.derivative([y + step / 2 * k for y, k in zip(state, k1)])
            k3 = self.derivative([y + step / 2 * k for y, k in zip(state, k2)])
            k4 = self.derivative([y + step * k for y, k in zip(state, k3)])
            state = tuple(y + step / 6 * (a + 2 * b + 2 * c + d) for y, a, b, c, d in zip(state, k1, k2, k3, k4))
            states.append(state)
        return states

    def cuts(self):
        """Return the steps at which the parts of the strip begin, and the last one."""
        return [round(fraction * self.steps) for fraction in (*PARTS, 1)]

    def starts(self, unknowns):
        """Return the states at the beginning of the parts; in the middle z, force along x and moment are unknown."""
        height, along, moment = unknowns[:3]
        return [(0.0, height, 0.0, along, self.middle, moment),
                *(unknowns[i:i + 6] for i in range(3, len(unknowns), 6))]

    def shoot(self, unknowns):
        """Return the states of all steps."""
        cuts, states = self.cuts(), []
        for start, first, last in zip(self.starts(unknowns), cuts, cuts[1:]):
            states = states[:-1] + self.integrate(start, first, last)
        return states

    def first_guess(self, height):
        """Return unknowns of a straight strip without forces."""
        places = [self.length * cut / self.steps for cut in self.cuts()[1:-1]]
        return [height, 0.0, 0.0] + [value for x in places for value in (x, height, 0.0, 0.0, 0.0, 0.0)]

    def ends(self, unknowns):
        """Return the state at the end of each part."""
        cuts = self.cuts()
        return [list(self.integrate(start, first, last)[-1])
                for start, first, last in zip(self.starts(unknowns), cuts, cuts[1:])]

    def residual(self, unknowns):
        """Return the steps of the states between the parts; forces and moment at the end less the load."""
        ends, starts = self.ends(unknowns), self.starts(unknowns)
        steps = [a - b for end, start in zip(ends, starts[1:]) for a, b in zip(end, start)]
        return [*steps, ends[-1][3], ends[-1][4] + self.end, ends[-1][5]]

    def tangent(self, unknowns):
        """Return the derivative of the residual, by differences: each unknown belongs to one part."""
        cuts, starts, n = self.cuts(), self.starts(unknowns), len(unknowns)
        matrix = [[0.0] * n for _ in range(n)]
        for part, (start, first, last) in enumerate(zip(starts, cuts, cuts[1:])):
            own = [(i, i + 6 * part - 3) for i in range(6)] if part else [(1, 0), (3, 1), (5, 2)]
            sides = []
            for component, column in own:
                for sign in (1, -1):
                    moved = list(start)
                    moved[component] += sign * 1e-7
                    sides.append(self.integrate(moved, first, last)[-1])
                rows = range(6) if part + 1 < len(starts) else (3, 4, 5)
                for row, i in enumerate(rows):
                    matrix[6 * part + row][column] = (sides[-2][i] - sides[-1][i]) / 2e-7
                if part:
                    matrix[6 * part - 6 + component][column] -= 1.0
        return matrix

    def solve(self, unknowns):
        """Return the unknowns of the solution near the given ones, by Newton's method with step halving."""
        unknowns, found = list(unknowns), self.residual(unknowns)
        for _ in range(60):
            if size(found) < 1e-8:
                return unknowns
            step, fraction = eliminate(self.tangent(unknowns), found), 1.0
            while True:
                trial = [a - fraction * b for a, b in zip(unknowns, step)]
                other = self.residual(trial)
                if size(other) < size(found) or fraction < 1e-6:
                    break
                fraction /= 2
            unknowns, found = trial, other
        raise ArithmeticError(f"the strip did not converge: {size(found):g}")


def size(values):
    """Return the largest absolute value."""
    return max(abs(value) for value in values)


def eliminate(matrix, right):
    """Return the solution of linear equations, by Gauss's elimination."""
    rows, n = [[*row, value] for row, value in zip(matrix, right)], len(right)
    for i in range(n):
        pivot = max(range(i, n), key=lambda row: abs(rows[row][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        for row in rows[i + 1:]:
            factor = row[i] / rows[i][i]
            if factor:
                row[i:] = [a - factor * b for a, b in zip(row[i:], rows[i][i:])]
    result = [0.0] * n
    for i in reversed(range(n)):
        result[i] = (rows[i][n] - sum(a * b for a, b in zip(rows[i][i + 1:n], result[i + 1:]))) / rows[i][i]
    return result
