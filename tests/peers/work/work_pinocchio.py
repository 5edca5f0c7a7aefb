"""Pinocchio's forward dynamics in the Runge-Kutta methods of SciPy, as a user of Python writes it."""

import json, time
import numpy as np
import pinocchio as pin
from scipy.integrate import solve_ivp
from protocol import serve
from scenes import rotation

METHODS = ['RK45', 'DOP853', 'Radau', 'LSODA']
AXES = {(1.0, 0.0, 0.0): 'X', (0.0, 1.0, 0.0): 'Y', (0.0, 0.0, 1.0): 'Z'}


class Model:
    def __init__(self, file):
        scene = json.load(open(file))
        self.model = pin.Model()
        self.model.gravity = pin.Motion(np.array(scene['gravity']), np.zeros(3))
        self.frames, q, v = [], [], []
        self.links, self.balls, self.euclidean, self.springs = scene['links'], [], [], []
        for link in self.links:
            at = pin.SE3(np.array(link['R']), np.array(link['p']))
            index = 0 if link['parent'] < 0 else self.frames[link['parent']]
            place = 0
            for joint in link['joints']:
                index = self.model.addJoint(index, kind(joint), at, f'{link["name"]}_{len(q)}_{place}')
                at = pin.SE3.Identity()
                place += 1
            self.frames.append(index)
            inertia = pin.Inertia(link['mass'], np.array(link['com']), np.array(link['inertia']))
            self.model.appendBodyToJoint(index, inertia, pin.SE3.Identity())
            iq, iv = len(q), len(v)
            first = link['joints'][0]['kind']
            if first == 'S':
                w, x, y, z = link['q']
                q += [x, y, z, w]
                v += link['v']
                self.balls.append((iq, iv))
            elif first == 'FF':
                w, x, y, z = link['q'][3:]
                q += link['q'][:3] + [x, y, z, w]
                v += link['v'][3:] + link['v'][:3]
                self.balls.append((iq + 3, iv + 3))
                self.euclidean.append(('FF', iq, iv))
            else:
                q += link['q']
                v += link['v']
                self.euclidean.append((len(link['joints']), iq, iv))
            if link['stiffness'] or link['damping']:
                self.springs.append((first, iq, iv, len(link['v']), link['stiffness'], link['damping']))
        self.data = self.model.createData()
        self.q, self.v = np.array(q, float), np.array(v, float)
        assert self.model.nq == len(q) and self.model.nv == len(v)

    def rates(self, deadline):
        model, data, nq = self.model, self.data, self.model.nq
        tau, rates = np.zeros(model.nv), np.empty(nq + model.nv)

        def f(t, y):
            if time.thread_time() > deadline:
                raise TimeoutError('takes longer')
            q, v = y[:nq].copy(), y[nq:]
            for iq, iv in self.balls:
                x = q[iq : iq + 4]
                w = v[iv : iv + 3]
                rates[iq : iq + 3] = 0.5 * (x[3] * w + np.cross(x[:3], w))
                rates[iq + 3] = -0.5 * x[:3].dot(w)
                x /= np.linalg.norm(x)
            for size, iq, iv in self.euclidean:
                if size == 'FF':
                    x = q[iq + 3 : iq + 7]
                    rates[iq : iq + 3] = rotation([x[3], x[0], x[1], x[2]]) @ v[iv : iv + 3]
                else:
                    rates[iq : iq + size] = v[iv : iv + size]
            tau[:] = 0.0
            for first, iq, iv, size, stiffness, damping in self.springs:
                if first == 'S':  # of the energy k (3 − tr R)/2
                    x = q[iq : iq + 4]
                    tau[iv : iv + 3] -= 2.0 * stiffness * x[3] * x[:3] + damping * v[iv : iv + 3]
                else:
                    tau[iv : iv + size] -= stiffness * q[iq : iq + size] + damping * v[iv : iv + size]
            rates[nq:] = pin.aba(model, data, q, v, tau)
            return rates.copy()

        return f

    def state(self, y):
        q, v = y[: self.model.nq].copy(), y[self.model.nq :]
        for iq, _ in self.balls:
            q[iq : iq + 4] /= np.linalg.norm(q[iq : iq + 4])
        pin.forwardKinematics(self.model, self.data, q, v)
        out = []
        for link, index in zip(self.links, self.frames):
            at, twist = self.data.oMi[index], self.data.v[index]
            com = np.array(link['com'])
            out += list(at.rotation @ com + at.translation) + list(at.rotation.ravel())
            out += list(at.rotation @ (twist.linear + np.cross(twist.angular, com))) + list(twist.angular)
        return out


def kind(joint):
    letter = AXES[tuple(joint['axis'])]
    return {
        'R': lambda: getattr(pin, f'JointModelR{letter}')(),
        'P': lambda: getattr(pin, f'JointModelP{letter}')(),
        'H': lambda: getattr(pin, f'JointModelH{letter}')(joint['pitch'] / (2 * np.pi)),
        'S': pin.JointModelSpherical,
        'FF': pin.JointModelFreeFlyer,
    }[joint['kind']]()


def load(file):
    return Model(file), [f'{method}:tol' for method in METHODS]


def run(loaded, method, tol, t_end, most):
    start = np.concatenate([loaded.q, loaded.v])
    rates = loaded.rates(time.thread_time() + most)
    found = solve_ivp(rates, (0.0, t_end), start, method=method, rtol=max(tol, 3e-14), atol=tol)
    if not found.success:
        raise RuntimeError(found.message)
    return lambda: loaded.state(found.y[:, -1]), int(found.nfev), len(found.t) - 1


if __name__ == '__main__':
    import scipy

    serve(f'pinocchio {pin.__version__}, scipy {scipy.__version__}, called from Python', load, run)
