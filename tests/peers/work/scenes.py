"""Scenes of the project with references, as other libraries take them.

A scene file and its reference become a list of links. The frame of a link is its joint's child frame, so that no library needs a placement after a
joint; the state at time 0 is read from the first sample of the reference, which the scene's own state is held to by the project's tests.
Joints are sequences of elementary ones: R and P turn about and slide along an axis, H is a screw, S a ball, FF free.
"""

import json, math, tomllib
import numpy as np

Z, X, Y = [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]
SEQUENCES = {
    'revolute': [('R', Z)],
    'prismatic': [('P', Z)],
    'cylindrical': [('R', Z), ('P', Z)],
    'universal': [('R', X), ('R', Y)],
    'screw': [('H', Z)],
    'ball': [('S', Z)],
    'ball_child': [('S', Z)],
    'free': [('FF', Z)],
}


class Beyond(Exception):
    """What a library cannot express, with the reason."""


def matrix(placement):
    """Rotation of a placement of a scene file."""
    given = placement.keys() - {'position', 'rotation', 'rotation_vector'}
    if given:
        raise Beyond(f'a placement by {", ".join(sorted(given))}')
    if 'rotation_vector' in placement:
        return exponential(np.array(placement['rotation_vector'], float))
    return np.array(placement.get('rotation', np.eye(3)), float)


def pose(placement):
    placement = placement or {}
    return matrix(placement), np.array(placement.get('position', [0.0, 0.0, 0.0]), float)


def cross(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]], float)


def exponential(v):
    angle = np.linalg.norm(v)
    if angle == 0.0:
        return np.eye(3)
    k = cross(v / angle)
    return np.eye(3) + math.sin(angle) * k + (1 - math.cos(angle)) * (k @ k)


def quaternion(R):
    """Unit quaternion w, x, y, z of a rotation, by its largest part."""
    t = [R[0, 0] + R[1, 1] + R[2, 2], R[0, 0], R[1, 1], R[2, 2]]
    k = int(np.argmax(t))
    if k == 0:
        q = [1 + t[0], R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]
    else:
        i, j, l = k - 1, k % 3, (k + 1) % 3
        q = [0.0] * 4
        q[0] = R[l, j] - R[j, l]
        q[1 + i] = 1 + R[i, i] - R[j, j] - R[l, l]
        q[1 + j] = R[j, i] + R[i, j]
        q[1 + l] = R[l, i] + R[i, l]
    q = np.array(q)
    return q / np.linalg.norm(q)


def rotation(q):
    """Rotation of a quaternion w, x, y, z."""
    w, u = q[0], np.asarray(q[1:], float)
    return np.eye(3) + 2 * w * cross(u) + 2 * cross(u) @ cross(u)


def load(scene, reference):
    """The links of a scene, or Beyond."""
    text = tomllib.load(open(scene, 'rb'))
    known = json.load(open(reference))
    unknown = text.keys() & {'spring', 'constraint', 'wrench', 'controller'}
    if unknown:
        raise Beyond(f'the scene has {", ".join(sorted(unknown))}')
    names = [body['name'] for body in text['body']]
    if [b for b in names if b not in known['bodies']]:
        raise Beyond('the reference knows less bodies than the scene has')
    at_start = dict(zip(known['bodies'], known['samples'][0]['bodies']))
    links, after = [], []
    for body in text['body']:
        kind = body['joint']['type']
        if kind not in SEQUENCES:
            raise Beyond(f'joint `{kind}`')
        odd = body.keys() & {'motion', 'effort', 'armature'}
        if odd:
            raise Beyond(f'body `{body["name"]}` has {", ".join(sorted(odd))}')
        Ra, pa = pose(body.get('body_at'))
        after.append((Ra, pa))
        parent = -1 if body.get('parent', 'world') == 'world' else names.index(body['parent'])
        Rb, pb = pose(body.get('at'))
        if parent >= 0:  # from the parent's own axes to its joint's frame
            R0, p0 = after[parent]
            Rb, pb = R0 @ Rb, R0 @ pb + p0
        spring = body.get('spring', {})
        links.append(
            dict(
                name=body['name'],
                parent=parent,
                joints=[dict(kind=k, axis=a, pitch=body['joint'].get('lead', 0.0)) for k, a in SEQUENCES[kind]],
                R=Rb,
                p=pb,
                mass=body['mass'],
                com=Ra @ np.array(body.get('com', [0, 0, 0]), float) + pa,
                inertia=Ra @ np.array(body['inertia'], float) @ Ra.T,
                stiffness=spring.get('stiffness', 0.0) if isinstance(spring, dict) else None,
                spring=spring.get('kind', 'log'),
                damping=body.get('damping', 0.0),
                after=Ra,
            )
        )
    start(links, text['body'], at_start)
    return dict(
        name=text['name'],
        gravity=text['gravity'],
        links=links,
        t_end=known['samples'][-1]['t'],
        expected=[known['samples'][-1]['bodies'][known['bodies'].index(name)] for name in names],
        first=[at_start[name] for name in names],
        floor=max(1.0, known['conditioning'], (known.get('frequency') or 0.0) * known['samples'][-1]['t']) * 1.1e-16,
    )


