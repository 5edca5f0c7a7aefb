"""Accelerations of robots in SDF by Drake, at random states, for `cargo test -p hamel --test sdf`. README.md says how it is run.

What Hamel and Drake have under different names is brought into the coordinates of MuJoCo, which `../mjcf/states.rs` reads: of a free joint the linear velocity in the
world and the angular velocity in the body, of a ball a quaternion and the angular velocity in the body, of a universal joint two angles.
Drake does not leave gravity out of single links, nor does it hold mimic joints in continuous time: the weight is taken back by a force, and the equations are projected.
"""

import importlib.metadata
import pathlib
import sys
import xml.etree.ElementTree as xml

import numpy as np
from pydrake.math import RollPitchYaw, RotationMatrix
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import ExternallyAppliedSpatialForce, MultibodyPlant
from pydrake.systems.framework import DiagramBuilder

ROOT = pathlib.Path(__file__).resolve().parents[3]
FOLDER = ROOT / 'tests/data/sdf'
STATES = 3


class Robot:
    """A model of Drake: its joints in the order of their names in the file, and what the file says that Drake does not read."""

    def __init__(self, path):
        self.tree = xml.parse(path).getroot()
        self.plant = MultibodyPlant(0.0)
        Parser(self.plant).AddModels(str(path))
        world = self.tree.find('world/gravity')
        self.gravity = np.array(world.text.split(), float) if world is not None else np.array([0, 0, -9.81])
        self.plant.mutable_gravity_field().set_gravity_vector(self.gravity)
        self.plant.Finalize()
        top = self.tree.find('world') if self.tree.find('world') is not None else self.tree
        models = top.findall('model')
        self.names = {}
        for model in models:
            self.collect(model, '' if len(models) == 1 else f'{model.get("name")}::')
        self.joints = [self.plant.get_joint(index) for index in self.plant.GetJointIndices()]
        self.joints = [joint for joint in self.joints if joint.num_velocities() > 0]
        self.follows = {joint.get('name'): self.law(joint) for joint in self.tree.iter('joint') if joint.find('axis/mimic') is not None}

    @staticmethod
    def law(joint):
        mimic = joint.find('axis/mimic')
        multiplier, offset, reference = (float(mimic.findtext(name, '0')) for name in ('multiplier', 'offset', 'reference'))
        return mimic.get('joint'), multiplier, offset - multiplier * reference

    def collect(self, model, scope):
        """Names of links and joints with those of their models, as Hamel has them; Drake knows a joint by the model of its child."""
        for element in model.findall('link') + model.findall('joint'):
            self.names[element.get('name')] = scope + element.get('name')
        for inner in model.findall('model'):
            self.collect(inner, f'{scope}{inner.get("name")}::')

    def name(self, joint):
        """A free joint is called as its link."""
        return self.names[joint.child_body().name() if self.kind(joint) == 'free' else joint.name()]

    @staticmethod
    def kind(joint):
        return {'quaternion_floating': 'free', 'ball_rpy': 'ball'}.get(joint.type_name(), 'hinge')

    def lines(self):
        lines = []
        for joint in self.joints:
            if joint.name() in self.follows:
                continue
            name, kind = self.name(joint), self.kind(joint)
            lines.append(f'joint\t{name}\t{kind}')
            if joint.type_name() == 'universal':
                lines.append(f'joint\t{name}_2\t{kind}')
        return lines

    def state(self, rng):
        """A state of Drake and the same in the coordinates of the table."""
        context = self.plant.CreateDefaultContext()
        q, v, own_q, own_v = np.zeros(self.plant.num_positions()), rng.normal(size=self.plant.num_velocities()), [], []
        for joint in self.joints:
            at = slice(joint.position_start(), joint.position_start() + joint.num_positions())
            moving = slice(joint.velocity_start(), joint.velocity_start() + joint.num_velocities())
            kind = self.kind(joint)
            if kind == 'free':
                turn = rng.normal(size=4)
                q[at] = np.r_[turn / np.linalg.norm(turn), rng.normal(size=3)]
            elif kind == 'ball':
                q[at] = rng.normal(size=3) * 0.7
            else:
                scale = 0.2 if joint.type_name() == 'prismatic' else 0.8
                q[at] = rng.normal(size=joint.num_positions()) * scale
        self.place(q, v)
        for joint in self.joints:
            at = slice(joint.position_start(), joint.position_start() + joint.num_positions())
            moving = slice(joint.velocity_start(), joint.velocity_start() + joint.num_velocities())
            if joint.name() in self.follows:
                continue
            if self.kind(joint) == 'free':
                own_q += [*q[at][4:], *q[at][:4]]
                own_v += [*v[moving][3:], *(self.turn(joint, q).T @ v[moving][:3])]
            elif self.kind(joint) == 'ball':
                r = self.turn(joint, q)
                own_q += [*RotationMatrix(r).ToQuaternion().wxyz()]
                own_v += [*(r.T @ v[moving])]
            else:
                own_q += [*q[at]]
                own_v += [*v[moving]]
        self.plant.SetPositionsAndVelocities(context, np.r_[q, v])
        return context, own_q, own_v

    def place(self, q, v):
        """Puts joints where what they follow says."""
        by_name = {joint.name(): joint for joint in self.joints}
        for name, (leader, multiplier, offset) in self.follows.items():
            own, other = by_name[name], by_name[leader]
            q[own.position_start()] = multiplier * q[other.position_start()] + offset
            v[own.velocity_start()] = multiplier * v[other.velocity_start()]

    def turn(self, joint, q):
        own = q[joint.position_start():joint.position_start() + joint.num_positions()]
        if self.kind(joint) == 'free':
            w, x, y, z = own[:4]
            return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                             [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                             [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])
        return RollPitchYaw(own).ToRotationMatrix().matrix()

    def accelerations(self, context):
        plant = self.plant
        lifted = []
        for link in self.tree.iter('link'):
            if link.findtext('gravity', 'true').strip() in ('false', '0'):
                body = plant.GetBodyByName(link.get('name'))
                force = ExternallyAppliedSpatialForce()
                force.body_index = body.index()
                force.p_BoBq_B = body.CalcCenterOfMassInBodyFrame(context)
                force.F_Bq_W = SpatialForce(np.zeros(3), -self.gravity * body.get_mass(context))
                lifted.append(force)
        plant.get_applied_spatial_force_input_port().FixValue(context, lifted)
        rates = plant.EvalTimeDerivatives(context).CopyToVector()[plant.num_positions():]
        q = plant.GetPositions(context)
        free = [joint for joint in self.joints if joint.name() not in self.follows]
        if self.follows:
            mass = plant.CalcMassMatrix(context)
            basis = np.zeros((plant.num_velocities(), len(free)))
            for column, joint in enumerate(free):
                basis[joint.velocity_start(), column] = 1
                for name, (leader, multiplier, _) in self.follows.items():
                    if leader == joint.name():
                        basis[plant.GetJointByName(name).velocity_start(), column] = multiplier
            return np.linalg.solve(basis.T @ mass @ basis, basis.T @ mass @ rates)
        own = []
        for joint in free:
            a = rates[joint.velocity_start():joint.velocity_start() + joint.num_velocities()]
            if self.kind(joint) == 'free':
                own += [*a[3:], *(self.turn(joint, q).T @ a[:3])]
            elif self.kind(joint) == 'ball':
                own += [*(self.turn(joint, q).T @ a)]
            else:
                own += [*a]
        return own


def numbers(values):
    return ' '.join(repr(float(value)) for value in values)


def main():
    out = [f'# Drake {importlib.metadata.version("drake")}: accelerations, by tests/peers/sdf/accelerations.py']
    files = [pathlib.Path(file).resolve() for file in sys.argv[1:]] or sorted(FOLDER.glob('*.sdf'))
    for path in files:
        try:
            robot = Robot(path)
        except Exception as error:
            print(f'{path.name}: left out: {str(error).splitlines()[0]}', file=sys.stderr)
            continue
        rng = np.random.default_rng(sum(path.name.encode()))
        out += [f'model\t{path.name}'] + robot.lines()
        for _ in range(STATES):
            context, q, v = robot.state(rng)
            out += [f'q\t{numbers(q)}', f'v\t{numbers(v)}', f'a\t{numbers(robot.accelerations(context))}']
        print(f'{path.name}: {len(v)} speeds', file=sys.stderr)
    if len(sys.argv) == 1:
        (FOLDER / 'accelerations.txt').write_text('\n'.join(out) + '\n')
    else:
        print('\n'.join(out))


if __name__ == '__main__':
    main()
