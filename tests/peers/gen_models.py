#!/usr/bin/env python3
"""Builds every test model with Pinocchio (Python), and writes
   $WORK/models/NAME.txt    plain-text model all the C++/Rust harnesses read
   $WORK/models/NAME.bin    1024 random states (float64): per state q[nq] v[nv] tau[nv]
   $WORK/models/NAME.xml    MJCF for MuJoCo
   ./urdf/*.urdf            the URDFs used, stripped of visual/collision/mesh elements
Fixed seeds throughout. Usage: gen_models.py WORKDIR
"""

import sys, os, json, math, xml.etree.ElementTree as ET
import numpy as np
import pinocchio as pin

HERE = os.path.dirname(os.path.abspath(__file__))
WORK = sys.argv[1]
os.makedirs(f'{WORK}/models', exist_ok=True)
os.makedirs(f'{HERE}/urdf', exist_ok=True)
NSTATES = 1024


def erd():
    import cmeel, site

    for p in site.getsitepackages():
        d = f'{p}/cmeel.prefix/share/example-robot-data/robots'
        if os.path.isdir(d):
            return d
    raise SystemExit('example-robot-data not found')


def strip_urdf(src, dst, fix=()):
    t = ET.parse(src)
    r = t.getroot()
    for link in r.findall('link'):
        for k in ('visual', 'collision'):
            for e in link.findall(k):
                link.remove(e)
    for k in ('transmission', 'gazebo', 'material', 'mujoco'):
        for e in r.findall(k):
            r.remove(e)
    for j in r.findall('joint'):
        if j.get('name') in fix:
            j.set('type', 'fixed')
            for k in ('axis', 'limit', 'mimic', 'dynamics', 'safety_controller'):
                for e in j.findall(k):
                    j.remove(e)
    ET.indent(t)
    t.write(dst, encoding='utf-8', xml_declaration=True)


PENDULUM = '''<?xml version="1.0"?>
<robot name="pendulum">
  <link name="base"/>
  <link name="rod">
    <inertial>
      <origin xyz="0.01 -0.02 -0.35" rpy="0.1 -0.2 0.3"/>
      <mass value="1.3"/>
      <inertia ixx="0.021" ixy="0.0004" ixz="-0.0007" iyy="0.0205" iyz="0.0003" izz="0.0011"/>
    </inertial>
  </link>
  <joint name="hinge" type="revolute">
    <parent link="base"/><child link="rod"/>
    <origin xyz="0.05 0.1 0.9" rpy="0 0 0.25"/>
    <axis xyz="0 1 0"/>
    <limit lower="-6.3" upper="6.3" effort="100" velocity="100"/>
  </joint>
</robot>
'''


def random_inertia(rng):
    """A random ellipsoid of density ~1000 with random offset and orientation: physically consistent."""
    a = rng.uniform(0.03, 0.12, 3)
    m = 1000.0 * 4.0 / 3.0 * math.pi * a[0] * a[1] * a[2]
    I = m / 5.0 * np.diag([a[1] ** 2 + a[2] ** 2, a[0] ** 2 + a[2] ** 2, a[0] ** 2 + a[1] ** 2])
    q = pin.Quaternion(rng.normal(size=4))
    q.normalize()
    R = q.matrix()
    c = np.array([0, 0, -0.1]) + rng.uniform(-0.05, 0.05, 3)
    return pin.Inertia(m, c, R @ I @ R.T)


def chain(kind, n, seed=12345):
    rng = np.random.default_rng(seed)
    m = pin.Model()
    m.name = f'{kind}{n}'
    parent = 0
    for i in range(n):
        if kind == 'ball':
            jm = pin.JointModelSpherical()
        else:
            jm = [pin.JointModelRX(), pin.JointModelRY(), pin.JointModelRZ()][int(rng.integers(3))]
        q = pin.Quaternion(rng.normal(size=4))
        q.normalize()
        p = np.zeros(3) if i == 0 else np.array([0, 0, -0.2]) + rng.uniform(-0.03, 0.03, 3)
        # small random mounting rotation for links, general for the first
        if i > 0:
            w = rng.uniform(-0.5, 0.5, 3)
            R = pin.exp3(w)
        else:
            R = q.matrix()
        j = m.addJoint(parent, jm, pin.SE3(R, p), f'j{i}')
        m.appendBodyToJoint(j, random_inertia(rng), pin.SE3.Identity())
        parent = j
    return m


