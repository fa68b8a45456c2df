// The live figures: each robot of the page is moved by its own generated functions.
//
// `robots` are these functions, `data` the shapes of the robots (wmrgen/report/pages/live.py). Sliders set a twist, from
// which `inverse` computes the joints, or the joints directly. `forward` computes the driven twist from the joints, and
// `odometry` the pose. Units are metres, radians and seconds; x is forward, y to the left.

const TWIST = { vx: "m/s", vy: "m/s", omega: "rad/s" };
const UNITS = { spin: "rad/s", steer: "°", steer_rate: "rad/s" };
const SLIDING = 1e-6; // m/s: smaller speeds are rounding errors
const SHOWN = 0.4; // s: the arrow of a velocity is the distance covered in this time
const TICKS = 8; // marks on the circumference of a tyre
const PULLED = 0.005; // s: time step of trailers
const GROUND = [9, 6]; // width and height of the visible ground, in sizes of the largest robot

const degrees = (angle) => (angle * 180) / Math.PI;
// A number with some digits; rounded zeros have no sign.
const fixed = (value, digits) => value.toFixed(digits).replace(/^-(0\.?0*)$/, "$1");
const joint = (name) => name.slice(name.lastIndexOf(".") + 1);

// Add an element to `parent`: HTML, or SVG if `svg` is set.
function add(parent, kind, attributes = {}, svg = false) {
  const element = svg ? document.createElementNS("http://www.w3.org/2000/svg", kind) : document.createElement(kind);
  set(element, attributes);
  parent.append(element);
  return element;
}

function set(element, attributes) {
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
}

// The distance from P to the farthest point of a robot; trailers count half.
function reach(robot) {
  const towed = robot.trailers.reduce((sum, t) => sum + t.hitch + t.length, 0);
  return Math.max(0.05, towed / 2, ...robot.wheels.map((w) => Math.hypot(w.x, w.y) + w.r));
}

