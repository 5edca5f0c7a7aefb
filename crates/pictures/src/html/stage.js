/** The ball around the box around some balls. */
function extent(balls) {
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (const [place, radius] of balls)
    for (let k = 0; k < 3; k++) {
      low[k] = Math.min(low[k], place[k] - radius);
      high[k] = Math.max(high[k], place[k] + radius);
    }
  const centre = scaled(add(low, high), 0.5);
  const distances = balls.map(([place, radius]) => length(sub(place, centre)) + radius);
  return { centre, radius: distances.reduce((a, b) => Math.max(a, b), 0) || 1 };
}

/** Few of many balls: of those whose middles are within a cell of a grid, the largest. */
function thinned(balls, size) {
  const kept = new Map();
  for (const ball of balls) {
    const key = ball[0].map((part) => Math.round(part / (0.04 * size))).join();
    if (!(kept.get(key)?.[1] >= ball[1])) kept.set(key, ball);
  }
  return [...kept.values()];
}

const placed = (pose, balls) => balls.map(([place, radius]) => [point(pose, place), radius]);

/** Balls in a shape that touch its surface where it reaches farthest. */
const corners = {
  box: (size) => signs.map((sign) => [sign.map((part, k) => (part * size[k]) / 2), 0]),
  sphere: ([r]) => [[[0, 0, 0], r]],
  cylinder: ([r, l]) => rim.flatMap(([c, s]) => [-l / 2, l / 2].map((z) => [[r * c, r * s, z], 0])),
  capsule: ([r, l]) => [[[0, 0, -l / 2], r], [[0, 0, l / 2], r]],
  mesh: (size, low) => corners.box(size).map(([corner]) => [add(corner, add(low, scaled(size, 0.5))), 0]),
  ellipsoid: (half) => half.flatMap((axis, k) => [-axis, axis].map((part) => [[0, 1, 2].map((j) => (j === k ? part : 0)), 0])).concat([[[0, 0, 0], Math.min(...half)]]),
};
const signs = [-1, 1].flatMap((x) => [-1, 1].flatMap((y) => [-1, 1].map((z) => [x, y, z])));
const rim = Array.from({ length: 8 }, (_, k) => [Math.cos((k * Math.PI) / 4), Math.sin((k * Math.PI) / 4)]);

/** What is to be seen of the recording at a time. */
class Stage {
  constructor(recording, painter) {
    this.recording = recording;
    this.painter = painter;
    this.camera = new Camera(recording.up);
    this.options = { solids: "shape", rods: true, frames: false, trails: false, ground: true, follow: false };
    this.selected = null;
    // Height of what covers the picture's top, pixels.
    this.covered = 0;
    // Shapes show by themselves how bodies hang together.
    this.options.rods = recording.bodies.some((_, body) => !recording.shapes.some((shape) => shape.body === body));
    this.measure();
    this.solids = this.makeSolids();
    this.rods = this.makeRods();
    this.paths = recording.bodies.map((body, index) => this.path(body, index));
    this.home();
  }

  /** How large the mechanism is, where it goes, and how high the ground is. */
  measure() {
    const { recording } = this;
    const stride = Math.max(1, Math.ceil(recording.frames / 240));
    const some = Array.from({ length: Math.ceil(recording.frames / stride) }, (_, k) => k * stride);
    some.push(recording.frames - 1);
    const poses = some.map((frame) => recording.bodies.map((_, index) => recording.poseAt(frame, index)));
    const still = extent(this.balls(poses[0]));
    this.size = still.radius;
    this.everything = poses.flatMap((poses) => this.balls(poses));
    this.travels = extent(this.everything).radius > 2.5 * this.size;
    // Of what travels, all that is ever about the centre of mass: it stays in a picture that goes with it.
    const moved = (poses) => {
      const centre = recording.centre(poses);
      return this.balls(poses).map(([place, radius]) => [sub(place, centre), radius]);
    };
    this.about = thinned(poses.flatMap(moved), this.size);
    this.everything = thinned(this.everything, this.size);
    this.options.follow = this.travels;
    this.ground = this.groundBelow(poses);
  }

