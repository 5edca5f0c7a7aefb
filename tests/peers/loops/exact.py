"""Mechanisms with loops in 200-bit arithmetic: a spanning tree of rigid bodies, and equations between its coordinates with multipliers.

Nothing here is shared with any library that is measured. Matrices are numpy arrays of gmpy2 numbers; twists and forces are (angular; linear), in body axes.
"""

import gmpy2, numpy as np

gmpy2.get_context().precision = 200
#: Below this an entry is one that cancels, of numbers of order one.
NOTHING = gmpy2.mpfr('1e-45')


def number(x):
    return gmpy2.mpfr(x)


def exact(x):
    """An array of numbers as it stands."""
    array = np.array(x, dtype=object)
    return np.vectorize(number, otypes=[object])(array) if array.size else array


def zeros(*shape):
    return exact(np.zeros(shape))


def cross(v):
    z = number(0)
    return np.array([[z, -v[2], v[1]], [v[2], z, -v[0]], [-v[1], v[0], z]], dtype=object)


def turn(axis, angle):
    """Rotation about x, y or z."""
    c, s = gmpy2.cos(angle), gmpy2.sin(angle)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    R = exact(np.eye(3))
    R[i, i], R[j, j], R[i, j], R[j, i] = c, c, -s, s
    return R


def of_quaternion(x, y, z, w):
    v = np.array([x, y, z], dtype=object)
    K = cross(v)
    return exact(np.eye(3)) + 2 * w * K + 2 * (K @ K)


def to_child(R, p):
    """Takes twists of a parent to axes and origin of a frame in it."""
    X = zeros(6, 6)
    X[:3, :3] = X[3:, 3:] = R.T
    X[3:, :3] = -R.T @ cross(p)
    return X


def solve(A, b):
    """By Gauss with pivots; b is a vector or a matrix."""
    A, b = A.copy(), b.copy()
    n = len(A)
    for k in range(n):
        pivot = k + int(np.argmax([abs(x) for x in A[k:, k]]))
        if abs(A[pivot, k]) < NOTHING:
            raise ZeroDivisionError('the equations are singular')
        if pivot != k:
            A[[k, pivot]], b[[k, pivot]] = A[[pivot, k]], b[[pivot, k]]
        rows = [i for i in range(k + 1, n) if A[i, k] != 0]
        for i in rows:
            factor = A[i, k] / A[k, k]
            A[i, k:] -= factor * A[k, k:]
            b[i] = b[i] - factor * b[k]
    x = b.copy()
    for k in reversed(range(n)):
        rest = A[k, k + 1 :] @ x[k + 1 :] if k + 1 < n else 0
        x[k] = (b[k] - rest) / A[k, k]
    return x


class Joint:
    """Free (`FF`: x y z and a quaternion x y z w; v linear, then angular, body axes) or a turn about x, y or z (`R`)."""

    def __init__(self, name, parent, kind, axis, R, p, mass, com, inertia, armature=0.0):
        self.name, self.parent, self.kind, self.axis = name, parent, kind, axis
        self.R, self.p, self.mass, self.com, self.inertia = R, p, mass, com, inertia
        self.armature = armature
        self.nq, self.nv = (7, 6) if kind == 'FF' else (1, 1)


def depth_first(joints):
    """The place of each joint where all of a branch stands together, as Pinocchio's factors of the mass matrix take it."""
    place = {-1: -1}

    def visit(joint):
        place[joint] = len(place) - 1
        for i, other in enumerate(joints):
            if other.parent == joint:
                visit(i)

    for i, joint in enumerate(joints):
        if joint.parent == -1:
            visit(i)
    return place


