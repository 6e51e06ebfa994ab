"use strict";
// Scans as points that can be turned. LIDAR axes: x right, y down, z forward; yaw and pitch of 0 are the LIDAR's own view.
(() => {
  const bytes = (text) => Uint8Array.from(atob(text), (one) => one.charCodeAt(0));
  const still = matchMedia("(prefers-reduced-motion: reduce)"), views = [];
  const EDGES = [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]];
  const AXES = ["x", "y", "z"], LEVELS = 32, ASIDE = [0.55, -0.3], TURN = Math.PI / 36, FEW = 8;

  const rgb = (colour) => colour.match(/[\d.]+/g).slice(0, 3).map(Number);
  const ramp = (stops) => Array.from({ length: LEVELS }, (_, level) => {
    const at = (level / (LEVELS - 1)) * (stops.length - 1), low = Math.min(Math.floor(at), stops.length - 2);
    const [a, b] = [rgb(stops[low]), rgb(stops[low + 1])];
    return `rgb(${a.map((value, channel) => Math.round(value + (b[channel] - value) * (at - low))).join(",")})`;
  });

  class View {
    constructor(figure, shared) {
      this.figure = figure;
      this.canvas = figure.querySelector("canvas");
      this.legend = figure.querySelector(".g-scan-legend");
      this.data = JSON.parse(figure.querySelector(".g-data").textContent);
      this.fates = shared.fates;
      this.unpack();
      this.colour = "strength";
      this.hidden = new Set();
      this.zoom = 1;
      [this.yaw, this.pitch] = ASIDE;
      this.listen();
    }

    unpack() {
      const { data } = this, grid = new DataView(bytes(data.xyz).buffer);
      this.count = data.count;
      this.points = new Float32Array(3 * data.count);
      for (let i = 0; i < 3 * data.count; i++) this.points[i] = data.origin[i % 3] + data.step * grid.getInt16(2 * i, true) - data.centre[i % 3];
      for (const name of ["strength", "fate", "part", "lost"]) this[name] = bytes(data[name]);
      const [cx, cy, cz] = data.centre;
      this.ranges = Float32Array.from({ length: data.count }, (_, i) => Math.hypot(this.points[3 * i] + cx, this.points[3 * i + 1] + cy, this.points[3 * i + 2] + cz));
      const near = [...this.ranges].filter((_, i) => !this.lost[i]).sort((a, b) => a - b);
      this.least = near[Math.floor(near.length * 0.01)] ?? 0;
      this.most = near[Math.floor((near.length - 1) * 0.99)] ?? 1;
      const met = new Map();
      this.part.forEach((one, i) => { if (!this.lost[i]) met.set(one, (met.get(one) ?? 0) + 1); });
      this.largest = [...met].sort((a, b) => b[1] - a[1]).map(([one]) => one); // as many parts as there are colours stand apart
      const poses = data.poses.map((pose) => ({ ...pose, corners: pose.corners.map((p) => p.map((v, k) => v - data.centre[k])), axes: pose.axes.map((p) => p.map((v, k) => v - data.centre[k])) }));
      this.poses = poses;
      this.radius = Math.max(0.1, ...poses[0].corners.map((p) => Math.hypot(...p)));
    }

    reset() {
      this.yaw = this.pitch = 0;
      this.zoom = 1;
      this.draw();
    }

    turn(yaw, pitch) {
      this.yaw += yaw;
      this.pitch = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, this.pitch + pitch));
      this.draw();
    }

    closer(factor) {
      this.zoom = Math.max(0.3, Math.min(12, this.zoom * factor));
      this.draw();
    }

    listen() {
      const { canvas } = this;
      let from = null;
      canvas.addEventListener("pointerdown", (event) => { from = [event.clientX, event.clientY]; canvas.setPointerCapture(event.pointerId); });
      canvas.addEventListener("pointermove", (event) => {
        if (!from) return;
        this.turn((event.clientX - from[0]) / 120, (event.clientY - from[1]) / 120);
        from = [event.clientX, event.clientY];
      });
      for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => { from = null; });
      canvas.addEventListener("keydown", (event) => this.key(event));
      this.figure.querySelector(".g-tools").addEventListener("change", (event) => {
        const { type, value, checked } = event.target;
        if (type === "radio") this.colour = value;
        else if (checked) this.hidden.delete(+value);
        else this.hidden.add(+value);
        this.draw();
      });
      this.figure.querySelector(".g-buttons").addEventListener("click", (event) => this.press(event.target.closest("button")));
      new ResizeObserver(() => this.draw()).observe(canvas);
    }

    key(event) {
      const does = {
        ArrowLeft: () => this.turn(-TURN, 0), ArrowRight: () => this.turn(TURN, 0), ArrowUp: () => this.turn(0, -TURN), ArrowDown: () => this.turn(0, TURN),
        "+": () => this.closer(1.15), "=": () => this.closer(1.15), "-": () => this.closer(1 / 1.15), 0: () => this.reset(),
      }[event.key];
      if (!does || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      does();
    }

    press(button) {
      const what = button?.dataset.do;
      if (what === "closer") this.closer(1.25);
      else if (what === "away") this.closer(0.8);
      else if (what === "reset") this.reset();
      else if (what === "spin") {
        this.spinning = !this.spinning;
        button.setAttribute("aria-pressed", String(this.spinning));
        if (still.matches) { this.turn(Math.PI / 6, 0); this.spinning = false; button.setAttribute("aria-pressed", "false"); } // one step
        else if (this.spinning) this.spin(performance.now());
      }
    }

    spin(before) {
      if (this.spinning) requestAnimationFrame((now) => { this.turn(Math.min(now - before, 100) / 3000, 0); this.spin(now); });
    }

    theme() {
      const probe = this.figure.appendChild(document.createElement("i")), style = getComputedStyle(probe);
      const read = (name) => { probe.style.color = `var(--${name})`; return style.color; }; // a variable's own text need not be a colour
      const many = (name, count) => Array.from({ length: count }, (_, index) => read(`${name}-${index}`));
      const found = {
        ground: read("scan-ground"), ink: read("scan-ink"), true: read("true-line"), ramp: ramp(many("ramp", 6)),
        fate: many("fate", FEW), part: many("part", FEW), series: many("series", 6),
      };
      probe.remove();
      return found;
    }

    colours(theme) {
      const level = (share) => theme.ramp[Math.max(0, Math.min(LEVELS - 1, Math.round(share * (LEVELS - 1))))];
      const span = Math.max(this.most - this.least, 1e-6);
      return {
        strength: (i) => level(this.strength[i] / 255), range: (i) => level(1 - (this.ranges[i] - this.least) / span),
        fate: (i) => theme.fate[this.fate[i]] ?? theme.ink, part: (i) => theme.part[this.largest.indexOf(this.part[i])] ?? theme.ink,
      }[this.colour];
    }

    // Turned about the target's place: first about y (down), then about x (right); seen along z from far away.
    projection(width, height) {
      const [cy, sy, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
      const scale = (0.46 * Math.min(width, height) * this.zoom) / this.radius;
      return (x, y, z) => {
        const right = cy * x + sy * z, ahead = -sy * x + cy * z;
        return [width / 2 + scale * right, height / 2 + scale * (cp * y - sp * ahead), sp * y + cp * ahead];
      };
    }

    draw() {
      const { canvas } = this, theme = (this.themed ??= this.theme()), ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
      if (!width || !height) return;
      if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
        canvas.width = Math.round(width * ratio);
        canvas.height = Math.round(height * ratio);
      }
      const pen = canvas.getContext("2d"), place = this.projection(width, height);
      pen.setTransform(ratio, 0, 0, ratio, 0, 0);
      pen.fillStyle = theme.ground;
      pen.fillRect(0, 0, width, height);
      this.poses.forEach((pose, index) => { if (!this.hidden.has(index)) this.box(pen, pose, theme, place); });
      this.paint(pen, theme, place, width, height);
      this.explain(theme);
    }

    paint(pen, theme, place, width, height) {
      const colour = this.colours(theme), seen = [], all = this.colour === "fate";
      for (let i = 0; i < this.count; i++) {
        if (this.lost[i] && !all) continue;
        const [u, v, depth] = place(this.points[3 * i], this.points[3 * i + 1], this.points[3 * i + 2]);
        if (u > -4 && v > -4 && u < width + 4 && v < height + 4) seen.push([depth, u, v, i]);
      }
      seen.sort((a, b) => b[0] - a[0]); // the farthest first
      const size = Math.max(1.6, Math.min(4, 0.011 * Math.min(width, height) * Math.sqrt(this.zoom)));
      for (const [, u, v, i] of seen) {
        pen.fillStyle = colour(i);
        pen.fillRect(u - size / 2, v - size / 2, size, size);
      }
      this.drawn = seen.length;
    }

    box(pen, pose, theme, place) {
      const corners = pose.corners.map((p) => place(...p)), axes = pose.axes.map((p) => place(...p)), own = pose.series === null;
      const line = (a, b) => { pen.beginPath(); pen.moveTo(a[0], a[1]); pen.lineTo(b[0], b[1]); pen.stroke(); };
      pen.strokeStyle = own ? theme.true : theme.series[pose.series % 6];
      pen.fillStyle = pen.strokeStyle;
      pen.setLineDash(own ? [6, 4] : []);
      pen.lineWidth = own ? 1.6 : 1;
      for (const [a, b] of EDGES) line(corners[a], corners[b]);
      pen.lineWidth = 1.8;
      pen.font = "12px system-ui, sans-serif";
      AXES.forEach((name, k) => {
        line(axes[0], axes[k + 1]);
        if (own) pen.fillText(name, axes[k + 1][0] + 3, axes[k + 1][1] - 3);
      });
      pen.setLineDash([]);
    }

    explain(theme) {
      if (this.explained === this.colour + theme.ground) return;
      this.explained = this.colour + theme.ground;
      const swatch = (colour, name) => {
        const one = document.createElement("span"), patch = document.createElement("i");
        one.className = "g-swatch";
        patch.style.background = colour;
        one.append(patch, name);
        return one;
      };
      const bar = (low, high, stops) => {
        const one = document.createElement("span");
        one.className = "g-ramp";
        one.style.background = `linear-gradient(to right, ${stops.join(",")})`;
        return [low, one, high];
      };
      this.legend.replaceChildren(...{
        strength: () => bar("weak ", " strong", theme.ramp),
        range: () => bar(`${this.least.toFixed(1)} m `, ` ${this.most.toFixed(1)} m`, [...theme.ramp].reverse()),
        fate: () => [...new Set(this.fate)].sort((a, b) => a - b).map((one) => swatch(theme.fate[one] ?? theme.ink, this.fates[one] ?? "nothing")),
        part: () => [
          ...this.largest.slice(0, FEW).map((one, place) => swatch(theme.part[place], this.data.parts[one] ?? String(one))),
          ...(this.largest.length > FEW ? [swatch(theme.ink, "other parts")] : []),
        ],
      }[this.colour]());
    }
  }

  const shared = document.getElementById("scan3d-shared");
  if (!shared) return;
  for (const figure of document.querySelectorAll(".g-scan")) {
    for (const input of figure.querySelectorAll("input")) input.checked = input.defaultChecked;
    figure.querySelector(".g-tools").hidden = false;
    views.push(new View(figure, JSON.parse(shared.textContent)));
  }
  const repaint = () => views.forEach((view) => { view.themed = null; view.draw(); });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", repaint);
  new MutationObserver(repaint).observe(document.documentElement, { attributes: true, attributeFilter: ["data-theme"] });
})();
