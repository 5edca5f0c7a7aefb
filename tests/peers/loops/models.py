#!/usr/bin/env python3
"""Writes mechanisms with loops as every program of the comparison takes them: models.py FOLDER [NAME ...].

    NAME.toml         scene, and joints/*.joint where the library has no joint for it
    NAME.ours.bin     its states: little-endian doubles, per state q, v and tau of the scene
    NAME.txt          spanning tree with loops and couplings, in the words of `src/bench_loops.cpp`
    NAME.bin          its states: q, v and tau of the tree
    NAME.json         exact accelerations of the first states, of both, and names of the tree's joints

States are drawn in 200-bit arithmetic, where loops close exactly, and then rounded for each.
"""

import json, os, random, sys
import numpy as np
import exact
from chains import PARALLELOGRAM, Chains, four_bars, rotors
from mechanism import double
from scene_tree import Scene

#: Rods of the ankles carry no mass in our joint. Of others only those can do without that solve for all multipliers at once.
ROD_MASS = 1e-6
STATES, CHECKED = 32, 4
#: Depths of the parallel chains, and the links that are coupled.
DEPTHS = {5: (1, 2, 3), 10: (1, 2, 4), 20: (1, 3), 40: (1, 4)}


def catalogue():
    """Name → a function that makes the model."""
    all_ = {'humanoid': lambda: Scene('humanoid', ROD_MASS).model('humanoid')}
    all_['humanoid_tree'] = lambda: Scene('humanoid_tree').model('humanoid_tree')
    for depth in (5, 10):
        all_[f'rotors_{depth}'] = lambda depth=depth: rotors(depth)
        all_[f'four_bars_{depth}'] = lambda depth=depth: four_bars(depth)
    for depth, levels in DEPTHS.items():
        for level in levels:
            for implicit in (False, True):
                chains = Chains(depth, level, implicit)
                all_[chains.name] = lambda chains=chains: chains.model()
    return all_


def words(model):
    """The spanning tree as text."""
    tree = model.tree
    line = lambda *parts: ' '.join(str(x) if isinstance(x, str) else repr(float(x)) if not isinstance(x, (int, np.integer)) else str(x) for x in parts)
    out = [f'model {model.name}', line('gravity', *tree.gravity), line('sizes', len(tree.joints), tree.nq, tree.nv)]
    for i, joint in enumerate(tree.joints):
        axis = [0, 0, 0]
        axis[joint.axis] = 1
        I = np.array(joint.inertia, float)
        numbers = [*np.array(joint.R, float).ravel(), *joint.p, joint.mass, *joint.com, I[0, 0], I[0, 1], I[0, 2], I[1, 1], I[1, 2], I[2, 2]]
        out.append(line('joint', i + 1, joint.parent + 1, joint.kind, *map(float, axis), *numbers))
    out += [line('armature', i + 1, joint.armature) for i, joint in enumerate(tree.joints) if joint.armature]
    out += [line('loop', i + 1, *a, j + 1, *b) for i, a, j, b in tree.loops]
    for coupling in tree.couplings:
        parts = [x for joint, factor in coupling.items() for x in (tree.index[joint] + 1, float(factor))]
        out.append(line('coupling', len(coupling), *parts))
    return '\n'.join(out) + '\n'


def write(model, folder):
    source = random.Random(model.name)
    tree_rows, our_rows, checked = [], [], dict(tree=[], ours=[])
    bare = None if model.name != 'humanoid' else Scene('humanoid').model('humanoid')
    while len(tree_rows) < STATES:
        q, v, tau = model.draw(source)
        a, ours_a = exact.zeros(model.tree.nv), None
        if len(tree_rows) < CHECKED:
            a = model.tree.accelerations(q, v, tau)
            # Ours carries no rods: its exact accelerations are those without.
            ours_a = bare.tree.accelerations(q, v, tau) if bare else a
            checked['tree'].append([float(x) for x in a])
            checked['ours'].append([float(x) for x in model.ours(q, v, ours_a, tau)[2]])
        own = model.ours(q, v, a, tau)
        tree_rows.append(np.concatenate([q, v, tau]))
        our_rows.append(np.concatenate([own[0], own[1], own[3]]))
    at = lambda ending: os.path.join(folder, f'{model.name}.{ending}')
    double(np.array(tree_rows)).astype('<f8').tofile(at('bin'))
    double(np.array(our_rows)).astype('<f8').tofile(at('ours.bin'))
    keep(at('toml'), model.scene)
    keep(at('txt'), words(model))
    names = [joint.name for joint in model.tree.joints]
    json.dump(dict(nv=len(checked['ours'][0]), nv_tree=model.tree.nv, joints=names, **checked), open(at('json'), 'w'))


def keep(path, text):
    """A file that is written anew each time would be built anew each time."""
    if not os.path.exists(path) or open(path).read() != text:
        open(path, 'w').write(text)


def main():
    folder, asked = sys.argv[1], sys.argv[2:]
    os.makedirs(os.path.join(folder, 'joints'), exist_ok=True)
    keep(os.path.join(folder, 'joints', 'parallelogram.joint'), PARALLELOGRAM)
    for depth, levels in DEPTHS.items():
        for chains in [Chains(depth, level, implicit) for level in levels for implicit in (False, True)]:
            if chains.level > 1 or chains.implicit:
                keep(os.path.join(folder, 'joints', f'{chains.joint()}.joint'), chains.spec())
    for name, make in catalogue().items():
        if not asked or name in asked:
            write(make(), folder)
            print(name, flush=True)


if __name__ == '__main__':
    main()
