// The structure and its mechanisms in 3-D. Reads #viewer-data (see viewer.py), draws into #viewer.
import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { SHELL, STONES, ShellView, VIEWS } from "churchpipe/shell.js";
import { arrowOf, showLoads } from "churchpipe/loads.js";
import { offerParts, offerPictures, offerSections, offerViews, showJoints } from "churchpipe/tools.js";

const data = JSON.parse(document.getElementById("viewer-data").textContent);
const element = (id) => document.getElementById(id);

function bytes(text) {
  return Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
}
const floats = (text) => new Float32Array(bytes(text));
const integers = (text) => new Uint32Array(bytes(text));

const rest = floats(data.points);
const centroid = floats(data.centroid);
const pointer = integers(data.point_ptr);
const triangles = integers(data.triangles);
const analyses = data.analyses.map((a) => ({ ...a, velocities: floats(a.velocities), speed: floats(a.speed),
  joints: a.joints ? floats(a.joints) : null,
  path: a.path ? { ...a.path, position: floats(a.path.position), rotation: floats(a.path.rotation) } : null }));
const joints = data.joints ? { ...data.joints, blocks: integers(data.joints.blocks) } : null;
const stoneCount = data.id.length;

const stoneOfPoint = new Uint32Array(rest.length / 3);
for (let s = 0; s < stoneCount; s++) stoneOfPoint.fill(s, pointer[s], pointer[s + 1]);

// Every stone is carried along its own constant velocity field, that is turned about a fixed axis (motion.py): it keeps
// its shape at any amplitude, and stones that move as one body stay together.
function displace(out, velocities, amplitude) {
  for (let s = 0; s < stoneCount; s++) {
    const [vx, vy, vz, wx, wy, wz] = velocities.subarray(6 * s, 6 * s + 6);
    const rate = Math.hypot(wx, wy, wz) || 1e-30;
    const x = wx / rate, y = wy / rate, z = wz / rate;
    const sin = Math.sin(amplitude * rate), cos = Math.cos(amplitude * rate);
    const versine = 2 * Math.sin((amplitude * rate) / 2) ** 2;
    const a = sin / rate, b = versine / rate, along = (x * vx + y * vy + z * vz) * (amplitude - a);
    const cx = centroid[3 * s], cy = centroid[3 * s + 1], cz = centroid[3 * s + 2];
    const dx = cx + a * vx + b * (y * vz - z * vy) + along * x;
    const dy = cy + a * vy + b * (z * vx - x * vz) + along * y;
    const dz = cz + a * vz + b * (x * vy - y * vx) + along * z;
    for (let i = 3 * pointer[s]; i < 3 * pointer[s + 1]; i += 3) {
      const px = rest[i] - cx, py = rest[i + 1] - cy, pz = rest[i + 2] - cz;
      const kept = (x * px + y * py + z * pz) * versine;
      out[i] = dx + cos * px + sin * (y * pz - z * py) + kept * x;
      out[i + 1] = dy + cos * py + sin * (z * px - x * pz) + kept * y;
      out[i + 2] = dz + cos * pz + sin * (x * py - y * px) + kept * z;
    }
  }
}

// The real path: between two of its frames centroids (3) and rotation vectors (3) change in proportion.
function follow(out, path, share) {
  const place = share * (path.words.length - 1), below = Math.min(Math.floor(place), Math.max(path.words.length - 2, 0));
  const part = place - below, first = 3 * stoneCount * below, next = path.words.length > 1 ? 3 * stoneCount : 0;
  const between = (array, i) => array[first + i] + part * (array[first + next + i] - array[first + i]);
  for (let s = 0; s < stoneCount; s++) {
    const [ox, oy, oz] = [0, 1, 2].map((i) => between(path.position, 3 * s + i));
    const [rx, ry, rz] = [0, 1, 2].map((i) => between(path.rotation, 3 * s + i));
    const angle = Math.hypot(rx, ry, rz), x = rx / (angle || 1), y = ry / (angle || 1), z = rz / (angle || 1);
    const sin = Math.sin(angle), cos = Math.cos(angle);
    const cx = centroid[3 * s], cy = centroid[3 * s + 1], cz = centroid[3 * s + 2];
    for (let i = 3 * pointer[s]; i < 3 * pointer[s + 1]; i += 3) {
      const px = rest[i] - cx, py = rest[i + 1] - cy, pz = rest[i + 2] - cz;
      const kept = (x * px + y * py + z * pz) * (1 - cos);
      out[i] = ox + cos * px + sin * (y * pz - z * py) + kept * x;
      out[i + 1] = oy + cos * py + sin * (z * px - x * pz) + kept * y;
      out[i + 2] = oz + cos * pz + sin * (x * py - y * px) + kept * z;
    }
  }
  return path.words[Math.round(place)];
}