class Tree:
    """Joints with parents first (-1 is the world), loops and couplings.

    A loop (i, point, j, point) says that the points of two bodies are one; a coupling {joint: factor} that a sum of coordinates is 0.
    """

    def __init__(self, joints, gravity, loops=(), couplings=()):
        place = depth_first(joints)
        self.joints = sorted(joints, key=lambda joint: place[joints.index(joint)])
        for joint in joints:
            joint.parent = place[joint.parent]
        self.gravity, self.couplings = gravity, list(couplings)
        self.loops = [(place[i], a, place[j], b) for i, a, j, b in loops]
        self.iq, self.iv, self.nq, self.nv = [], [], 0, 0
        for joint in self.joints:
            self.iq.append(self.nq)
            self.iv.append(self.nv)
            self.nq += joint.nq
            self.nv += joint.nv
        self.index = {joint.name: i for i, joint in enumerate(self.joints)}

    def place(self, q):
        """Poses of all joints' frames in the world, and maps of twists from parents."""
        poses, maps = [], []
        for joint, start in zip(self.joints, self.iq):
            R, p = exact(joint.R), exact(joint.p)
            own = q[start : start + joint.nq]
            if joint.kind == 'FF':
                p = p + R @ own[:3]
                R = R @ of_quaternion(*own[3:])
            else:
                R = R @ turn(joint.axis, own[0])
            maps.append(to_child(R, p))
            if joint.parent >= 0:
                above, origin = poses[joint.parent]
                R, p = above @ R, origin + above @ p
            poses.append((R, p))
        return poses, maps

    def own(self, joint):
        S = zeros(6, joint.nv)
        if joint.kind == 'FF':
            S[3:, :3] = S[:3, 3:] = exact(np.eye(3))
        else:
            S[joint.axis, 0] = number(1)
        return S

    def jacobians(self, maps):
        out = []
        for i, joint in enumerate(self.joints):
            J = zeros(6, self.nv) if joint.parent < 0 else maps[i] @ out[joint.parent]
            J[:, self.iv[i] : self.iv[i] + joint.nv] = self.own(joint)
            out.append(J)
        return out

    def biases(self, maps, J, v):
        """Twists, and their rates where v does not change."""
        twists, rates = [], []
        for i, joint in enumerate(self.joints):
            twist = J[i] @ v
            relative = self.own(joint) @ v[self.iv[i] : self.iv[i] + joint.nv]
            rate = zeros(6) if joint.parent < 0 else maps[i] @ rates[joint.parent]
            w, u = twist[:3], twist[3:]
            rate[:3] = rate[:3] + cross(w) @ relative[:3]
            rate[3:] = rate[3:] + cross(u) @ relative[:3] + cross(w) @ relative[3:]
            twists.append(twist)
            rates.append(rate)
        return twists, rates

    def residual(self, q):
        """By how much loops are open, in axes of their first body; entries in the order of `equations`, without those that vanish."""
        poses, _ = self.place(q)
        return np.concatenate([self._gap(poses, loop) for loop in self.loops] + [zeros(0)])

    def _gap(self, poses, loop):
        i, a, j, b = loop
        (R1, p1), (R2, p2) = poses[i], poses[j]
        return R1.T @ (p2 + R2 @ exact(b) - p1 - R1 @ exact(a))

    def equations(self, poses, J, twists=None, rates=None):
        """A with A v = 0, and what A v̇ must be."""
        rows, right = [], []
        for i, a, j, b in self.loops:
            ends = []
            for body, point in ((i, a), (j, b)):
                R, point = poses[body][0], exact(point)
                at = lambda twist: twist[3:] - cross(point) @ twist[:3]
                drift = None
                if twists is not None:
                    velocity = at(twists[body])
                    drift = R @ (at(rates[body]) + cross(twists[body][:3]) @ velocity)
                ends.append((R @ (J[body][3:] - cross(point) @ J[body][:3]), drift))
            axes = poses[i][0].T
            rows += list(axes @ (ends[1][0] - ends[0][0]))
            if twists is not None:
                right += list(-(axes @ (ends[1][1] - ends[0][1])))
        for coupling in self.couplings:
            row = zeros(self.nv)
            for joint, factor in coupling.items():
                row[self.iv[self.index[joint]]] = number(factor)
            rows.append(row)
            right.append(number(0))
        return np.array(rows, dtype=object).reshape(-1, self.nv), np.array(right, dtype=object)

    def independent(self, A):
        """Rows that are not 0: a loop in a plane says nothing across it."""
        return [k for k, row in enumerate(A) if max(abs(x) for x in row) > NOTHING]

    def close(self, q, free):
        """Moves all coordinates but those of the joints `free` until the loops are closed. Couplings and free-flyers are left alone."""
        dependent = [i for i, joint in enumerate(self.joints) if joint.name not in free]
        columns = [self.iv[i] for i in dependent]
        for _ in range(40):
            poses, maps = self.place(q)
            gap = self.residual(q)
            if max([abs(x) for x in gap] + [number(0)]) < NOTHING:
                return q
            A, _ = self.equations(poses, self.jacobians(maps))
            A = A[: len(gap)]
            rows = self.independent(A)
            step = solve_least(A[np.ix_(rows, columns)], gap[rows])
            q = q.copy()
            for i, d in zip(dependent, step):
                q[self.iq[i]] -= d
        raise ArithmeticError('the loops do not close')

    def speeds(self, q, v, free):
        """All of v, from that of the joints `free`."""
        columns = [self.iv[i] for i, joint in enumerate(self.joints) if joint.name not in free]
        if not columns:
            return v
        poses, maps = self.place(q)
        A, _ = self.equations(poses, self.jacobians(maps))
        rows = self.independent(A)
        v = v.copy()
        v[columns] = number(0)
        v[columns] = -solve_least(A[np.ix_(rows, columns)], A[rows] @ v)
        return v

    def accelerations(self, q, v, tau):
        """v̇: the equations of Newton and Euler with multipliers."""
        poses, maps = self.place(q)
        J = self.jacobians(maps)
        twists, rates = self.biases(maps, J, v)
        M, force = zeros(self.nv, self.nv), tau.copy()
        for i, joint in enumerate(self.joints):
            inertia, com, mass = zeros(6, 6), cross(exact(joint.com)), number(joint.mass)
            inertia[:3, :3] = exact(joint.inertia) - mass * com @ com
            inertia[:3, 3:], inertia[3:, :3] = mass * com, -mass * com
            inertia[3:, 3:] = mass * exact(np.eye(3))
            rate = rates[i].copy()
            rate[3:] = rate[3:] - poses[i][0].T @ exact(self.gravity)
            momentum = inertia @ twists[i]
            w, u = twists[i][:3], twists[i][3:]
            load = inertia @ rate
            load[:3] = load[:3] + cross(w) @ momentum[:3] + cross(u) @ momentum[3:]
            load[3:] = load[3:] + cross(w) @ momentum[3:]
            columns = [k for k in range(self.nv) if any(x != 0 for x in J[i][:, k])]
            own = J[i][:, columns]
            M[np.ix_(columns, columns)] = M[np.ix_(columns, columns)] + own.T @ inertia @ own
            force[columns] = force[columns] - own.T @ load
            for k in range(joint.nv):
                M[self.iv[i] + k, self.iv[i] + k] += number(joint.armature)
        A, right = self.equations(poses, J, twists, rates)
        rows = self.independent(A)
        A, right = A[rows], right[rows]
        size = self.nv + len(rows)
        whole = zeros(size, size)
        whole[: self.nv, : self.nv] = M
        whole[self.nv :, : self.nv], whole[: self.nv, self.nv :] = A, A.T
        return solve(whole, np.concatenate([force, right]))[: self.nv]


def solve_least(A, b):
    """The x for which A x − b is least; A has full column rank."""
    return solve(A.T @ A, A.T @ b)
