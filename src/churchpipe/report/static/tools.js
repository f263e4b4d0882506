// Tools of the viewer: standard views, sections, parts to hide, the joints of a stone, pictures, full screen. And tables as CSV.
import * as THREE from "three";

const element = (id) => document.getElementById(id);

export const VIEWPOINTS = {
  "from the front": [0, -1, 0], "from behind": [0, 1, 0], "from the left": [-1, 0, 0], "from the right": [1, 0, 0],
  "from above": [0, -1e-3, 1], "oblique": [0.55, -0.75, 0.4],
};

export function download(name, blob) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

export function offerViews(look) {
  const choice = element("viewer-viewpoint");
  Object.keys(VIEWPOINTS).forEach((name) => choice.append(new Option(name, name)));
  choice.addEventListener("change", () => look(VIEWPOINTS[choice.value]));
}

// A plane cuts the structure; what lies on the far side of it, seen along the axis, stays.
export function offerSections(renderer, extent, draw) {
  const axis = element("viewer-section"), place = element("viewer-section-place");
  const update = () => {
    const a = axis.value ? "xyz".indexOf(axis.value) : -1;
    place.disabled = a < 0;
    renderer.clippingPlanes = [];
    if (a >= 0) {
      const from = a === 2 ? 0 : -extent.getComponent(a) / 2;
      const at = from + (extent.getComponent(a) * Number(place.value)) / 100;
      const normal = new THREE.Vector3().setComponent(a, a === 1 ? 1 : -1);
      renderer.clippingPlanes = [new THREE.Plane(normal, a === 1 ? -at : at)];
    }
    draw();
  };
  axis.addEventListener("change", update);
  place.addEventListener("input", update);
}

// Macro-elements can be hidden: their triangles and edges leave the index, so that they cannot be picked either.
export function offerParts(data, geometries, panelOfPoint, draw) {
  const hidden = new Set(), box = element("viewer-parts");
  const whole = geometries.map((geometry) => geometry.index.array.slice());
  const update = () => {
    geometries.forEach((geometry, g) => {
      const size = g === 0 ? 3 : 2, kept = [];
      for (let i = 0; i < whole[g].length; i += size) {
        if (!hidden.has(panelOfPoint(whole[g][i]))) for (let k = 0; k < size; k++) kept.push(whole[g][i + k]);
      }
      geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(kept), 1));
    });
    draw();
  };
  data.panels.forEach((panel, number) => {
    if (!panel.drawn) return;
    const label = document.createElement("label"), tick = document.createElement("input");
    tick.type = "checkbox";
    tick.checked = true;
    tick.autocomplete = "off";
    tick.addEventListener("change", () => {
      hidden[tick.checked ? "delete" : "add"](number);
      update();
    });
    label.append(tick, ` ${panel.name}`);
    box.append(label);
  });
}

export function offerPictures(canvas, draw) {
  element("viewer-picture").addEventListener("click", () => {
    draw();
    canvas.toBlob((blob) => download(`${document.querySelector("h1").textContent}.png`, blob));
  });
  element("viewer-full").addEventListener("click", () => element("viewer").requestFullscreen());
}

const HEADINGS = ["Joint with", "Kind", "Normal force, kN", "Shear, kN", "Shear / normal", "Opening rate", "Sliding rate"];

function row(cells, tag) {
  const line = document.createElement("tr");
  cells.forEach((text, c) => {
    const cell = document.createElement(tag);
    cell.textContent = text;
    if (c > 1) cell.className = "number";
    line.append(cell);
  });
  return line;
}

// The joints of a stone: with which neighbour, the resultants, and how fast the mechanism opens them and slides in them. A joint is
// picked by the name of the neighbour: `mark` is called with it.
export function showJoints(data, joints, stone, values, mark) {
  const box = element("viewer-joints");
  box.replaceChildren();
  if (stone === null || !joints) return;
  const number = (value) => (Number.isFinite(value) ? value.toFixed(3) : "");
  // kN: three figures where three decimals would leave fewer, because the joints of a model bear newtons; what is below is rounding.
  const force = (newtons) =>
    Math.abs(newtons) >= 1e-3 && Math.abs(newtons) < 100 ? String(Number((newtons / 1e3).toPrecision(3))) : number(newtons / 1e3);
  const table = document.createElement("table");
  table.append(row(HEADINGS, "th"));
  for (let i = 0; i < joints.kind.length; i++) {
    const first = joints.blocks[2 * i], second = joints.blocks[2 * i + 1];
    if (first !== stone && second !== stone) continue;
    const [normal, shear, opening, slip] = values.subarray(4 * i, 4 * i + 4);
    const across = first === stone ? second : first, name = document.createElement("button");
    const line = row(["", joints.kinds[joints.kind[i]], force(normal),
      force(shear), normal > 0 ? number(shear / normal) : "", number(opening), number(slip)], "td");
    name.type = "button";
    name.textContent = data.id[across];
    name.addEventListener("click", () => {
      table.querySelectorAll(".marked").forEach((other) => other.classList.remove("marked"));
      line.classList.add("marked");
      mark(across);
    });
    line.firstChild.append(name);
    table.append(line);
  }
  const note = document.createElement("p");
  note.className = "small";
  note.textContent = "Forces are resultants, of one equilibrium of many. " +
    "Rates are speeds of the mechanism, whose size means nothing: compare them with each other.";
  box.append(table, note);
}
