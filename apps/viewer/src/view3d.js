// The 3-D view: what the camera measured, the particles, the model at the estimate.
import * as THREE from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { cameraPart, cloudParts, matrixOf, modelParts, paintModel, particleParts, place, placeCloud, placeParticles } from './view_parts.js';
import { color, whenColorsChange } from './dom.js';

// Camera axes (y down, z forward) and object axes (z up) to three's (y up).
const UP_FROM_CAMERA = new THREE.Matrix4().makeScale(1, -1, -1);
const UP_FROM_OBJECT = new THREE.Matrix4().makeRotationX(-Math.PI / 2);

export class View3d {
  // Throws where the browser has no WebGL.
  constructor(container, data) {
    Object.assign(this, { container, data, frames: data.frames, index: 0 });
    this.options = { view: 'free', hold: 'part', coloring: 'depth',
      cloud: true, around: true, particles: true, model: true, truth: false, camera: true };
    this.renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.canvas = this.renderer.domElement;
    this.canvas.setAttribute('role', 'img');
    this.canvas.setAttribute('aria-label', 'Measured points, particles and the model at the estimate; drag to turn, wheel to zoom');
    container.append(this.canvas);
    this.build();
    this.eye = new THREE.PerspectiveCamera(38, 1, 0.01, 20);
    this.controls = new OrbitControls(this.eye, this.canvas);
    this.controls.addEventListener('change', () => this.draw());
    whenColorsChange(() => this.paint());
    new ResizeObserver(() => this.resize()).observe(container);
    this.paint();
    this.show(0);
    this.reset();
  }

