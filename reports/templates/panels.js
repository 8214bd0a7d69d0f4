"use strict";
/* The paper's figures 7 to 9: one grid of small panels for each coefficient of restitution, for the model chosen. */
rockcheck.whenReady.push(async () => {
  const holder = document.getElementById("panel-data");
  const chart = document.getElementById("panel-chart");
  const select = document.getElementById("panel-model");
  let data = {};
  let group = 0;
  const line = (curve, name, axis, colour, scale, words) => ({
    type: "scatter", mode: "lines", x: curve.t_s, y: scale === 1 ? curve[name] : scaled(curve[name], scale), xaxis: `x${axis}`, yaxis: `y${axis}`,
    line: { color: colour, width: 1.3 }, name: words, showlegend: false, hovertemplate: `${words} %{y:.4f}<extra></extra>`,
  });
  const scaled = (values, scale) => values.map((value) => value * scale);
  const figure = () => {
    const panels = data.groups[group].panels;
    const amplitudes = [...new Set(panels.map((panel) => panel.amplitude_g))].sort((a, b) => a - b);
    const frequencies = [...new Set(panels.map((panel) => panel.frequency_hz))].sort((a, b) => a - b);
    const columns = window.innerWidth < 760 ? 1 : amplitudes.length;
    const places = [];
    for (const [column, amplitude] of amplitudes.entries()) for (const [row, frequency] of frequencies.entries()) places.push({ amplitude, frequency, column: columns === 1 ? 0 : column, row: columns === 1 ? column * frequencies.length + row : row });
    const rows = columns === 1 ? amplitudes.length * frequencies.length : frequencies.length;
    const gapX = 0.06, gapY = 0.36 / rows, width = (1 - gapX * (columns - 1)) / columns, height = (1 - gapY * (rows - 1)) / rows;
    const traces = [], annotations = [];
    const layout = { height: 60 + rows * 168, showlegend: false, hovermode: "x", margin_top: 36 };
    places.forEach((place, index) => {
      const axis = index === 0 ? "" : String(index + 1);
      const left = place.column * (width + gapX), top = 1 - place.row * (height + gapY);
      layout[`xaxis${axis}`] = { domain: [left, left + width], anchor: `y${axis}`, matches: index ? "x" : undefined, gridcolor: style("--line"), zeroline: false, title: place.row === rows - 1 ? { text: "time  [s]" } : undefined };
      layout[`yaxis${axis}`] = { domain: [Math.max(0, top - height), top], anchor: `x${axis}`, range: [-data.shown_rad, data.shown_rad], gridcolor: style("--line"), zerolinecolor: style("--muted"), nticks: 5, title: place.column === 0 ? { text: "θ [rad]", standoff: 4 } : undefined };
      annotations.push({ xref: "paper", yref: "paper", x: left, y: top, xanchor: "left", yanchor: "bottom", showarrow: false, text: `<b>${place.amplitude} g, ${place.frequency} Hz</b>`, font: { size: 12 } });
      const panel = panels.find((item) => item.amplitude_g === place.amplitude && item.frequency_hz === place.frequency);
      const curves = panel && panel.curves[select.value];
      if (!curves) { annotations.push({ xref: "paper", yref: "paper", x: left + width / 2, y: top - height / 2, showarrow: false, text: "not run", font: { color: style("--muted") } }); return; }
      if (curves.floor) traces.push(line(curves.floor, "theta_rad", axis, data.colours.floor, 1, "on the floor, rad"));
      if (curves.pedestal) {
        traces.push(line(curves.pedestal, "theta_rad", axis, data.colours.pedestal, 1, "on the pedestal, rad"));
        traces.push(line(curves.pedestal, "slip_m", axis, data.colours.slip, 0.1, "slip ÷ 10, m"));
      }
      if (!curves.floor && !curves.pedestal) traces.push({ x: [], y: [], xaxis: `x${axis}`, yaxis: `y${axis}` });
    });
    layout.annotations = annotations;
    return [traces, fitted(layout)];
  };
  const draw = async () => {
    data = await rockcheck.data(holder, rockcheck.coloured);
    const [traces, layout] = figure();
    await Plotly.react(rockcheck.live(chart), traces, layout, config);
  };
  for (const button of document.querySelectorAll("[data-panel-group]")) {
    button.addEventListener("click", () => {
      group = Number(button.dataset.panelGroup);
      for (const other of document.querySelectorAll("[data-panel-group]")) other.setAttribute("aria-pressed", String(other === button));
      draw();
    });
  }
  select.addEventListener("change", draw);
  rockcheck.isDark.addEventListener("change", draw);
  await draw();
});
