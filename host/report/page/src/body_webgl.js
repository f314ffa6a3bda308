// The body by WebGL. The same members as body_software.js.
import {
  AmbientLight,
  BufferAttribute,
  BufferGeometry,
  Color,
  DirectionalLight,
  DoubleSide,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  PerspectiveCamera,
  Raycaster,
  Scene,
  SphereGeometry,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { colour } from "./dom.js";
import { light } from "./colour.js";

const fieldOfView = 26;

/// Throws where there is no WebGL.
export class WebglBody {
  constructor(canvas) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(fieldOfView, 1, 0.01, 100);
    this.scene.add(this.camera, new AmbientLight(0xffffff, 1.6));
    const lamp = new DirectionalLight(0xffffff, 2.0);
    lamp.position.set(-0.6, 1, 0.9);
    this.camera.add(lamp, lamp.target);
    lamp.target.position.set(0, 0, -1);
    this.geometry = new BufferGeometry();
    this.mesh = new Mesh(
      this.geometry,
      new MeshLambertMaterial({
        vertexColors: true,
        side: DoubleSide,
        polygonOffset: true,
        polygonOffsetFactor: 1,
        polygonOffsetUnits: 1,
      }),
    );
    this.mesh.frustumCulled = false;
    this.lines = this.lineObject(0.32);
    this.ghost = this.lineObject(0.2);
    this.marker = new Mesh(new SphereGeometry(1, 20, 14), new MeshBasicMaterial({ depthTest: true }));
    this.halo = new Mesh(
      new SphereGeometry(1, 20, 14),
      new MeshBasicMaterial({ transparent: true, opacity: 0.25, depthTest: false }),
    );
    this.marker.visible = this.halo.visible = false;
    this.scene.add(this.mesh, this.lines, this.ghost, this.halo, this.marker);
    this.ghost.visible = false;
    this.frameAt({ centre: [0, 0, 0], radius: 1 });
    this.theme();
  }

  lineObject(opacity) {
    const object = new LineSegments(
      new BufferGeometry(),
      new LineBasicMaterial({ transparent: true, opacity, depthWrite: false }),
    );
    object.frustumCulled = false;
    return object;
  }

  setFaces(faces, vertices) {
    this.geometry.setIndex(new BufferAttribute(faces, 1));
    for (const name of ["position", "normal", "color"])
      this.geometry.setAttribute(name, new BufferAttribute(new Float32Array(3 * vertices), 3));
  }

  setShape(positions, normals) {
    this.geometry.attributes.position.array.set(positions);
    this.geometry.attributes.normal.array.set(normals);
    this.geometry.attributes.position.needsUpdate = this.geometry.attributes.normal.needsUpdate = true;
    this.geometry.boundingSphere = null;
  }

  /// `indices` into `table`, 256 colours of three bytes.
  setColours(indices, table) {
    const out = this.geometry.attributes.color.array;
    for (let i = 0; i < indices.length; ++i) for (let c = 0; c < 3; ++c) out[3 * i + c] = light[table[3 * indices[i] + c]];
    this.geometry.attributes.color.needsUpdate = true;
  }

  setLines(points) {
    this.place(this.lines, points);
  }

  setGhost(points) {
    this.place(this.ghost, points);
  }

  place(object, points) {
    object.visible = points !== null;
    if (points) {
      object.geometry.dispose();
      object.geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(points, 3));
    }
  }

  setMarker(point) {
    this.marker.visible = this.halo.visible = point !== null;
    if (!point) return;
    this.marker.position.set(...point);
    this.halo.position.set(...point);
    this.marker.scale.setScalar(0.016 * this.frame.radius);
    this.halo.scale.setScalar(0.04 * this.frame.radius);
  }

  frameAt(frame) {
    this.frame = frame;
  }

  theme() {
    this.lines.material.color = new Color(colour("--body-lines"));
    this.ghost.material.color = new Color(colour("--ghost"));
    this.marker.material.color = new Color(colour("--marker"));
    this.halo.material.color = new Color(colour("--marker"));
  }

  resize(width, height, ratio) {
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
  }

  draw(view) {
    const { centre, radius } = this.frame;
    const half = Math.atan(Math.tan((fieldOfView * Math.PI) / 360) * Math.min(1, this.camera.aspect));
    const away = (0.9 * radius) / Math.sin(half) / view.zoom;
    this.camera.position.set(...view.direction().map((d, c) => centre[c] + away * d));
    this.camera.near = Math.max(away - 3 * radius, away / 100);
    this.camera.far = away + 3 * radius;
    this.camera.lookAt(...centre);
    this.camera.updateProjectionMatrix();
    this.renderer.render(this.scene, this.camera);
  }

  /// {corners, weights} of the foremost face at a point of the picture, or null.
  pick([x, y]) {
    const caster = new Raycaster();
    caster.setFromCamera(new Vector2(x, y), this.camera);
    const [hit] = caster.intersectObject(this.mesh);
    if (!hit) return null;
    const corners = [hit.face.a, hit.face.b, hit.face.c];
    const { array } = this.geometry.attributes.position;
    const [a, b, c] = corners.map((v) => new Vector3().fromArray(array, 3 * v));
    const area = (p, q, r) => q.clone().sub(p).cross(r.clone().sub(p)).length();
    const parts = [area(hit.point, b, c), area(hit.point, c, a), area(hit.point, a, b)];
    const sum = parts[0] + parts[1] + parts[2] || 1;
    return { corners, weights: parts.map((part) => part / sum) };
  }
}