def joint_info(m, i):
    """-> (type, axis)"""
    j = m.joints[i]
    s = j.shortname()
    ax = {'X': [1.0, 0, 0], 'Y': [0, 1.0, 0], 'Z': [0, 0, 1.0]}
    if s == 'JointModelFreeFlyer':
        return 'FF', [0, 0, 0]
    if s == 'JointModelSpherical':
        return 'S', [0, 0, 0]
    if s in ('JointModelRX', 'JointModelRY', 'JointModelRZ'):
        return 'R', ax[s[-1]]
    if s in ('JointModelPX', 'JointModelPY', 'JointModelPZ'):
        return 'P', ax[s[-1]]
    if s in ('JointModelRevoluteUnaligned', 'JointModelPrismaticUnaligned'):
        e = j.extract() if hasattr(j, 'extract') else None
        a = e.axis if e is not None else None
        return ('R' if 'Revolute' in s else 'P'), [float(x) for x in a]
    raise SystemExit(f'joint type {s} not handled')


def unaligned_axis(m, i):
    # portable: read the axis from the motion subspace
    d = m.createData()
    pin.computeJointJacobians(m, d, pin.neutral(m))
    J = pin.getJointJacobian(m, d, i, pin.LOCAL)
    c = J[:, m.joints[i].idx_v]
    return [float(x) for x in (c[3:] if 'Revolute' in m.joints[i].shortname() else c[:3])]


def states(m, infos, n, seed=2024):
    rng = np.random.default_rng(seed)
    out = []
    for _ in range(n):
        q = np.zeros(m.nq)
        for i in range(1, m.njoints):
            iq = m.joints[i].idx_q
            t = infos[i][0]
            if t == 'FF':
                q[iq : iq + 3] = rng.uniform(-1, 1, 3)
                x = rng.normal(size=4)
                q[iq + 3 : iq + 7] = x / np.linalg.norm(x)
            elif t == 'S':
                x = rng.normal(size=4)
                q[iq : iq + 4] = x / np.linalg.norm(x)
            elif t == 'R':
                q[iq] = rng.uniform(-math.pi, math.pi)
            else:
                q[iq] = rng.uniform(-0.5, 0.5)
        v = rng.uniform(-1, 1, m.nv)
        tau = rng.uniform(-5, 5, m.nv)
        out.append((q, v, tau))
    return out


def f17(x):
    return ' '.join(repr(float(y)) for y in np.asarray(x).ravel())


def write_txt(m, infos, path):
    with open(path, 'w') as f:
        f.write(f'model {m.name}\n')
        f.write(f'gravity {f17(m.gravity.linear)}\n')
        f.write(f'sizes {m.njoints-1} {m.nq} {m.nv}\n')
        for i in range(1, m.njoints):
            t, a = infos[i]
            P = m.jointPlacements[i]
            Y = m.inertias[i]
            I = Y.inertia
            f.write(
                f'joint {i} {m.parents[i]} {t} {f17(a)} {f17(P.rotation)} {f17(P.translation)} '
                f'{f17([Y.mass])} {f17(Y.lever)} '
                f'{f17([I[0,0], I[0,1], I[0,2], I[1,1], I[1,2], I[2,2]])}\n'
            )