  /** Balls that fill what stands for each body up to its corners, and its joint: [place, radius]. */
  balls(poses) {
    this.around ??= this.recording.bodies.map((body, index) => {
      const shapes = this.recording.shapes.filter((shape) => shape.body === index);
      const balls = shapes.flatMap((shape) => placed(poseOf(shape.pose), corners[shape.kind](shape.size, shape.low)));
      if (balls.length === 0 && body.ellipsoid) balls.push(...placed(poseOf(body.ellipsoid.pose), corners.ellipsoid(body.ellipsoid.half)));
      return [...balls, [body.com, 0], [poseOf(body.joint_in_body).p, 0]];
    });
    // Of what stands in the world, meshes: a robot's base, rather than a floor.
    const still = this.recording.shapes.filter((shape) => shape.body === null && shape.kind === "mesh");
    const fixed = still.flatMap((shape) => placed(poseOf(shape.pose), corners.mesh(shape.size, shape.low)));
    return fixed.concat(this.around.flatMap((balls, index) => placed(poses[index], balls)));
  }

  /** The ground is level with the world's origin, or below everything; of what falls far, below where it starts. */
  groundBelow(poses) {
    const bottom = (poses) => Math.min(...poses.map((pose, index) => this.lowest(index, pose)));
    const lowest = Math.min(...poses.map(bottom));
    this.falls = lowest < -6 * this.size;
    const level = this.falls ? bottom(poses[0]) : lowest;
    return level < -0.02 * this.size ? level : 0;
  }

