"use strict";
/* Draws the charts of this page from its own data. No network. */
const rockcheck = { charts: {}, whenReady: [], time: 0 };
window.rockcheck = rockcheck;

/* A number as the page's language writes it. */
const written = new Map();
rockcheck.number = (value, digits) => {
  if (!written.has(digits)) written.set(digits, new Intl.NumberFormat(document.documentElement.lang, { minimumFractionDigits: digits, maximumFractionDigits: digits, useGrouping: false }));
  return written.get(digits).format(value).replace("-", "−");
};

rockcheck.unpack = async (holder) => {
  const text = atob(holder.textContent), packed = new Uint8Array(text.length);
  for (let n = 0; n < text.length; n += 1) packed[n] = text.charCodeAt(n); /* a tenth of the time of Uint8Array.from */
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
};

/* Arrays come as differences of whole multiples of a step (charts/histories.py); columns of one table come one after another. */
const summed = ({ step, order, deltas }) => {
  const values = Float64Array.from(deltas);
  for (let k = 0; k < order; k += 1) for (let n = 1; n < values.length; n += 1) values[n] += values[n - 1];
  return values.map((value) => value * step);
};
const unpacked = (value) => {
  if (value === null || typeof value !== "object") return value;
  if (value.deltas) return summed(value);
  for (const key of Object.keys(value)) value[key] = unpacked(value[key]);
  return value;
};
rockcheck.data = async (holder) => unpacked(JSON.parse(await rockcheck.unpack(holder)));
rockcheck.interleaved = (columns, kind) => {
  const table = new kind(columns.length * columns[0].length);
  columns.forEach((column, letter) => column.forEach((value, row) => { table[row * columns.length + letter] = value; }));
  return table;
};

rockcheck.run = async (id) => {
  const script = document.createElement("script");
  script.textContent = await rockcheck.unpack(document.getElementById(id));
  document.head.append(script);
};

/* On a dark screen charts take the dark colours of the palette by the page's style; printed pages show the stills, which stay light. */
rockcheck.isDark = window.matchMedia("(prefers-color-scheme: dark)");

/* The live chart stands beside its still, which is printed in its place. A chart that answers is no picture any more. */
rockcheck.live = (chart) => {
  let box = chart.querySelector(".live");
  if (!box) {
    chart.querySelector(".wait")?.remove();
    box = document.createElement("div");
    box.className = "live";
    chart.append(box);
    chart.classList.add("drawn");
    chart.setAttribute("role", "group");
  }
  return box;
};

/* Of samples as few as keep every column, joined by lines, within this share of its range: less than a pixel is high. */
const NEAR = 2.5e-4;
const bent = (chosen, along, columns) => {
  const near = columns.map((values) => { const shown = chosen.map((n) => values[n]); return NEAR * (Math.max(...shown) - Math.min(...shown)); });
  const kept = [chosen[0]], free = columns.map(() => [-Infinity, Infinity]);
  let slopes = free, last = chosen[0];
  for (const n of chosen.slice(1)) {
    const slope = (values, error) => (values[n] - values[kept.at(-1)] + error) / (along[n] - along[kept.at(-1)]);
    if (!columns.every((values, k) => slope(values, 0) >= slopes[k][0] && slope(values, 0) <= slopes[k][1])) { kept.push(last); slopes = free; }
    slopes = columns.map((values, k) => [Math.max(slopes[k][0], slope(values, -near[k])), Math.min(slopes[k][1], slope(values, near[k]))]);
    last = n;
  }
  return [...kept, last];
};

/* Of the samples of a curve those within a stretch, and one more at each end: of every bin the first and each column's extremes. */
const samplesOf = (along, columns, [low, high], bins) => {
  const before = along.findIndex((value) => value >= low), after = along.findIndex((value) => value > high);
  const from = Math.max(0, (before < 0 ? along.length : before) - 1), to = after < 0 ? along.length : after + 1;
  const width = Math.max(1, (to - from) / bins), chosen = new Set();
  for (let begin = from; begin < to; begin += width) {
    const first = Math.floor(begin), end = Math.min(to, Math.floor(begin + width));
    chosen.add(first);
    for (const values of columns) {
      let least = first, most = first;
      for (let n = first; n < end; n += 1) { if (values[n] < values[least]) least = n; if (values[n] > values[most]) most = n; }
      chosen.add(least).add(most);
    }
  }
  return bent([...chosen.add(to - 1)].sort((a, b) => a - b), along, columns);
};

