/** Ticks of an axis from `low` to `high`, about `count` of them, at 1, 2 or 5 times a power of ten. */
function ticks(low, high, count) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = ([1, 2, 5, 10].find((factor) => factor * power >= rough * 0.999) ?? 10) * power;
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: Math.max(0, last - first + 1) }, (_, k) => (first + k) * step);
}

/** Ticks of a logarithmic axis between two powers of ten: whole powers, and where these are few, 2 and 5 times them. */
function powers(low, high) {
  const factors = high - low > 3 ? [1] : high - low > 1.2 ? [1, 3] : [1, 2, 5];
  const found = [];
  for (let power = Math.floor(low); power <= high; power++)
    for (const factor of factors) found.push(power + Math.log10(factor));
  return found.filter((value) => value >= low && value <= high);
}

/** A number for people: three or four digits. */
function shortNumber(number, digits = 4) {
  if (!Number.isFinite(number)) return "–";
  const size = Math.abs(number);
  const plain = number === 0 || (size < 1e5 && size >= 1e-3);
  const rounded = Number(number.toPrecision(plain ? digits : Math.min(3, digits)));
  return (plain ? String(rounded) : rounded.toExponential().replace("e+", "e")).replace(/^-/, "−");
}

/** A plot of columns over the time; its pointer sets the time. */
class Plot {
  static margin = { left: 50, right: 8, top: 6, bottom: 16 };

  constructor(recording, chart, scrub) {
    this.recording = recording;
    this.chart = chart;
    this.time = 0;
    this.element = document.createElement("section");
    this.element.className = "chart";
    this.element.innerHTML = `<div class="head"><h2></h2><span class="unit"></span></div>
      <div class="plot"><canvas></canvas><div class="cursor"></div></div><div class="legend"></div>`;
    this.find = (selector) => this.element.querySelector(selector);
    this.find("h2").textContent = chart.title;
    this.canvas = this.find("canvas");
    this.cursor = this.find(".cursor");
    if (chart.variants.length > 1) this.addSelect();
    this.choose(0);
    this.listen(scrub);
  }

  addSelect() {
    this.select = document.createElement("select");
    this.select.setAttribute("aria-label", this.chart.title);
    this.chart.variants.forEach((variant, index) => this.select.add(new Option(variant.name, index)));
    this.select.addEventListener("change", () => {
      this.choose(Number(this.select.value));
      this.draw();
      this.tell();
    });
    this.find(".head").append(this.select);
  }

  /** Shows one of the variants. */
  choose(index) {
    this.variant = this.chart.variants[index];
    if (this.select) this.select.value = index;
    this.find(".unit").textContent = this.variant.unit;
    const legend = this.find(".legend");
    legend.replaceChildren();
    this.values = this.variant.columns.map((column, k) => {
      const entry = document.createElement("span");
      const mark = document.createElement("i");
      mark.style.background = `var(--line-${(k % 6) + 1})`;
      const value = document.createElement("b");
      const name = this.variant.columns.length > 1 ? `${column.name} ` : "";
      entry.append(mark, name, value);
      legend.append(entry);
      return value;
    });
  }

  /** Shows the variant about a body, if there is one. */
  chooseBody(body) {
    const index = this.chart.variants.findIndex((variant) => variant.body === body);
    if (index < 0) return;
    this.choose(index);
    this.draw();
    this.tell();
  }

  listen(scrub) {
    const plot = this.find(".plot");
    const timeAt = (event) => {
      const { left, width } = plot.getBoundingClientRect();
      const { left: before, right: after } = Plot.margin;
      const part = (event.clientX - left - before) / (width - before - after);
      return Math.min(1, Math.max(0, part)) * this.recording.duration;
    };
    plot.addEventListener("pointerdown", (event) => {
      plot.setPointerCapture(event.pointerId);
      scrub(timeAt(event));
    });
    plot.addEventListener("pointermove", (event) => event.buttons && scrub(timeAt(event)));
  }