  /** Height of the lowest point of what stands for a body: of its shapes, or of its ellipsoid. */
  lowest(index, pose) {
    const { recording } = this;
    const up = recording.up;
    const shapes = recording.shapes.filter((shape) => shape.body === index);
    const below = (local, extent) => {
      const whole = composed(pose, local);
      const along = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => dot(turned(whole.q, axis), up));
      return dot(whole.p, up) - extent(along);
    };
    const round = ([x, y]) => Math.hypot(x, y);
    const extents = {
      box: (size) => (along) => along.reduce((sum, part, k) => sum + Math.abs(part) * size[k] * 0.5, 0),
      sphere: ([r]) => () => r,
      cylinder: ([r, l]) => (along) => r * round(along) + 0.5 * l * Math.abs(along[2]),
      capsule: ([r, l]) => (along) => r + 0.5 * l * Math.abs(along[2]),
      mesh: (size, low) => (along) => -along.reduce((sum, part, k) => sum + Math.min(part * low[k], part * (low[k] + size[k])), 0),
    };
    const heights = shapes.map((shape) => below(poseOf(shape.pose), extents[shape.kind](shape.size, shape.low)));
    const { ellipsoid, com } = recording.bodies[index];
    if (shapes.length === 0 && ellipsoid)
      heights.push(below(poseOf(ellipsoid.pose), (along) => Math.hypot(...along.map((part, k) => part * ellipsoid.half[k]))));
    return heights.length ? Math.min(...heights) : dot(point(pose, com), up);
  }

  /** The first direction of view, on all of the motion, or on what travels at the time shown. */
  home() {
    this.camera.reset();
    this.options.follow = this.travels;
    const centre = this.recording.centre(this.poses ?? this.recording.posesAt(0));
    this.fit(this.travels ? this.near(centre) : this.everything);
  }

  /** All of the motion, in the direction of view that there is. */
  frameAll() {
    this.options.follow = false;
    this.fit(this.everything);
  }

  /** Begins or ends to go with the mechanism; it begins in the middle of the picture. */
  follow(wanted) {
    this.options.follow = wanted;
    if (wanted && this.poses) this.fit(this.near(this.recording.centre(this.poses)));
  }

  /** All that is ever about the centre of mass, when that is at `centre`, with room to see where it goes. */
  near(centre) {
    return this.about.map(([place, radius]) => [add(scaled(place, 1.25), centre), 1.25 * radius]);
  }

  fit(balls) {
    const { clientWidth: width, clientHeight: height } = this.painter.canvas;
    this.camera.fit(balls, width / height || 1, height ? Math.min(0.25, this.covered / height) : 0);
    this.followed = null;
  }

  /** All solids: for each body its shapes, its ellipsoid and its box of inertia, of which one kind is shown. */
  makeSolids() {
    const { painter, recording } = this;
    const { few, many, shadow } = painter.around;
    const around = recording.bodies.length > 8 ? many : few;
    const solids = [];
    const least = 0.006 * this.size;
    recording.shapes.forEach(({ body, kind, size, low, mesh: own, pose, color }) => {
      const key = kind === "capsule" ? `capsule ${size}` : kind === "mesh" ? `mesh ${own}` : kind;
      const mesh = painter.mesh(key, () => (kind === "mesh" ? faceted(recording.meshes[own]) : meshes[kind](few, ...size)));
      const scale = {
        box: () => scaled(size, 0.5),
        sphere: () => [size[0], size[0], size[0]],
        cylinder: () => [size[0], size[0], size[1]],
        capsule: () => [1, 1, 1],
        mesh: () => [1, 1, 1],
      }[kind]();
      const reach = {
        capsule: () => [size[0], size[0], size[0] + size[1] / 2],
        cylinder: () => [size[0], size[0], size[1] / 2],
        mesh: () => size.map((side) => Math.max(side / 2, least)),
      }[kind]?.() ?? scale;
      const middle = kind === "mesh" ? add(low, scaled(size, 0.5)) : [0, 0, 0];
      const shade = color?.map((part) => part / 255);
      solids.push({ body, when: ["shape"], mesh, local: poseOf(pose), size: scale, own: shade, octants: kind !== "box" && kind !== "mesh", reach, middle });
    });
    recording.bodies.forEach(({ ellipsoid }, body) => {
      if (!ellipsoid) return;
      const local = poseOf(ellipsoid.pose);
      const bare = !recording.shapes.some((shape) => shape.body === body);
      const half = ellipsoid.half.map((axis) => Math.max(axis, least));
      const sphere = painter.mesh("ellipsoid", () => meshes.sphere(around));
      const coarse = painter.mesh("coarse sphere", () => meshes.sphere(shadow));
      solids.push({ body, when: bare ? ["shape", "ellipsoid"] : ["ellipsoid"], mesh: sphere, coarse, local, size: half, octants: true, reach: half });
      // A box of half sides s has moments m/3 (s² + s²), the ellipsoid m/5 (a² + a²).
      const sides = scaled(half, Math.sqrt(3 / 5));
      solids.push({ body, when: ["box"], mesh: painter.mesh("box", meshes.box), local, size: sides, octants: false, reach: sides });
    });
    return solids;
  }

  /** Rods: within bodies from their joint to their centre of mass and to the next joints; and along joints that slide. */
  makeRods() {
    const { recording } = this;
    const rods = [];
    recording.bodies.forEach((body, index) => {
      const joint = poseOf(body.joint_in_body).p;
      const at = (local) => ({ body: index, local });
      if (body.freedoms < 6) rods.push({ joint: at(joint) });
      rods.push({ ends: [at(joint), at(body.com)] });
      const before = { body: body.parent, local: poseOf(body.joint_in_parent).p };
      if (body.parent !== null) {
        const start = poseOf(recording.bodies[body.parent].joint_in_body).p;
        rods.push({ ends: [{ body: body.parent, local: start }, before] });
      }
      if (body.freedoms <= 2) rods.push({ ends: [before, at(joint)] });
    });
    return rods;
  }

  /** Path of a body's centre of mass over all frames. */
  path(body, index) {
    const { recording } = this;
    const numbers = new Float32Array(3 * recording.frames);
    for (let frame = 0; frame < recording.frames; frame++)
      numbers.set(point(recording.poseAt(frame, index), body.com), 3 * frame);
    return this.painter.buffer(numbers);
  }

  /** Colours as the style sheet has them. */
  readColors() {
    const style = getComputedStyle(document.documentElement);
    const color = (name) => {
      const digits = style.getPropertyValue(name).trim().slice(1);
      return [0, 2, 4].map((k) => parseInt(digits.slice(k, k + 2), 16) / 255);
    };
    const axes = ["--axis-x", "--axis-y", "--axis-z"].map(color);
    const lines = [1, 2, 3, 4, 5, 6].map((k) => color(`--line-${k}`));
    // Solids are paler than lines: half way to the card.
    const card = color("--card");
    const solids = lines.map((line) => line.map((part, k) => 0.78 * part + 0.22 * (card[k] > 0.5 ? 0.85 : 0.5)));
    const names = { sky: "--sky", grid: "--grid", rod: "--rod", accent: "--accent" };
    this.colors = { axes, lines, solids, shadow: Number(style.getPropertyValue("--shadow")) };
    for (const [key, name] of Object.entries(names)) this.colors[key] = color(name);
  }

  colorOf(solid) {
    const color = solid.own ?? (solid.body === null ? this.colors.rod : this.colors.solids[solid.body % 6]);
    if (solid.body === null || solid.body !== this.selected) return color;
    return color.map((part) => 0.45 * part + 0.55 * Math.min(1, part + 0.55));
  }

  /** The solids to show, where they stand. */
  shown(poses) {
    const visible = this.solids.filter((solid) => solid.when.includes(this.options.solids) || (solid.body === null && solid.when[0] === "shape"));
    return visible.map((solid) => ({
      ...solid,
      pose: solid.body === null ? solid.local : composed(poses[solid.body], solid.local),
      color: this.colorOf(solid),
    }));
  }

  shownRods(poses) {
    if (!this.options.rods) return [];
    const { painter, size, colors } = this;
    const place = ({ body, local }) => (body === null ? local : point(poses[body], local));
    const thick = 0.007 * size;
    const ball = painter.mesh("ball", () => meshes.sphere(4));
    const tube = painter.mesh("rod", () => meshes.tube(6));
    const out = [];
    for (const rod of this.rods) {
      if (rod.joint) {
        out.push({ mesh: ball, pose: { p: place(rod.joint), q: [1, 0, 0, 0] }, size: [2.2 * thick, 2.2 * thick, 2.2 * thick], color: colors.rod });
        continue;
      }
      const [a, b] = rod.ends.map(place);
      const along = sub(b, a);
      const long = length(along);
      if (long < thick) continue;
      const pose = { p: scaled(add(a, b), 0.5), q: fromAxis(along) };
      out.push({ mesh: tube, pose, size: [thick, thick, long], color: colors.rod });
    }
    return out;
  }

  /** Draws the picture at `time`. */
  draw(time) {
    const { recording, painter, camera, options, colors } = this;
    const poses = (this.poses = recording.posesAt(time));
    const centre = recording.centre(poses);
    if (options.follow && this.followed) camera.target = add(camera.target, sub(centre, this.followed));
    this.followed = options.follow ? centre : null;
    painter.begin(camera, colors.sky, recording.up);
    const solids = this.shown(poses);
    if (options.ground) {
      const seen = dot(sub(camera.eye(), scaled(recording.up, this.ground)), recording.up) > 0;
      const coarse = solids.map((solid) => ({ ...solid, mesh: solid.coarse ?? solid.mesh }));
      if (seen) painter.drawSolids(coarse, { ground: this.ground, darkness: colors.shadow });
      this.drawGrid();
    }
    painter.drawSolids(solids.concat(this.shownRods(poses)));
    if (options.trails) this.drawTrails(time);
    if (options.frames) this.drawFrames(poses);
  }

  /** Heights of the grids: the ground; where something falls through it, floors at equal distances, of which one is above it and one below. */
  floors() {
    const height = dot(this.camera.target, this.recording.up);
    const spacing = 2 * this.size;
    const below = Math.floor((height - this.size - this.ground) / spacing);
    if (!this.falls || below >= 0) return [this.ground];
    return [below, below + 1].map((floor) => this.ground + floor * spacing);
  }

  /** Squares on the ground about the middle of the picture, 1, 2 or 5 times a power of ten wide. */
  drawGrid() {
    const { camera, recording, painter, colors } = this;
    const wide = 0.12 * camera.distance;
    const power = 10 ** Math.floor(Math.log10(wide));
    const step = [1, 2, 5, 10].find((factor) => factor * power >= wide) * power;
    const [e1, e2] = [camera.front, camera.left];
    const middle = [e1, e2].map((axis) => Math.round(dot(camera.target, axis) / step));
    const reach = 18;
    for (const height of this.floors()) {
      const at = (u, v) => add(add(scaled(e1, u * step), scaled(e2, v * step)), scaled(recording.up, height));
      const points = [];
      for (let k = -reach; k <= reach; k++) {
        points.push(...at(middle[0] + k, middle[1] - reach), ...at(middle[0] + k, middle[1] + reach));
        points.push(...at(middle[0] - reach, middle[1] + k), ...at(middle[0] + reach, middle[1] + k));
      }
      painter.drawLines(new Float32Array(points), { color: colors.grid, alpha: 0.75, width: 1, centre: at(...middle), reach: reach * step });
    }
    this.gridStep = step;
  }

  /** Paths so far: the whole one of the selected body, else of all bodies over a third of the recording. */
  drawTrails(time) {
    const { recording, painter, colors } = this;
    const last = recording.frameAt(time);
    const since = this.selected === null ? time - recording.duration / 3 : 0;
    const first = recording.frameAt(Math.max(0, since));
    this.paths.forEach((path, body) => {
      if (this.selected !== null && body !== this.selected) return;
      const color = colors.lines[body % 6];
      painter.drawLines(path, { color, width: 2, strip: true, from: first, count: last - first, ageing: true });
      const tip = [recording.poseAt(last, body), this.poses[body]].flatMap((pose) => point(pose, recording.bodies[body].com));
      painter.drawLines(new Float32Array(tip), { color, width: 2 });
    });
  }

  /** Axes of the world, of bodies and of named frames: x red, y green, z blue. */
  drawFrames(poses) {
    const { recording, painter, colors, size } = this;
    const world = { p: [0, 0, 0], q: [1, 0, 0, 0] };
    const named = recording.marks.map((mark) => [composed(mark.body === null ? world : poses[mark.body], poseOf(mark.pose)), 0.07]);
    const all = [[world, 0.2], ...poses.map((pose) => [pose, 0.13]), ...named];
    [[1, 0, 0], [0, 1, 0], [0, 0, 1]].forEach((axis, k) => {
      const points = all.flatMap(([pose, long]) => [...pose.p, ...point(pose, scaled(axis, long * size))]);
      painter.drawLines(new Float32Array(points), { color: colors.axes[k], width: 2.5, above: true });
    });
  }

  /** The body under a place in the picture, or null. */
  pick(place) {
    const direction = this.camera.ray(place);
    const eye = this.camera.eye();
    let [nearest, body] = [Infinity, null];
    for (const solid of this.shown(this.poses)) {
      const back = [solid.pose.q[0], -solid.pose.q[1], -solid.pose.q[2], -solid.pose.q[3]];
      const scale = (v) => v.map((part, k) => part / solid.reach[k]);
      const from = scale(sub(turned(back, sub(eye, solid.pose.p)), solid.middle ?? [0, 0, 0]));
      const along = scale(turned(back, direction));
      // Every solid is taken as the ellipsoid in its box, a little larger.
      const [a, b, c] = [dot(along, along), dot(from, along), dot(from, from) - 1.2];
      const root = b * b - a * c;
      const distance = (-b - Math.sqrt(root)) / a;
      if (root >= 0 && distance > 0 && distance < nearest) [nearest, body] = [distance, solid.body];
    }
    return body;
  }
}
