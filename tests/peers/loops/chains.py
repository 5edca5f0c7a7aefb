"""Chains of the benchmarks of generalized_rbda (`Benchmarking/urdfs`), with its lengths, inertias and names of joints."""

import numpy as np
from exact import Joint, Tree
from mechanism import Model, directions, free_flyer, turns, unit

HEAD = 'hamel = 1\nname = "{}"\ngravity = [0.0, 0.0, -9.81]\n'
GRAVITY = [0.0, 0.0, -9.81]
LINK = dict(mass=0.25, com=[0.0, 0.5, 0.0], inertia=np.diag([0.01, 0.1, 0.01]).tolist())
#: No body has such moments: the largest is more than the sum of the others. In our scenes it is one that moves alike in the plane, where that about z alone counts.
PHYSICAL = LINK | dict(inertia=np.diag([0.1, 0.1, 0.01]).tolist())
Y = [0.0, 1.0, 0.0]


def inertia_of(given):
    return ', '.join(f'{key} = {given[key]}' for key in ('mass', 'com', 'inertia'))


def simple_body(name, parent, at, given, kind='revolute'):
    lines = [f'\n[[body]]\nname = "{name}"\nparent = "{parent}"\njoint = {{ type = "{kind}" }}']
    lines += [f'{key} = {given[key]}' for key in ('mass', 'com', 'inertia')]
    return '\n'.join(lines + [f'at.position = {at}\n' if any(at) else ''])


def joint_of(name, parent, at, given):
    return Joint(name, parent, 'R', 2, np.eye(3), np.array(at, float), given['mass'], given['com'], given['inertia'])


def end(chain, start=()):
    """Where a chain of links along y ends, as expressions of their directions."""
    x = ' + '.join(list(start) + [f'-{link}.s' for link in chain]) or '0'
    y = ' + '.join(f'{link}.c' for link in chain) or '0'
    return x.replace('+ -', '- '), y


