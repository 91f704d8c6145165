// A camera that goes around what is looked at: by mouse, touch and keys.

const VIEW_ANGLE = 0.6;  // rad, from top to bottom
const START = { yaw: -0.9, pitch: 0.42 };
const MOST_PITCH = Math.PI / 2 - 0.001;
const TURNS = 16;      // directions around that a whole box is to be seen from
const MARGIN = 1.06;

export class Camera {
  constructor() {
    Object.assign(this, START, { target: [0, 0, 0], half: [0.5, 0.5, 0.5], size: 1, zoom: 1 });
  }

  // Looks at a box (low, high) as a whole, from where it looks now.
  frame([low, high]) {
    this.target = low.map((l, c) => (l + high[c]) / 2);
    this.half = low.map((l, c) => (high[c] - l) / 2);
    this.size = 2 * Math.hypot(...this.half) || 1;
    this.zoom = 1;
  }

  reset(box) {
    Object.assign(this, START);
    this.frame(box);
  }

  orbit(right, up) {
    this.yaw -= right;
    this.pitch = Math.min(MOST_PITCH, Math.max(-MOST_PITCH, this.pitch + up));
  }

  zoomBy(factor) {
    this.zoom = Math.min(50, Math.max(0.2, this.zoom * factor));
  }

  // Moves what is looked at along the picture, in parts of its height.
  pan(right, up) {
    const { x, y } = this.axes();
    const height = 2 * this.distance(1) * Math.tan(VIEW_ANGLE / 2);
    this.target = this.target.map((t, c) => t - height * (right * x[c] + up * y[c]));
  }

  // Axes of the picture: x to the right, y upwards, z towards the eye.
  axes(yaw = this.yaw, pitch = this.pitch) {
    const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
    return { x: [-sy, cy, 0], y: [-sp * cy, -sp * sy, cp], z: [cp * cy, cp * sy, sp] };
  }

  // From where the whole box is seen from all around, at the pitch of the start.
  distance(aspect) {
    const slope = Math.tan(VIEW_ANGLE / 2);
    let distance = 0;
    for (let turn = 0; turn < TURNS; ++turn) {
      const { x, y, z } = this.axes(2 * Math.PI * turn / TURNS, START.pitch);
      for (let corner = 0; corner < 8; ++corner) {
        const along = (axis) =>
          axis.reduce((sum, a, c) => sum + a * this.half[c] * (corner >> c & 1 ? 1 : -1), 0);
        const off = Math.max(Math.abs(along(x)) / aspect, Math.abs(along(y)));
        distance = Math.max(distance, along(z) + off / slope);
      }
    }
    return (MARGIN * distance || 1) / this.zoom;
  }

  // Matrices column by column: `view` to the eye's axes, `projection` to the picture.
  matrices(aspect) {
    const { x, y, z } = this.axes();
    const distance = this.distance(aspect);
    const eye = this.target.map((t, c) => t + distance * z[c]);
    const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const view = [x[0], y[0], z[0], 0, x[1], y[1], z[1], 0, x[2], y[2], z[2], 0,
      -dot(x, eye), -dot(y, eye), -dot(z, eye), 1];
    const near = Math.max(distance - 2 * this.size, distance / 100), far = distance + 2 * this.size;
    const f = 1 / Math.tan(VIEW_ANGLE / 2);
    const projection = [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1,
      0, 0, 2 * far * near / (near - far), 0];
    return { view, projection };
  }
}

// Lets a person move the camera on an element; calls changed() whenever it has moved, reset() for its
// first position.
export function steer(element, camera, changed, reset) {
  const pointers = new Map();
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, distance: Math.hypot(a.x - b.x, a.y - b.y) };
  };
  element.addEventListener("pointerdown", (event) => {
    element.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  element.addEventListener("pointermove", (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    const height = element.clientHeight;
    const now = { x: event.clientX, y: event.clientY };
    if (pointers.size === 2) {
      const before = spread();
      pointers.set(event.pointerId, now);
      const after = spread();
      camera.zoomBy(after.distance / (before.distance || 1));
      camera.pan((after.x - before.x) / height, (before.y - after.y) / height);
    } else if (event.buttons & 2 || event.shiftKey) {
      camera.pan((now.x - last.x) / height, (last.y - now.y) / height);
    } else {
      camera.orbit(5 * (now.x - last.x) / height, 5 * (now.y - last.y) / height);
    }
    pointers.set(event.pointerId, now);
    changed();
  });
  for (const end of ["pointerup", "pointercancel"]) {
    element.addEventListener(end, (event) => pointers.delete(event.pointerId));
  }
  element.addEventListener("contextmenu", (event) => event.preventDefault());
  element.addEventListener("wheel", (event) => {
    event.preventDefault();
    camera.zoomBy(Math.exp(-event.deltaY * (event.deltaMode === 1 ? 0.03 : 0.001)));
    changed();
  }, { passive: false });
  const keys = {
    ArrowLeft: () => camera.orbit(-0.1, 0), ArrowRight: () => camera.orbit(0.1, 0),
    ArrowUp: () => camera.orbit(0, 0.1), ArrowDown: () => camera.orbit(0, -0.1),
    "+": () => camera.zoomBy(1.15), "-": () => camera.zoomBy(1 / 1.15), 0: reset,
  };
  element.addEventListener("keydown", (event) => {
    if (!keys[event.key] || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    keys[event.key]();
    changed();
  });
}
