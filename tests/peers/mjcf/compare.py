"""Accelerations of robots in MJCF by Hamel and by MuJoCo, at random states: one line a model.

What Hamel leaves out, and tells, is switched off in MuJoCo: limits, dry friction, contacts, actuators, tendons, fluids, equalities. Joints that equalities couple
linearly are coupled exactly in Hamel: MuJoCo's equations are projected onto them. README.md says how it is run.
"""

import argparse
import os
import pathlib
import subprocess
import sys
import tempfile

import mujoco
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
OWN = ROOT / 'tests/data/mjcf'
KINDS = {0: 'free', 1: 'ball', 2: 'slide', 3: 'hinge'}
OFF = ('mjDSBL_CONTACT', 'mjDSBL_LIMIT', 'mjDSBL_FRICTIONLOSS', 'mjDSBL_EQUALITY', 'mjDSBL_ACTUATION', 'mjDSBL_CONSTRAINT')


class Coupled:
    """A model of MuJoCo, and how its speeds follow those that are independent: v = G y."""

    def __init__(self, path):
        spec = mujoco.MjSpec.from_file(str(path))
        for joint in spec.joints:
            joint.springdamper[:] = 0
        m = self.m = spec.compile()
        for flag in OFF:
            m.opt.disableflags |= int(getattr(mujoco.mjtDisableBit, flag))
        m.opt.density = m.opt.viscosity = 0
        for name in ('tendon_stiffness', 'tendon_damping', 'tendon_armature', 'tendon_stiffnesspoly', 'tendon_dampingpoly', 'jnt_stiffnesspoly',
                     'dof_dampingpoly', 'actuator_armature', 'actuator_damping', 'actuator_dampingpoly'):
            if hasattr(m, name):
                getattr(m, name)[:] = 0
        for j in range(m.njnt):
            if m.jnt_type[j] == 0:
                at = m.jnt_dofadr[j]
                m.dof_armature[at:at + 6] = 0
        mujoco.mj_setConst(m, mujoco.MjData(m))
        self.follows = {}
        linear = lambda e: m.eq_type[e] == mujoco.mjtEq.mjEQ_JOINT and m.eq_active0[e] and m.eq_obj2id[e] >= 0 \
            and not m.eq_data[e, 2:5].any() and m.eq_data[e, 1] != 0
        for e in filter(linear, range(m.neq)):
            self.follows.setdefault(int(m.eq_obj1id[e]), (int(m.eq_obj2id[e]), m.eq_data[e, 0], m.eq_data[e, 1]))
        self.G = np.eye(m.nv)
        for j in self.follows:
            row = np.zeros(m.nv)
            leader, ratio = j, 1.0
            while leader in self.follows:
                leader, _, own = self.follows[leader]
                ratio *= own
            row[m.jnt_dofadr[leader]] = ratio
            self.G[m.jnt_dofadr[j]] = row
        self.free = [j for j in range(m.njnt) if j not in self.follows]
        self.columns = [m.jnt_dofadr[j] + i for j in self.free for i in range({0: 6, 1: 3}.get(int(m.jnt_type[j]), 1))]

    def joints(self):
        name = lambda j: mujoco.mj_id2name(self.m, mujoco.mjtObj.mjOBJ_JOINT, j) or '-'
        return [(name(j), KINDS[int(self.m.jnt_type[j])]) for j in self.free]

    def state(self, rng):
        m = self.m
        q, v = m.qpos0.copy(), np.zeros(m.nv)
        for j in range(m.njnt):
            at, kind = m.jnt_qposadr[j], KINDS[int(m.jnt_type[j])]
            if kind in ('hinge', 'slide'):
                q[at] += rng.normal() * (1.0 if kind == 'hinge' else 0.3)
                continue
            if kind == 'free':
                q[at:at + 3] += rng.normal(size=3)
                at += 3
            turn = rng.normal(size=4)
            q[at:at + 4] = turn / np.linalg.norm(turn)
        v[self.columns] = rng.normal(size=len(self.columns))
        for _ in self.follows:
            for j, (other, offset, ratio) in self.follows.items():
                a, b = m.jnt_qposadr[j], m.jnt_qposadr[other]
                q[a] = m.qpos0[a] + offset + ratio * (q[b] - m.qpos0[b])
        return q, self.G @ v

    def acceleration(self, q, v):
        m = self.m
        d = mujoco.MjData(m)
        d.qpos[:], d.qvel[:] = q, v
        mujoco.mj_forward(m, d)
        if not self.follows:
            return d.qacc_smooth.copy()
        M = np.zeros((m.nv, m.nv))
        columns = np.eye(m.nv)
        for i in range(m.nv):
            mujoco.mj_mulM(m, d, M[i], columns[i])
        G = self.G[:, self.columns]
        return np.linalg.solve(G.T @ M @ G, G.T @ d.qfrc_smooth)

    def independent(self, q, v):
        own = []
        for j in self.free:
            at = self.m.jnt_qposadr[j]
            own.extend(q[at:at + {0: 7, 1: 4}.get(int(self.m.jnt_type[j]), 1)])
        return own, v[self.columns]


