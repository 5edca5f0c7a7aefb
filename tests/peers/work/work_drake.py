"""Drake's Simulator on a continuous MultibodyPlant, which steps in compiled code."""

import json
import numpy as np
from pydrake.all import (
    ApplySimulatorConfig,
    BallRpyJoint,
    Frame,
    FixedOffsetFrame,
    MultibodyPlant,
    PrismaticJoint,
    QuaternionFloatingJoint,
    RevoluteJoint,
    RevoluteSpring,
    RigidTransform,
    RollPitchYaw,
    RotationMatrix,
    RotationalInertia,
    ScrewJoint,
    Simulator,
    SimulatorConfig,
    SpatialInertia,
    UnitInertia,
)
from protocol import serve
from scenes import rotation

SCHEMES = ['runge_kutta3', 'runge_kutta5', 'bogacki_shampine3', 'radau3', 'implicit_euler']


class Plant:
    def __init__(self, file):
        self.scene = json.load(open(file))
        self.plant = plant = MultibodyPlant(0.0)
        plant.mutable_gravity_field().set_gravity_vector(np.array(self.scene['gravity']))
        self.bodies, self.joints = [], []
        for i, link in enumerate(self.scene['links']):
            frame = plant.world_frame() if link['parent'] < 0 else self.bodies[link['parent']].body_frame()
            at = RigidTransform(RotationMatrix(np.array(link['R'])), np.array(link['p']))
            frame = plant.AddFrame(FixedOffsetFrame(f'f{i}', frame, at))
            own = []
            for k, joint in enumerate(link['joints']):
                last = k + 1 == len(link['joints'])
                inertia = spatial(link) if last else SpatialInertia(0.0, np.zeros(3), UnitInertia(0, 0, 0), True)
                body = plant.AddRigidBody(f'b{i}_{k}', inertia)
                own.append(self.joint(f'j{i}_{k}', frame, body.body_frame(), joint, link))
                frame = body.body_frame()
            self.bodies.append(body)
            self.joints.append(own)
        plant.Finalize()
        self.simulator = Simulator(plant)
        self.context = self.simulator.get_mutable_context()
        self.set()
        self.start = self.context.get_continuous_state_vector().CopyToVector()

    def joint(self, name, parent, child, joint, link):
        kind, axis, damping = joint['kind'], np.array(joint['axis']), link['damping']
        if link['stiffness'] and kind != 'R':
            raise RuntimeError(f'no spring of this kind at a joint {kind}')
        made = {
            'R': lambda: RevoluteJoint(name, parent, child, axis, damping),
            'P': lambda: PrismaticJoint(name, parent, child, axis, damping=damping),
            'H': lambda: ScrewJoint(name, parent, child, axis, joint['pitch'], damping),
            'S': lambda: BallRpyJoint(name, parent, child, damping),
            'FF': lambda: QuaternionFloatingJoint(name, parent, child),
        }[kind]()
        made = self.plant.AddJoint(made)
        if link['stiffness']:
            self.plant.AddForceElement(RevoluteSpring(made, 0.0, link['stiffness']))
        return made

    def set(self):
        context = self.context
        for link, own in zip(self.scene['links'], self.joints):
            kind = link['joints'][0]['kind']
            if kind == 'S':
                R = rotation(link['q'])
                own[0].set_angles(context, RollPitchYaw(RotationMatrix(R)).vector())
                own[0].set_angular_velocity(context, R @ link['v'])
            elif kind == 'FF':
                R = RotationMatrix(rotation(link['q'][3:]))
                own[0].SetPose(context, RigidTransform(R, link['q'][:3]))
                own[0].set_angular_velocity(context, R.matrix() @ link['v'][:3])
                own[0].set_translational_velocity(context, R.matrix() @ link['v'][3:])
            else:
                for joint, q, v in zip(own, link['q'], link['v']):
                    position, speed = np.array([q]), np.array([v])
                    self.plant.SetPositions(context, spread(self.plant.GetPositions(context), joint.position_start(), position))
                    self.plant.SetVelocities(context, spread(self.plant.GetVelocities(context), joint.velocity_start(), speed))

    def state(self):
        out = []
        for link, body in zip(self.scene['links'], self.bodies):
            pose = self.plant.EvalBodyPoseInWorld(self.context, body)
            twist = self.plant.EvalBodySpatialVelocityInWorld(self.context, body)
            R, com = pose.rotation().matrix(), pose.rotation().matrix() @ np.array(link['com'])
            out += list(pose.translation() + com) + list(R.ravel())
            out += list(twist.translational() + np.cross(twist.rotational(), com)) + list(R.T @ twist.rotational())
        return out


def spread(all, place, values):
    all = np.array(all)
    all[place : place + len(values)] = values
    return all


def spatial(link):
    m, c, I = link['mass'], np.array(link['com']), np.array(link['inertia'])
    about_origin = I + m * (c.dot(c) * np.eye(3) - np.outer(c, c))
    i = about_origin / m
    unit = UnitInertia(i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2])
    return SpatialInertia(m, c, unit)


def load(file):
    return Plant(file), [f'{scheme}:accuracy' for scheme in SCHEMES]


def run(loaded, scheme, accuracy, t_end, most):
    simulator = loaded.simulator
    config = SimulatorConfig(
        integration_scheme=scheme, accuracy=accuracy, max_step_size=t_end, use_error_control=True, target_realtime_rate=0.0
    )
    loaded.context.SetTime(0.0)
    loaded.context.SetContinuousState(loaded.start)
    ApplySimulatorConfig(config, simulator)
    simulator.Initialize()
    import time

    deadline = time.thread_time() + most
    # Nearly all of the time is inside; the pieces let a run be given up.
    for piece in range(1, 9):
        simulator.AdvanceTo(t_end * piece / 8)
        if time.thread_time() > deadline and piece < 8:
            raise TimeoutError('takes longer')
    integrator = simulator.get_integrator()
    return loaded.state, int(integrator.get_num_derivative_evaluations()), int(integrator.get_num_steps_taken())


if __name__ == '__main__':
    from importlib.metadata import version

    serve(f'drake {version("drake")}, Simulator.AdvanceTo', load, run)