  build() {
    const { model } = this.data;
    this.scene = new THREE.Scene();
    this.held = new THREE.Group(); // camera coordinates within
    this.held.matrixAutoUpdate = false;
    this.model = modelParts(model);
    this.particles = particleParts(Math.max(...this.frames.map((frame) => (frame.particles_float32?.length ?? 0) / 40 + 2)), model.diameter_m);
    this.clouds = cloudParts();
    const seen = this.frames.find((frame) => frame.camera);
    this.intrinsics = seen?.camera ?? [640, 480, 600, 600, 320, 240];
    this.camera = cameraPart(this.intrinsics, 0.22 * model.diameter_m);
    this.path = new THREE.Line(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ transparent: true, opacity: 0.6 }));
    this.path.frustumCulled = false;
    this.held.add(this.model.estimate, this.model.truth, this.particles, this.clouds.part, this.clouds.around, this.camera);
    this.light = new THREE.DirectionalLight(0xffffff, 2.1);
    this.scene.add(this.held, this.path, new THREE.HemisphereLight(0xffffff, 0x8090a0, 1.6), this.light, this.light.target);
  }

  paint() {
    this.scene.background = new THREE.Color(color('stage'));
    paintModel(this.model);
    this.camera.material.color.set(color('camera'));
    this.path.material.color.set(color('camera'));
    this.show(this.index);
  }

  // The part's place in the held-still part's coordinates: the truth where it is known, so that errors are seen to move.
  reference(index) {
    const frame = this.frames[index];
    const pose = frame.truth ?? frame.pose ?? this.frames.find((other) => other.pose)?.pose;
    return pose ? matrixOf(pose) : new THREE.Matrix4();
  }

  heldFromCamera(index) {
    if (this.options.hold === 'camera' || this.options.view === 'camera') return UP_FROM_CAMERA.clone();
    const centre = new THREE.Vector3(...this.data.model.centre_m);
    return UP_FROM_OBJECT.clone().multiply(new THREE.Matrix4().makeTranslation(centre.negate()))
      .multiply(this.reference(index).invert());
  }

  show(index) {
    this.index = index;
    const frame = this.frames[index];
    const { options } = this;
    this.held.matrix.copy(this.heldFromCamera(index));
    place(this.model.estimate, frame.pose);
    place(this.model.truth, frame.truth);
    this.model.estimate.visible &&= options.model;
    this.model.truth.visible &&= options.truth;
    placeParticles(this.particles, frame, this.data.model.centre_m);
    this.particles.visible = options.particles;
    placeCloud(this.clouds, frame, options.coloring);
    this.clouds.part.visible = options.cloud;
    this.clouds.around.visible = options.around;
    this.camera.visible = options.camera && options.view !== 'camera';
    this.showPath(index);
    this.scene.updateMatrixWorld(true);
    this.draw();
  }

  // Where the camera came from, as seen from the part.
  showPath(index) {
    this.path.visible = showsPath(this.options);
    if (!this.path.visible) return;
    const places = this.frames.slice(0, index + 1).filter((frame) => frame.truth ?? frame.pose)
      .map((frame) => new THREE.Vector3().setFromMatrixPosition(this.heldFromCamera(this.frames.indexOf(frame))));
    this.path.geometry.dispose();
    this.path.geometry = new THREE.BufferGeometry().setFromPoints(places);
  }

  set(name, value) {
    this.options[name] = value;
    this.show(this.index);
    if (name === 'view' || name === 'hold') this.reset();
  }

  // Where the viewer stands at first, and again after a change of what is held still.
  reset() {
    const { view, hold } = this.options;
    this.controls.enabled = view === 'free';
    this.resize();
    if (view === 'camera') {
      this.eye.position.set(0, 0, 0);
      this.eye.up.set(0, 1, 0);
      this.eye.lookAt(0, 0, -1);
      return this.draw();
    }
    const diameter = this.data.model.diameter_m;
    const up = new THREE.Vector3(0, 1, 0);
    const middle = Math.floor(0.5 * this.frames.length);
    const camera = new THREE.Vector3().setFromMatrixPosition(this.heldFromCamera(middle));
    const target = hold === 'part' ? new THREE.Vector3()
      : new THREE.Vector3(...this.data.model.centre_m).applyMatrix4(this.reference(middle)).applyMatrix4(this.heldFromCamera(middle));
    const towards = camera.clone().sub(target).normalize();
    const aside = new THREE.Vector3().crossVectors(up, towards);
    if (aside.length() < 0.3) aside.set(1, 0, 0);
    const direction = towards.multiplyScalar(0.55).add(aside.normalize().multiplyScalar(0.75)).addScaledVector(up, 0.35).normalize();
    // Part and camera both in view: the ball around the two, but never so far off that the part is a dot.
    const apart = Math.min(camera.distanceTo(target), 1.2 * diameter);
    const radius = 0.5 * (apart + 0.62 * diameter);
    target.addScaledVector(camera.clone().sub(target).normalize(), Math.max(0, radius - 0.45 * diameter));
    this.eye.position.copy(target).addScaledVector(direction, Math.max(1.5 * diameter, radius / Math.tan(Math.PI * 19 / 180)));
    this.controls.target.copy(target);
    this.controls.update();
    return this.draw();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.container;
    if (width < 10 || height < 10) return;
    this.renderer.setSize(width, height);
    this.eye.aspect = width / height;
    this.eye.near = 0.01 * this.data.model.diameter_m;
    this.eye.far = 60 * this.data.model.diameter_m;
    this.eye.updateProjectionMatrix();
    if (this.options.view === 'camera') this.project(width / height);
    this.draw();
  }

  // The real camera's image, widened or heightened to the panel's shape.
  project(aspect) {
    const [w, h, fx, fy, cx, cy] = this.intrinsics;
    const { near, far } = this.eye;
    let [left, right, top, bottom] = [-(cx + 0.5) / fx, (w - 0.5 - cx) / fx, (cy + 0.5) / fy, -(h - 0.5 - cy) / fy];
    const more = aspect * (top - bottom) - (right - left);
    if (more > 0) [left, right] = [left - more / 2, right + more / 2];
    else [top, bottom] = [top - more / aspect / 2, bottom + more / aspect / 2];
    this.eye.projectionMatrix.makePerspective(near * left, near * right, near * top, near * bottom, near, far);
    this.eye.projectionMatrixInverse.copy(this.eye.projectionMatrix).invert();
  }

  // camera_from_object of the mesh that is drawn, row-major 3 x 4, from the matrices it is drawn with.
  shownPose() {
    if (!this.frames[this.index].pose) return null;
    const matrix = this.held.matrixWorld.clone().invert().multiply(this.model.estimate.matrixWorld).transpose();
    return matrix.elements.slice(0, 12);
  }

  draw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.light.position.copy(this.eye.position).add(new THREE.Vector3(-0.3, 0.8, 0.2).multiplyScalar(this.data.model.diameter_m));
      this.light.target.position.copy(this.controls.target);
      this.renderer.render(this.scene, this.eye);
    });
  }
}

const showsPath = ({ camera, hold, view }) => camera && hold === 'part' && view === 'free';
