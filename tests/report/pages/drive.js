// What the pictures of all robots of the page show when their sliders are moved.
const shown = (live) => ({
  body: live.body.getAttribute("transform"),
  wheels: Object.fromEntries(live.wheels.map((w) => [w.wheel.name, w.group.getAttribute("transform")])),
  trailers: Object.fromEntries(live.trailers.map((t) => [t.trailer.name, t.group.getAttribute("transform")])),
  icr: [live.centre.getAttribute("cx"), live.centre.getAttribute("cy"), live.centre.getAttribute("visibility")],
  values: Object.fromEntries(live.sliders.map((s) => [s.name, [s.input.valueAsNumber, ...["step", "min", "max"].map((a) => Number(s.input[a]))]])),
  outputs: Object.fromEntries(live.sliders.map((s) => [s.name, s.output.textContent])),
  asked: { ...live.asked },
  driven: { ...live.twist },
  joints: { ...live.joints },
  slip: live.slip,
  told: live.state.textContent,
});
const move = (live, part, kind) => {
  live.sliders.filter((s) => s.kind === kind).forEach((s, k) => {
    const [min, max] = [Number(s.input.min), Number(s.input.max)];
    const f = part(k);
    s.input.value = f >= 0 ? f * max : -f * min;
    s.input.dispatchEvent(new Event("input"));
  });
};
const parts = {
  ahead: [(k) => (k === 0 ? 0.4 : 0), "twist"],
  turning: [(k) => [0.3, 0, 0.25][k], "twist"],
  all: [(k) => [0.3, -0.35, 0.4][k], "twist"],
  joints: [(k) => [0.2, 0.35, -0.15, 0.3][k % 4], "joint"],
};
const results = {};
for (const live of document.getElementById("live").lives) {
  live.mates = [live];
  results[live.robot.name] = {};
  for (const [name, [part, kind]] of Object.entries(parts)) {
    live.reset();
    live.draw();
    move(live, part, kind);
    const before = shown(live);
    live.step(0.5);
    live.draw();
    results[live.robot.name][name] = [before, shown(live)];
  }
  // What its digits make 0 has no sign.
  live.ask({ vx: -1e-9, vy: -0, omega: -1e-9 });
  live.draw();
  results[live.robot.name].small = [live.state.textContent, ...live.sliders.map((s) => s.output.textContent)];
  // A path ahead and to the left is followed to its end, by a robot that can.
  live.reset();
  live.size = Math.max(...live.robot.wheels.map((w) => 0.1 + Math.hypot(w.x, w.y)));
  live.draw();
  const pointer = (kind, k) => {
    const at = new DOMPoint(k * 0.4 * live.size, -0.03 * k * k * live.size).matrixTransform(live.picture.getScreenCTM());
    live.picture.dispatchEvent(new PointerEvent(`pointer${kind}`, { clientX: at.x, clientY: at.y, pointerId: 1 }));
  };
  pointer("down", 0);
  for (let k = 1; k <= 20; k++) pointer("move", k);
  pointer("up", 20);
  const end = live.path.at(-1);
  let steps = 0;
  for (; steps < 4000 && live.follows; steps++) live.step(0.02);
  const { x, y } = live.pose;
  results[live.robot.name].path = { arrives: !live.follows, off: Math.hypot(x - end[0], y - end[1]) / live.size, steps };
  live.reset();
}
return results;