class Chains:
    """Two chains of `depth` links in a plane. Their links number `level` have one direction, or are joined by a rod."""

    def __init__(self, depth, level, implicit):
        self.depth, self.level, self.implicit = depth, level, implicit
        self.size = 2 * level + implicit
        self.first = [f'joint_1_{i}' for i in range(1, level + 1)]
        self.second = [f'joint_2_{i}' for i in range(1, level + 1)]
        self.name = f'{"implicit" if implicit else "explicit"}_{depth}_{self.size}'

    def tree(self):
        joints, places = [], {}

        def add(name, parent, at):
            joints.append(joint_of(name, places.get(parent, -1), at, LINK))
            places[name] = len(joints) - 1

        aside = [1.0, 0.0, 0.0] if self.implicit else [0.0] * 3
        for chain, at in ((1, [0.0] * 3), (2, aside)):
            for i in range(1, self.level + 1):
                add(f'joint_{chain}_{i}', f'joint_{chain}_{i - 1}', at if i == 1 else Y)
        loops, couplings = [], []
        if self.implicit:
            add('connecting_rod_joint', self.first[-1], Y)
            loops.append((places[self.second[-1]], Y, places['connecting_rod_joint'], [1.0, 0.0, 0.0]))
        else:
            couplings.append({name: 1 for name in self.first} | {name: -1 for name in self.second})
        for chain in (1, 2):
            for i in range(self.level + 1, self.depth + 1):
                add(f'joint_{chain}_{i}', f'joint_{chain}_{i - 1}', Y)
        return Tree(joints, GRAVITY, loops, couplings)

    def links(self):
        """Links of both chains, by the names of their directions."""
        a, b = [f'a{i}' for i in range(1, self.level + 1)], [f'b{i}' for i in range(1, self.level + 1)]
        return a, b

    def spec(self):
        a, b = self.links()
        # The direction of each link: the last ones share theirs where no rod joins them.
        direction = {x: x for x in a + b} | ({} if self.implicit else {b[-1]: a[-1]})
        own = a + b + ['r'] if self.implicit else a + b[:-1]
        aside = ['1'] if self.implicit else []
        told = 'joined by a rod' if self.implicit else 'whose last links have one direction'
        lines = ['hamel = 1;', '', f'/// Two chains of {self.level} links of length 1 m in a plane, {told}.', '///']
        lines += ['/// Q: directions of the links; v: rates of the independent ones, rad/s.', f'joint {self.joint()} {{']
        lines.append('    config  ' + ', '.join(f'{x}: S1' for x in own) + ';')
        lines.append('    bodies  ' + ', '.join(self.bodies()) + ';')
        if self.implicit:
            (x1, y1), (x2, y2) = end(a), end(b, aside)
            lines += [f'    relation {x1} + r.c = {x2};', f'    relation {y1} + r.s = {y2};']
            lines.append('    home near ' + ', '.join(['[1, 0]'] * len(own)) + ';')
            lines.append('    /// The last link of the second chain and the rod are in line.')
            lines.append(f'    except  {b[-1]}.c * r.c + {b[-1]}.s * r.s = 0;')
        lines += [f'    basis   turn_{x} of so2({x});' for x in self.independent()]
        if not self.implicit:
            lines.append('    velocity in child;')
        for chain, start in ((a, []), (b, aside)):
            for i, x in enumerate(chain):
                at = end([direction[y] for y in chain[:i]], start)
                lines.append(f'    H.l{x} = pose(rot_z({direction[x]}), [{at[0]}, {at[1]}, 0]);')
        if self.implicit:
            lines.append('    H.rod = pose(rot_z(r), [{}, {}, 0]);'.format(*end(a)))
        return '\n'.join(lines + ['}', ''])

    def bodies(self):
        a, b = self.links()
        return [f'l{x}' for x in a + b] + (['rod'] if self.implicit else [])

    def independent(self):
        a, b = self.links()
        return a + b[:-1]

    def joint(self):
        return f'chains_{"joined" if self.implicit else "aligned"}_{self.level}'

    def scene(self):
        bodies = self.bodies()
        text = HEAD.format(self.name) + '\n[[body]]\nname = "chains"\nparent = "world"\n'
        if self.level == 1 and not self.implicit:
            bodies = ['output', 'rotor']
            text += 'joint = { type = "geared_revolute", ratio = 1.0 }\n'
        else:
            text += f'joint = {{ type = "{self.joint()}" }}\n'
        text += ''.join(f'bodies.{body} = {{ {inertia_of(PHYSICAL)} }}\n' for body in bodies)
        last = [bodies[self.level - 1], bodies[2 * self.level - 1]]
        for chain in (1, 2):
            parent = f'chains.{last[chain - 1]}'
            for i in range(self.level + 1, self.depth + 1):
                text += simple_body(f'link_{chain}_{i}', parent, Y, PHYSICAL)
                parent = f'link_{chain}_{i}'
        return text

    def model(self):
        tree = self.tree()
        rest = [f'joint_{chain}_{i}' for chain in (1, 2) for i in range(self.level + 1, self.depth + 1)]
        names = self.first + self.second
        if self.implicit:
            dependent = [self.second[-1], 'connecting_rod_joint']
            chains = [self.first, self.second, self.first + ['connecting_rod_joint']]
            pieces = [directions(chains, self.first + self.second[:-1])]
        else:
            dependent = [self.second[-1]]
            pieces = [directions([self.first, self.second[:-1]], self.first + self.second[:-1])]
            if self.level == 1:
                pieces = [turns(self.first[0])]
        pieces += [turns(name) for name in rest]
        free_ = [name for name in names + rest if name not in dependent]
        spread = {name: 0.6 / self.level for name in self.first} | {name: 0.7 / self.level for name in self.second}
        return Model(self.name, tree, self.scene(), pieces, free_, spread=spread | {name: 1.0 for name in rest})


def base():
    given = dict(mass=5.0, com=[0.0] * 3, inertia=np.diag([0.1] * 3).tolist())
    joint = Joint('world_to_base', -1, 'FF', 2, np.eye(3), np.zeros(3), 5.0, [0.0] * 3, given['inertia'])
    return joint, simple_body('base', 'world', [0.0] * 3, given, 'free')


X = [1.0, 0.0, 0.0]


