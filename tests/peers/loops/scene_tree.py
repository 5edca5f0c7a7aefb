"""A scene file of the project as a spanning tree with loops, with what acts at joints and soles left out."""

import os, re, tomllib
import numpy as np
from exact import Joint, Tree, exact, number, turn
from mechanism import Model, ankle, four_bar, free_flyer, turns

SCENES = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', '..', 'scenes')


def rotation(placement):
    if 'rotation' in placement:
        return exact(placement['rotation'])
    if 'axis' in placement:
        x, y, z = placement['axis']
        return exact([[1, 0, 0], [0, 0, y], [0, -y, 0]] if y else [[0, 0, x], [0, 1, 0], [-x, 0, 0]] if x else np.eye(3))
    if 'rotation_vector' in placement:
        vector = placement['rotation_vector']
        (axis,) = np.flatnonzero(vector)
        return turn(int(axis), number(vector[axis]))
    if 'rpy' in placement:
        r, p, y = [number(x) for x in placement['rpy']]
        return turn(2, y) @ turn(1, p) @ turn(0, r)
    return exact(np.eye(3))


def pose(placement):
    placement = placement or {}
    return rotation(placement), exact(placement.get('position', [0, 0, 0]))


def at(*position):
    return pose({'position': position})


def after(first, second):
    return first[0] @ second[0], first[1] + first[0] @ second[1]


MASSLESS = (0.0, [0.0] * 3, np.zeros((3, 3)))


class Scene:
    """A scene file as a spanning tree, with what acts at joints and soles left out."""

    def __init__(self, name, rods=0.0):
        text = open(os.path.join(SCENES, f'{name}.toml')).read()
        self.name, self.text = name, without_forces(text)
        self.rods, self.joints, self.loops, self.pieces = rods, [], [], []
        self.home, self.spread, self.free, self.driven = {}, {}, [], []
        #: The tree's joint of each body, and the body's frame in it.
        self.frames = {'world': (-1, pose(None))}
        scene = tomllib.loads(text)
        for body in scene['body']:
            getattr(self, 'joint_' + body['joint']['type'])(body)
        self.gravity = scene['gravity']

    def add(self, name, above, kind, axis, given=None, armature=0.0, free=True, home=0.0):
        """A joint of the tree; `above` is a joint with a placement in it, `given` what has mass."""
        parent, (R, p) = above
        mass, com, inertia = MASSLESS
        if given:
            own = pose(given.get('body_at'))
            mass, com = given['mass'], own[0] @ exact(given.get('com', [0, 0, 0])) + own[1]
            inertia = own[0] @ exact(given['inertia']) @ own[0].T
        self.joints.append(Joint(name, parent, kind, axis, R, p, mass, com, inertia, armature))
        self.home[name] = home
        if free:
            self.free.append(name)
        return len(self.joints) - 1

    def above(self, body, *placements):
        joint, frame = self.frames[body['parent']]
        for placement in (pose(body.get('at')),) + placements:
            frame = after(frame, placement)
        return joint, frame

    def body(self, name, joint, given):
        self.frames[name] = joint, pose(given.get('body_at'))

    def simple(self, body, kind, axis=2):
        name = body['name']
        joint = self.add(name, self.above(body), kind, axis, body, body.get('armature', 0.0))
        self.body(name, joint, body)
        self.driven.append(name)
        return name

    def joint_free(self, body):
        self.pieces.append(free_flyer(self.simple(body, 'FF')))

    def joint_revolute(self, body):
        self.pieces.append(turns(self.simple(body, 'R')))

    def joint_universal(self, body):
        name, armature = body['name'], body.get('armature', [0.0, 0.0])
        outer = self.add(f'{name}_1', self.above(body), 'R', 0, None, armature[0])
        inner = self.add(f'{name}_2', (outer, pose(None)), 'R', 1, body, armature[1])
        self.body(name, inner, body)
        self.driven += [f'{name}_1', f'{name}_2']
        self.pieces.append(turns(f'{name}_1', f'{name}_2'))

    def joint_four_bar(self, body):
        name, given, links = body['name'], body['joint'], body['bodies']
        names = [f'{name}_{link}' for link in ('crank', 'coupler', 'rocker')]
        c = [np.arctan2(*body['initial']['configuration'][2 * i : 2 * i + 2][::-1]) for i in range(3)]
        crank = self.add(names[0], self.above(body), 'R', 2, links['crank'], free=False, home=c[0])
        coupler = self.add(names[1], (crank, at(given['crank'], 0, 0)), 'R', 2, links['coupler'], free=False, home=c[1] - c[0])
        rocker = self.add(names[2], self.above(body, at(given['ground'], 0, 0)), 'R', 2, links['rocker'], home=c[2])
        self.spread[names[2]] = 0.3
        for link, joint in zip(('crank', 'coupler', 'rocker'), (crank, coupler, rocker)):
            self.body(f'{name}.{link}', joint, links[link])
        self.loops.append((rocker, [given['rocker'], 0, 0], coupler, [given['coupler'], 0, 0]))
        self.driven.append(names[0])
        self.pieces.append(four_bar(*names, given))

    def joint_parallel_ankle(self, body):
        name, given, links = body['name'], body['joint'], body['bodies']
        armature = body.get('armature', 0.0)
        c = [np.arctan2(*body['initial']['configuration'][2 * i : 2 * i + 2][::-1]) for i in range(4)]
        cranks = []
        for side, y, angle in (('left', given['half'], c[0]), ('right', -given['half'], c[1])):
            above = self.above(body, at(0, y, given['height']))
            joint = self.add(f'{name}_{side}', above, 'R', 1, links[side], armature, False, angle)
            self.body(f'{name}.{side}', joint, links[side])
            self.driven.append(f'{name}_{side}')
            cranks.append((side, y, angle, joint))
        pitch = self.add(f'{name}_pitch', self.above(body), 'R', 1, home=c[2])
        foot = self.add(f'{name}_roll', (pitch, pose(None)), 'R', 0, links['foot'], home=c[3])
        self.spread[f'{name}_pitch'] = self.spread[f'{name}_roll'] = 0.2
        self.body(f'{name}.foot', foot, links['foot'])
        length = given['rod']
        thin, long = self.rods * (0.1 * length) ** 2, self.rods * length**2 / 12
        rod = {'mass': self.rods, 'com': [0, 0, -length / 2], 'inertia': np.diag([long, long, thin]).tolist()}
        for side, y, angle, crank in cranks:
            end = (crank, at(-given['crank'], 0, 0))
            swing = self.add(f'{name}_{side}_swing', end, 'R', 1, None, free=False, home=-angle)
            tilt = self.add(f'{name}_{side}_tilt', (swing, pose(None)), 'R', 0, rod, free=False)
            self.loops.append((foot, [-given['heel'], y, 0.0], tilt, [0.0, 0.0, -length]))
        self.pieces.append(ankle(f'{name}_left', f'{name}_right', f'{name}_pitch', f'{name}_roll'))

    def model(self, name):
        tree = Tree(self.joints, self.gravity, self.loops)
        return Model(name, tree, self.text, self.pieces, self.free, self.home, self.spread, self.driven)


def without_forces(text):
    """Without springs and shapes: inertia, gravity and given efforts are left."""
    blocks = re.split(r'(?m)^(?=\[)', text)
    blocks = [block for block in blocks if not block.startswith(('[[spring]]', '[[shape]]'))]
    return re.sub(r'(?m)^(spring|ports\.\w+\.spring) = .*\n', '', ''.join(blocks))
