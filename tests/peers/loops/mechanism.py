"""What is compared: a spanning tree, the scene that is the same mechanism, and how states of the first become those of the second."""

import numpy as np
import exact
from exact import number

def double(x):
    return np.array(np.vectorize(float)(x), float)


class Model:
    """A spanning tree, its scene, and how states of one become those of the other.

    `pieces` are the joints of the scene in its order, each with functions of the tree's q, v, a and tau (by names of joints) for what the scene has.
    `free` are joints whose coordinates are drawn, `home` coordinates about which they are, by `spread`; `driven` those with efforts.
    """

    def __init__(self, name, tree, scene, pieces, free, home=None, spread=None, driven=None):
        self.name, self.tree, self.scene, self.pieces = name, tree, scene, pieces
        self.free, self.home, self.spread = set(free), home or {}, spread or {}
        self.driven = free if driven is None else driven

    def draw(self, random, tries=20):
        """A random state; coordinates at which loops do not close are drawn anew."""
        for _ in range(tries):
            try:
                return self.drawn(random)
            except ArithmeticError:
                continue
        raise ArithmeticError(f'{self.name}: no state of {tries} closes its loops')

    def drawn(self, random):
        tree = self.tree
        q, v, tau = exact.zeros(tree.nq), exact.zeros(tree.nv), exact.zeros(tree.nv)
        for i, joint in enumerate(tree.joints):
            place, speed = tree.iq[i], slice(tree.iv[i], tree.iv[i] + joint.nv)
            if joint.kind == 'FF':
                quaternion = exact.exact([random.gauss(0, 1) for _ in range(4)])
                quaternion = quaternion / exact.gmpy2.sqrt(quaternion @ quaternion)
                q[place : place + 3] = exact.exact([random.uniform(-1, 1) for _ in range(3)])
                q[place + 3 : place + 7] = quaternion
            else:
                spread = self.spread.get(joint.name, 0.5) if joint.name in self.free else 0.0
                q[place] = number(self.home.get(joint.name, 0.0) + random.uniform(-spread, spread))
            v[speed] = exact.exact([random.uniform(-1, 1) for _ in range(joint.nv)])
            if joint.name in self.driven:
                tau[speed] = exact.exact([random.uniform(-1, 1) for _ in range(joint.nv)])
        if self.tree.couplings:
            q = self.coupled(q)
        q = tree.close(q, self.free)
        return q, tree.speeds(q, v, self.free), tau

    def coupled(self, q):
        """Where a coupling says what a joint is that is not free."""
        for coupling in self.tree.couplings:
            (last,) = [joint for joint in coupling if joint not in self.free]
            others = [(joint, factor) for joint, factor in coupling.items() if joint != last]
            sum_ = sum(number(factor) * q[self.tree.iq[self.tree.index[joint]]] for joint, factor in others)
            q[self.tree.iq[self.tree.index[last]]] = -sum_ / number(coupling[last])
        return q

    def by_name(self, values, of_q=False):
        starts = self.tree.iq if of_q else self.tree.iv
        sizes = [joint.nq if of_q else joint.nv for joint in self.tree.joints]
        return {joint.name: values[s : s + n] for joint, s, n in zip(self.tree.joints, starts, sizes)}

    def ours(self, q, v, a, tau):
        """q, v, v̇ and tau of the scene."""
        state = [self.by_name(q, True), self.by_name(v), self.by_name(a), self.by_name(tau)]
        parts = [piece(*state) for piece in self.pieces]
        return [np.concatenate([part[k] for part in parts]) for k in range(4)]


# Pieces: (q, v, v̇, tau) of one joint of the scene.


def free_flyer(name):
    def piece(q, v, a, tau):
        p, R = q[name][:3], exact.of_quaternion(*q[name][3:])
        swap = lambda x: np.concatenate([x[name][3:], x[name][:3]])
        return np.column_stack([R, p]).reshape(-1), swap(v), swap(a), swap(tau)

    return piece


def turns(*names):
    """Coordinates that are those of the tree."""
    return lambda *state: [np.concatenate([part[name] for name in names]) for part in state]


def unit(angle):
    return [exact.gmpy2.cos(angle), exact.gmpy2.sin(angle)]


def four_bar(crank, coupler, rocker, lengths):
    """v is that along the generalised cross product: the crank's rate is v times coupler · rocker · sin(coupler − rocker)."""
    product = number(lengths['coupler']) * number(lengths['rocker'])

    def piece(q, v, a, tau):
        angles = [q[crank][0], q[crank][0] + q[coupler][0], q[rocker][0]]
        rates = [v[crank][0], v[crank][0] + v[coupler][0], v[rocker][0]]
        between, rate = angles[1] - angles[2], rates[1] - rates[2]
        factor, change = product * exact.gmpy2.sin(between), product * exact.gmpy2.cos(between) * rate
        speed = rates[0] / factor
        acceleration = (a[crank][0] - change * speed) / factor
        stored = sum([unit(angle) for angle in angles], [])
        return [np.array(x, dtype=object) for x in (stored, [speed], [acceleration], [tau[crank][0] * factor])]

    return piece


def ankle(left, right, pitch, roll):
    def piece(q, v, a, tau):
        stored = sum([unit(q[name][0]) for name in (left, right, pitch, roll)], [])
        two = lambda x: np.array([x[left][0], x[right][0]], dtype=object)
        return np.array(stored, dtype=object), two(v), two(a), two(tau)

    return piece


def directions(chains, independent):
    """Directions of links that turn in one plane, from angles of each on the one before it; v are the rates of `independent` ones."""

    def piece(q, v, a, tau):
        def sums(x):
            out = {}
            for chain in chains:
                total = number(0)
                for name in chain:
                    total = out[name] if name in out else total + x[name][0]
                    out[name] = total
            return out

        angles, rates, accelerations = sums(q), sums(v), sums(a)
        names = list(angles)
        efforts = {name: number(0) for name in names}
        for chain in chains:
            for before, name in zip([None] + chain[:-1], chain):
                if name in seen_twice(chains) and chain is not first_with(chains, name):
                    continue
                efforts[name] += tau[name][0]
                if before is not None:
                    efforts[before] -= tau[name][0]
        stored = sum([unit(angles[name]) for name in names], [])
        pick = lambda x: np.array([x[name] for name in independent], dtype=object)
        return np.array(stored, dtype=object), pick(rates), pick(accelerations), pick(efforts)

    return piece


def seen_twice(chains):
    names = [name for chain in chains for name in chain]
    return {name for name in names if names.count(name) > 1}


def first_with(chains, name):
    return next(chain for chain in chains if name in chain)
