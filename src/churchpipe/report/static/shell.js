// The homogenised shell and the opened joints of the stones. Reads the "shell" part of #viewer-data (see shell_view.py).
import * as THREE from "three";

export const STONES = 1, SHELL = 2, JOINTS = 3;
// What each view draws, from left to right: the layers of each picture.
export const VIEWS = {
  both: [[STONES], [SHELL]],
  stones: [[STONES]],
  shell: [[SHELL]],
  overlay: [[SHELL, JOINTS]],
};

function bytes(text) {
  return Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
}
const floats = (text) => new Float32Array(bytes(text));
const integers = (text) => new Uint32Array(bytes(text));

function ramp(stops) {
  const colours = stops.map((c) => new THREE.Color(c));
  return (share, out) => {
    const place = Math.min(Math.max(share, 0), 1) * (colours.length - 1);
    const below = Math.min(Math.floor(place), colours.length - 2);
    return out.lerpColors(colours[below], colours[below + 1], place - below);
  };
}

// Facets have corners of their own, so that each has one colour; borders share the nodes.
function meshOf(data) {
  const rest = floats(data.points), triangles = integers(data.triangles), borders = integers(data.borders);
  const solid = new THREE.BufferGeometry(), lines = new THREE.BufferGeometry();
  solid.setAttribute("position", new THREE.BufferAttribute(new Float32Array(3 * triangles.length), 3));
  solid.setAttribute("color", new THREE.BufferAttribute(new Float32Array(3 * triangles.length), 3));
  lines.setAttribute("position", new THREE.BufferAttribute(new Float32Array(rest), 3));
  lines.setIndex(new THREE.BufferAttribute(borders, 1));
  return { rest, triangles, solid, lines, panels: data.panels, panelOf: integers(data.panel_of) };
}

function jointsOf({ points, ptr }) {
  const place = floats(points), pointer = integers(ptr);
  const faces = [], outline = [];
  for (let j = 0; j + 1 < pointer.length; j++) {
    for (let k = pointer[j]; k < pointer[j + 1]; k++) {
      outline.push(k, k + 1 < pointer[j + 1] ? k + 1 : pointer[j]);
      if (k > pointer[j] && k + 1 < pointer[j + 1]) faces.push(pointer[j], k, k + 1);
    }
  }
  const position = new THREE.BufferAttribute(place, 3);
  const [solid, lines] = [faces, outline].map((index) => {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", position);
    geometry.setIndex(index);
    return geometry;
  });
  return { solid, lines };
}

export class ShellView {
  constructor(data, panelColours, edgeColour, scene) {
    this.analyses = data.analyses.map((a) => ({ ...a, motion: floats(a.motion), strain: floats(a.strain) }));
    this.meshes = data.meshes.map(meshOf);
    this.joints = data.joints.map(jointsOf);
    this.panelColours = panelColours;
    this.strainColour = ramp(data.plastic_stops);
    this.surface = new THREE.Mesh(this.meshes[0].solid, new THREE.MeshLambertMaterial({
      vertexColors: true, flatShading: true, side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    }));
    this.borders = new THREE.LineSegments(this.meshes[0].lines, new THREE.LineBasicMaterial({ color: edgeColour }));
    this.opened = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshBasicMaterial({
      color: data.joint, side: THREE.DoubleSide, transparent: true, opacity: 0.55, depthWrite: false,
    }));
    this.rims = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: data.joint }));
    for (const [object, layer] of [[this.surface, SHELL], [this.borders, SHELL], [this.opened, JOINTS], [this.rims, JOINTS]]) {
      object.frustumCulled = false;
      object.layers.set(layer);
      scene.add(object);
    }
    this.current = this.analyses[0];
  }

  // The first analysis of the shell that answers the same question as a rigid-block one; -1: none does.
  partnerOf(number) {
    return this.analyses.findIndex((a) => a.partner === number);
  }

  choose(number) {
    this.current = this.analyses[number];
    this.mesh = this.meshes[this.current.mesh];
    this.surface.geometry = this.mesh.solid;
    this.borders.geometry = this.mesh.lines;
  }

  chooseJoints(number) {
    this.opened.geometry = this.joints[number].solid;
    this.rims.geometry = this.joints[number].lines;
  }

  move(amplitude) {
    const { rest, triangles, solid, lines } = this.mesh, { motion } = this.current;
    const nodes = lines.attributes.position.array, corners = solid.attributes.position.array;
    for (let i = 0; i < rest.length; i++) nodes[i] = rest[i] + amplitude * motion[i];
    triangles.forEach((node, corner) => {
      for (let c = 0; c < 3; c++) corners[3 * corner + c] = nodes[3 * node + c];
    });
    solid.attributes.position.needsUpdate = lines.attributes.position.needsUpdate = true;
  }

  // Plastic strain of a facet over the one that stands for the mechanism.
  share(facet) {
    return this.current.reference_strain > 0 ? this.current.strain[facet] / this.current.reference_strain : 0;
  }

  // The colour goes by the square root of the strain: hinges show beside cracks.
  paint(byPanel) {
    const { panelOf, solid, panels } = this.mesh, out = solid.attributes.color.array;
    const colour = new THREE.Color();
    panelOf.forEach((panel, facet) => {
      if (byPanel) colour.copy(this.panelColours[panels[panel]] ?? new THREE.Color("#cccccc"));
      else this.strainColour(this.share(facet) ** 0.5, colour);
      for (let k = 0; k < 3; k++) colour.toArray(out, 9 * facet + 3 * k);
    });
    solid.attributes.color.needsUpdate = true;
  }

  // What was hit, in words.
  describe(ray) {
    this.mesh.solid.computeBoundingSphere();
    const hit = ray.intersectObject(this.surface)[0];
    if (!hit) return "";
    const facet = hit.faceIndex;
    const strain = this.current.real ? `plastic strain ${this.current.strain[facet].toExponential(1)}`
      : `plastic strain ${Math.round(100 * this.share(facet))} % of the reference`;
    return `Shell, ${this.mesh.panels[this.mesh.panelOf[facet]]}: ${strain}`;
  }
}
