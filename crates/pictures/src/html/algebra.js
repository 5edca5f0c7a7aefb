// Vectors are arrays [x, y, z]; quaternions [w, x, y, z], in files scalar last; a pose is { p, q }; matrices of four by four stand column by column.

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const scaled = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = (a) => Math.hypot(a[0], a[1], a[2]);
const unit = (a) => scaled(a, 1 / (length(a) || 1));

/** A direction across `a`. */
const across = (a) => unit(cross(a, Math.abs(a[0]) < 0.8 * length(a) ? [1, 0, 0] : [0, 1, 0]));

function multiplied([aw, ax, ay, az], [bw, bx, by, bz]) {
  return [
    aw * bw - ax * bx - ay * by - az * bz,
    aw * bx + ax * bw + ay * bz - az * by,
    aw * by - ax * bz + ay * bw + az * bx,
    aw * bz + ax * by - ay * bx + az * bw,
  ];
}

/** The vector `v` turned by the unit quaternion `q`. */
function turned([w, x, y, z], v) {
  const t = scaled(cross([x, y, z], v), 2);
  return add(add(v, scaled(t, w)), cross([x, y, z], t));
}

/** The rotation that takes z to the direction of `a`. */
function fromAxis(a) {
  const [x, y, z] = unit(a);
  if (z < -0.999999) return [0, 1, 0, 0];
  const n = Math.hypot(1 + z, x, y);
  return [(1 + z) / n, -y / n, x / n, 0];
}

/** A unit quaternion as files have it: x, y, z, w, where w is not negative. */
function scalarLast(q) {
  const [w, x, y, z] = q[0] < 0 ? q.map((entry) => -entry) : q;
  return [x, y, z, w];
}

const point = (pose, v) => add(pose.p, turned(pose.q, v));
const composed = (a, b) => ({ p: point(a, b.p), q: multiplied(a.q, b.q) });
const poseOf = (seven, at = 0) => ({
  p: [seven[at], seven[at + 1], seven[at + 2]],
  q: [seven[at + 6], seven[at + 3], seven[at + 4], seven[at + 5]],
});

/** Between two poses: straight for the position, the short way round for the attitude. */
function between(a, b, part) {
  const cosine = a.q[0] * b.q[0] + a.q[1] * b.q[1] + a.q[2] * b.q[2] + a.q[3] * b.q[3];
  const angle = Math.acos(Math.min(1, Math.abs(cosine)));
  let [left, right] = [1 - part, part];
  if (angle > 1e-3) {
    left = Math.sin(left * angle) / Math.sin(angle);
    right = Math.sin(right * angle) / Math.sin(angle);
  }
  if (cosine < 0) right = -right;
  const q = a.q.map((entry, k) => left * entry + right * b.q[k]);
  const norm = Math.hypot(...q);
  return { p: add(scaled(a.p, 1 - part), scaled(b.p, part)), q: q.map((entry) => entry / norm) };
}

/** Product of two matrices. */
function product(a, b) {
  const out = new Float32Array(16);
  for (let c = 0; c < 4; c++)
    for (let r = 0; r < 4; r++)
      for (let k = 0; k < 4; k++) out[4 * c + r] += a[4 * k + r] * b[4 * c + k];
  return out;
}

/** Projection with the angle `fov` from top to bottom. */
function perspective(fov, aspect, near, far) {
  const f = 1 / Math.tan(fov / 2);
  const out = new Float32Array(16);
  out[0] = f / aspect;
  out[5] = f;
  out[10] = (far + near) / (near - far);
  out[11] = -1;
  out[14] = (2 * far * near) / (near - far);
  return out;
}

/** From world to eye, where the eye looks along −z. */
function looking(eye, right, up, back) {
  return new Float32Array([
    right[0], up[0], back[0], 0,
    right[1], up[1], back[1], 0,
    right[2], up[2], back[2], 0,
    -dot(right, eye), -dot(up, eye), -dot(back, eye), 1,
  ]);
}
