"use strict";
/* Replays the recorded motion with the statue's own mesh: three.js draws, this file moves one transform per model and frame. */
rockcheck.whenReady.push(async () => {
  const root = document.getElementById("replay");
  if (!root) return;
  const stage = root.querySelector(".stage");
  const wait = stage.querySelector(".wait");
  let renderer;
  try {
    await rockcheck.run("three-js");
    renderer = new THREE.WebGLRenderer({ antialias: true });
  } catch (error) {
    wait.textContent = wait.dataset.without;
    return;
  }
  const data = await rockcheck.data(document.getElementById("replay-data"));

  /* the scene */
  const scene = new THREE.Scene();
  scene.background = new THREE.Color();
  renderer.outputEncoding = THREE.sRGBEncoding;
  renderer.shadowMap.enabled = true;
  renderer.shadowMap.type = THREE.PCFSoftShadowMap;
  renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
  const wallSide = data.wall ? (data.wall.side === "right" ? 1 : -1) : 0;
  const lift = data.pedestal ? data.pedestal.height_m : 0;
  const total = data.in_sight_m;
  const centre = 0.5 * (data.corner_right_m - data.corner_left_m);
  scene.add(new THREE.HemisphereLight("#f4f7fb", "#a39a8c", 0.55));
  const sun = new THREE.DirectionalLight("#fff4e2", 0.62);
  sun.position.set(centre - 1.9 * total, -1.3 * total, 2.3 * total);
  sun.target.position.set(centre, 0, 0.4 * total);
  sun.castShadow = true;
  sun.shadow.mapSize.set(1024, 1024);
  sun.shadow.radius = 4;
  sun.shadow.normalBias = 0.01 * total;
  Object.assign(sun.shadow.camera, { left: -1.8 * total, right: 1.8 * total, top: 1.8 * total, bottom: -1.8 * total, near: 0.1, far: 7 * total });
  scene.add(sun, sun.target);
  const floor = new THREE.Mesh(new THREE.PlaneGeometry(40 * total, 40 * total), new THREE.MeshStandardMaterial({ roughness: 1 }));
  floor.receiveShadow = true;
  scene.fog = new THREE.Fog("#eceff2", 6 * total, 16 * total);
  const light = () => {
    const [air, ground] = rockcheck.isDark.matches ? ["#20262e", "#3a424c"] : ["#eceff2", "#dfe2e5"];
    scene.background.set(air);
    scene.fog.color.set(air);
    floor.material.color.set(ground);
    grid.material.opacity = rockcheck.isDark.matches ? 0.25 : 1;
  };
  scene.add(floor);
  const grid = new THREE.GridHelper(20, 80, "#aab2bb", "#cdd2d8");
  grid.material.transparent = true;
  grid.rotation.x = Math.PI / 2;
  grid.position.set(centre, 0, 0.0015);
  scene.add(grid);
  if (data.wall) {
    const at = wallSide > 0 ? data.corner_right_m + data.wall.distance_m : -data.corner_left_m - data.wall.distance_m;
    const wall = new THREE.Mesh(new THREE.BoxGeometry(0.05, 1.7 * total, 1.2 * total), new THREE.MeshStandardMaterial({ color: "#a9b2bd", transparent: true, opacity: 0.5, depthWrite: false }));
    wall.position.set(at + wallSide * 0.025, 0.35 * total, 0.6 * total);
    scene.add(wall);
  }

  /* one figure per model: a group at its pivot, the mesh behind it */
  let geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(rockcheck.interleaved(data.mesh.positions, Float32Array), 3));
  geometry.setIndex(new THREE.BufferAttribute(rockcheck.interleaved(data.mesh.index, Uint32Array), 1));
  if (!data.mesh.own) geometry = geometry.toNonIndexed(); /* a block has flat sides */
  geometry.computeVertexNormals();
  geometry.computeBoundingSphere();
  const figures = new Map();
  for (const model of data.models) {
    const frames = model.frames;
    const body = new THREE.Mesh(geometry, null);
    body.position.x = -data.corner_right_m; /* it turns about its right corner */
    const tilt = new THREE.Group(), whole = new THREE.Group();
    tilt.rotation.order = "ZYX";
    tilt.add(body);
    whole.add(tilt);
    let stone = null;
    if (data.pedestal) {
      stone = new THREE.Mesh(new THREE.BoxGeometry(data.pedestal.width_m, data.pedestal.depth_m, data.pedestal.height_m), null);
      stone.rotation.order = "ZYX";
      whole.add(stone);
    }
    scene.add(whole);
    figures.set(model.name, { model, frames, body, tilt, whole, stone });
  }
  const marble = new THREE.MeshStandardMaterial({ color: "#ded7ca", roughness: 0.78, metalness: 0 });
  const plinth = new THREE.MeshStandardMaterial({ color: "#aeb4bc", roughness: 0.9, metalness: 0 });
  const arrow = new THREE.ArrowHelper(new THREE.Vector3(1, 0, 0), new THREE.Vector3(), 1, "#c2185b", 0.07, 0.05);
  scene.add(arrow);

  /* camera: drag, arrow keys and buttons turn it */
  const camera = new THREE.PerspectiveCamera(30, 1, 0.05 * total, 60 * total);
  camera.up.set(0, 0, 1);
  const away = wallSide < 0 ? 1 : -1; /* look past the wall, not through it */
  const view = { azimuth: 0.42 * away, elevation: 0.2, distance: 3.25 * total };
  const target = new THREE.Vector3(centre, 0, 0.47 * total);
  const views = { front: [0, 0.06], oblique: [0.42 * away, 0.2], side: [(Math.PI / 2) * away, 0.06], above: [0, 1.45] };
  const aim = () => {
    const { azimuth, elevation, distance } = view;
    camera.position.set(target.x + distance * Math.sin(azimuth) * Math.cos(elevation), target.y - distance * Math.cos(azimuth) * Math.cos(elevation), target.z + distance * Math.sin(elevation));
    camera.lookAt(target);
  };

  /* pose of a model at a time, between its frames */
  const at = (figure, name, time) => {
    const values = figure.frames[name];
    if (!values) return 0;
    const last = values.length - 1;
    const end = figure.model.end_s;
    if (time >= end) return values[last];
    const place = Math.max(0, time / data.step_s), k = Math.min(Math.floor(place), last - 1);
    const from = k * data.step_s, width = k === last - 1 ? end - from : data.step_s;
    const share = width > 0 ? (time - from) / width : 0;
    return values[k] + share * (values[k + 1] - values[k]);
  };
  const choice = { solid: root.dataset.solid, ghost: root.dataset.ghost, beside: false };
  const pose = (figure, time) => {
    const of = (name) => at(figure, name, time), places = (body) => ["x", "y", "z"].map((letter) => of(`${body}_${letter}_m`));
    const aside = choice.beside && figure.model.name === choice.ghost ? Math.max(1.15 * data.height_m, 1.6 * (data.pedestal ? data.pedestal.depth_m : data.depth_m)) : 0;
    figure.whole.position.y = aside;
    figure.tilt.position.set(...places("corner_right"));
    figure.tilt.rotation.set(of("roll_rad"), of("pitch_rad"), of("yaw_rad"));
    if (figure.stone) {
      figure.stone.position.set(...places("pedestal"));
      figure.stone.rotation.set(0, of("pedestal_tilt_rad"), of("pedestal_yaw_rad"));
    }
    return of("theta_rad");
  };
  const dress = () => {
    for (const [name, figure] of figures) {
      const solid = name === choice.solid, ghost = name === choice.ghost && !solid;
      figure.whole.visible = solid || ghost;
      if (ghost) {
        const faint = choice.beside ? 0.92 : 0.26;
        const skin = new THREE.MeshStandardMaterial({ color: figure.model.colour, transparent: true, opacity: faint, roughness: 0.8, depthWrite: choice.beside });
        figure.body.material = skin;
        if (figure.stone) { figure.stone.material = skin; figure.stone.visible = choice.beside; }
      } else {
        figure.body.material = marble;
        if (figure.stone) { figure.stone.material = plinth; figure.stone.visible = true; }
      }
      figure.body.castShadow = solid || choice.beside;
      figure.body.receiveShadow = solid;
      if (figure.stone) { figure.stone.castShadow = figure.body.castShadow; figure.stone.receiveShadow = true; }
    }
    draw();
  };

  /* time: one clock for replay, slider, readout and the cursor over the histories */
  const slider = root.querySelector("input[type=range]");
  const play = root.querySelector("[data-replay=play]");
  const clock = root.querySelector(".clock");
  const cells = new Map([...root.querySelectorAll("[data-theta]")].map((cell) => [cell.dataset.theta, cell]));
  const floorValues = data.floor;
  const stats = { frames: 0, script_ms: 0, worst_ms: 0 };
  let playing = false, seen = true, moveCursor = () => {}, before = 0, speed = 1;
  const floorAt = (axis) => {
    const values = floorValues[axis];
    return values ? values[Math.min(values.length - 1, Math.round(rockcheck.time / data.step_s))] : 0;
  };
  const draw = (always = false) => {
    const begun = performance.now();
    for (const [name, figure] of figures) {
      const theta = pose(figure, rockcheck.time);
      const cell = cells.get(name);
      if (cell) cell.textContent = `${Math.abs(theta) < 5e-5 ? "" : theta < 0 ? "−" : "+"}${rockcheck.number(Math.abs(theta), 4)} rad${rockcheck.time > figure.model.end_s ? ` (${clock.dataset.ended})` : ""}`;
    }
    const push = new THREE.Vector3(floorAt("x"), floorAt("y"), floorAt("z"));
    const size = push.length();
    arrow.visible = size > 0.004;
    if (arrow.visible) {
      arrow.position.set(centre, -0.75 * Math.max(data.depth_m, data.pedestal ? data.pedestal.depth_m : 0), 0.03);
      arrow.setDirection(push.divideScalar(size));
      arrow.setLength(Math.max(0.12, size * total), 0.07, 0.05);
    }
    clock.textContent = `${rockcheck.number(rockcheck.time, 3)} s`;
    slider.value = rockcheck.time;
    moveCursor();
    if (seen || always) renderer.render(scene, camera);
    const spent = performance.now() - begun;
    stats.frames += 1;
    stats.script_ms += spent;
    stats.worst_ms = Math.max(stats.worst_ms, spent);
  };
  rockcheck.setTime = (time) => {
    rockcheck.time = Math.min(data.end_s, Math.max(0, time));
    draw();
  };
  const frame = (now) => {
    if (!playing) return;
    const next = rockcheck.time + (speed * Math.min(now - before, 100)) / 1000;
    before = now;
    if (next >= data.end_s) { rockcheck.setTime(data.end_s); setPlaying(false); return; }
    rockcheck.setTime(next);
    requestAnimationFrame(frame);
  };
  const begins = play.textContent;
  const setPlaying = (yes) => {
    playing = yes;
    play.textContent = yes ? play.dataset.pause : begins;
    play.setAttribute("aria-pressed", String(yes));
    if (!yes) return;
    if (rockcheck.time >= data.end_s) rockcheck.time = data.begin_s;
    before = performance.now();
    requestAnimationFrame(frame);
  };
  play.addEventListener("click", () => setPlaying(!playing));
  slider.max = data.end_s;
  slider.addEventListener("input", () => { setPlaying(false); rockcheck.setTime(Number(slider.value)); });
  root.querySelector("[data-replay=speed]").addEventListener("change", (event) => { speed = Number(event.target.value); });
  for (const name of ["solid", "ghost"]) {
    root.querySelector(`[data-replay=${name}]`).addEventListener("change", (event) => { choice[name] = event.target.value; dress(); });
  }
  root.querySelector("[data-replay=beside]").addEventListener("click", (event) => {
    choice.beside = !choice.beside;
    event.target.setAttribute("aria-pressed", String(choice.beside));
    dress();
  });
  for (const button of root.querySelectorAll("[data-view]")) {
    button.addEventListener("click", () => { [view.azimuth, view.elevation] = views[button.dataset.view]; aim(); draw(); });
  }

  /* the canvas */
  const canvas = renderer.domElement;
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", stage.dataset.canvas);
  const turn = (right, up) => { view.azimuth -= right; view.elevation = Math.min(1.5, Math.max(-0.05, view.elevation + up)); aim(); draw(); };
  const zoomBy = (factor) => { view.distance = Math.min(12 * total, Math.max(1.2 * total, view.distance * factor)); aim(); draw(); };
  let held = null;
  canvas.addEventListener("pointerdown", (event) => { held = [event.clientX, event.clientY]; canvas.setPointerCapture(event.pointerId); });
  canvas.addEventListener("pointermove", (event) => {
    if (!held) return;
    turn((event.clientX - held[0]) * 0.008, (event.clientY - held[1]) * 0.006);
    held = [event.clientX, event.clientY];
  });
  for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, () => { held = null; });
  canvas.addEventListener("wheel", (event) => { if (event.ctrlKey) { event.preventDefault(); zoomBy(Math.exp(event.deltaY * 0.002)); } }, { passive: false });
  const keys = { ArrowLeft: () => turn(0.1, 0), ArrowRight: () => turn(-0.1, 0), ArrowUp: () => turn(0, 0.08), ArrowDown: () => turn(0, -0.08), "+": () => zoomBy(0.9), "-": () => zoomBy(1.1), " ": () => setPlaying(!playing) };
  canvas.addEventListener("keydown", (event) => { if (keys[event.key]) { event.preventDefault(); keys[event.key](); } });
  const fit = () => {
    const width = stage.clientWidth, height = Math.round(Math.min(560, Math.max(320, 0.62 * width)));
    renderer.setSize(width, height);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    draw(true);
  };
  if (rockcheck.charts.histories) {
    moveCursor = rockcheck.addCursor("histories");
    rockcheck.charts.histories.clicked = (time) => { setPlaying(false); rockcheck.setTime(time); };
  }
  wait.remove();
  stage.prepend(canvas);
  aim();
  light();
  rockcheck.isDark.addEventListener("change", () => { light(); draw(true); });
  rockcheck.time = data.begin_s; /* shortly before anything moves */
  dress();
  fit();
  new ResizeObserver(fit).observe(stage);
  new IntersectionObserver((entries) => { seen = entries[0].isIntersecting; if (seen) draw(); }).observe(canvas);
  rockcheck.replay = { stats, setPlaying, isPlaying: () => playing, figures, camera, renderer };
});