def write_mjcf(m, infos, path):
    kids = {i: [] for i in range(m.njoints)}
    for i in range(1, m.njoints):
        kids[int(m.parents[i])].append(i)
    L = [
        '<mujoco>',
        '<compiler angle="radian" autolimits="false" balanceinertia="false" boundmass="0" boundinertia="0" inertiagrouprange="9 9"/>',
        f'<option gravity="{f17(m.gravity.linear)}" timestep="0.001" integrator="Euler"><flag constraint="disable" equality="disable" frictionloss="disable" limit="disable" contact="disable" actuation="disable" clampctrl="disable" filterparent="disable" sensor="disable" eulerdamp="disable" warmstart="disable" island="disable"/></option>',
        '<worldbody>',
    ]

    def rec_open(i):
        P = m.jointPlacements[i]
        Y = m.inertias[i]
        I = Y.inertia
        q = pin.Quaternion(P.rotation)
        t, a = infos[i]
        L.append(
            f'<body name="b{i}" pos="{f17(P.translation)}" quat="{f17([q.w, q.x, q.y, q.z])}">'
        )
        L.append(
            f'<inertial mass="{Y.mass!r}" pos="{f17(Y.lever)}" fullinertia="{f17([I[0,0], I[1,1], I[2,2], I[0,1], I[0,2], I[1,2]])}"/>'
        )
        if t == 'FF':
            L.append('<freejoint/>')
        elif t == 'S':
            L.append(f'<joint type="ball" pos="0 0 0" damping="0" armature="0"/>')
        else:
            L.append(
                f'<joint type="{"hinge" if t=="R" else "slide"}" pos="0 0 0" axis="{f17(a)}" damping="0" armature="0" limited="false"/>'
            )

    stack = [('o', k) for k in reversed(kids[0])]
    while stack:
        op, i = stack.pop()
        if op == 'c':
            L.append('</body>')
            continue
        rec_open(i)
        stack.append(('c', i))
        for k in reversed(kids[i]):
            stack.append(('o', k))
    L += ['</worldbody>', '</mujoco>']
    open(path, 'w').write('\n'.join(L))


def main():
    R = erd()
    open(f'{HERE}/urdf/pendulum.urdf', 'w').write(PENDULUM)
    U = {
        'panda7': (
            f'{R}/panda_description/urdf/panda.urdf',
            False,
            ('panda_finger_joint1', 'panda_finger_joint2'),
        ),
        'anymal': (f'{R}/anymal_b_simple_description/robots/anymal.urdf', True, ()),
        'g1': (f'{R}/g1_description/urdf/g1_29dof_rev_1_0.urdf', True, ()),
    }
    models = []
    m = pin.buildModelFromUrdf(f'{HERE}/urdf/pendulum.urdf')
    m.name = 'pendulum'
    models.append((m, 'urdf/pendulum.urdf', 'fixed'))
    for name, (src, ff, fix) in U.items():
        dst = f'{HERE}/urdf/{name}.urdf'
        strip_urdf(src, dst, fix)
        m = (
            pin.buildModelFromUrdf(dst, pin.JointModelFreeFlyer())
            if ff
            else pin.buildModelFromUrdf(dst)
        )
        m.name = name
        models.append((m, f'urdf/{name}.urdf', 'floating' if ff else 'fixed'))
    for kind in ('rev', 'ball'):
        for n in (8, 32, 128, 512):
            models.append((chain(kind, n), None, 'fixed'))
    idx = []
    for m, urdf, base in models:
        infos = [None]
        for i in range(1, m.njoints):
            s = m.joints[i].shortname()
            if 'Unaligned' in s and 'Unbounded' not in s:
                infos.append(('R' if 'Revolute' in s else 'P', unaligned_axis(m, i)))
            else:
                infos.append(joint_info(m, i))
        st = states(m, infos, NSTATES)
        write_txt(m, infos, f'{WORK}/models/{m.name}.txt')
        np.concatenate([np.concatenate(s) for s in st]).astype('<f8').tofile(
            f'{WORK}/models/{m.name}.bin'
        )
        write_mjcf(m, infos, f'{WORK}/models/{m.name}.xml')
        idx.append(dict(name=m.name, joints=m.njoints - 1, nq=m.nq, nv=m.nv, base=base))
        print(f'{m.name:10s} joints {m.njoints-1:4d} nq {m.nq:5d} nv {m.nv:5d} {base}', flush=True)
    json.dump(idx, open(f'{WORK}/models/index.json', 'w'))


main()
