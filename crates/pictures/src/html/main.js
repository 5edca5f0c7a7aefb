const element = (id) => document.getElementById(id);

/** The page: its parts, what joins them, and when they are drawn. */
class Page {
  constructor(recording) {
    this.recording = recording;
    this.canvas = element("stage");
    this.clock = new Clock(recording.duration, () => this.invalidate());
    this.panel = new Panel(recording, element("selected"));
    this.plots = recording.charts.map((chart) => new Plot(recording, chart, (time) => this.clock.seek(time)));
    this.labels = recording.bodies.map((body) => Object.assign(document.createElement("span"), { textContent: body.name }));
    this.pace = new Pace(() => this.resize());
    this.stage = this.makeStage();
    element("name").textContent = recording.name;
    Object.assign(element("description"), { textContent: recording.description, title: recording.description });
    element("facts").textContent = `${recording.method} · ${recording.frames} frames`;
    element("charts").append(...this.plots.map((plot) => plot.element));
    this.panel.choose(null);
    this.listenToTime();
    if (this.stage) this.listenToView();
    this.listenToKeys();
    this.listenToWindow();
    this.restyle();
    this.resize();
    this.home();
  }

  /** The view; null, and told, where it cannot be. */
  makeStage() {
    try {
      if (this.recording.frames === 0) throw new Error("the simulation stopped before its first sample");
      return new Stage(this.recording, new Painter(this.canvas));
    } catch (error) {
      element("refusal").hidden = false;
      element("refusal").textContent = `The motion cannot be drawn: ${error.message}. Plots do not need it.`;
      for (const id of ["stage", "tools"]) element(id).hidden = true;
      return null;
    }
  }

  /** Asks for a picture, soon. */
  invalidate() {
    if (!this.scheduled) requestAnimationFrame((now) => this.frame(now));
    this.scheduled = true;
  }

  frame(now) {
    this.scheduled = false;
    this.clock.tick(now);
    if (this.clock.playing !== this.drawnPlaying) this.resize();
    this.draw(now);
    this.pace.note(now, this.clock.playing);
    if (this.clock.playing) this.invalidate();
  }

  draw(now) {
    const { time, duration, playing } = this.clock;
    if (this.stage) {
      this.stage.draw(time);
      this.panel.show(this.stage.poses);
      if (element("names").checked) this.placeLabels();
    }
    for (const plot of this.plots) plot.show(time);
    // Numbers that change faster cannot be read, and cost as much as the picture.
    if (!playing || !(now - this.told < 100)) {
      for (const plot of this.plots) plot.tell();
      this.told = now;
    }
    element("scrub").value = duration ? time / duration : 0;
    element("time").textContent = `${time.toFixed(3)} / ${duration.toFixed(3)} s`;
    element("play").textContent = playing ? "Pause" : "Play";
  }