// The corners of the convex hull of `points`, counter-clockwise (Andrew's monotone chain).
function hull(points) {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const turn = (o, a, b) => (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
  const chain = (corners, p) => {
    while (corners.length > 1 && turn(corners.at(-2), corners.at(-1), p) <= 0) corners.pop();
    return [...corners, p];
  };
  return [...sorted.reduce(chain, []), ...sorted.reverse().reduce(chain, [])];
}

// ---- One wheel in the picture: a group at its pivot, rotated by heading and steering angle.

class WheelPicture {
  constructor(parent, wheel, size) {
    this.wheel = wheel;
    this.width = 0.45 * wheel.r;
    this.group = add(parent, "g", { "data-wheel": wheel.name }, true);
    const { r, d, o } = wheel;
    if (wheel.zero && !wheel.swivels) {
      add(this.group, "line", { class: "axle", x1: d, x2: d, y1: -60 * size, y2: 60 * size }, true);
    }
    if (wheel.ball || !wheel.rolls) {
      const round = { class: "tyre", r: r || 0.06 * size, "fill-opacity": wheel.rolls ? 0.5 : 1 };
      add(this.group, "circle", round, true);
      if (!wheel.rolls) return;
    } else {
      const box = { x: d - r, y: o - this.width / 2, width: 2 * r, height: this.width, rx: 0.15 * r };
      add(this.group, "rect", { class: "tyre", ...box }, true);
    }
    this.treads = Array.from({ length: TICKS }, () => add(this.group, "line", { class: "tread" }, true));
    if (d || o) add(this.group, "path", { class: "arm", fill: "none", d: `M0 0L${d} 0L${d} ${o}` }, true);
    this.sliding = add(this.group, "line", { class: "slipping", x1: d, y1: o, x2: d, y2: o }, true);
  }

  // `turned`: rolled angle. `across`: velocity of the contact point along the axle.
  draw(steer, turned, across) {
    const { x, y, heading, r, d, o, gamma } = this.wheel;
    set(this.group, { transform: `translate(${x} ${y}) rotate(${degrees(heading + steer)})` });
    if (!this.wheel.rolls) return;
    // The visible rollers are on top and lean the other way than the rollers at the ground.
    const [along, aside] = gamma === null ? [0, 1] : [Math.cos(gamma), -Math.sin(gamma)];
    const half = (0.5 * this.width) / Math.max(0.6, Math.abs(aside));
    this.treads.forEach((tread, k) => {
      const angle = turned + (2 * Math.PI * k) / TICKS;
      const at = d + r * Math.sin(angle);
      const ends = { x1: at - half * along, x2: at + half * along, y1: o - half * aside, y2: o + half * aside };
      set(tread, { ...ends, visibility: Math.cos(angle) > 0.1 ? "visible" : "hidden" });
    });
    set(this.sliding, { y2: o + SHOWN * across });
  }
}

// ---- One trailer: a group at the middle of its axle, rotated by its heading.

class TrailerPicture {
  constructor(parent, trailer, half) {
    this.trailer = trailer;
    this.hitch = add(parent, "line", { class: "bar" }, true);
    this.group = add(parent, "g", { class: "trailer", "data-trailer": trailer.name }, true);
    add(this.group, "path", { class: "bar", fill: "none", d: `M${trailer.length} 0L0 0M0 ${-half}L0 ${half}` }, true);
    const box = { x: -0.3 * half, width: 0.6 * half, height: 0.2 * half, rx: 0.05 * half };
    for (const side of [-1, 1]) add(this.group, "rect", { class: "tyre", ...box, y: side * half - 0.1 * half }, true);
  }

  // `front`: the axle that pulls it, (x, y, heading) in the world. Returns the axle of the trailer.
  draw(front, heading) {
    const behind = ([x, y, angle], way) => [x - way * Math.cos(angle), y - way * Math.sin(angle)];
    const [x, y] = behind(front, this.trailer.hitch);
    set(this.hitch, { x1: front[0], y1: front[1], x2: x, y2: y });
    const axle = behind([x, y, heading], this.trailer.length);
    set(this.group, { transform: `translate(${axle.join(" ")}) rotate(${degrees(heading)})` });
    return [...axle, heading];
  }
}

// ---- One robot: its command, its motion, its picture and its controls.

class Live {
  constructor(parent, robot, functions, size) {
    Object.assign(this, { robot, functions, size });
    this.mates = [this]; // what is asked of one is asked of all
    this.build(parent);
    this.reset();
  }

  // The speed along a path.
  get cruise() {
    return Math.min(0.5 * this.range("vx")[1], 2 * this.size);
  }

  // The ends of a slider: the limits of the robot file, else values that suit the size of the robot.
  range(name) {
    if (this.robot.limits[name]) return this.robot.limits[name];
    const speed = Math.min(2, 3 * this.size);
    const wheel = this.robot.wheels.find((w) => name.startsWith(`${w.name}.`));
    const fastest = this.robot.limits.vx?.[1] ?? speed;
    const spin = (1.5 * fastest) / (wheel?.r || 1);
    const most = { vx: speed, vy: speed, omega: 2, spin, steer: Math.PI, steer_rate: 4 };
    return [-most[joint(name)], most[joint(name)]];
  }

  reset() {
    const { pose, angles } = this.robot.drive ?? { pose: [0, 0, 0], angles: {} };
    const [x, y, theta] = pose;
    this.pose = { x, y, theta };
    this.joints = {};
    for (const wheel of this.robot.wheels) {
      if (wheel.turns) this.joints[`${wheel.name}.steer`] = angles[`${wheel.name}.steer`] ?? 0;
    }
    for (const name of this.robot.joints) this.joints[name] ??= 0;
    this.turned = Object.fromEntries(this.robot.wheels.map((w) => [w.name, 0]));
    const behind = theta + this.robot.axle.heading;
    this.headings = Object.fromEntries(
      this.robot.trailers.map((t) => [`${t.name}.theta`, angles[`${t.name}.theta`] ?? behind]),
    );
    this.trail = [];
    this.camera = [x, y];
    this.stop();
  }

  stop() {
    this.release();
    this.ask({ vx: 0, vy: 0, omega: 0 });
  }

  // Follow no path and play no drive.
  release() {
    this.path = [];
    this.follows = false;
    this.played = [];
  }

  // Play the recorded drive from its start: a list of [seconds, vx, vy, omega].
  play() {
    this.reset();
    this.played = (this.robot.drive?.segments ?? []).map((segment) => [...segment]);
  }

  // Command a twist.
  ask(twist) {
    this.asked = { ...twist };
    this.byTwist = true;
    this.compute();
  }

  // Command one joint; the others keep their values.
  askJoint(name, value) {
    this.release();
    this.byTwist = false;
    this.joints[name] = value;
    this.compute();
  }

  // Compute the joints from the command, and the driven twist from the joints.
  compute() {
    const { inverse, forward } = this.functions;
    if (this.byTwist) {
      const { slip, ...commands } = inverse({ ...this.joints, ...this.asked });
      Object.assign(this.joints, commands);
      this.slip = slip;
    }
    const { slip, ...twist } = forward(this.joints);
    // A command without slip is driven even if the joints do not determine the twist: somebody pushes.
    this.twist = this.byTwist && !(this.slip > SLIDING) ? this.asked : twist;
    if (!this.byTwist) {
      this.slip = slip;
      const others = Object.entries(inverse({ ...this.joints, ...twist }));
      const free = others.filter(([name]) => name !== "slip" && !this.robot.joints.includes(name));
      Object.assign(this.joints, Object.fromEntries(free));
      this.asked = { ...twist };
    }
  }

  // Move for `dt` seconds. A recorded drive is played exactly: its segments end between two frames.
  step(dt) {
    if (!this.played.length) {
      this.advance(dt);
      return;
    }
    for (let left = dt; left > 0 && this.played.length; ) {
      const [seconds, vx, vy, omega] = this.played[0];
      const part = Math.min(left, seconds);
      this.ask({ vx, vy, omega });
      this.advance(part);
      this.played[0][0] -= part;
      left -= part;
      if (this.played[0][0] < 1e-9) this.played.shift(); // s: rounding
    }
    if (!this.played.length) this.stop();
  }

  advance(dt) {
    if (this.follows) this.pursue();
    else this.compute();
    this.tow(dt);
    this.pose = this.functions.odometry({ ...this.pose, ...this.twist, dt });
    for (const { name, swivels } of this.robot.wheels) {
      this.turned[name] += (this.joints[`${name}.spin`] ?? 0) * dt;
      if (swivels) this.joints[`${name}.steer`] += (this.joints[`${name}.steer_rate`] ?? 0) * dt;
    }
    const last = this.trail.at(-1);
    if (!last || Math.hypot(this.pose.x - last[0], this.pose.y - last[1]) > 0.05 * this.size) {
      this.trail = [...this.trail.slice(-2000), [this.pose.x, this.pose.y]];
    }
  }

  // Let the trailers follow for `dt` seconds, from the present pose.
  tow(dt) {
    if (!this.robot.trailers.length) return;
    const steps = Math.ceil(dt / PULLED);
    for (let k = 0; k < steps; k++) {
      const theta = this.pose.theta + (this.twist.omega * k * dt) / steps;
      const rates = this.functions.towed({ ...this.twist, theta, ...this.headings });
      for (const name of Object.keys(this.headings)) this.headings[name] += (rates[`${name}_rate`] * dt) / steps;
    }
  }

  // The twist towards the first point of the path that is further away than the look-ahead (pure pursuit).
  pursue() {
    const { x, y, theta } = this.pose;
    const away = (p) => Math.hypot(p[0] - x, p[1] - y);
    while (this.path.length > 1 && away(this.path[0]) < 1.5 * this.size) this.path.shift();
    const distance = away(this.path[0]);
    if (distance < 0.25 * this.size) {
      this.stop();
      return;
    }
    const [dx, dy] = [this.path[0][0] - x, this.path[0][1] - y];
    const ahead = (Math.cos(theta) * dx + Math.sin(theta) * dy) / distance;
    const left = (Math.cos(theta) * dy - Math.sin(theta) * dx) / distance;
    const speed = this.cruise * Math.min(1, distance / this.size);
    if (this.robot.omnidirectional) {
      this.ask({ vx: speed * ahead, vy: speed * left, omega: 0 });
      return;
    }
    const curvature = (2 * (ahead > 0 ? left : Math.sign(left) || 1)) / distance;
    const most = this.range("omega")[1] / Math.max(1e-9, Math.abs(curvature));
    const vx = Math.min(speed, most);
    this.ask({ vx, vy: 0, omega: curvature * vx });
  }

  get moves() {
    return this.follows || this.played.length > 0 || Object.values(this.twist).some((v) => Math.abs(v) > 1e-9);
  }

  // The ICR in the robot frame; null if the robot stands still or drives straight ahead.
  get icr() {
    const { vx, vy, omega } = this.twist;
    return Math.abs(omega) > 1e-6 * (1 + Math.hypot(vx, vy) / this.size) ? [-vy / omega, vx / omega] : null;
  }

  // ---- The picture.

  build(parent) {
    const root = add(parent, "section", { class: "robot", "aria-label": `${this.robot.name}, to drive` });
    add(root, "h2").textContent = this.robot.name;
    this.picture = add(root, "svg", { role: "img", "aria-label": "Top view: draw a path" }, true);
    const up = add(this.picture, "g", { transform: "scale(1,-1)" }, true);
    this.grid = add(up, "path", { class: "grid" }, true);
    this.trailLine = add(up, "polyline", { class: "trail" }, true);
    this.pathLine = add(up, "polyline", { class: "path" }, true);
    const half = Math.max(0.1 * this.size, ...this.robot.wheels.map((w) => Math.abs(w.y)));
    this.trailers = this.robot.trailers.map((trailer) => new TrailerPicture(up, trailer, half));
    this.body = add(up, "g", { class: "chassis" }, true);
    const corners = hull(this.robot.wheels.map((w) => [w.x, w.y]));
    add(this.body, "polygon", { class: "body", points: corners.join(" ") }, true);
    const s = 0.12 * this.size;
    add(this.body, "path", { class: "ahead", d: `M0 ${-s}L${1.6 * s} 0L0 ${s}` }, true);
    this.wheels = this.robot.wheels.map((wheel) => new WheelPicture(this.body, wheel, this.size));
    this.centre = add(this.body, "circle", { class: "icr", r: 0.07 * this.size }, true);
    this.state = add(root, "p", { class: "state", "aria-live": "off" });
    const buttons = add(root, "div", { class: "buttons" });
    const works = [["Stop", (m) => m.stop()], ["Start again", (m) => m.reset()]];
    if (this.robot.drive) works.unshift(["Play the drive", (m) => m.play()]);
    for (const [name, work] of works) {
      const button = add(buttons, "button", { type: "button" });
      button.textContent = name;
      button.addEventListener("click", () => this.each(work));
    }
    add(buttons, "span").textContent = "Move a slider, or draw a path in the picture.";
    const controls = add(root, "div", { class: "controls" });
    this.sliders = [
      ...Object.entries(TWIST).map(([name, unit]) => this.slider(controls, name, unit, "twist")),
      ...this.robot.joints.map((name) => this.slider(controls, name, UNITS[joint(name)], "joint")),
    ];
    this.drawable();
  }

  // Apply a function to this robot and to the robots next to it.
  each(work) {
    for (const mate of this.mates) {
      work(mate);
      mate.draw();
    }
  }

  slider(parent, name, unit, kind) {
    const label = add(parent, "label", { class: kind });
    add(label, "span", { class: "name", title: name }).textContent = name.replace(".", ".\u200b"); // may break there
    const [min, max] = this.range(name);
    const input = add(label, "input", { type: "range", name, min, max, step: (max - min) / 400, "aria-label": name });
    const output = add(label, "output", { "data-name": name });
    input.addEventListener("input", () => {
      const value = Math.abs(input.valueAsNumber) < (max - min) / 300 ? 0 : input.valueAsNumber;
      if (kind === "twist") this.each((m) => (m.release(), m.ask({ ...m.asked, [name]: value })));
      else {
        this.askJoint(name, value);
        this.draw();
      }
    });
    return { name, unit, kind, input, output };
  }

  // A path drawn with the pointer is followed when the pointer is lifted.
  drawable() {
    let drawing = false;
    const place = (event) => {
      const p = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.picture.getScreenCTM().inverse());
      return [p.x, -p.y];
    };
    const draw = (event) => this.each((m) => m.path.push(place(event)));
    this.picture.addEventListener("pointerdown", (event) => {
      drawing = true;
      if (event.isTrusted) this.picture.setPointerCapture(event.pointerId);
      this.each((m) => m.stop());
      draw(event);
    });
    this.picture.addEventListener("pointermove", (event) => drawing && draw(event));
    this.picture.addEventListener("pointerup", () => {
      drawing = false;
      this.each((m) => (m.follows = m.path.length > 0));
    });
  }

  draw() {
    const { x, y, theta } = this.pose;
    this.look();
    set(this.body, { transform: `translate(${x} ${y}) rotate(${degrees(theta)})` });
    const axle = this.robot.axle;
    const [c, s] = [Math.cos(theta), Math.sin(theta)];
    this.trailers.reduce(
      (front, picture) => picture.draw(front, this.headings[`${picture.trailer.name}.theta`]),
      [x + c * axle.x - s * axle.y, y + s * axle.x + c * axle.y, theta + axle.heading],
    );
    for (const picture of this.wheels) {
      const { name } = picture.wheel;
      const steer = this.joints[`${name}.steer`] ?? 0;
      picture.draw(steer, this.turned[name], this.across(picture.wheel, steer));
    }
    const icr = this.icr;
    set(this.centre, { visibility: icr ? "visible" : "hidden", cx: icr?.[0] ?? 0, cy: icr?.[1] ?? 0 });
    set(this.trailLine, { points: this.trail.join(" ") });
    set(this.pathLine, { points: this.path.join(" ") });
    for (const { name, unit, kind, input, output } of this.sliders) {
      const value = (kind === "twist" ? this.asked : this.joints)[name];
      input.value = value;
      output.textContent = `${unit === "°" ? fixed(degrees(value), 1) : fixed(value, 3)} ${unit}`;
    }
    this.tell();
  }

  // The velocity along the axle of the contact point of a wheel that must not slide.
  across(wheel, steer) {
    if (!wheel.zero || wheel.swivels || !(this.slip > SLIDING)) return 0;
    const [c, s] = [Math.cos(wheel.heading + steer), Math.sin(wheel.heading + steer)];
    const [x, y] = [wheel.x + wheel.d * c - wheel.o * s, wheel.y + wheel.d * s + wheel.o * c];
    const { vx, vy, omega } = this.asked;
    return c * (vy + omega * x) - s * (vx - omega * y);
  }

  // The ground does not move until the robot is near its edge.
  look() {
    const [width, height] = GROUND.map((n) => n * this.size);
    const at = [this.pose.x, this.pose.y];
    this.camera = this.camera.map((c, k) => {
      const room = [width, height][k] / 2 - 1.6 * this.size;
      return Math.min(Math.max(c, at[k] - room), at[k] + room);
    });
    const [x, y] = this.camera;
    set(this.picture, { viewBox: [x - width / 2, -y - height / 2, width, height].join(" ") });
    const power = 10 ** Math.floor(Math.log10(width / 5));
    this.square = [1, 2, 5].map((n) => n * power).findLast((n) => n <= width / 5);
    const lines = [];
    for (let k = Math.ceil((x - width / 2) / this.square); k * this.square < x + width / 2; k++) {
      lines.push(`M${k * this.square} ${y - height / 2}v${height}`);
    }
    for (let k = Math.ceil((y - height / 2) / this.square); k * this.square < y + height / 2; k++) {
      lines.push(`M${x - width / 2} ${k * this.square}h${width}`);
    }
    set(this.grid, { d: lines.join("") });
  }

  tell() {
    const { vx, vy, omega } = this.twist;
    const icr = this.icr?.map((v) => fixed(v, 2)).join(", ");
    const slides = this.slip > SLIDING;
    this.state.classList.toggle("slips", slides);
    const slip = `slip ${this.slip.toFixed(3)} m/s. `;
    const why = !slides ? "" : this.byTwist
      ? `The wheels cannot follow this command completely: ${slip}`
      : `The speeds of the wheels do not agree: ${slip}`;
    this.state.textContent =
      `${why}It drives vx ${fixed(vx, 3)} m/s, vy ${fixed(vy, 3)} m/s, ω ${fixed(omega, 3)} rad/s` +
      `${icr ? ` about the ICR (${icr}) m` : ""}. One square is ${+this.square.toPrecision(1)} m.`;
  }
}

// ---- All robots of the page, in step.

const parent = document.getElementById("live");
if (parent) {
  const size = Math.max(...data.map(reach));
  const lives = data.map((robot, k) => new Live(parent, robot, robots[k], size));
  for (const live of lives) {
    live.mates = lives;
    live.play();
    live.draw();
  }
  parent.lives = lives; // for the console
  let last = performance.now();
  const frame = (now) => {
    const dt = Math.min(0.05, (now - last) / 1000);
    last = now;
    for (const live of lives.filter((l) => l.moves)) {
      live.step(dt);
      live.draw();
    }
    requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
}
