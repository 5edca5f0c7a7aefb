/** The run: what the header tells, and the numbers at each frame. */
class Recording {
  constructor(header, base64) {
    Object.assign(this, header);
    const bytes = Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
    const columns = this.charts.flatMap((chart) => chart.variants).flatMap((variant) => variant.columns).length;
    this.times = new Float64Array(bytes.buffer, 0, this.frames);
    this.columns = [];
    for (let index = 0; index < columns; index++)
      this.columns.push(new Float32Array(bytes.buffer, this.frames * (8 + 4 * index), this.frames));
    this.poses = new Float32Array(bytes.buffer, this.frames * (8 + 4 * columns));
    this.duration = this.frames ? this.times[this.frames - 1] : 0;
    const g = length(this.gravity);
    this.up = g > 0 ? scaled(this.gravity, -1 / g) : [0, 0, 1];
    // A shape that is a mesh has the sides of the box around it as its size, and where that box begins.
    for (const shape of this.shapes)
      if (shape.kind === "mesh") {
        const { low, step } = this.meshes[shape.mesh];
        shape.low = low;
        shape.size = scaled(step, 65535);
      }
    this.totalMass = this.bodies.reduce((sum, body) => sum + body.mass, 0);
  }

  /** The last frame that is not after `time`. */
  frameAt(time) {
    let [low, high] = [0, this.frames - 1];
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.times[middle] <= time) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  /** The frame nearest to `time`. */
  nearest(time) {
    const frame = this.frameAt(time);
    const next = Math.min(frame + 1, this.frames - 1);
    return this.times[next] - time < time - this.times[frame] ? next : frame;
  }

  /** Pose of a body at a frame. */
  poseAt(frame, body) {
    return poseOf(this.poses, 7 * (frame * this.bodies.length + body));
  }

  /** Poses of all bodies at a time; between two frames, between their poses. */
  posesAt(time) {
    const frame = this.frameAt(time);
    const next = Math.min(frame + 1, this.frames - 1);
    const part = next > frame ? (time - this.times[frame]) / (this.times[next] - this.times[frame]) : 0;
    return this.bodies.map((_, body) => {
      const pose = this.poseAt(frame, body);
      return part > 0 ? between(pose, this.poseAt(next, body), part) : pose;
    });
  }

  /** Centre of mass of all bodies; the middle of their origins where nothing has mass. */
  centre(poses) {
    const weight = (body) => (this.totalMass > 0 ? body.mass / this.totalMass : 1 / this.bodies.length);
    return this.bodies.reduce(
      (sum, body, index) => add(sum, scaled(point(poses[index], body.com), weight(body))),
      [0, 0, 0],
    );
  }
}
