"""Robots in URDF by Hamel and by Pinocchio, at random states: one line a file. README.md says how it is run."""

import argparse
import pathlib
import sys
import time
import warnings
from xml.etree import ElementTree

import hamel
import numpy as np
import pinocchio

STATES = 10


class Peer:
    """A robot in Pinocchio: fixed to the world, joints that mimic others coupled to them, with the damping of its file."""

    def __init__(self, path):
        # Its parser writes what it leaves out to stderr by itself.
        self.model = pinocchio.buildModelFromUrdf(str(path), mimic=True)
        self.data = self.model.createData()
        # The first is the world.
        joints = list(zip(self.model.names, self.model.joints))[1:]
        self.names = [name for name, joint in joints if 'Mimic' not in joint.shortname()]
        self.damping = self.speeds(damping(path))

    def joint(self, name):
        return self.model.joints[self.model.getJointId(name)]

    def configuration(self, angles):
        q = pinocchio.neutral(self.model)
        for name, angle in angles.items():
            joint = self.joint(name)
            # A continuous joint is stored by its cosine and sine.
            q[joint.idx_q:joint.idx_q + joint.nq] = [angle] if joint.nq == 1 else [np.cos(angle), np.sin(angle)]
        return q

    def speeds(self, values):
        v = np.zeros(self.model.nv)
        for name, value in values.items():
            v[self.joint(name).idx_v] = value
        return v

    def forward_dynamics(self, angles, rates, efforts):
        """Accelerations by name, and the condition of the mass matrix."""
        q, v = self.configuration(angles), self.speeds(rates)
        tau = self.speeds(efforts) - self.damping * v
        mass = pinocchio.crba(self.model, self.data, q, pinocchio.Convention.WORLD)
        mass = np.triu(mass) + np.triu(mass, 1).T
        # Not by its articulated-body algorithm, which does without joints that mimic others.
        found = np.linalg.solve(mass, tau - pinocchio.nonLinearEffects(self.model, self.data, q, v))
        return {name: found[self.joint(name).idx_v] for name in self.names}, np.linalg.cond(mass)


def damping(path):
    """Damping of the joints of a file by name, where those that mimic one slow it by the square of how fast they move."""
    joints = {joint.get('name'): joint for joint in ElementTree.parse(path).getroot().findall('joint')}
    found = {}
    for name, joint in joints.items():
        dynamics = joint.find('dynamics')
        own = 0.0 if dynamics is None else float(dynamics.get('damping', 0.0))
        ratio = 1.0
        while (mimic := joint.find('mimic')) is not None:
            ratio *= float(mimic.get('multiplier', 1.0))
            name = mimic.get('joint')
            joint = joints[name]
        if joint.get('type') != 'fixed':
            found[name] = found.get(name, 0.0) + ratio**2 * own
    return found


def states(names):
    random = np.random.default_rng(1)
    for _ in range(STATES):
        yield tuple(dict(zip(names, random.uniform(-1.0, 1.0, len(names)))) for _ in range(3))


def difference(robot, peer):
    """The largest difference of accelerations as a part of what is allowed, 1e-9 · max(1, |a|) or cond(M) · 1e-15 of it where that is more, and the largest relative one."""
    parts, relative = [0.0], [0.0]
    where = {name: robot.joint(name) for name in robot.joints}
    for angles, rates, efforts in states(peer.names):
        v, tau = np.zeros(robot.sizes.speeds), np.zeros(robot.sizes.freedoms)
        for name, joint in where.items():
            v[joint.speeds], tau[joint.freedoms] = rates[name], efforts[name]
        found = robot.forward_dynamics(robot.configuration(angles), v, tau)
        expected, condition = peer.forward_dynamics(angles, rates, efforts)
        own = np.array([found[joint.speeds][0] for joint in where.values()])
        other = np.array([expected[name] for name in where])
        size = max(1.0, np.linalg.norm(other))
        apart = np.linalg.norm(own - other) / size
        assert np.isfinite(condition)
        relative.append(apart)
        parts.append(apart / max(1e-9, condition * 1e-15))
    # Unlike `max`, these keep a NaN, which agrees with nothing.
    return np.max(parts), np.max(relative)


def load(path):
    """The robot, and what it took: nothing, a floating base where no joint moves, or changes of what is broken."""
    try:
        return hamel.load(path), ''
    except hamel.FileError as error:
        if 'no joint of the robot moves' in str(error):
            return hamel.load(path, floating_base=True), 'floating'
        return hamel.load(path, lenient=True), 'lenient'


def outcome(path):
    """A word on one file, and the rest of its line."""
    start = time.perf_counter()
    try:
        robot, taken = load(path)
    except hamel.FileError as error:
        return 'refused', str(error).splitlines()[0]
    page = hamel.simulate(robot, 0.01, estimate=False).to_html()
    took = time.perf_counter() - start
    coupled = sum(len(robot.joint(name).bodies) > 1 for name in robot.joints)
    told = f'{robot.sizes.freedoms} degrees of freedom, {coupled} couplings, page of {len(page) / 1e6:.1f} MB, {took:.1f} s'
    if taken:
        # Nothing to compare: without a joint, or other masses than in the file, which Pinocchio reads as they are.
        return taken, told
    try:
        peer = Peer(path)
    except ValueError as error:
        return 'refused by Pinocchio', f'{error}; {told}'
    if sorted(peer.names) != sorted(robot.joints):
        return 'OTHER JOINTS', f'{sorted(set(peer.names) ^ set(robot.joints))}'
    part, relative = difference(robot, peer)
    return ('agrees' if part <= 1.0 else 'DIFFERS'), f'{relative:.1e}, {told}'


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('folder', type=pathlib.Path, help='every *.urdf under it is read')
    folder = parser.parse_args().folder
    warnings.simplefilter('ignore')
    counts = {}
    for path in sorted(folder.rglob('*.urdf')):
        word, told = outcome(path)
        counts[word] = counts.get(word, 0) + 1
        print(f'{path.relative_to(folder)}: {word}: {told}', flush=True)
    print(', '.join(f'{count} {word}' for word, count in sorted(counts.items())))
    sys.exit(any(word.isupper() for word in counts) or 'agrees' not in counts)


if __name__ == '__main__':
    main()
