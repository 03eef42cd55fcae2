// What stands in the 3-D view. Everything but the model's mesh is in camera coordinates [m]: x right, y down, z forward.
import * as THREE from 'three';
import { float32, int16, points, uint32 } from './decode.js';
import { depthColor, residualColor } from './ramps.js';
import { color } from './dom.js';

export const RESIDUAL_RANGE_MM = 3;
const NO_RESIDUAL = -32768;

// [x y z qx qy qz qw] to a matrix.
export function matrixOf(pose) {
  const [x, y, z, ...xyzw] = pose;
  return new THREE.Matrix4().compose(new THREE.Vector3(x, y, z), new THREE.Quaternion(...xyzw).normalize(), new THREE.Vector3(1, 1, 1));
}

export function place(object, pose) {
  object.visible = pose != null;
  if (pose) object.matrix.copy(matrixOf(pose));
}

function geometryOf(model) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(points(model.vertices), 3));
  const corners = uint32(model.triangles_uint32);
  if (corners.length > 0) geometry.setIndex(new THREE.BufferAttribute(corners, 1));
  return geometry;
}

// The mesh at the estimate, see-through with its edges, and the lines of the same at the truth.
export function modelParts(model) {
  const geometry = geometryOf(model);
  const estimate = new THREE.Group(), truth = new THREE.Group();
  for (const group of [estimate, truth]) group.matrixAutoUpdate = false;
  if (!geometry.index) {
    const dots = (size) => new THREE.Points(geometry, new THREE.PointsMaterial({ size, sizeAttenuation: false }));
    estimate.add(dots(2));
    truth.add(dots(1.5));
  } else {
    const faces = new THREE.MeshStandardMaterial({ flatShading: true, side: THREE.DoubleSide, transparent: true,
      opacity: 0.72, roughness: 0.65, metalness: 0.05, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
    const edges = new THREE.EdgesGeometry(geometry, 30);
    estimate.add(new THREE.Mesh(geometry, faces),
      new THREE.LineSegments(edges, new THREE.LineBasicMaterial({ transparent: true, opacity: 0.55 })));
    truth.add(new THREE.LineSegments(edges, new THREE.LineBasicMaterial({ transparent: true, opacity: 0.9 })));
  }
  return { estimate, truth };
}

export function paintModel({ estimate, truth }) {
  const materials = estimate.children.map((child) => child.material);
  materials[0].color.set(color('model'));
  materials[1]?.color.set(color('model-edge'));
  truth.children[0].material.color.set(color('truth'));
}

// Three short arms, red x, green y, blue z: one instance a particle.
export function particleParts(count, diameterM) {
  const arm = 0.055 * diameterM, width = 0.006 * diameterM;
  const positions = [], colors = [], index = [];
  for (let axis = 0; axis < 3; ++axis) {
    const size = [width, width, width], shift = [0, 0, 0];
    size[axis] = arm;
    shift[axis] = arm / 2;
    const box = new THREE.BoxGeometry(...size).translate(...shift);
    const first = positions.length / 3;
    positions.push(...box.attributes.position.array);
    for (let i = 0; i < box.attributes.position.count; ++i) colors.push(...[[0.95, 0.25, 0.25], [0.2, 0.75, 0.3], [0.25, 0.5, 1]][axis]);
    for (const corner of box.index.array) index.push(first + corner);
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(positions, 3));
  geometry.setAttribute('color', new THREE.Float32BufferAttribute(colors, 3));
  geometry.setIndex(index);
  const material = new THREE.MeshBasicMaterial({ vertexColors: true, depthTest: false, transparent: true, opacity: 0.8 });
  const mesh = new THREE.InstancedMesh(geometry, material, Math.max(1, count));
  mesh.frustumCulled = false;
  mesh.renderOrder = 5;
  return mesh;
}

// The markers sit at the part's centre under each particle; heavier ones are larger.
export function placeParticles(mesh, frame, centreM) {
  const rows = float32(frame.particles_float32);
  mesh.count = rows.length / 8;
  const centre = new THREE.Vector3(...centreM);
  let heaviest = 1e-12;
  for (let i = 7; i < rows.length; i += 8) heaviest = Math.max(heaviest, rows[i]);
  for (let i = 0; i < mesh.count; ++i) {
    const row = rows.subarray(8 * i, 8 * i + 8);
    const size = 0.7 + 0.6 * Math.sqrt(row[7] / heaviest);
    const matrix = matrixOf(row.subarray(0, 7));
    matrix.setPosition(centre.clone().applyMatrix4(matrix));
    mesh.setMatrixAt(i, matrix.scale(new THREE.Vector3(size, size, size)));
  }
  mesh.instanceMatrix.needsUpdate = true;
}

export function cloudParts() {
  const cloud = (size, opacity) => {
    const made = new THREE.Points(new THREE.BufferGeometry(),
      new THREE.PointsMaterial({ size, sizeAttenuation: false, vertexColors: true, transparent: opacity < 1, opacity }));
    made.frustumCulled = false;
    return made;
  };
  return { part: cloud(2.6, 1), around: cloud(2, 0.55) };
}

function fill(cloud, positions, colorAt) {
  cloud.geometry.dispose();
  cloud.geometry = new THREE.BufferGeometry();
  const colors = new Float32Array(positions.length);
  const set = new THREE.Color();
  for (let i = 0; i < positions.length / 3; ++i) {
    set.setRGB(...colorAt(i, positions[3 * i + 2]), THREE.SRGBColorSpace).toArray(colors, 3 * i);
  }
  cloud.geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
  cloud.geometry.setAttribute('color', new THREE.BufferAttribute(colors, 3));
}

export function placeCloud(parts, frame, coloring) {
  const all = frame.cloud ? points(frame.cloud) : new Float32Array();
  const split = 3 * (frame.on_part ?? 0);
  const residuals = int16(frame.residuals_int16);
  const grey = new THREE.Color(color('around')).toArray();
  const depthAt = (i, z) => depthColor((z - frame.near_m) / (frame.far_m - frame.near_m));
  const residualAt = (i) => (residuals[i] === NO_RESIDUAL ? grey
    : residualColor(residuals[i] * frame.residual_unit_mm / RESIDUAL_RANGE_MM));
  fill(parts.part, all.slice(0, split), coloring === 'residual' ? residualAt : depthAt);
  fill(parts.around, all.slice(split), () => grey);
}

// The camera's corner rays to `lengthM`, and a bar where its top is.
export function cameraPart(camera, lengthM) {
  const [width, height, fx, fy, cx, cy] = camera;
  const corner = (u, v) => [lengthM * (u - cx) / fx, lengthM * (v - cy) / fy, lengthM];
  const corners = [corner(-0.5, -0.5), corner(width - 0.5, -0.5), corner(width - 0.5, height - 0.5), corner(-0.5, height - 0.5)];
  const top = [corner(0.4 * width, -0.06 * height), corner(0.5 * width, -0.16 * height), corner(0.6 * width, -0.06 * height)];
  const lines = [];
  corners.forEach((from, i) => lines.push([0, 0, 0], from, from, corners[(i + 1) % 4]));
  top.forEach((from, i) => lines.push(from, top[(i + 1) % 3]));
  const geometry = new THREE.BufferGeometry().setAttribute('position', new THREE.Float32BufferAttribute(lines.flat(), 3));
  return new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ transparent: true, opacity: 0.9 }));
}