const panelColours = data.panels.map((p) => new THREE.Color(p.colour));
const speedStops = data.speed_stops.map((c) => new THREE.Color(c));

function speedColour(share, out) {
  const place = Math.min(Math.max(share, 0), 1) * (speedStops.length - 1);
  const below = Math.min(Math.floor(place), speedStops.length - 2);
  return out.lerpColors(speedStops[below], speedStops[below + 1], place - below);
}

function paint(out, analysis, byPanel) {
  const colour = new THREE.Color();
  for (let s = 0; s < stoneCount; s++) {
    if (byPanel) colour.copy(panelColours[data.panel_of[s]]);
    else speedColour(analysis.reference_speed > 0 ? analysis.speed[s] / analysis.reference_speed : 0, colour);
    fill(out, s, colour);
  }
}

function fill(out, stone, colour) {
  for (let p = pointer[stone]; p < pointer[stone + 1]; p++) colour.toArray(out, 3 * p);
}

function lengthText(metres) {
  const size = Math.abs(metres);
  if (size >= 1) return `${metres.toFixed(2)} m`;
  return `${(1000 * metres).toFixed(size >= 0.1 ? 0 : 1)} mm`;
}

function start(canvas, renderer) {
  renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
  const scene = new THREE.Scene();
  const extent = new THREE.Vector3(...data.size);
  const radius = extent.length() / 2;
  const camera = new THREE.PerspectiveCamera(28, 1, radius / 50, radius * 60);
  camera.up.set(0, 0, 1);
  const controls = new OrbitControls(camera, canvas);

  scene.add(new THREE.HemisphereLight(0xffffff, 0xcfc5b5, 1.7));
  const lamp = new THREE.DirectionalLight(0xffffff, 1.9);
  lamp.position.set(-0.4, 0.7, 0.5);
  camera.add(lamp);
  scene.add(camera);

  // One mesh and one set of lines share the positions; flat shading needs no normals.
  const position = new THREE.BufferAttribute(new Float32Array(rest), 3).setUsage(THREE.DynamicDrawUsage);
  const colour = new THREE.BufferAttribute(new Float32Array(rest.length), 3);
  const solid = new THREE.BufferGeometry();
  solid.setAttribute("position", position);
  solid.setAttribute("color", colour);
  solid.setIndex(new THREE.BufferAttribute(triangles, 1));
  const wires = new THREE.BufferGeometry();
  wires.setAttribute("position", position);
  wires.setIndex(new THREE.BufferAttribute(integers(data.edges), 1));
  const stones = new THREE.Mesh(solid, new THREE.MeshLambertMaterial({
    vertexColors: true, flatShading: true, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
  }));
  const lines = new THREE.LineSegments(wires, new THREE.LineBasicMaterial({
    color: data.colours.edge, transparent: true, opacity: 0.5,
  }));
  for (const object of [stones, lines]) {
    object.frustumCulled = false;
    object.layers.set(STONES);
    scene.add(object);
  }
  const byName = Object.fromEntries(data.panels.map((p, i) => [p.name, panelColours[i]]));
  const shell = data.shell ? new ShellView(data.shell, byName, data.colours.edge, scene) : null;
  if (data.ground) scene.add(ground(extent));
  // Places of findings, seen through the stones before them.
  for (const mark of data.marks ?? []) {
    const ball = new THREE.Mesh(
      new THREE.SphereGeometry(mark.radius, 24, 16),
      new THREE.MeshBasicMaterial({ color: mark.colour, transparent: true, opacity: 0.6, depthTest: false }));
    ball.position.set(...mark.place);
    scene.add(ball);
  }
  for (const outline of data.outlines ?? []) {
    const edge = new THREE.BufferGeometry().setFromPoints(outline.points.map((point) => new THREE.Vector3(...point)));
    scene.add(new THREE.LineLoop(edge, new THREE.LineBasicMaterial({ color: data.colours.push, depthTest: false })));
  }
  const arrow = new THREE.Group(), pushed = new THREE.MeshLambertMaterial({ color: data.colours.push });
  scene.add(arrow);

  const framed = new Set(triangles);
  const state = { analysis: analyses[0], view: shell ? "both" : "stones", byPanel: false, share: 0.5, playing: false, origin: null };
  const period = 900; // ms a radian

  // The pictures of a view stand side by side, seen by one camera.
  function draw() {
    const { clientWidth, clientHeight } = canvas.parentElement;
    const pictures = VIEWS[state.view], width = clientWidth / pictures.length;
    renderer.setScissorTest(pictures.length > 1);
    pictures.forEach((layers, number) => {
      renderer.setViewport(number * width, 0, width, clientHeight);
      renderer.setScissor(number * width, 0, width, clientHeight);
      camera.layers.set(0);
      layers.forEach((layer) => camera.layers.enable(layer));
      renderer.render(scene, camera);
    });
  }

  function move() {
    const amplitude = 2 * state.share * state.analysis.amplitude, path = state.analysis.path;
    const words = path ? follow(position.array, path, state.share) : "";
    if (!path) displace(position.array, state.analysis.velocities, amplitude);
    position.needsUpdate = true;
    // Opened joints are drawn on the shell as it stands.
    shell?.move(state.view === "overlay" ? 0 : 2 * state.share * shell.current.amplitude);
    element("viewer-moved").textContent = path ? words : state.analysis.moving
      ? `largest displacement as drawn ${lengthText(amplitude * state.analysis.fastest)}` : "no mechanism";
    canvas.dataset.amplitude = amplitude;
    name();
    draw();
  }

  function choose(number) {
    state.analysis = analyses[number];
    const moving = state.analysis.moving;
    if (!moving) setPlaying(false);
    element("viewer-count").textContent = moving ? `${moving} of ${data.free} ${data.free === 1 ? "stone moves" : "stones move"},` : "";
    if (shell) {
      const partner = Math.max(shell.partnerOf(number), 0);
      element("viewer-shell").value = partner;
      shell.choose(partner);
      if (!state.analysis.path) shell.chooseJoints(number);
    }
    enable();
    arrow.clear();
    forget();
    if (state.analysis.push) arrow.add(arrowOf(state.analysis.push, pushed));
    chosen(state.stone ?? null);
    move();
  }

  function enable() {
    const still = state.view === "overlay" || !(state.analysis.moving || (shell && state.view !== "stones"));
    if (still) setPlaying(false);
    element("viewer-amplitude").disabled = element("viewer-play").disabled = still;
  }

  function recolour() {
    const byPanel = state.byPanel || !state.analysis.moving;
    paint(colour.array, state.analysis, byPanel);
    if (Number.isInteger(state.stone)) fill(colour.array, state.stone, new THREE.Color(data.colours.picked));
    if (Number.isInteger(state.across)) fill(colour.array, state.across, new THREE.Color(data.colours.across));
    colour.needsUpdate = true;
    shell?.paint(state.byPanel);
    legend(byPanel, state.view, state.byPanel);
    draw();
  }

  function show(view) {
    state.view = view;
    element("viewer-halves").dataset.view = view;
    enable();
    resize();
    recolour();
    move();
    look();
  }

  // The nearest camera position that frames every displaced point and the arrow of the load.
  function look(direction = state.analysis.toward) {
    Object.assign(state, { direction, turned: false });
    const toward = new THREE.Vector3(...direction).normalize();
    const right = new THREE.Vector3(0, 0, 1).cross(toward).normalize();
    const axes = [right, toward.clone().cross(right), toward];
    const points = Array.from(framed, (p) => new THREE.Vector3().fromArray(position.array, 3 * p));
    if (state.analysis.push) points.push(new THREE.Vector3(...state.analysis.push.start));
    const seen = points.map((point) => new THREE.Vector3(...axes.map((axis) => point.dot(axis))));
    const box = new THREE.Box3().setFromPoints(seen);
    const centre = box.getCenter(new THREE.Vector3());
    const slope = Math.tan((camera.fov * Math.PI) / 360);
    let distance = 0;
    for (const point of seen) {
      point.sub(centre);
      distance = Math.max(distance, Math.max(Math.abs(point.x) / camera.aspect, Math.abs(point.y)) / slope + point.z);
    }
    controls.target.set(0, 0, 0);
    axes.forEach((axis, a) => controls.target.addScaledVector(axis, centre.getComponent(a)));
    camera.position.copy(controls.target).addScaledVector(toward, 1.1 * distance);
    controls.update();
    draw();
  }

  function resize() {
    const { clientWidth, clientHeight } = canvas.parentElement;
    renderer.setSize(clientWidth, clientHeight, false);
    camera.aspect = clientWidth / VIEWS[state.view].length / clientHeight;
    camera.updateProjectionMatrix();
    draw();
  }

  function play(time) {
    if (!state.playing) return;
    state.origin ??= time - period * Math.acos(1 - 2 * state.share);
    state.share = 0.5 - 0.5 * Math.cos((time - state.origin) / period);
    element("viewer-amplitude").value = 100 * state.share;
    move();
    requestAnimationFrame(play);
  }

  function setPlaying(playing) {
    state.playing = playing;
    state.origin = null;
    element("viewer-play").textContent = playing ? "Pause" : "Play";
    if (playing) requestAnimationFrame(play);
  }

  function pick(event) {
    const box = canvas.getBoundingClientRect();
    const pictures = VIEWS[state.view];
    const across = (pictures.length * (event.clientX - box.left)) / box.width;
    const number = Math.min(Math.max(Math.floor(across), 0), pictures.length - 1);
    const pointerPlace = new THREE.Vector2(2 * (across - number) - 1, 1 - (2 * (event.clientY - box.top)) / box.height);
    const ray = new THREE.Raycaster();
    ray.setFromCamera(pointerPlace, camera);
    ray.layers.enableAll();
    if (pictures[number].includes(SHELL)) {
      element("viewer-picked").textContent = shell.describe(ray);
      chosen(null);
      return;
    }
    solid.computeBoundingSphere();
    // A section hides what lies before it from the eye, and so from the pointer.
    const seen = (place) => renderer.clippingPlanes.every((plane) => plane.distanceToPoint(place) >= 0);
    const hit = ray.intersectObject(stones).find((found) => seen(found.point));
    const stone = hit ? stoneOfPoint[hit.face.a] : null;
    element("viewer-picked").textContent = "";
    chosen(stone);
  }

  function chosen(stone) {
    Object.assign(state, { stone, across: null });
    name();
    showJoints(data, state.analysis.path ? null : joints, stone, state.analysis.joints, (across) => {
      state.across = across;
      recolour();
    });
    recolour();
  }

  // Arrows turn the view, + and - zoom.
  function steer(event) {
    const turns = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }, zooms = { "+": 0.9, "-": 1 / 0.9 };
    if (!(event.key in turns) && !(event.key in zooms)) return;
    event.preventDefault();
    const [around, over] = turns[event.key] ?? [0, 0];
    const arm = camera.position.clone().sub(controls.target), length = arm.length() * (zooms[event.key] ?? 1);
    const azimuth = Math.atan2(arm.y, arm.x) + 0.12 * around;
    const polar = Math.min(Math.max(Math.acos(arm.z / arm.length()) + 0.12 * over, 0.01), Math.PI - 0.01);
    arm.set(Math.sin(polar) * Math.cos(azimuth), Math.sin(polar) * Math.sin(azimuth), Math.cos(polar)).multiplyScalar(length);
    camera.position.copy(controls.target).add(arm);
    controls.update();
    draw();
  }

  function find(wanted) {
    const stone = data.id.indexOf(wanted);
    element("viewer-picked").textContent = wanted ? `no stone ${wanted}` : "";
    chosen(stone >= 0 ? stone : null);
  }

  // How far the stone that is picked has moved changes with the amplitude and with the analysis.
  function name() {
    if (Number.isInteger(state.stone)) element("viewer-picked").textContent = describe(state.stone);
  }

  // What was said of a facet of the shell was of another analysis.
  function forget() {
    if (!Number.isInteger(state.stone)) element("viewer-picked").textContent = "";
  }

  function describe(s) {
    const course = data.course[s] >= 0 ? `, course ${data.course[s]}` : "";
    const moved = 2 * state.share * state.analysis.amplitude * state.analysis.speed[s];
    const motion = state.analysis.moving && !state.analysis.path ? `, moves ${lengthText(moved)}` : "";
    return `Stone ${data.id[s]}: ${data.panels[data.panel_of[s]].name}${course}${motion}`;
  }

  element("viewer-analysis").addEventListener("change", (e) => { choose(Number(e.target.value)); });
  if (shell) {
    element("viewer-shell").addEventListener("change", (e) => {
      shell.choose(Number(e.target.value));
      forget();
      recolour();
      move();
    });
    element("viewer-view").addEventListener("change", (e) => { show(e.target.value); });
  }
  element("viewer-colour").addEventListener("change", (e) => { state.byPanel = e.target.value === "panel"; recolour(); });
  element("viewer-amplitude").addEventListener("input", (e) => {
    setPlaying(false);
    state.share = Number(e.target.value) / 100;
    move();
  });
  element("viewer-play").addEventListener("click", () => { setPlaying(!state.playing); });
  element("viewer-reset").addEventListener("click", () => look());
  offerViews(look);
  offerSections(renderer, extent, draw);
  offerParts(data, [solid, wires], (point) => data.panel_of[stoneOfPoint[point]], draw);
  showLoads(data.loads, scene, element("viewer-parts"), draw);
  offerPictures(canvas, draw);
  controls.addEventListener("change", draw);
  controls.addEventListener("start", () => { state.turned = true; });
  canvas.addEventListener("keydown", steer);
  element("viewer-stone").addEventListener("change", (e) => { find(e.target.value.trim()); });
  let pressed = [0, 0];
  canvas.addEventListener("pointerdown", (e) => { pressed = [e.clientX, e.clientY]; });
  canvas.addEventListener("pointerup", (e) => {
    if (Math.hypot(e.clientX - pressed[0], e.clientY - pressed[1]) < 4) pick(e);
  });
  // A page that has become narrower would cut what it showed.
  new ResizeObserver(() => {
    resize();
    if (!state.turned) look(state.direction);
  }).observe(canvas.parentElement);
  resize();
  choose(0);
  look();
}

