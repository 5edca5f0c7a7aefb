/** The time shown, and how it runs. */
class Clock {
  constructor(duration, changed) {
    this.duration = duration;
    this.changed = changed;
    this.time = 0;
    this.speed = 1;
    this.loops = true;
    this.playing = false;
    this.last = null;
  }

  /** Goes to a time. */
  seek(time) {
    this.time = Math.min(this.duration, Math.max(0, time));
    this.changed();
  }

  toggle() {
    if (!this.playing && this.time >= this.duration) this.time = 0;
    this.playing = !this.playing && this.duration > 0;
    this.last = null;
    this.changed();
  }

  /** Lets the time run until `now`, ms. */
  tick(now) {
    if (!this.playing) return;
    if (this.last !== null) this.time += ((now - this.last) / 1000) * this.speed;
    this.last = now;
    if (this.time <= this.duration) return;
    if (this.loops) this.time %= this.duration;
    else {
      this.time = this.duration;
      this.playing = false;
    }
  }
}
