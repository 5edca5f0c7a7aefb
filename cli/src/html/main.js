/** Puts the parts together. */
function start() {
  const element = (id) => document.getElementById(id);
  const recording = new Recording(JSON.parse(element("header").textContent), element("numbers").textContent.trim());
  element("name").textContent = recording.name;
  element("description").textContent = recording.description;
  element("facts").textContent = `${recording.method} · ${recording.frames} frames`;

  const canvas = element("stage");
  let stage = null;
  try {
    if (recording.frames === 0) throw new Error("the simulation stopped before its first sample");
    stage = new Stage(recording, new Painter(canvas));
  } catch (error) {
    element("refusal").hidden = false;
    element("refusal").textContent = `The motion cannot be drawn: ${error.message}. Plots do not need it.`;
    for (const id of ["stage", "tools"]) element(id).hidden = true;
  }
  const panel = new Panel(recording, element("selected"));
  const clock = new Clock(recording.duration, invalidate);
  const scrub = (time) => clock.seek(time);
  const plots = recording.charts.map((chart) => new Plot(recording, chart, scrub));
  element("charts").append(...plots.map((plot) => plot.element));
  panel.choose(null);

  const labels = recording.bodies.map((body) => {
    const label = document.createElement("span");
    label.textContent = body.name;
    return label;
  });

  let scheduled = false;
  function invalidate() {
    if (!scheduled) requestAnimationFrame(frame);
    scheduled = true;
  }

  /** Pixels of the picture to one of the page; while it plays fewer where drawing is slow. */
  const sharpest = Math.min(2, window.devicePixelRatio || 1);
  let sharpness = sharpest;
  let drawnPlaying = false;
  const pace = { since: null, drawn: 0, rate: 0 };

  function frame(now) {
    scheduled = false;
    clock.tick(now);
    if (clock.playing !== drawnPlaying) resize();
    draw();
    if (!clock.playing) {
      pace.since = null;
      element("rate").textContent = "";
      return;
    }
    measure(now);
    invalidate();
  }

  function measure(now) {
    pace.since ??= now;
    pace.drawn += 1;
    const span = now - pace.since;
    if (span < 500) return;
    pace.rate = ((pace.drawn - 1) / span) * 1000;
    [pace.since, pace.drawn] = [now, 1];
    element("rate").textContent = `${pace.rate.toFixed(0)} frames/s`;
    if (pace.rate < 35 && sharpness > 0.6) {
      sharpness = Math.max(0.6, 0.8 * sharpness);
      resize();
    }
  }

  function draw() {
    const { time, duration } = clock;
    if (stage) {
      stage.draw(time);
      panel.show(stage.poses);
      if (element("names").checked) placeLabels();
    }
    for (const plot of plots) plot.show(time);
    element("scrub").value = duration ? time / duration : 0;
    element("time").textContent = `${time.toFixed(3)} / ${duration.toFixed(3)} s`;
    element("play").textContent = clock.playing ? "Pause" : "Play";
  }

  function placeLabels() {
    const { clientWidth: width, clientHeight: height } = canvas;
    recording.bodies.forEach((body, index) => {
      const place = stage.camera.project(point(stage.poses[index], body.com));
      labels[index].hidden = !place;
      if (place) labels[index].style.transform = `translate(${place[0] * width}px, ${place[1] * height}px)`;
    });
  }

  function resize() {
    drawnPlaying = clock.playing;
    const pixels = drawnPlaying ? sharpness : sharpest;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((size) => Math.max(1, Math.round(size * pixels)));
    // Setting a size clears the picture, even the same size.
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    invalidate();
  }

  function select(body) {
    stage.selected = body;
    panel.choose(body);
    if (body !== null) for (const plot of plots) plot.chooseBody(body);
    invalidate();
  }

  function restyle() {
    stage?.readColors();
    for (const plot of plots) plot.resize();
    invalidate();
  }

  element("play").addEventListener("click", () => clock.toggle());
  element("scrub").addEventListener("input", (event) => clock.seek(event.target.value * recording.duration));
  element("speed").addEventListener("change", (event) => (clock.speed = Number(event.target.value)));
  element("loop").addEventListener("change", (event) => (clock.loops = event.target.checked));
  element("names").addEventListener("change", (event) => {
    element("labels").replaceChildren(...(event.target.checked ? labels : []));
    invalidate();
  });
  const goHome = () => {
    stage?.home();
    invalidate();
  };
  element("home").addEventListener("click", goHome);
  if (stage) {
    for (const option of ["rods", "frames", "trails", "ground", "follow"]) {
      element(option).checked = stage.options[option];
      element(option).addEventListener("change", (event) => {
        stage.options[option] = event.target.checked;
        invalidate();
      });
    }
    element("solids").addEventListener("change", (event) => {
      stage.options.solids = event.target.value;
      invalidate();
    });
    if (recording.shapes.length === 0) {
      element("solids").options[0].remove();
      stage.options.solids = "ellipsoid";
    }
    stage.camera.listen(canvas, invalidate, (place) => select(stage.pick(place)));
  }

  const step = (by) => {
    clock.playing = false;
    const target = recording.nearest(clock.time) + by;
    clock.seek(recording.times[Math.min(recording.frames - 1, Math.max(0, target))]);
  };
  const keys = {
    " ": () => clock.toggle(),
    ArrowLeft: () => step(-1),
    ArrowRight: () => step(1),
    Home: () => clock.seek(0),
    End: () => clock.seek(recording.duration),
    r: goHome,
    Escape: () => stage && select(null),
  };
  document.addEventListener("keydown", (event) => {
    const key = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    const own = event.target.closest("select, input, button");
    const taken = own?.matches("select, input[type=range]") ? /^( |Arrow|Home|End)/ : /^ /;
    if (!key || event.ctrlKey || event.metaKey || event.altKey || (own && taken.test(event.key))) return;
    event.preventDefault();
    key();
  });
  new ResizeObserver(resize).observe(canvas);
  new ResizeObserver(() => plots.forEach((plot) => plot.resize())).observe(element("charts"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", restyle);
  restyle();
  resize();

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
