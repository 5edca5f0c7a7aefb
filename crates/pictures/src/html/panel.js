/** What is known of the selected body, at the time shown. */
class Panel {
  constructor(recording, element) {
    this.recording = recording;
    this.element = element;
  }

  /** Shows a body; null for none. */
  choose(body) {
    this.body = body;
    this.element.hidden = body === null;
    if (body === null) return;
    const { name, joint, joint_type: type, parent, mass } = this.recording.bodies[body];
    const on = parent === null ? "the world" : this.recording.bodies[parent].name;
    const heading = document.createElement("h2");
    heading.textContent = name;
    const facts = document.createElement("div");
    facts.textContent = `${shortNumber(mass)} kg · joint ${joint} (${type}) on ${on}`;
    const list = document.createElement("dl");
    this.values = ["centre of mass, m", "quaternion x, y, z, w"].map((term) => {
      const [dt, dd] = [document.createElement("dt"), document.createElement("dd")];
      dt.textContent = term;
      list.append(dt, dd);
      return dd;
    });
    this.element.replaceChildren(heading, facts, list);
  }

  /** Shows where the body is. */
  show(poses) {
    if (this.body === null || this.body === undefined) return;
    const { com, quaternion } = described(this.recording, poses, this.body);
    const text = (vector) => vector.map((part) => part.toFixed(4).replace("-", "−").padStart(9)).join(" ");
    this.values[0].textContent = text(com);
    this.values[1].textContent = text(quaternion);
  }
}

/** Position of a body's centre of mass and its attitude, as the columns of the CSV have them. */
function described(recording, poses, body) {
  const pose = poses[body];
  return { com: point(pose, recording.bodies[body].com), quaternion: scalarLast(pose.q) };
}