/* Rows of a chart's data, which come as columns (charts/drawn.py); typed arrays are the samples of curves. */
const listed = (part) => Object.keys(part).filter((key) => typeof part[key] === "object" && part[key] !== null);
const isCurve = (part) => Object.values(part).some(ArrayBuffer.isView);
const rowsOf = (parts, stretch, bins) => parts.flatMap((part) => {
  const keys = listed(part), [along, ...others] = keys.map((key) => part[key]).filter(ArrayBuffer.isView);
  const shown = along ? samplesOf(along, others, stretch, bins) : [...part[keys[0]].keys()];
  return shown.map((n) => ({ ...part, ...Object.fromEntries(keys.map((key) => [key, part[key][n]])) }));
});

/* As `sized` of charts/drawn.py; where it is narrow, plots side by side stand below each other. */
const sized = (spec, width, alone = true) => {
  if (Array.isArray(spec)) return spec.map((each) => sized(each, width, false));
  if (spec.spec) { const columns = width < 620 ? 1 : spec.columns; return { ...spec, columns, spec: { ...spec.spec, width: Math.max(60, (width - 132) / columns - 24) } }; }
  const parted = ["vconcat", "hconcat"].filter((key) => spec[key]);
  if (parted.length) return { ...spec, ...Object.fromEntries(parted.map((key) => [key, sized(spec[key], width, false)])) };
  return alone ? { ...spec, width, autosize: { type: "fit-x", contains: "padding" } } : { ...spec, width: Math.max(60, spec.width * width - 132) };
};