def rotors(depth):
    """A chain of turns behind gears on a floating base, each with its rotor."""
    joint, text = base()
    joints, couplings, pieces, free_ = [joint], [], [free_flyer('world_to_base')], ['world_to_base']
    link = dict(mass=1.0, com=[0.5, 0.0, 0.0], inertia=np.eye(3).tolist())
    rotor = dict(mass=0.0, com=[0.0] * 3, inertia=np.diag([1e-4] * 3).tolist())
    parent, above, before = 0, 'base', 'base'
    for i in range(1, depth + 1):
        names = [f'{before}_to_link_{i}', f'{before}_to_rotor_{i}']
        joints += [joint_of(names[0], parent, X, link), joint_of(names[1], parent, X, rotor)]
        couplings.append({names[0]: 6, names[1]: -1})
        text += f'\n[[body]]\nname = "gear_{i}"\nparent = "{above}"\njoint = {{ type = "geared_revolute", ratio = 6.0 }}\nat.position = {X}\n'
        text += f'bodies.output = {{ {inertia_of(link)} }}\nbodies.rotor = {{ {inertia_of(rotor)} }}\n'
        pieces.append(turns(names[0]))
        free_.append(names[0])
        parent, above, before = len(joints) - 2, f'gear_{i}.output', f'link_{i}'
    name = f'rotors_{depth}'
    return Model(name, Tree(joints, GRAVITY, [], couplings), HEAD.format(name) + text, pieces, free_, spread={name: 1.0 for name in free_})


PARALLELOGRAM = '''hamel = 1;

/// A four-bar linkage whose opposite links are as long: it folds flat.
///
/// Q: directions of crank, coupler and rocker; v: rate of the crank, rad/s.
joint parallelogram(
    /// Distance of the fixed pins, and length of the coupler.
    ground: m > 0,
    /// Length of crank and rocker.
    crank: m > 0,
) {
    config  a: S1, b: S1, c: S1;
    bodies  crank, coupler, rocker;
    relation crank * a.c + ground * b.c = ground + crank * c.c;
    relation crank * a.s + ground * b.s = crank * c.s;
    home near [0, 1], [1, 0], [0, 1];
    /// It lies flat.
    except  c.s * b.c - c.c * b.s = 0;
    basis   turn of so2(a);
    H.crank   = rot_z(a);
    H.coupler = pose(rot_z(b), [crank * a.c, crank * a.s, 0]);
    H.rocker  = pose(rot_z(c), [ground, 0, 0]);
}
'''


def four_bars(depth):
    """A chain of four-bars on a floating base, each on the rocker of the one before it."""
    joint, text = base()
    joints, loops, pieces, free_, home = [joint], [], [free_flyer('world_to_base')], ['world_to_base'], {}
    given = dict(mass=3.3, com=[0.0] * 3, inertia=np.diag([0.011253, 0.036203, 0.042673]).tolist())
    parent, above, before = 0, 'base', 'base'
    for k in range(depth):
        i = 3 * k + 1
        rocker, crank, coupler = f'{before}_to_link_{i}', f'{before}_to_link_{i + 1}', f'link_{i + 1}_to_link_{i + 2}'
        at = len(joints)
        joints += [joint_of(rocker, parent, X, given), joint_of(crank, parent, [0.0] * 3, given)]
        joints.append(joint_of(coupler, at + 1, [0.5, 0.0, 0.0], given))
        loops.append((at, [0.5, 0.0, 0.0], at + 2, X))
        home |= {crank: 1.3, rocker: 1.3, coupler: -1.3}
        text += f'\n[[body]]\nname = "loop_{k + 1}"\nparent = "{above}"\njoint = {{ type = "parallelogram", ground = 1.0, crank = 0.5 }}\n'
        text += 'initial.configuration = [0.0, 1.0, 1.0, 0.0, 0.0, 1.0]\n'
        text += ''.join(f'bodies.{body} = {{ {inertia_of(given)} }}\n' for body in ('crank', 'coupler', 'rocker'))
        pieces.append(parallel(crank, coupler, rocker))
        free_.append(crank)
        parent, above, before = at, f'loop_{k + 1}.rocker', f'link_{i}'
    name = f'four_bars_{depth}'
    return Model(name, Tree(joints, GRAVITY, loops), HEAD.format(name) + text, pieces, free_, home)


def parallel(crank, coupler, rocker):
    def piece(q, v, a, tau):
        stored = unit(q[crank][0]) + unit(q[crank][0] + q[coupler][0]) + unit(q[rocker][0])
        return np.array(stored, dtype=object), v[crank], a[crank], tau[crank]

    return piece
