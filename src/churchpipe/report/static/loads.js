// Arrows of loads and of the push, and ties, in 3-D.
import * as THREE from "three";

const SHAFT = new THREE.CylinderGeometry(0.04, 0.04, 0.65, 16), HEAD = new THREE.ConeGeometry(0.11, 0.35, 24);
const UP = new THREE.Vector3(0, 1, 0);

export function arrowOf({ direction, start, length }, material) {
  const shaft = new THREE.Mesh(SHAFT, material), head = new THREE.Mesh(HEAD, material), group = new THREE.Group();
  shaft.position.y = 0.325;
  head.position.y = 0.825;
  group.add(shaft, head);
  group.scale.setScalar(length);
  group.quaternion.setFromUnitVectors(UP, new THREE.Vector3(...direction));
  group.position.set(...start);
  return group;
}

// Bars between two points; what might be added is dashed.
function bar(ends, added, radius, material) {
  const [start, end] = ends.map((end) => new THREE.Vector3(...end)), group = new THREE.Group();
  const direction = end.clone().sub(start), parts = added ? 15 : 1;
  for (let part = 0; part < parts; part += 2) {
    const piece = new THREE.Mesh(new THREE.CylinderGeometry(radius, radius, direction.length() / parts, 8), material);
    piece.quaternion.setFromUnitVectors(UP, direction.clone().normalize());
    piece.position.copy(start).addScaledVector(direction, (part + 0.5) / parts);
    group.add(piece);
  }
  for (const place of [start, end]) group.add(ball(place, 2.5 * radius, material));
  return group;
}

function ball(place, radius, material) {
  const mesh = new THREE.Mesh(new THREE.SphereGeometry(radius, 12, 8), material);
  mesh.position.copy(place);
  return mesh;
}

// What the building carries and its ties, seen through the stones before them, with a tick that hides them.
export function showLoads(loads, scene, box, draw) {
  if (!loads || !(loads.arrows.length || loads.dots.length || loads.ties.length)) return;
  const group = new THREE.Group(), clear = { transparent: true, opacity: 0.85, depthTest: false };
  const load = new THREE.MeshBasicMaterial({ color: loads.colours.load, ...clear });
  const tie = new THREE.MeshBasicMaterial({ color: loads.colours.tie, ...clear });
  loads.arrows.forEach((arrow) => group.add(arrowOf(arrow, load)));
  loads.dots.forEach((place) => group.add(ball(new THREE.Vector3(...place), loads.thickness, load)));
  loads.ties.forEach(({ ends, added }) => group.add(bar(ends, added, loads.thickness, tie)));
  scene.add(group);
  const label = document.createElement("label"), tick = document.createElement("input");
  tick.type = "checkbox";
  tick.id = "viewer-loads";
  tick.checked = true;
  tick.autocomplete = "off";
  tick.addEventListener("change", () => {
    group.visible = tick.checked;
    draw();
  });
  label.append(tick, " loads and ties");
  box.append(label);
}