/* A chart that answers: its view, the stretches of its axes (`X`, `Y`; none: as they come), and what the pointer is told. */
const answering = async (name, spec) => {
  const box = rockcheck.live(document.getElementById(`chart-${name}`)), { views = null, read = null } = spec.usermeta || {};
  const part = (className, tag = "div") => box.appendChild(Object.assign(document.createElement(tag), { className }));
  const chart = { box, views, spec }, plot = part("plot"), frame = part("frame"), tip = part("tip");
  part("hidden").textContent = box.parentElement.getAttribute("aria-label"); /* what its signs show, which have no words */
  const kept = Object.fromEntries(spec.params.filter((each) => "value" in each).map((each) => [each.name, each.value]));
  const bound = spec.params.filter((each) => each.bind && "value" in each).map((each) => each.name);
  const parts = (key) => spec.datasets[key].filter((each) => bound.every((name) => !(name in each) || each[name] === kept[name]));
  const data = (key) => rowsOf(parts(key), kept.X || (views ? views.event_s : [-Infinity, Infinity]), box.clientWidth / 3);
  const keys = Object.keys(spec.datasets), curves = keys.filter((key) => spec.datasets[key].some(isCurve));
  let drawn = 0;
  chart.draw = async () => {
    drawn = box.clientWidth;
    for (const key of Object.keys(chart.view ? kept : {})) kept[key] = chart.view.signal(key);
    chart.view?.finalize();
    const { fontFamily: font } = getComputedStyle(box);
    const params = [...spec.params.map((each) => ("value" in each ? { ...each, value: kept[each.name] } : each)), { name: "W", value: drawn }];
    const datasets = Object.fromEntries(keys.map((key) => [key, data(key)]));
    const options = { mode: "vega-lite", renderer: "svg", actions: false, defaultStyle: false, tooltip: false, logLevel: 1 };
    chart.view = (await vegaEmbed(plot, { ...sized(spec, drawn), params, datasets, config: { ...spec.config, font } }, options)).view;
    plot.querySelector("svg").setAttribute("aria-hidden", "true");
    for (const name of bound) chart.view.addSignalListener(name, (_, value) => { if (kept[name] !== value) { kept[name] = value; redone(); } });
    chart.moved?.();
  };
  const redone = async () => {
    for (const key of curves) chart.view.data(key, data(key));
    await chart.view.runAsync();
    chart.moved?.();
  };
  chart.zoom = async (stretches) => {
    for (const key of Object.keys(stretches)) chart.view.signal(key, kept[key] = stretches[key]);
    await redone();
  };
  const scale = (letter) => chart.view.scale(letter);
  chart.range = () => kept.X || scale("x").domain();
  /* Where the pairs of axes lie on the screen. */
  chart.plots = () => [...plot.querySelectorAll("path.background")].filter((item) => !item.closest(".role-axis, .role-legend, .role-title"))
    .map((item) => item.getBoundingClientRect()).filter((area) => area.width > 20 && area.height > 5);
  /* What stands at a share of an axis from its beginning. */
  chart.value = (letter, share) => { const axis = scale(letter), [a, b] = axis.range(); return axis.invert(a + share * (b - a)); };
  const shares = (event, area) => [(event.clientX - area.left) / area.width, 1 - (event.clientY - area.top) / area.height];
  const under = (event) => chart.plots().find((area) => shares(event, area).every((share) => share >= 0 && share <= 1));
  const zooms = () => ["x", "y"].filter((letter) => (letter === "x" || !spec.vconcat) && scale(letter)?.invert);

  let held = null;
  plot.addEventListener("pointerdown", (event) => {
    const area = event.pointerType === "mouse" && !event.button && under(event);
    if (area) { held = { area, at: [event.clientX, event.clientY] }; event.preventDefault(); }
  });
  const corners = (event) => {
    const [x, y] = held.at, { area } = held, tall = zooms().includes("y") && Math.abs(event.clientY - y) > 12;
    const inside = (value, low, high) => Math.min(Math.max(value, low), high), last = [inside(event.clientX, area.left, area.right), inside(event.clientY, area.top, area.bottom)];
    return { x: [Math.min(x, last[0]), Math.max(x, last[0])], y: tall ? [Math.min(y, last[1]), Math.max(y, last[1])] : [area.top, area.bottom], tall };
  };
  window.addEventListener("pointermove", (event) => {
    if (!held) return;
    const { x, y } = corners(event), home = box.getBoundingClientRect();
    Object.assign(frame.style, { display: "block", left: `${x[0] - home.left}px`, width: `${x[1] - x[0]}px`, top: `${y[0] - home.top}px`, height: `${y[1] - y[0]}px` });
  });
  window.addEventListener("pointerup", (event) => {
    if (!held) return;
    const { area } = held, { x, y, tall } = corners(event), ways = zooms();
    held = null;
    frame.style.display = "none";
    if (x[1] - x[0] < 6 && !tall) { if (ways.includes("x")) chart.clicked?.(chart.value("x", shares(event, area)[0])); return; }
    const stretch = {};
    if (x[1] - x[0] >= 6 && ways.includes("x")) stretch.X = x.map((at) => chart.value("x", (at - area.left) / area.width));
    if (tall) stretch.Y = [y[1], y[0]].map((at) => chart.value("y", 1 - (at - area.top) / area.height));
    if (Object.keys(stretch).length) chart.zoom(stretch);
  });
  plot.addEventListener("dblclick", (event) => { if (under(event)) chart.zoom({ X: null, Y: null }); });

  /* What stands at the pointer: of curves every model at its time, else what the nearest point or cell says. */
  const told = (event, area) => {
    const [across, up] = shares(event, area);
    if (read) {
      const time = chart.value("x", across), column = read[chart.plots().findIndex((each) => each.top === area.top)];
      if (!column) return "";
      const lines = spec.datasets[column.data].filter((each) => each[column.of]).map((each) => {
        const after = each.t.findIndex((value) => value >= time), n = after < 0 ? each.t.length - 1 : after;
        return `${[each.name, column.words].filter(Boolean).join(" ")} ${rockcheck.number(each[column.of][n], column.decimals)} ${column.unit}`;
      });
      return [`${rockcheck.number(time, 4)} s`, ...lines].join("\n");
    }
    return nearest(event, area, "tip");
  };
  const nearest = (event, area, of) => {
    const [across, up] = shares(event, area);
    const x = scale("x"), y = scale("y"), place = (axis, value, length) => (axis(value) + (axis.bandwidth ? axis.bandwidth() / 2 : 0)) * length / Math.max(...axis.range());
    let best = 60, said = "";
    for (const each of keys.flatMap((key) => spec.datasets[key])) for (let n = 0; n < (each[of]?.length || 0); n += 1) {
      const away = Math.hypot(place(x, each.x[n], area.width) - across * area.width, place(y, each.y[n], area.height) - (1 - up) * area.height);
      if (away < best) [best, said] = [away, each[of][n]];
    }
    return said;
  };
  /* Of a point that is clicked, its run in the chart that it opens, and the command for it, marked to be copied. */
  plot.addEventListener("click", (event) => {
    const area = under(event), command = area && nearest(event, area, "more");
    if (!command) return;
    const opens = spec.usermeta.opens, other = rockcheck.charts[opens], point = nearest(event, area, opens);
    if (other?.spec.datasets.runs.some((each) => each[opens] === point)) other.zoom({ [opens]: point, X: null, Y: null });
    let shown = box.nextElementSibling;
    if (!shown?.matches("output.command")) { shown = document.createElement("output"); shown.className = "command"; box.after(shown); }
    shown.textContent = command;
    getSelection().selectAllChildren(shown);
  });
  plot.addEventListener("pointermove", (event) => {
    const area = under(event), text = area && !held ? told(event, area) : "", home = box.getBoundingClientRect();
    tip.textContent = text;
    tip.style.display = text ? "block" : "none";
    const left = event.clientX - home.left;
    Object.assign(tip.style, { left: `${Math.max(0, Math.min(left + 14, home.width - tip.offsetWidth))}px`, top: `${event.clientY - home.top + 12}px` });
  });
  plot.addEventListener("pointerleave", () => { tip.style.display = "none"; });
  new ResizeObserver(() => { if (chart.view && box.clientWidth && Math.abs(box.clientWidth - drawn) > 4) chart.draw(); }).observe(box);
  rockcheck.charts[name] = chart;
  await chart.draw();
};

