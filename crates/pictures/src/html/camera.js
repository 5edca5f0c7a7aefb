/** Looks at a target from around it; turned by drags, nearer and farther by the wheel or two fingers. */
class Camera {
  static angle = (35 * Math.PI) / 180;

  constructor(up) {
    this.up = up;
    this.front = across(up);
    this.left = cross(up, this.front);
    this.target = [0, 0, 0];
    this.distance = 1;
    this.reset();
  }

  /** The first direction of view. */
  reset() {
    this.azimuth = 0.9;
    this.elevation = 0.35;
  }

  /** Shows all of some balls, [place, radius], as large as they can be, in a picture so many times wider than high, whose part `covered` at
      the top is under something else. */
  fit(balls, aspect, covered = 0) {
    const { back, right, up } = this.axes();
    // Balls stay off the edges.
    const upright = Math.tan(Camera.angle / 2) * 0.92;
    const most = (slope, along) =>
      Math.max(...balls.map(([place, radius]) => dot(along, place) + slope * dot(back, place) + radius * Math.hypot(1, slope)));
    const opposite = (along) => scaled(along, -1);
    // The eye is behind four planes that touch the balls; in its own axes, at x, y and z.
    const [wide, high] = [upright * aspect, upright * (1 - 2 * covered)];
    const [east, west] = [most(wide, right), most(wide, opposite(right))];
    const [north, south] = [most(high, up), most(upright, opposite(up))];
    const z = Math.max((east + west) / (2 * wide), (north + south) / (high + upright));
    const x = (east - west) / 2;
    const y = (north - south + z * (upright - high)) / 2;
    const depths = balls.map(([place, radius]) => [dot(back, place) - radius, dot(back, place) + radius]).flat();
    const middle = (Math.min(...depths) + Math.max(...depths)) / 2;
    this.target = add(add(scaled(right, x), scaled(up, y)), scaled(back, middle));
    this.distance = Math.max(z - middle, 1e-9);
  }

  /** Directions of the picture in the world: towards the eye, right and up. */
  axes() {
    const level = add(scaled(this.front, Math.sin(this.azimuth)), scaled(this.left, -Math.cos(this.azimuth)));
    const back = add(scaled(level, Math.cos(this.elevation)), scaled(this.up, Math.sin(this.elevation)));
    const right = unit(cross(this.up, level));
    return { back, right, up: cross(back, right) };
  }

  eye() {
    return add(this.target, scaled(this.axes().back, this.distance));
  }

  /** From world to the picture. */
  matrix(aspect) {
    const { back, right, up } = this.axes();
    const projection = perspective(Camera.angle, aspect, this.near(), 200 * this.distance);
    this.aspect = aspect;
    return (this.last = product(projection, looking(this.eye(), right, up, back)));
  }

  /** Distance from which on something is seen. */
  near() {
    return 0.02 * this.distance;
  }

  /** Direction to the light: above the viewer's left shoulder. */
  light() {
    const { back, right } = this.axes();
    const level = unit(sub(back, scaled(this.up, dot(back, this.up))));
    return unit(add(add(scaled(this.up, 1.1), scaled(level, 0.55)), scaled(right, -0.5)));
  }

  /** Place in the picture, from 0 to 1 rightwards and downwards; null behind the viewer. */
  project(v) {
    const m = this.last;
    const row = (k) => m[k] * v[0] + m[4 + k] * v[1] + m[8 + k] * v[2] + m[12 + k];
    const w = row(3);
    return w > 0 ? [0.5 + row(0) / w / 2, 0.5 - row(1) / w / 2] : null;
  }

  /** Direction of the ray through a place in the picture. */
  ray([x, y]) {
    const { back, right, up } = this.axes();
    const half = Math.tan(Camera.angle / 2);
    const sideways = scaled(right, (2 * x - 1) * half * this.aspect);
    return unit(add(add(scaled(back, -1), sideways), scaled(up, (1 - 2 * y) * half)));
  }

  turn(dx, dy) {
    this.azimuth -= dx;
    this.elevation = Math.max(-1.55, Math.min(1.55, this.elevation + dy));
  }

  /** Moves the target with the pointer, by parts of the picture's height. */
  shift(dx, dy) {
    const { right, up } = this.axes();
    const size = 2 * Math.tan(Camera.angle / 2) * this.distance;
    this.target = add(this.target, add(scaled(right, -dx * size), scaled(up, dy * size)));
  }

  zoom(factor) {
    this.distance = Math.max(1e-9, this.distance * factor);
  }

  /** Follows pointers on `canvas`; calls `moved` after each change and `clicked` with the place of a click. */
  listen(canvas, moved, clicked) {
    const pointers = new Map();
    let travel = 0;
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      canvas.focus();
      if (pointers.size === 0) travel = 0;
      pointers.set(event.pointerId, event);
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) return;
      const { height } = canvas.getBoundingClientRect();
      const [dx, dy] = [event.clientX - before.clientX, event.clientY - before.clientY];
      travel += Math.abs(dx) + Math.abs(dy);
      const others = [...pointers.values()].filter((other) => other.pointerId !== event.pointerId);
      pointers.set(event.pointerId, event);
      if (others.length > 0) {
        const distance = (p) => Math.hypot(p.clientX - others[0].clientX, p.clientY - others[0].clientY);
        this.zoom(Math.max(1, distance(before)) / Math.max(1, distance(event)));
        this.shift(dx / height / 2, dy / height / 2);
      } else if (event.shiftKey || event.buttons & 6) this.shift(dx / height, dy / height);
      else this.turn((4 * dx) / height, (4 * dy) / height);
      moved();
    });
    const ended = (event) => {
      const { left, top, width, height } = canvas.getBoundingClientRect();
      const alone = pointers.size === 1 && event.type === "pointerup" && event.button === 0;
      if (pointers.delete(event.pointerId) && alone && travel < 5)
        clicked([(event.clientX - left) / width, (event.clientY - top) / height]);
    };
    canvas.addEventListener("pointerup", ended);
    canvas.addEventListener("pointercancel", ended);
    canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        const lines = event.deltaMode === 1 ? 16 : 1;
        this.zoom(Math.exp(0.0012 * lines * event.deltaY));
        moved();
      },
      { passive: false },
    );
  }
}