def start(links, bodies, at_start):
    """Coordinates q and speeds v of each link: as the scene gives them, or for balls and free joints from the first sample."""
    frames = []
    for link, body in zip(links, bodies):
        sample = at_start[link['name']]
        R = np.array(sample['rotation_body_to_world_rowmajor']).reshape(3, 3) @ link['after'].T
        w = R @ link['after'] @ np.array(sample['angular_velocity_body'])  # world axes
        p = np.array(sample['position_com']) - R @ link['com']
        v = np.array(sample['velocity_com_world']) - np.cross(w, R @ link['com'])
        frames.append((R, p, w))
        Rp, pp, wp = frames[link['parent']] if link['parent'] >= 0 else (np.eye(3), np.zeros(3), np.zeros(3))
        own = (Rp @ link['R']).T
        relative = quaternion(own @ R)
        kinds = [joint['kind'] for joint in link['joints']]
        if kinds == ['S']:
            link['q'], link['v'] = list(relative), list(R.T @ (w - wp))
        elif kinds == ['FF']:
            if link['parent'] >= 0:
                raise Beyond('a free joint on a body')
            link['q'] = list(own @ (p - link['p'])) + list(relative)
            link['v'] = list(R.T @ w) + list(R.T @ v)
        else:
            initial = body.get('initial', {})
            link['q'] = initial.get('phi', [0.0] * len(kinds))
            link['v'] = initial.get('speeds', [0.0] * len(kinds))


def errors(scene, numbers, own_axes, key='expected'):
    """The largest error over bodies: attitude, rad, and position, velocity and angular velocity relative to max(1, size).

    `numbers` are 18 for each body: position of the centre of mass, rotation to world by rows, velocity of the centre of mass, all in
    world axes, and the angular velocity in the axes of the body, or of the link unless `own_axes`.
    """
    worst = 0.0
    for link, expected, x in zip(scene['links'], scene[key], np.reshape(numbers, (-1, 18))):
        R, w = x[3:12].reshape(3, 3), x[15:18]
        if not own_axes:
            R, w = R @ link['after'], link['after'].T @ w
        E = np.array(expected['rotation_body_to_world_rowmajor']).reshape(3, 3).T @ R
        s = 0.5 * np.linalg.norm([E[2, 1] - E[1, 2], E[0, 2] - E[2, 0], E[1, 0] - E[0, 1]])
        parts = [math.atan2(s, 0.5 * (np.trace(E) - 1))]
        for found, name in ((x[0:3], 'position_com'), (x[12:15], 'velocity_com_world'), (w, 'angular_velocity_body')):
            e = np.array(expected[name])
            parts.append(np.linalg.norm(found - e) / max(1.0, np.linalg.norm(e)))
        worst = max([worst] + [p if p == p else math.inf for p in parts])
    return worst


def plain(scene):
    """As JSON can hold it."""
    return json.loads(json.dumps(scene, default=lambda x: x.tolist()))