function ground(extent) {
  const group = new THREE.Group();
  const reach = Math.ceil((0.65 * Math.max(extent.x, extent.y) + 0.15 * extent.length()) / data.grid) * data.grid;
  const level = -1e-3 * extent.length();
  const plane = new THREE.Mesh(
    new THREE.PlaneGeometry(2 * reach, 2 * reach),
    new THREE.MeshBasicMaterial({ color: data.colours.ground, transparent: true, opacity: 0.3, depthWrite: false, side: THREE.DoubleSide }));
  const grid = new THREE.GridHelper(2 * reach, Math.round((2 * reach) / data.grid), data.colours.ground, data.colours.ground);
  grid.rotation.x = Math.PI / 2;
  plane.position.z = grid.position.z = level;
  group.add(plane, grid);
  return group;
}

function legend(byPanel, view, shellByPanel) {
  const box = element("viewer-legend");
  box.replaceChildren();
  const add = (stops, before, after) => {
    const bar = document.createElement("i");
    bar.className = "ramp";
    bar.style.background = `linear-gradient(to right, ${stops.join(",")})`;
    const item = document.createElement("span");
    item.append(`${before} `, bar, ` ${after}`);
    box.append(item);
  };
  const stonesSeen = view === "both" || view === "stones";
  if (view !== "stones" && !shellByPanel) add(data.shell.plastic_stops, "shell: elastic", "plastic strain");
  if (view === "overlay") {
    const item = document.createElement("span"), swatch = document.createElement("i");
    swatch.style.background = data.shell.joint;
    item.append(swatch, "joints of the stones that open");
    box.append(item);
  }
  if ((byPanel && stonesSeen) || shellByPanel) {
    for (const panel of data.panels.filter((p) => p.drawn)) {
      const item = document.createElement("span");
      const swatch = document.createElement("i");
      swatch.style.background = panel.colour;
      item.append(swatch, panel.name);
      box.append(item);
    }
  } else if (stonesSeen) {
    add(data.speed_stops, data.shell ? "stones: at rest" : "at rest", "fastest");
  }
  if (data.ground) {
    const item = document.createElement("span");
    item.append(`grid ${lengthText(data.grid)}`);
    box.append(item);
  }
}

const canvas = element("viewer-canvas");
let renderer = null;
try {
  renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
} catch (error) {
  document.body.dataset.viewer = "no-webgl";
}
if (renderer) {
  document.body.dataset.viewer = "on";
  start(canvas, renderer);
  requestAnimationFrame(() => { document.body.dataset.ready = "true"; });
}