  /** Least and greatest of what is shown, as the axis has it. */
  range() {
    let [low, high] = [Infinity, -Infinity];
    for (const { index } of this.variant.columns)
      for (const number of this.recording.columns[index]) {
        const value = this.onAxis(number);
        if (value < low) low = value;
        if (value > high) high = value;
      }
    if (!Number.isFinite(low) || !Number.isFinite(high)) return [0, 1];
    // Rounding must not fill the plot.
    const least = this.chart.log ? 0.5 : Math.max(Math.abs(low), Math.abs(high)) * 1e-6 || 1e-9;
    if (high - low < least) [low, high] = [(low + high) / 2 - least, (low + high) / 2 + least];
    const room = 0.06 * (high - low);
    return [low - room, high + room];
  }

  /** Where a number stands on the axis; NaN and −∞ stand nowhere. */
  onAxis(number) {
    return this.chart.log ? (number > 0 ? Math.log10(number) : NaN) : number;
  }

  /** Draws axes and lines. */
  draw() {
    const { canvas, recording } = this;
    const ratio = window.devicePixelRatio || 1;
    const { clientWidth: width, clientHeight: height } = canvas;
    if (!width) return;
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    const context = canvas.getContext("2d");
    context.scale(ratio, ratio);
    const style = getComputedStyle(document.documentElement);
    const color = (name) => style.getPropertyValue(name).trim();
    const { left, right, top, bottom } = Plot.margin;
    const [low, high] = this.range();
    const x = (time) => left + ((width - left - right) * time) / (recording.duration || 1);
    const y = (value) => height - bottom - ((height - top - bottom) * (value - low)) / (high - low);
    context.font = "10px system-ui, sans-serif";
    context.lineWidth = 1;
    context.strokeStyle = color("--edge");
    context.fillStyle = color("--muted");
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const value of this.chart.log ? powers(low, high) : ticks(low, high, 4)) {
      context.beginPath();
      context.moveTo(left, y(value));
      context.lineTo(width - right, y(value));
      context.stroke();
      const label = this.chart.log ? shortNumber(10 ** value, 2) : shortNumber(value, 5);
      context.fillText(label, left - 5, y(value));
    }
    context.textAlign = "center";
    context.textBaseline = "alphabetic";
    for (const time of ticks(0, recording.duration || 1, 5))
      if (x(time) < width - 22) context.fillText(shortNumber(time), x(time), height - 4);
    context.textAlign = "right";
    context.fillText("s", width - right, height - 4);
    context.save();
    context.beginPath();
    context.rect(left, 0, width - left - right, height - bottom + 1);
    context.clip();
    context.lineWidth = 1.5;
    context.lineJoin = "round";
    this.variant.columns.forEach(({ index }, k) => {
      context.strokeStyle = color(`--line-${(k % 6) + 1}`);
      this.line(context, recording.columns[index], x, y);
    });
    context.restore();
  }

  /** One column as a line, which gaps break. */
  line(context, column, x, y) {
    context.beginPath();
    let down = false;
    column.forEach((number, frame) => {
      const value = this.onAxis(number);
      if (Number.isFinite(value)) {
        const place = [x(this.recording.times[frame]), y(value)];
        if (down) context.lineTo(...place);
        else context.moveTo(...place);
      }
      down = Number.isFinite(value);
    });
    context.stroke();
  }

  /** Moves the cursor to a time. */
  show(time) {
    this.time = time;
    const { left, right } = Plot.margin;
    const part = this.recording.duration ? time / this.recording.duration : 0;
    this.width ??= this.canvas.clientWidth;
    this.cursor.style.transform = `translateX(${left + part * (this.width - left - right)}px)`;
  }

  /** Shows the numbers at the time of the cursor. */
  tell() {
    const frame = this.recording.nearest(this.time);
    this.variant.columns.forEach(({ index }, k) => {
      const text = shortNumber(this.recording.columns[index][frame]);
      if (this.values[k].textContent !== text) this.values[k].textContent = text;
    });
  }

  /** Fits the plot to a new size. */
  resize() {
    this.width = this.canvas.clientWidth;
    this.draw();
  }
}
