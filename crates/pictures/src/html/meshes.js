// Meshes: corners with their normals, six numbers each, and triangles of corners, counterclockwise from outside. Round ones are
// of radius 1 about z, with so many corners `around` it, a multiple of four.

/** The surface that strips of rows, [radius, z, normal across, normal along], make when they turn about z. */
function revolved(strips, around) {
  const [corners, triangles] = [[], []];
  for (const rows of strips) {
    const first = corners.length / 6;
    for (const [radius, z, across, along] of rows)
      for (let step = 0; step <= around; step++) {
        const angle = (2 * Math.PI * step) / around;
        const [c, s] = [Math.cos(angle), Math.sin(angle)];
        corners.push(radius * c, radius * s, z, across * c, across * s, along);
      }
    for (let k = 0; k + 1 < rows.length; k++)
      for (let step = 0; step < around; step++) {
        const a = first + k * (around + 1) + step;
        const b = a + around + 1;
        if (rows[k][0] > 0) triangles.push(a, a + 1, b + 1);
        if (rows[k + 1][0] > 0) triangles.push(a, b + 1, b);
      }
  }
  return { corners: new Float32Array(corners), triangles: new Uint16Array(triangles) };
}

/** Rows of a quarter circle between two angles of latitude, about the height `z`. */
function arc(from, to, steps, radius = 1, z = 0) {
  return Array.from({ length: steps + 1 }, (_, k) => {
    const angle = from + ((to - from) * k) / steps;
    const c = k === 0 && from === -Math.PI / 2 ? 0 : k === steps && to === Math.PI / 2 ? 0 : Math.cos(angle);
    return [radius * c, z + radius * Math.sin(angle), c, Math.sin(angle)];
  });
}

/** Cosine of the angle between faces from which on an edge is sharp: 40°. */
const sharp = Math.cos((40 * Math.PI) / 180);

const bytesOf = (base64) => Uint8Array.from(atob(base64), (character) => character.charCodeAt(0)).buffer;

/** A mesh of the page, with corners for each triangle: their normals are the mean of those of the faces around that are not beyond a sharp edge. */
function faceted({ low, step, corners, triangles, width }) {
  const steps = new Uint16Array(bytesOf(corners));
  const faces = new (width === 2 ? Uint16Array : Uint32Array)(bytesOf(triangles));
  const places = Float32Array.from(steps, (own, k) => low[k % 3] + step[k % 3] * own);
  const place = (k) => places.subarray(3 * faces[k], 3 * faces[k] + 3);
  // Twice the area of each face along its normal, by which it counts, and that area.
  const normals = new Float32Array(faces.length);
  const areas = new Float32Array(faces.length / 3);
  // The faces around each corner: where they begin in one list of all.
  const begin = new Uint32Array(steps.length / 3 + 1);
  for (const corner of faces) begin[corner + 1]++;
  for (let corner = 0; corner + 1 < begin.length; corner++) begin[corner + 1] += begin[corner];
  const around = new Uint32Array(faces.length);
  const next = begin.slice();
  for (let face = 0; face < areas.length; face++) {
    const [a, b, c] = [0, 1, 2].map((k) => place(3 * face + k));
    const normal = cross(sub(b, a), sub(c, a));
    normals.set(normal, 3 * face);
    areas[face] = length(normal);
    for (let k = 0; k < 3; k++) around[next[faces[3 * face + k]]++] = face;
  }
  const numbers = new Float32Array(6 * faces.length);
  for (let k = 0; k < faces.length; k++) {
    const own = 3 * Math.floor(k / 3);
    const least = sharp * areas[own / 3];
    let [x, y, z] = [0, 0, 0];
    // About a corner of very many faces, as in the middle of a disk, each counts for itself.
    const [first, last] = [begin[faces[k]], begin[faces[k] + 1]];
    const isCrowded = last - first > 200;
    if (isCrowded) [x, y, z] = normals.subarray(own, own + 3);
    for (let index = first; !isCrowded && index < last; index++) {
      const other = 3 * around[index];
      const [u, v, w] = [normals[other], normals[other + 1], normals[other + 2]];
      if (u * normals[own] + v * normals[own + 1] + w * normals[own + 2] < least * areas[around[index]]) continue;
      x += u;
      y += v;
      z += w;
    }
    numbers.set(place(k), 6 * k);
    numbers.set([x, y, z], 6 * k + 3);
  }
  return { corners: numbers, triangles: Uint32Array.from(faces, (_, k) => k), open: true };
}

const meshes = {
  sphere: (around) => revolved([arc(-Math.PI / 2, Math.PI / 2, around / 2)], around),

  /** From z = −1/2 to z = 1/2. */
  cylinder: (around) => {
    const [bottom, top] = [-0.5, 0.5];
    const strips = [
      [[0, bottom, 0, -1], [1, bottom, 0, -1]],
      [[1, bottom, 1, 0], [1, top, 1, 0]],
      [[1, top, 0, 1], [0, top, 0, 1]],
    ];
    return revolved(strips, around);
  },

  /** A cylinder without ends. */
  tube: (around) => revolved([[[1, -0.5, 1, 0], [1, 0.5, 1, 0]]], around),

  /** From −1 to 1 along each axis. */
  box: () => {
    const [corners, triangles] = [[], []];
    for (let axis = 0; axis < 3; axis++)
      for (const sign of [-1, 1]) {
        const first = corners.length / 6;
        for (const [a, b] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) {
          const [position, normal] = [[0, 0, 0], [0, 0, 0]];
          normal[axis] = position[axis] = sign;
          position[(axis + 1) % 3] = a;
          position[(axis + 2) % 3] = b;
          corners.push(...position, ...normal);
        }
        const order = sign > 0 ? [0, 1, 2, 0, 2, 3] : [0, 2, 1, 0, 3, 2];
        triangles.push(...order.map((corner) => first + corner));
      }
    return { corners: new Float32Array(corners), triangles: new Uint16Array(triangles) };
  },

  capsule: (around, radius, length) => {
    const lower = arc(-Math.PI / 2, 0, around / 4, radius, -length / 2);
    const upper = arc(0, Math.PI / 2, around / 4, radius, length / 2);
    return revolved([[...lower, ...upper]], around);
  },
};