  /** Names beside the bodies, the nearest ones first; one that would cover another goes below it, or is left out. */
  placeLabels() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const eye = this.stage.camera.eye();
    const labels = this.recording.bodies.map((body, index) => {
      const place = point(this.stage.poses[index], body.com);
      return { label: this.labels[index], seen: this.stage.camera.project(place), far: length(sub(place, eye)) };
    });
    labels.sort((a, b) => a.far - b.far);
    const taken = [];
    const room = { width: 4, height: 17 };
    for (const { label, seen } of labels) {
      const x = seen ? seen[0] * width : 0;
      const wide = (label.wide ??= label.offsetWidth) + room.width;
      const free = (y) => !taken.some((other) => Math.abs(other.y - y) < room.height && x < other.x + other.wide && other.x < x + wide);
      const y = seen ? [0, 1, -1, 2, -2].map((row) => seen[1] * height + row * room.height).find(free) : undefined;
      label.style.visibility = y === undefined ? "hidden" : "";
      if (y === undefined) continue;
      taken.push({ x, y, wide });
      label.style.transform = `translate(${x}px, ${y}px)`;
    }
  }

  /** Fits the picture to its place: as sharp as the screen, or while it plays as sharp as this machine can. */
  resize() {
    this.drawnPlaying = this.clock.playing;
    const pixels = this.drawnPlaying ? this.pace.sharpness : Pace.sharpest();
    const { canvas } = this;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((size) => Math.max(1, Math.round(size * pixels)));
    // Setting a size clears the picture, even the same size.
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    this.invalidate();
  }

  /** Takes the colours of the style sheet again. */
  restyle() {
    this.stage?.readColors();
    for (const plot of this.plots) plot.resize();
    this.invalidate();
  }

  /** Selects a body; null for none. */
  select(body) {
    if (!this.stage) return;
    this.stage.selected = body;
    this.panel.choose(body);
    if (body !== null) for (const plot of this.plots) plot.chooseBody(body);
    this.invalidate();
  }

  /** The first view again. */
  home() {
    this.look((stage) => stage.home());
  }

  /** All of the motion. */
  frameAll() {
    this.look((stage) => stage.frameAll());
  }

  /** Goes with the mechanism, or no longer. */
  follow(wanted) {
    this.look((stage) => stage.follow(wanted));
  }

  /** Changes the view. */
  look(change) {
    if (!this.stage) return;
    const tools = element("tools");
    this.stage.covered = tools.offsetTop + tools.offsetHeight;
    change(this.stage);
    element("follow").checked = this.stage.options.follow;
    this.invalidate();
  }

  /** Goes on by so many frames. */
  step(by) {
    const { clock, recording } = this;
    clock.playing = false;
    const target = recording.nearest(clock.time) + by;
    clock.seek(recording.times[Math.min(recording.frames - 1, Math.max(0, target))]);
  }

  listenToTime() {
    const { clock } = this;
    element("play").addEventListener("click", () => clock.toggle());
    element("scrub").addEventListener("input", (event) => clock.seek(event.target.value * clock.duration));
    element("speed").addEventListener("change", (event) => (clock.speed = Number(event.target.value)));
    element("loop").addEventListener("change", (event) => (clock.loops = event.target.checked));
  }

  listenToView() {
    const { options, camera } = this.stage;
    const changed = (id, change) =>
      element(id).addEventListener("change", (event) => {
        change(event.target);
        this.invalidate();
      });
    for (const option of ["rods", "frames", "trails", "ground"]) {
      element(option).checked = options[option];
      changed(option, (box) => (options[option] = box.checked));
    }
    if (this.recording.shapes.length === 0) {
      element("solids").options[0].remove();
      options.solids = "ellipsoid";
    }
    changed("solids", (list) => (options.solids = list.value));
    changed("names", (box) => element("labels").replaceChildren(...(box.checked ? this.labels : [])));
    element("follow").addEventListener("change", (event) => this.follow(event.target.checked));
    element("all").addEventListener("click", () => this.frameAll());
    element("home").addEventListener("click", () => this.home());
    const clicked = (place) => this.select(this.stage.pick(place));
    camera.listen(this.canvas, () => this.invalidate(), clicked);
  }

  listenToKeys() {
    const keys = {
      " ": () => this.clock.toggle(),
      ArrowLeft: () => this.step(-1),
      ArrowRight: () => this.step(1),
      Home: () => this.clock.seek(0),
      End: () => this.clock.seek(this.clock.duration),
      a: () => this.frameAll(),
      f: () => this.follow(!this.stage?.options.follow),
      r: () => this.home(),
      Escape: () => this.select(null),
    };
    document.addEventListener("keydown", (event) => {
      const key = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
      if (!key || event.ctrlKey || event.metaKey || event.altKey || needsKey(document.activeElement, event.key)) return;
      event.preventDefault();
      key();
    });
    // A control that was clicked gives the keys back.
    document.addEventListener("pointerdown", () => (this.pointed = true), true);
    document.addEventListener("keydown", () => (this.pointed = false), true);
    for (const kind of ["click", "change"])
      document.addEventListener(kind, ({ target }) => {
        // A list is open after a click on it, until something is chosen.
        if (this.pointed && target.matches?.("button, input, select") && !(kind === "click" && target.matches("select"))) target.blur();
      });
  }

  listenToWindow() {
    new ResizeObserver(() => this.resize()).observe(this.canvas);
    new ResizeObserver(() => this.plots.forEach((plot) => plot.resize())).observe(element("charts"));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.restyle());
  }
}

/** Whether a control that has the focus does something itself with a key. */
function needsKey(control, key) {
  if (control?.matches("select, textarea, input[type=text], input[type=number], input[type=search]")) return key !== "Escape";
  if (control?.matches("input[type=range]")) return /^(Arrow|Home|End|Page)/.test(key);
  return key === " " && Boolean(control?.matches("button, input, summary"));
}

/** Counts the frames drawn in a second, and asks for a less sharp picture where they are few. */
class Pace {
  static least = 35;
  static sharpest = () => Math.min(2, window.devicePixelRatio || 1);

  constructor(changed) {
    this.changed = changed;
    this.sharpness = Pace.sharpest();
    this.since = null;
    this.rate = 0;
  }

  /** A frame has been drawn at `now`, ms. */
  note(now, playing) {
    if (!playing || this.since === null) {
      [this.since, this.drawn] = [playing ? now : null, 0];
      if (!playing) element("rate").textContent = "";
      return;
    }
    this.drawn += 1;
    const span = now - this.since;
    if (span < 500) return;
    this.rate = (1000 * this.drawn) / span;
    [this.since, this.drawn] = [now, 0];
    element("rate").textContent = `${this.rate.toFixed(0)} frames/s`;
    if (this.rate >= Pace.least || this.sharpness <= 0.6) return;
    this.sharpness = Math.max(0.6, 0.8 * this.sharpness);
    this.changed();
  }
}

function start() {
  const header = JSON.parse(element("header").textContent);
  const recording = new Recording(header, element("numbers").textContent.trim());
  const { clock, stage, pace } = new Page(recording);
  // For the browser's console, and for tests.
  window.hamel = {
    recording,
    seek: (time) => clock.seek(time),
    get time() { return clock.time; },
    get playing() { return clock.playing; },
    get framesPerSecond() { return pace.rate; },
    body: (name) => {
      const index = recording.bodies.findIndex((body) => body.name === name);
      return described(recording, stage?.poses ?? recording.posesAt(clock.time), index);
    },
  };
}

start();
