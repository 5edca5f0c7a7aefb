// Meshes: corners and normals, six numbers each, in triangles. Round ones are of radius 1 about z.

/** Rows of a surface of revolution, [radius, z, normal across, normal along], as triangles. */
function revolved(rows, around = 28) {
  const out = [];
  const corner = ([radius, z, across, along], step) => {
    const angle = (2 * Math.PI * step) / around;
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    out.push(radius * c, radius * s, z, across * c, across * s, along);
  };
  for (let k = 0; k + 1 < rows.length; k++)
    for (let step = 0; step < around; step++) {
      const [a, b] = [rows[k], rows[k + 1]];
      if (a[0] > 0) [[a, 0], [a, 1], [b, 1]].forEach(([row, more]) => corner(row, step + more));
      if (b[0] > 0) [[a, 0], [b, 1], [b, 0]].forEach(([row, more]) => corner(row, step + more));
    }
  return new Float32Array(out);
}

/** Rows of a quarter circle between two angles of latitude, about the height `z`. */
function arc(from, to, radius = 1, z = 0, steps = 8) {
  return Array.from({ length: steps + 1 }, (_, k) => {
    const angle = from + ((to - from) * k) / steps;
    const c = k === 0 && from === -Math.PI / 2 ? 0 : k === steps && to === Math.PI / 2 ? 0 : Math.cos(angle);
    return [radius * c, z + radius * Math.sin(angle), c, Math.sin(angle)];
  });
}

const meshes = {
  sphere: () => revolved(arc(-Math.PI / 2, Math.PI / 2, 1, 0, 16)),

  /** From z = −1/2 to z = 1/2. */
  cylinder: (around) => {
    const [bottom, top] = [-0.5, 0.5];
    const rows = [
      [[0, bottom, 0, -1], [1, bottom, 0, -1]],
      [[1, bottom, 1, 0], [1, top, 1, 0]],
      [[1, top, 0, 1], [0, top, 0, 1]],
    ];
    const parts = rows.flatMap((pair) => Array.from(revolved(pair, around)));
    return new Float32Array(parts);
  },

  /** From −1 to 1 along each axis. */
  box: () => {
    const out = [];
    for (let axis = 0; axis < 3; axis++)
      for (const sign of [-1, 1]) {
        const corners = [[-1, -1], [1, -1], [1, 1], [-1, -1], [1, 1], [-1, 1]];
        for (const [a, b] of sign > 0 ? corners : corners.reverse()) {
          const [position, normal] = [[0, 0, 0], [0, 0, 0]];
          normal[axis] = position[axis] = sign;
          position[(axis + 1) % 3] = a;
          position[(axis + 2) % 3] = b;
          out.push(...position, ...normal);
        }
      }
    return new Float32Array(out);
  },

  capsule: (radius, length) => {
    const lower = arc(-Math.PI / 2, 0, radius, -length / 2);
    const upper = arc(0, Math.PI / 2, radius, length / 2);
    return revolved([...lower, ...upper]);
  },
};
