"use strict";
// Turns the network in space under the mouse, a finger or the arrow keys. Lengths are in metres, x and y level, z upwards.
{
  const figure = document.getElementById("turn"), svg = figure.querySelector("svg");
  const { receivers, transmitters } = JSON.parse(document.getElementById("network").textContent);
  const of = (kind) => (node) => ({ ...node, kind });
  const nodes = [...receivers.map(of("receiver")), ...transmitters.map(of("transmitter"))];
  const { width, height } = svg.viewBox.baseVal;
  const level = [0, 1, 2], names = ["x", "y", "z"];

  // A box about all points, from one multiple of the step to another, with ellipsoids that are not larger than the network.
  const points = nodes.flatMap((node) => (node.truth ? [node.at, node.truth] : [node.at]));
  const ranges = level.map((k) => {
    const values = points.map((p) => p[k]);
    return values.length ? [values.reduce((a, b) => Math.min(a, b)), values.reduce((a, b) => Math.max(a, b))] : [0, 0];
  });
  const largest = Math.max(...ranges.map(([low, high]) => high - low)) / 2;
  for (const { at, ellipsoid } of nodes) {
    const reach = level.map((k) => (ellipsoid ? Math.sqrt(ellipsoid[k][k]) : 0));
    if (Math.max(...reach) > largest) continue;
    ranges.forEach((range, k) => {
      range[0] = Math.min(range[0], at[k] - reach[k]);
      range[1] = Math.max(range[1], at[k] + reach[k]);
    });
  }
  const step = nice(Math.max(...ranges.map(([low, high]) => high - low)) / 8 || 1);
  const box = ranges.map(([low, high]) => {
    const first = Math.floor(low / step);
    return [first, Math.max(Math.ceil(high / step), first + 1)].map((count) => count * step);
  });
  const centre = box.map(([low, high]) => (low + high) / 2);
  // From every side, the box stays in the picture, with room for numbers.
  const scale = (height - 90) / Math.hypot(...box.map(([low, high]) => high - low));

  const START = { around: -0.5, above: 0.4 };
  const VIEWS = {
    "from above": { around: 0, above: Math.PI / 2 },
    "from the front": { around: 0, above: 0 },
    "from the side": { around: Math.PI / 2, above: 0 },
    "slanted": START,
  };
  let from = { ...START }, hovered = null, waiting = false;

  /** The largest of 1, 2, 5 times a power of ten that is at most this. */
  function nice(length) {
    const power = 10 ** Math.floor(Math.log10(length));
    return ([5, 2, 1].find((digit) => digit * power <= length) ?? 1) * power;
  }

  /** The directions to the right, upwards and to the viewer; from above, x is to the right and y upwards. */
  function directions() {
    const [c, s, h, v] = [Math.cos(from.around), Math.sin(from.around), Math.cos(from.above), Math.sin(from.above)];
    return [[c, s, 0], [-s * v, c * v, h], [s * h, -c * h, v]];
  }

  let sides = directions();

  /** Where a point is in the picture, and how near to the viewer. */
  function project(p) {
    const [right, up, near] = sides.map((e) => level.reduce((sum, k) => sum + e[k] * (p[k] - centre[k]), 0));
    return [width / 2 + scale * right, height / 2 - scale * up, near];
  }

  function add(name, attributes, text) {
    const element = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text !== undefined) element.textContent = text;
    svg.append(element);
  }

  function line(a, b, kind) {
    const [[x1, y1], [x2, y2]] = [project(a), project(b)];
    add("line", { x1, y1, x2, y2, class: kind });
  }

  /** The multiples of the step along an axis of the box. */
  function ticks(k) {
    const count = Math.round((box[k][1] - box[k][0]) / step);
    return Array.from({ length: Math.min(count, 50) + 1 }, (_, i) => box[k][0] + i * step);
  }

  /** Numbers along an edge of the box, on the side that points away from it in the picture; one is left to another axis. */
  function axis(k, start, away, other) {
    const at = (value) => start.map((x, i) => (i === k ? value : x));
    const size = Math.hypot(...away) || 1, [ox, oy] = away.map((x) => x / size);
    const anchor = ox > 0.3 ? "start" : ox < -0.3 ? "end" : "middle";
    const label = (value, distance, text) => {
      const [x, y] = project(at(value));
      add("text", { x: x + distance * ox, y: y + distance * oy + 4, "text-anchor": anchor }, text);
    };
    line(at(box[k][0]), at(box[k][1]), "axis");
    const texts = ticks(k).map((value) => String(Number(value.toPrecision(12)))), [a, b] = [project(at(0)), project(at(step))];
    // Seen along its length, an axis has room for few numbers or none, beside or above each other.
    const letters = texts.reduce((most, text) => Math.max(most, text.length), 0);
    const every = Math.ceil(Math.min((7.5 * letters + 6) / Math.abs(a[0] - b[0]), 18 / Math.abs(a[1] - b[1])));
    if (every >= texts.length) return;
    texts.forEach((text, i) => {
      const value = box[k][0] + i * step;
      if (i % every === 0 && !(Math.abs(value - other) < step / 2)) label(value, 14, text);
    });
    label((box[k][0] + box[k][1]) / 2, 36 + 7.5 * letters * Math.abs(ox), names[k] + " (m)");
  }

  /** The floor with its grid, and the axes along edges that hide nothing. */
  function floor() {
    const bottom = box[2][0];
    for (const x of ticks(0)) line([x, box[1][0], bottom], [x, box[1][1], bottom], "grid");
    for (const y of ticks(1)) line([box[0][0], y, bottom], [box[0][1], y, bottom], "grid");
    const [right, up, near] = sides;
    const edge = (k) => box[k][near[k] > 0 ? 1 : 0];
    // Away from the box, and downwards where the floor is seen from its edge.
    const away = (k) => (near[k] > 0 ? [right[k], 1 - near[2] - up[k]] : [-right[k], 1 - near[2] + up[k]]);
    axis(0, [0, edge(1), bottom], away(1));
    axis(1, [edge(0), 0, bottom], away(0), edge(1));
    const corners = [0, 1, 2, 3].map((c) => [box[0][c & 1], box[1][c >> 1], bottom]);
    axis(2, corners.reduce((a, b) => (project(b)[0] < project(a)[0] ? b : a)), [-1, 0], bottom);
  }

  /** The shadow of an ellipsoid, whose matrix in square metres is that of the points x with x' A^-1 x = 1. */
  function shadow({ at, ellipsoid, kind }) {
    const [right, up] = sides;
    const along = (a, b) => level.reduce((sum, i) => level.reduce((sum, k) => sum + a[i] * ellipsoid[i][k] * b[k], sum), 0);
    const [xx, xy, yy] = [along(right, right), along(right, up), along(up, up)];
    const middle = (xx + yy) / 2, root = Math.hypot((xx - yy) / 2, xy);
    const [rx, ry] = [middle + root, middle - root].map((square) => scale * Math.sqrt(Math.max(square, 0)));
    // Larger than the view, it would be a wash of colour.
    if (!(rx < 2 * width)) return;
    const [x, y] = project(at), degrees = (-Math.atan2(2 * xy, xx - yy) * 90) / Math.PI;
    add("ellipse", { rx, ry, transform: `translate(${x} ${y}) rotate(${degrees})`, class: `ellipsoid ${kind}` });
  }

  function marker(node) {
    const [x, y] = project(node.at);
    if (node.truth) {
      line(node.at, node.truth, "error");
      const [tx, ty] = project(node.truth);
      add("path", { d: `M${tx - 5} ${ty}h10m-5-5v10`, class: "truth" });
    }
    if (node.kind === "receiver") add("path", { d: `M${x} ${y - 6}l5.2 9h-10.4z`, class: "receiver" });
    else add("circle", { cx: x, cy: y, r: 3.5, class: "transmitter" });
    if (node.held) add("rect", { x: x - 9, y: y - 9, width: 18, height: 18, class: "held" });
  }

  function draw() {
    waiting = false;
    sides = directions();
    svg.replaceChildren();
    floor();
    for (const { at } of nodes) line(at, [at[0], at[1], box[2][0]], "stem");
    for (const node of nodes) if (node.ellipsoid) shadow(node);
    const depths = nodes.map((node) => ({ node, near: project(node.at)[2] }));
    for (const { node } of depths.sort((a, b) => a.near - b.near)) marker(node);
    if (hovered) {
      const [x, y] = project(hovered.at), left = x > width / 2;
      add("text", { x: x + (left ? -10 : 10), y: y - 8, "text-anchor": left ? "end" : "start", class: "name" }, hovered.name);
    }
    for (const button of buttons) {
      const view = VIEWS[button.textContent];
      button.setAttribute("aria-pressed", String(view.around === from.around && view.above === from.above));
    }
  }

  function later() {
    if (!waiting) requestAnimationFrame(draw);
    waiting = true;
  }

  function turn(around, above) {
    from.around += around;
    // From below, the floor would lie over the network.
    from.above = Math.min(Math.max(from.above + above, 0), Math.PI / 2);
    later();
  }

  /** The node under the pointer. */
  function under(event) {
    const frame = svg.getBoundingClientRect(), zoom = width / frame.width;
    const [px, py] = [(event.clientX - frame.left) * zoom, (event.clientY - frame.top) * zoom];
    const reach = event.pointerType === "touch" ? 24 : 12;
    const distances = nodes.map((node) => {
      const [x, y] = project(node.at);
      return { node, distance: Math.hypot(x - px, y - py) };
    });
    const nearest = distances.reduce((a, b) => (b.distance < a.distance ? b : a), { node: null, distance: Infinity });
    return nearest.distance <= reach * Math.max(zoom, 1) ? nearest.node : null;
  }

  function hover(event) {
    const node = under(event);
    if (node !== hovered) later();
    hovered = node;
  }

  let held = null;
  svg.addEventListener("pointerdown", (event) => {
    if (held !== null || event.button !== 0) return;
    held = { id: event.pointerId, x: event.clientX, y: event.clientY };
    svg.setPointerCapture(event.pointerId);
    hover(event);
  });
  svg.addEventListener("pointermove", (event) => {
    if (held === null) return hover(event);
    if (held.id !== event.pointerId) return;
    turn((held.x - event.clientX) / 150, (event.clientY - held.y) / 150);
    [held.x, held.y] = [event.clientX, event.clientY];
  });
  for (const end of ["pointerup", "pointercancel"]) {
    svg.addEventListener(end, (event) => {
      if (held?.id === event.pointerId) held = null;
    });
  }
  svg.addEventListener("pointerleave", (event) => {
    // A name that a finger has found stays when the finger is lifted.
    if (event.pointerType !== "touch") hovered = null;
    later();
  });
  const KEYS = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  svg.addEventListener("keydown", (event) => {
    const way = KEYS[event.key];
    if ((!way && event.key !== "Home") || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    if (!way) from = { ...START };
    turn(...(way ?? [0, 0]).map((x) => x * (Math.PI / 36)));
  });
  const buttons = Object.keys(VIEWS).map((name) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = name;
    button.addEventListener("click", () => {
      from = { ...VIEWS[name] };
      draw();
    });
    return button;
  });
  figure.querySelector(".views").append(...buttons);
  figure.hidden = false;
  draw();
}