/* What is in sight comes first; the browser may answer the reader between two charts. */
const breath = () => new Promise((done) => setTimeout(done, 0));
rockcheck.draw = async () => {
  const away = (holder) => Math.max(0, holder.parentElement.getBoundingClientRect().top - window.innerHeight);
  const holders = [...document.querySelectorAll("script.chart-data")].map((holder) => [away(holder), holder]);
  for (const [, holder] of holders.sort((a, b) => a[0] - b[0])) {
    await answering(holder.dataset.chart, await rockcheck.data(holder));
    await breath();
  }
};

/* Buttons do what the mouse does, for keyboards and fingers. */
const within = ([low, high], end) => { const width = Math.min(high - low, end), start = Math.max(0, Math.min(low, end - width)); return [start, start + width]; };
const stretches = { in: [0.25, 0.75], out: [-0.5, 1.5], earlier: [-0.5, 0.5], later: [0.5, 1.5] };
document.addEventListener("click", (event) => {
  const button = event.target.closest("button[data-for]"), chart = button && rockcheck.charts[button.dataset.for];
  if (!chart) return;
  const { views } = chart, action = button.dataset.do;
  if (action === "all") chart.zoom({ X: views && [0, views.duration_s], Y: null });
  else if (action === "event") chart.zoom({ X: null, Y: null });
  else if (action === "height") {
    const whole = button.getAttribute("aria-pressed") !== "true";
    button.setAttribute("aria-pressed", String(whole));
    chart.zoom({ Y: whole ? views.whole : null });
  } else {
    const wanted = stretches[action].map((share) => chart.value("x", share));
    chart.zoom({ X: views ? within(wanted, views.duration_s) : wanted });
  }
});

/* A cursor over the histories, kept outside the chart so that moving it draws nothing anew. */
rockcheck.addCursor = (name) => {
  const chart = rockcheck.charts[name], line = chart.box.appendChild(Object.assign(document.createElement("div"), { className: "cursor" }));
  let areas = [], home = null;
  const place = () => {
    const [low, high] = chart.range(), share = (rockcheck.time - low) / (high - low), [first] = areas;
    line.style.display = first && share >= 0 && share <= 1 ? "block" : "none";
    if (first) line.style.transform = `translateX(${first.left - home.left + share * first.width}px)`;
  };
  chart.moved = () => {
    areas = chart.plots();
    home = chart.box.getBoundingClientRect();
    Object.assign(line.style, { top: `${areas[0].top - home.top}px`, height: `${areas.at(-1).bottom - areas[0].top}px` });
    place();
  };
  chart.moved();
  return place;
};

/* On a telephone long tables are folded away; a link to one, and printing, open it. At a desk all lie open. */
const telephone = window.matchMedia("(max-width: 599px)");
const folds = (within) => within.querySelectorAll("details.fold");
const foldAway = () => { for (const item of folds(document)) item.open = !telephone.matches; };
telephone.addEventListener("change", foldAway);
window.addEventListener("beforeprint", () => { for (const item of folds(document)) item.open = true; });
window.addEventListener("afterprint", foldAway);
document.addEventListener("click", (event) => {
  const link = event.target.closest("a[href^='#']");
  const target = link && document.getElementById(link.hash.slice(1));
  if (target) for (const item of folds(target)) item.open = true;
});

const start = async () => {
  foldAway();
  if (!("DecompressionStream" in window)) {
    for (const note of document.querySelectorAll(".wait")) note.textContent = note.dataset.old;
    return;
  }
  await breath();
  rockcheck.marks = { begun: performance.now() };
  await rockcheck.run("chart-library");
  rockcheck.marks.library = performance.now();
  await rockcheck.draw();
  rockcheck.marks.charts = performance.now();
  for (const next of rockcheck.whenReady) await next();
  rockcheck.readyMs = performance.now();
  document.documentElement.dataset.ready = "yes";
};
document.addEventListener("DOMContentLoaded", start);