def numbers(values):
    return ' '.join(repr(float(value)) for value in values)


def table(path, shown, count):
    """The lines of a model, and what MuJoCo says of it; an error of MuJoCo is a text."""
    try:
        model = Coupled(path)
    except Exception as error:
        return None, str(error).splitlines()[0]
    if model.m.nv == 0:
        return None, 'it has no joint'
    rng = np.random.default_rng(sum(path.name.encode()))
    lines = [f'model\t{shown}'] + [f'joint\t{name}\t{kind}' for name, kind in model.joints()]
    wanted = []
    for _ in range(count):
        q, v = model.state(rng)
        a = model.acceleration(q, v)
        own, speeds = model.independent(q, v)
        lines += [f'q\t{numbers(own)}', f'v\t{numbers(speeds)}', f'a\t{numbers(a)}']
        wanted.append(a)
    return lines, wanted


def answers(text, program):
    run = subprocess.run([program], input=text, capture_output=True, text=True, check=False)
    found, own = {}, None
    for line in run.stdout.splitlines():
        parts = line.split('\t')
        if parts[0] == 'model':
            own = found.setdefault(parts[1], [])
        elif parts[0] == 'a':
            own.append((np.array(parts[1].split(), float), float(parts[2]), float(parts[3])))
        else:
            own.append(parts[1])
    return found


def judged(path, wanted, own):
    if not own or isinstance(own[0], str):
        return 'refused', own[0] if own else 'the program ended'
    worst = small = 0.0
    for a, answer in zip(wanted, own):
        if isinstance(answer, str):
            return 'failed', answer
        found, allowed, of_small = answer
        if len(found) != len(a):
            return 'failed', f'{len(found)} accelerations for {len(a)}'
        error = np.linalg.norm(found - a)
        worst = max(worst, error / allowed)
        small = max(small, error / of_small)
    if small > 1:
        verdict = 'differs'
    else:
        verdict = 'agrees' if worst <= 1 else 'small'
    return verdict, f'{len(a):4d} speeds, error {worst:.1e} of what is allowed'


def models(args):
    if args.models:
        return [pathlib.Path(model).resolve() for model in args.models]
    folder = pathlib.Path(args.menagerie).resolve() if args.menagerie else OWN
    every = sorted(folder.rglob('*.xml'))
    return [path for path in every if '<mujoco' in path.read_text(errors='replace') and '<worldbody' in path.read_text(errors='replace')
            and 'parts' not in path.parts]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('models', nargs='*', help='models instead of those of tests/data/mjcf')
    parser.add_argument('--menagerie', help='all models under this folder')
    parser.add_argument('--program', default=str(ROOT / 'target/debug/examples/mjcf_peer'))
    parser.add_argument('--write', action='store_true', help='write tests/data/mjcf/accelerations.txt, which `cargo test` compares with')
    args = parser.parse_args()
    count = 3 if args.write else 10
    written = [f"# MuJoCo {mujoco.__version__}: qacc_smooth, by tests/peers/mjcf/compare.py --write"]
    counts = {}
    every = models(args)
    args.program = str(pathlib.Path(args.program).resolve())
    # MuJoCo writes a log where it stands.
    os.chdir(tempfile.gettempdir())
    for path in every:
        lines, wanted = table(path, str(path), count)
        if lines is None:
            verdict, said = 'left out', wanted
        else:
            written += [lines[0].replace(str(path), path.name)] + lines[1:]
            own = answers('\n'.join(lines) + '\n', args.program)
            verdict, said = judged(path, wanted, own.get(str(path)))
        counts[verdict] = counts.get(verdict, 0) + 1
        shown = '/'.join(path.parts[-2:])
        print(f'{shown:50} {verdict:8} {said[:400]}', flush=True)
    print(', '.join(f'{number} {verdict}' for verdict, number in sorted(counts.items())))
    if args.write:
        (OWN / 'accelerations.txt').write_text('\n'.join(written) + '\n')
    return 1 if counts.keys() & {'differs', 'failed'} else 0


if __name__ == '__main__':
    sys.exit(main())
